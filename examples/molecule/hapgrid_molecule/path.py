"""The path from a saddle down to a minimum, and eleven nodes along it: the intrinsic reaction coordinate, by local quadratic
steps (Page and McIver 1988). A plain gradient step would zigzag across the valley, whose walls are a thousand times steeper
than its floor.
"""

import itertools
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline, make_interp_spline
from scipy.optimize import brentq

from . import geometry, optimise
from .xtb import BOHR, HARTREE

FIRST_LEG = 10  # segments from the conformation to its first saddle; their length holds for all


def _arc_step(values, f, length):
    """Components of the steepest-descent step of a given arc length on a quadratic surface, or of
    the step to the surface's lowest point when that is nearer."""
    def at(t):
        # -f (1 - exp(-values t)) / values, and its limit -f t for small values t
        z = np.clip(values * t, -50, 700)
        safe = np.where(values == 0, 1, values)
        return -f * np.where(np.abs(z) < 1e-8, t, -np.expm1(-z) / safe)
    if values[0] > 0 and np.linalg.norm(f / values) < length:
        return -f / values
    high = 1.0
    while np.linalg.norm(at(high)) < length and high < 1e12:
        high *= 2
    return at(brentq(lambda t: np.linalg.norm(at(t)) - length, 0, high, xtol=1e-14 * high))


def descend(surface, saddle, sign, stop, step=0.2, steps=1200, every=12):
    """Shapes downhill from the saddle, which is the first. sign: which way along the falling mode. stop(shape, energy): true
    where the path may end. step: sqrt(amu) bohr. every: steps between exact Hessians; with updates alone the path would leave
    the floor of the valley."""
    root, hessian = np.repeat(np.sqrt(surface.masses), 3), saddle.hessian
    _, vectors = optimise.projected(hessian, saddle.x, surface.masses)
    surface(saddle.x)  # an SCF starts from the one before
    x = saddle.x + (sign * step * vectors[:, 0] / root).reshape(-1, 3)
    energy, gradient = surface(x)
    shapes, trial = [saddle.x, x], step
    for count in range(steps):
        if stop(x, energy) or np.abs(gradient).max() < 1e-6:
            break
        if count % every == 0:
            hessian = surface.hessian(x)
        values, vectors = optimise.projected(hessian, x, surface.masses)
        f = vectors.T @ (gradient.ravel() / root)
        moved = x + ((vectors @ _arc_step(values, f, trial)) / root).reshape(-1, 3)
        new, new_gradient = surface(moved)
        if new > energy + 1e-8 and trial > 0.01:
            trial /= 2
            hessian = surface.hessian(x)
            continue
        trial = min(step, trial * 1.5)
        hessian = optimise.bofill(hessian, (moved - x).ravel(), (new_gradient - gradient).ravel())
        x, energy, gradient = moved, new, new_gradient
        shapes.append(x)
    return shapes


def aligned_chain(shapes, masses):
    """Superposes each shape on the one before, so that only motion inside the molecule is left."""
    return list(itertools.accumulate(shapes, lambda before, x: geometry.aligned(x, before, masses)))


def _along(chain):
    """How far each shape of a chain is from the first, root mean square displacements added up."""
    return np.cumsum([0.0, *(geometry.rms(a, b) for a, b in zip(chain, chain[1:]))])


def resampled(shapes, masses, nodes=11, apart=None):
    """Shapes at equal distances (root mean square displacement) along a chain of nearby shapes;
    apart: about this far from each other, whatever their number."""
    chain = aligned_chain(shapes, masses)
    along = _along(chain)
    if apart is not None:
        nodes = max(4, round(along[-1] / apart) + 1)
    return list(make_interp_spline(along, chain, k=1)(np.linspace(0, along[-1], nodes)))


def spline(tree, shapes):
    """Internal coordinates as a function of t, in [0, 1], through those of the shapes: as the model has them."""
    q = np.array([tree.read(x) for x in shapes])
    q[:, 2] = np.unwrap(q[:, 2], axis=0)
    return CubicSpline(np.linspace(0, 1, len(q)), q, bc_type="natural")


def nodes(surface, saddle, sign, start, count=11, apart=None, near=None, turns=()):
    """(shapes, energies) from the minimum `start` to the saddle, at equal distances; apart: as resampled() has it. near: the
    minimum to which the path down leads, where that is `start` but for turns, [(Torsion, angle)], which the path has less and
    less. Errors: optimise.NoPath, when the path down ends elsewhere, or has a bump between its nodes."""
    masses, near = surface.masses, near or start

    def away(x):
        return geometry.rms(geometry.aligned(x, near.x, masses), near.x)

    def there(x, energy):
        # From here the path goes straight on: near a minimum a straight line to it never rises.
        return (energy - near.energy) * HARTREE < 0.02 and away(x) < 0.1
    shapes = descend(surface, saddle, sign, there)
    if away(shapes[-1]) > 0.4:
        raise optimise.NoPath(f"the path down ends {away(shapes[-1]) * BOHR:.2f} angstrom from the conformation")
    shapes = resampled([near.x] + shapes[::-1], masses, count, apart)
    for torsion, turn in turns:
        shapes = [torsion.turned(x, turn * (1 - k / (len(shapes) - 1))) for k, x in enumerate(shapes)]
    # Rounded as in the file, so that the file's energies are those of its shapes.
    shapes = [geometry.as_in_file(x) for x in [start.x, *(geometry.aligned(x, start.x, masses) for x in shapes[1:])]]
    energies = [start.energy] + [surface.energy(x) for x in shapes[1:]]
    middles = (np.arange(len(shapes) - 1) + 0.5) / (len(shapes) - 1)
    check(energies, [surface.energy(surface.tree.build(q)) for q in spline(surface.tree, shapes)(middles)], start.energy)
    return shapes, energies


def over(surface, ends, start, apart):
    """(nodes() from the minimum `start` up to the saddle of Ends, the same from it down to the minimum on its far side, that
    minimum as in a file, the distance of nodes). apart: that of the first leg, None for the first leg itself."""
    up = nodes(surface, ends.saddle, ends.sign, start, FIRST_LEG + 1, apart)
    if apart is None:
        apart = _along(aligned_chain(up[0], surface.masses))[-1] / FIRST_LEG
    x = geometry.as_in_file(ends.far.x)
    far = replace(ends.far, x=x, energy=surface.energy(x))
    shapes, energies = nodes(surface, ends.saddle, -ends.sign, far, apart=apart)
    return up, (shapes[::-1], energies[::-1]), far, apart


def check(energies, halfway, energy0):
    """Raises optimise.NoPath unless the energy climbs from the minimum to the saddle, at the nodes and,
    nearly so, half way between them. Slack: 0.05 kJ/mol and 0.5 % of the barrier (a methyl group
    that almost turns freely is at rest elsewhere along the way), half way another 5 %."""
    at, mid = ([(e - energy0) * HARTREE for e in some] for some in (energies, halfway))
    slack = 0.05 + 0.005 * at[-1]
    for k, (a, b) in enumerate(zip(at, at[1:])):
        if b < a - slack:
            raise optimise.NoPath(f"the energy falls by {a - b:.2f} kJ/mol before node {k + 1}")
        loose = slack + 0.05 * at[-1]
        if not a - loose < mid[k] < b + loose:
            raise optimise.NoPath(f"{mid[k]:.2f} kJ/mol between nodes of {a:.2f} and {b:.2f} kJ/mol")
