"""The path between a minimum and a saddle, and eleven nodes along it. It is the way by which the minimum was found from
the saddle (optimise.minimum): short quasi-Newton steps, on which stiff modes are at rest, so that it lies close to the
floor of the valley. Alternative: the intrinsic reaction coordinate, the line of steepest descent. It needs a descent of its
own, and its nodes have about the same energies: those of butane's paths differ by at most 0.9 kJ/mol.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from hapgrid.apps.common.arrays import Array, Shapes
from scipy.interpolate import CubicSpline, make_interp_spline

from . import geometry, optimise
from .results import Ends, Point
from .xtb import HARTREE

if TYPE_CHECKING:
    from .geometry import Tree
    from .torsions import Torsion
    from .xtb import Potential

Leg: TypeAlias = tuple[list[Array], list[float]]  # shapes and their energies
FIRST_LEG = 10  # segments from the conformation to its first saddle; their length holds for all


def aligned_chain(shapes: Shapes, masses: Array) -> list[Array]:
    """Superposes each shape on the one before, so that only motion inside the molecule is left."""
    return list(itertools.accumulate(shapes, lambda before, x: geometry.aligned(x, before, masses)))


def _along(chain: Shapes) -> Array:
    """How far each shape of a chain is from the first, root mean square displacements added up."""
    return np.cumsum([0.0, *(geometry.rms(a, b) for a, b in zip(chain, chain[1:]))])


def resampled(shapes: Shapes, masses: Array, nodes: int = 11, apart: float | None = None) -> list[Array]:
    """Shapes at equal distances (root mean square displacement) along a chain of nearby shapes;
    apart: about this far from each other, whatever their number."""
    chain = aligned_chain(shapes, masses)
    along = _along(chain)
    if apart is not None:
        nodes = max(4, round(along[-1] / apart) + 1)
    return list(make_interp_spline(along, chain, k=1)(np.linspace(0, along[-1], nodes)))


def spline(tree: Tree, shapes: Shapes) -> Any:
    """Internal coordinates as a function of t, in [0, 1], through those of the shapes: as the model has them."""
    q = np.array([tree.read(x) for x in shapes])
    q[:, 2] = np.unwrap(q[:, 2], axis=0)
    return CubicSpline(np.linspace(0, 1, len(q)), q, bc_type="natural")


def nodes(surface: Potential, shapes: Shapes, start: Point, count: int = 11, apart: float | None = None,
          turns: Sequence[tuple[Torsion, float]] = ()) -> Leg:
    """(shapes, energies) at equal distances along a chain of shapes up to a saddle; apart: as resampled() has it. The chain
    begins in a shape like the minimum `start`, but for turns, [(Torsion, angle)], which the path has less and less. Errors:
    optimise.NoPath, where the path has a bump between its nodes."""
    masses = surface.masses
    shapes = resampled(shapes, masses, count, apart)
    for torsion, turn in turns:
        shapes = [torsion.turned(x, turn * (1 - k / (len(shapes) - 1))) for k, x in enumerate(shapes)]
    # Rounded as in the file, so that the file's energies are those of its shapes.
    shapes = [geometry.as_in_file(x) for x in [start.x, *(geometry.aligned(x, start.x, masses) for x in shapes[1:])]]
    energies = [start.energy, *surface.energies(shapes[1:])]
    middles = (np.arange(len(shapes) - 1) + 0.5) / (len(shapes) - 1)
    check(energies, surface.energies([surface.tree.build(q) for q in spline(surface.tree, shapes)(middles)]), start.energy,
          optimise.LOUD * surface.noise[0] * HARTREE)
    return shapes, energies


def over(surface: Potential, ends: Ends, start: Point, apart: float | None) -> tuple[Leg, Leg, Point, float]:
    """(nodes() from the minimum `start` up to the saddle of Ends, the same from it down to the minimum on its far side, that
    minimum as in a file, the distance of nodes). apart: that of the first leg, None for the first leg itself."""
    up = nodes(surface, ends.up, start, FIRST_LEG + 1, apart)
    if apart is None:
        apart = _along(aligned_chain(up[0], surface.masses))[-1] / FIRST_LEG
    x = geometry.as_in_file(ends.far.x)
    far = replace(ends.far, x=x, energy=surface.energy(x))
    shapes, energies = nodes(surface, ends.down[::-1], far, apart=apart)
    return up, (shapes[::-1], energies[::-1]), far, apart


def check(energies: Sequence[float], halfway: Sequence[float], energy0: float, noise: float = 0.0) -> None:
    """Raises optimise.NoPath unless the energy climbs from the minimum to the saddle, at the nodes and,
    nearly so, half way between them. Slack: 0.05 kJ/mol and 0.5 % of the barrier (a methyl group
    that almost turns freely is at rest elsewhere along the way), half way another 5 %."""
    at, mid = ([(e - energy0) * HARTREE for e in some] for some in (energies, halfway))
    slack = 0.05 + 0.005 * at[-1] + noise
    for k, (a, b) in enumerate(zip(at, at[1:])):
        if b < a - slack:
            raise optimise.NoPath(f"the energy falls by {a - b:.2f} kJ/mol before node {k + 1}")
        loose = slack + 0.05 * at[-1]
        if not a - loose < mid[k] < b + loose:
            raise optimise.NoPath(f"{mid[k]:.2f} kJ/mol between nodes of {a:.2f} and {b:.2f} kJ/mol")
