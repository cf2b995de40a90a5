"""Minima and saddles: quasi-Newton steps in a trust radius.

Curvatures of a peptide's energy differ by five orders of magnitude between a bond and a soft
torsion, so steps are taken along the eigenvectors of a Hessian, never along the gradient. The
search for a saddle is the same, but it climbs along one eigenvector (Cerjan and Miller 1981).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from hapgrid.apps.common.arrays import Array
from scipy.optimize import brentq

from . import geometry
from .results import Point
from .xtb import WAVE_NUMBER


if TYPE_CHECKING:
    from .xtb import Potential

FINE = 3e-6  # hartree/bohr: the largest component of the gradient at a minimum or a saddle
# A bond beside several alkynes has no barrier: the differences of which a Hessian is made do not tell its wave number, cm^-1,
# from 0. Where energies of the shapes along it, hartree, are one, too, nothing falls.
LEVEL, LEVEL_ENERGY = 5.0, 1e-6

LOUD = 4.0  # times the noise: what differs by less is the same


class NoPath(Exception):
    """There is no path, or no such point on it; the message says why."""


class TurnsFreely(NoPath):
    """Nothing holds the bond."""


class NotConverged(NoPath):
    """The steps did not suffice."""


def projected(hessian: Array, x: Array, weights: Array | None = None) -> tuple[Array, Array]:
    """(eigenvalues ascending, eigenvectors) without shifts and turns. With masses as weights they
    are those of mass-weighted coordinates."""
    weights = np.ones(len(x)) if weights is None else weights
    root = np.repeat(1 / np.sqrt(weights), 3)
    rigid = geometry.rigid_vectors(x, weights)
    # Internal directions: the orthogonal complement, so that no eigenvalue is an artificial zero.
    basis = np.linalg.svd(rigid, full_matrices=True)[0][:, rigid.shape[1]:]
    values, vectors = np.linalg.eigh(basis.T @ (root[:, None] * hessian * root) @ basis)
    return values, basis @ vectors


def wave_numbers(hessian: Array, x: Array, masses: Array) -> Array:
    """Normal modes in cm^-1, ascending; imaginary ones negative."""
    values, _ = projected(hessian, x, masses)
    return np.sign(values) * np.sqrt(np.abs(values)) * WAVE_NUMBER


def point(surface: Potential, x: Array) -> Point:
    hessian = surface.hessian(x)
    return Point(x, surface.energy(x), hessian, float(wave_numbers(hessian, x, surface.masses)[0]))


def _bfgs(hessian: Array, s: Array, y: Array) -> Array:
    hs = hessian @ s
    if s @ y < 1e-12:  # the Hessian would no longer be positive definite
        return hessian
    return hessian + np.outer(y, y) / (s @ y) - np.outer(hs, hs) / (s @ hs)


def _bofill(hessian: Array, s: Array, y: Array) -> Array:
    """The update that may keep a negative eigenvalue. Source: Bofill 1994."""
    r: Array = y - hessian @ s
    ss, rs, rr = s @ s, r @ s, r @ r
    if ss < 1e-20 or rr < 1e-20:
        return hessian
    phi = rs * rs / (rr * ss)
    powell = (np.outer(r, s) + np.outer(s, r)) / ss - rs / ss**2 * np.outer(s, s)
    return hessian + rs / (rr * ss) * np.outer(r, r) + (1 - phi) * powell


def step_within(values: Array, f: Array, climbed: int | None, trust: float) -> Array:
    """Components of the step to the lowest point of a quadratic surface, within a trust radius; along a mode that is climbed
    to the highest one. values, f: curvatures and slopes along the modes."""
    values, f = values.copy(), f.copy()
    if climbed is not None:
        values[climbed], f[climbed] = abs(values[climbed]), -f[climbed]

    def length(shift: float) -> float:
        return float(np.linalg.norm(f / (values + shift)))
    shift = max(0.0, 1e-6 - values.min())
    if length(shift) > trust:
        shift = brentq(lambda shift: length(shift) - trust, shift, np.linalg.norm(f) / trust - values.min())
    return -f / (values + shift)


def search(function: Callable[[Array], tuple[float, Array]], x: Array, hessian: Array, *, climb: Array | None = None,
           tolerance: float = 1e-5, steps: int = 300, longest: float = 0.3, renew: Callable[[Array], Array] | None = None,
           every: int = 0, strict: bool = True, passed: list[Array] | None = None,
           noise: tuple[float, float] = (0.0, 0.0)) -> tuple[Array, float, Array]:
    """A stationary point near x: a minimum, or with `climb` a saddle.

    function(x): (energy, gradient). hessian: the first one. climb: a vector (3 atoms); the mode
    nearest to it is climbed, and then always the mode nearest to the one before. tolerance: largest
    component of the gradient (hartree/bohr). longest: step, bohr. renew(x): an exact Hessian, taken every `every`
    steps. strict: whether steps that do not suffice are an error. passed: a list that gets the shapes on the way. noise: of
    the energy and of a component of the gradient: within it no step is uphill, and no gradient is too large.
    Returns (x, energy, hessian as updated).
    """
    energy, gradient = function(x)
    rough = LOUD * noise[0]
    tolerance = max(tolerance, LOUD * noise[1])
    mode, update, trust = climb, _bfgs if climb is None else _bofill, min(0.2, longest)
    for count in range(steps):
        g = gradient.ravel()
        if np.abs(g).max() < tolerance:
            return x, energy, hessian
        values, vectors = projected(hessian, x)
        f, chosen = vectors.T @ g, None
        if climb is not None:
            # The mode most like the one before. Soft modes mix from step to step, so likeness alone may mislead: only modes
            # that fall are taken, or the softest where none falls.
            chosen = int(np.argmax(np.abs(vectors[:, :int((values < 0).sum()) or 8].T @ mode)))
            mode = vectors[:, chosen]
        step = step_within(values, f, chosen, trust)
        length = float(np.linalg.norm(step))
        expected = f @ step + step @ (values * step) / 2
        moved = x + (vectors @ step).reshape(-1, 3)
        new_energy, new_gradient = function(moved)
        gain = new_energy - energy
        hessian = update(hessian, vectors @ step, new_gradient.ravel() - g)
        ratio = gain / expected if abs(expected) > max(1e-9, rough) else 1.0
        if climb is None and gain > max(1e-6, rough) and (ratio < 0 or rough > abs(expected)):
            trust = max(length / 4, 1e-4)  # uphill: not taken, but it has improved the Hessian
            continue
        if ratio < 0.25 or climb is not None and ratio > 3:
            trust = max(length / 2, 0.01)
        elif ratio > 0.75 and length > 0.8 * trust:
            trust = min(2 * trust, longest)
        x, energy, gradient = moved, new_energy, new_gradient
        if passed is not None:
            passed.append(x)
        if renew and every and (count + 1) % every == 0:
            hessian = renew(x)
    if strict:
        raise NotConverged(f"not converged: {steps} steps left a gradient of {np.abs(gradient).max():.1e} hartree/bohr")
    return x, energy, hessian


def minimum(surface: Potential, x: Array, hessian: Array | None = None, longest: float = 0.3,
            passed: list[Array] | None = None) -> Point:
    """The minimum downhill of x, with its exact Hessian. longest, passed: as search() has them; short steps stay in the valley
    where they start."""
    hessian = surface.hessian(x) if hessian is None else hessian
    energies = []
    for tolerance, leave in zip((1e-4, FINE, FINE, FINE, FINE), (0.1, 0.2, 0.3, 0.4, 0.5)):
        x, *_ = search(surface, x, hessian, tolerance=tolerance, steps=400, longest=longest, renew=surface.hessian,
                       every=3 * surface.renewal, passed=passed, noise=surface.noise)
        one = point(surface, x)
        hessian = one.hessian
        energies.append(one.energy)
        if one.nu1 <= 0:
            # A saddle is near, or it is kept by symmetry: leave it downhill along the mode that falls, farther each time, since
            # on a nearly free rotor noise decides what is downhill at first.
            mode = projected(hessian, x)[1][:, 0]
            x = x - np.copysign(leave, surface(x)[1].ravel() @ mode) * mode.reshape(-1, 3)
        elif tolerance == FINE:
            return one
    if one.nu1 > -LEVEL and np.ptp(energies[1:]) < LEVEL_ENERGY:
        return one
    raise NotConverged("not converged: no minimum near a point of symmetry")


def saddle(surface: Potential, x: Array, direction: Array) -> Point:
    """The saddle uphill along the mode nearest to `direction` (3 atoms), with its exact Hessian. Steps are short, since long
    ones on an updated Hessian leave the ridge where a soft torsion's scan snaps over."""
    x, *_ = search(surface, x, surface.hessian(x), climb=direction, tolerance=FINE, steps=200, longest=0.2,
                   renew=surface.hessian, every=surface.renewal, noise=surface.noise)
    return point(surface, x)
