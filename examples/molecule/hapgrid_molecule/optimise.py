"""Minima and saddles: quasi-Newton steps in a trust radius.

Curvatures of a peptide's energy differ by five orders of magnitude between a bond and a soft
torsion, so steps are taken along the eigenvectors of a Hessian, never along the gradient. The
search for a saddle is the same, but it climbs along one eigenvector (P-RFO, Banerjee et al. 1985).
"""

import numpy as np

from . import geometry
from .results import Point
from .xtb import WAVE_NUMBER


class NoPath(Exception):
    """There is no path, or no such point on it; the message says why."""


class TurnsFreely(NoPath):
    """Nothing holds the bond."""


class NotConverged(NoPath):
    """The steps did not suffice."""


def projected(hessian, x, weights=None):
    """(eigenvalues ascending, eigenvectors) without shifts and turns. With masses as weights they
    are those of mass-weighted coordinates."""
    weights = np.ones(len(x)) if weights is None else weights
    root = np.repeat(1 / np.sqrt(weights), 3)
    rigid = geometry.rigid_vectors(x, weights)
    # Internal directions: the orthogonal complement, so that no eigenvalue is an artificial zero.
    basis = np.linalg.svd(rigid, full_matrices=True)[0][:, rigid.shape[1]:]
    values, vectors = np.linalg.eigh(basis.T @ (root[:, None] * hessian * root) @ basis)
    return values, basis @ vectors


def wave_numbers(hessian, x, masses):
    """Normal modes in cm^-1, ascending; imaginary ones negative."""
    values, _ = projected(hessian, x, masses)
    return np.sign(values) * np.sqrt(np.abs(values)) * WAVE_NUMBER


def point(surface, x, energy, hessian):
    return Point(x, energy, hessian, float(wave_numbers(hessian, x, surface.masses)[0]))


def bfgs(hessian, s, y):
    hs = hessian @ s
    if s @ y < 1e-12:  # the Hessian would no longer be positive definite
        return hessian
    return hessian + np.outer(y, y) / (s @ y) - np.outer(hs, hs) / (s @ hs)


def bofill(hessian, s, y):
    """The update that may keep a negative eigenvalue. Source: Bofill 1994."""
    r = y - hessian @ s
    ss, rs, rr = s @ s, r @ s, r @ r
    if ss < 1e-20 or rr < 1e-20:
        return hessian
    phi = rs * rs / (rr * ss)
    powell = (np.outer(r, s) + np.outer(s, r)) / ss - rs / ss**2 * np.outer(s, s)
    return hessian + rs / (rr * ss) * np.outer(r, r) + (1 - phi) * powell


def _rfo(values, f, climbed):
    """Step in eigenvector components: one climbed (or None), the others descended."""
    step = np.zeros_like(f)
    down = np.ones(len(f), bool)
    if climbed is not None:
        down[climbed] = False
        b, g = values[climbed], f[climbed]
        step[climbed] = -g / (b - (b + np.sqrt(b * b + 4 * g * g)) / 2) if g != 0 else 0
    n = down.sum()
    matrix = np.zeros((n + 1, n + 1))
    matrix[range(n), range(n)] = values[down]
    matrix[:n, n] = matrix[n, :n] = f[down]
    gap = values[down] - np.linalg.eigvalsh(matrix)[0]
    # Where by symmetry nothing pulls along a mode that falls, this is 0 / 0.
    step[down] = -f[down] / np.maximum(gap, 1e-12)
    return step


def search(function, x, hessian, *, climb=None, tolerance=1e-5, steps=300, trust=0.2, longest=0.3,
           renew=None, every=0, tree=None, strict=True):
    """A stationary point near x: a minimum, or with `climb` a saddle.

    function(x): (energy, gradient). hessian: the first one. climb: a vector (3 atoms); the mode
    nearest to it is climbed, and then always the mode nearest to the one before. tolerance: largest
    component of the gradient (hartree/bohr). renew(x): an exact Hessian, taken every `every` steps.
    tree: coordinates in which the steps are straight. strict: whether steps that do not suffice are an error.
    Returns (x, energy, hessian as updated).
    """
    energy, gradient = function(x)
    mode, update = climb, bfgs if climb is None else bofill
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
        step = _rfo(values, f, chosen)
        length = np.linalg.norm(step)
        if length > trust:
            step *= trust / length
            length = trust
        expected = f @ step + step @ (values * step) / 2
        s = (vectors @ step).reshape(-1, 3)
        moved = x + s if tree is None else tree.moved(x, s)
        new_energy, new_gradient = function(moved)
        gain = new_energy - energy
        hessian = update(hessian, (moved - x).ravel(), new_gradient.ravel() - g)
        ratio = gain / expected if abs(expected) > 1e-9 else 1.0
        if climb is None and gain > 1e-6 and ratio < 0:
            trust = max(length / 4, 1e-4)  # uphill: not taken, but it has improved the Hessian
            continue
        if ratio < 0.25 or climb is not None and ratio > 3:
            trust = max(length / 2, 0.01)
        elif ratio > 0.75 and length > 0.8 * trust:
            trust = min(2 * trust, longest)
        x, energy, gradient = moved, new_energy, new_gradient
        if renew and every and (count + 1) % every == 0:
            hessian = renew(x)
    if strict:
        raise NotConverged(f"not converged: {steps} steps left a gradient of {np.abs(gradient).max():.1e} hartree/bohr")
    return x, energy, hessian


def minimum(surface, x, hessian=None, tolerance=3e-6, steps=400, longest=0.3):
    """The minimum downhill of x, with its exact Hessian. longest: the longest step, bohr; short steps stay in the valley
    where they start."""
    exact, how = surface.hessian, dict(renew=surface.hessian, tree=surface.tree)
    x, energy, _ = search(surface, x, exact(x) if hessian is None else hessian, tolerance=1e-4, steps=steps,
                          every=3 * surface.renewal, trust=min(0.2, longest), longest=longest, **how)
    for _ in range(3):
        x, energy, _ = search(surface, x, exact(x), tolerance=tolerance, steps=100, every=surface.renewal, **how)
        bend = exact(x)
        values, vectors = projected(bend, x)
        if values[0] > 0:
            return point(surface, x, energy, bend)
        # A saddle, kept by symmetry: leave it along the mode that falls.
        x = x + 0.1 * vectors[:, 0].reshape(-1, 3)
    raise NotConverged("not converged: no minimum near a point of symmetry")


def saddle(surface, x, direction, tolerance=3e-6):
    """The saddle uphill along the mode nearest to `direction` (3 atoms), with its exact Hessian.

    Where a soft torsion's scan snaps over, long steps on an updated Hessian leave the ridge. Then the search begins anew with
    short steps and a fresh Hessian at nearly each.
    """
    how = dict(climb=direction, tolerance=tolerance, renew=surface.hessian, tree=surface.tree)
    first = surface.hessian(x)
    try:
        x, energy, _ = search(surface, x, first, steps=150, trust=0.1, longest=0.5, every=surface.renewal, **how)
    except NotConverged:
        x, energy, _ = search(surface, x, first, steps=80, trust=0.05, longest=0.1, every=surface.renewal // 3, **how)
    return point(surface, x, energy, surface.hessian(x))
