"""Paths between minima that are given, as an ensemble of conformers has them.

From the conformation to another minimum a chain of shapes is laid, each of which relaxes across the chain. Its top leads to
a saddle, and that to two minima. Where these are not the two ends, the gaps are closed in the same way. So a path is a row of
legs, each from a minimum over a saddle to the next. Rings flip along such paths, which no single bond could do.

Alternative: a nudged elastic band. Its springs need hundreds of steps; here each shape takes quasi-Newton steps of its own.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hapgrid.apps.common.arrays import Array

from . import geometry, optimise, path, torsions
from .molecule import Molecule
from .results import Ends, Path, Point
from .search import Search
from .xtb import BOHR

SHAPES = 11  # of a chain, with its ends
ROUNDS = 3  # of relaxing across the chain
STEPS = 6  # of each shape in a round
HELD = 1.0  # hartree/bohr²: what holds a shape in its place along the chain
MOST_LEGS = 6


def minimum(search: Search, x: Array) -> Point:
    """The minimum near a shape in angstrom, which lies as the conformation does."""
    one = optimise.minimum(search.surface, numbered_alike(search.molecule, x / BOHR, search.x))
    if not search.intact(one.x):
        raise optimise.NoPath("its bonds change")
    if why := search.start.isomer.differs(one.x):
        raise optimise.NoPath(why)
    turned = geometry.as_in_file(geometry.aligned(one.x, search.x, search.surface.masses))
    return replace(one, x=turned, energy=search.surface.energy(turned))


def numbered_alike(molecule: Molecule, x: Array, reference: Array) -> Array:
    """x with equal atoms exchanged where an atom with four neighbours is the mirror image of that in the reference, and where
    one that is flat would have to turn by more than a right angle: programs that embed shapes number the hydrogens of CH2 and
    NH2 either way. Errors: optimise.NoPath, for another stereoisomer."""
    x = x.copy()
    for at, near in enumerate(molecule.neighbours):
        leaves = [a for a in near if len(molecule.neighbours[a]) == 1]
        if len(near) == 3 and len(leaves) == 2 and len({molecule.numbers[a] for a in leaves}) == 1:
            other = next(a for a in near if a not in leaves)
            ends = [a for a in molecule.neighbours[other] if a != at]
            if ends and all(abs(torsions.height(y, molecule.neighbours, at)) < torsions.FLAT for y in (x, reference)):
                here, there = (geometry.torsion(y, leaves[0], at, other, ends[0]) for y in (x, reference))
                if np.cos(here - there) < 0:
                    x[leaves] = x[leaves[::-1]]
        if len(near) != 4:
            continue
        here, there = (np.linalg.det(y[near[1:]] - y[near[0]]) for y in (x, reference))
        if here * there > 0:
            continue
        equal = next(([a, b] for a in leaves for b in leaves if a < b and molecule.numbers[a] == molecule.numbers[b]), None)
        if equal is None:
            raise optimise.NoPath(f"another stereoisomer, at atom {at + 1}")
        x[equal] = x[equal[::-1]]
    return x


def _chain(search: Search, a: Array, b: Array) -> list[Array]:
    """Shapes from a to b, straight in internal coordinates: torsions turn the short way."""
    tree = search.surface.tree
    q, change = tree.read(a), tree.change(a, b)
    shapes = [tree.build(q + t * change) for t in np.linspace(0, 1, SHAPES)]
    # Where a tree of bonds cuts rings open, the straight line is in space.
    straight = geometry.aligned(b, a, search.surface.masses)
    if any(not search.intact(x) for x in shapes):
        shapes = [a + t * (straight - a) for t in np.linspace(0, 1, SHAPES)]
    return path.resampled([a, *shapes[1:-1], straight], search.surface.masses, SHAPES)


def _across(search: Search, shapes: list[Array], hessians: list[Array]) -> list[Array]:
    """The shapes of a chain, each relaxed but for its place along the chain, which it keeps."""
    surface, out = search.surface, [shapes[0]]
    for k in range(1, len(shapes) - 1):
        x = shapes[k]
        along = (shapes[k + 1] - shapes[k - 1]).ravel()
        along /= np.linalg.norm(along)

        def held(y: Array, x: Array = x, along: Array = along) -> tuple[float, Array]:
            energy, gradient = surface(y)
            off = along @ (y - x).ravel()
            return energy + HELD * off**2 / 2, gradient + (HELD * off * along).reshape(-1, 3)
        wall = HELD * np.outer(along, along)
        y, _, bend = optimise.search(held, x, hessians[k] + wall, tolerance=5e-4, steps=STEPS, strict=False,
                                     noise=surface.noise)
        hessians[k] = bend - wall
        out.append(geometry.aligned(y, out[-1], surface.masses))
    return [*out, geometry.aligned(shapes[-1], out[-1], surface.masses)]


def _top(search: Search, a: Array, b: Array) -> tuple[Array, Array]:
    """(guess of the highest saddle between two minima, the chain's direction there)."""
    shapes = _chain(search, a, b)
    hessians = [search.surface.hessian(x) for x in shapes]
    for _ in range(ROUNDS):
        shapes = path.resampled(_across(search, shapes, hessians), search.surface.masses, SHAPES)
    energies = search.surface.energies(shapes)
    k = int(np.argmax(energies))
    if k in (0, len(shapes) - 1):
        raise optimise.NoPath("no barrier lies between the two minima")
    return shapes[k], (shapes[k + 1] - shapes[k - 1]).ravel()


def legs(search: Search, a: Point, b: Point, left: int = MOST_LEGS) -> list[Ends]:
    """The Ends of the saddles on a way from minimum a to minimum b, in this order. Errors: optimise.NoPath."""
    if left < 1:
        raise optimise.NoPath(f"more than {MOST_LEGS} barriers lie on the way")
    saddle = search.climbed(*_top(search, a.x, b.x))
    height = search.above(saddle.energy)
    if height > search.start.options.highest:
        raise optimise.NoPath(f"a barrier of {height:.0f} kJ/mol lies on the way")
    ends = search.ends(saddle, a.x, b.x)
    if not (search.intact(ends.near.x) and search.intact(ends.far.x)):
        raise optimise.NoPath("bonds change")
    if search.same(ends.near.x, ends.far.x):
        raise optimise.NoPath("its highest barrier leads back to where it began")
    out = [ends]
    if not search.same(ends.near.x, a.x):
        out = legs(search, a, ends.near, left - 1) + out
    if not search.same(ends.far.x, b.x):
        out = out + legs(search, ends.far, b, left - len(out))
    return out


def path_to(search: Search, b: Point) -> Path:
    """The Path from the conformation to minimum b."""
    out, at, apart = Path([search.x], [search.energy]), search.rest, None
    for ends in legs(search, at, b):
        up, down, at, apart = path.over(search.surface, ends, at, apart)
        out.add(*up, "saddle")
        out.add(*down, "minimum")
    out.nodes[1:] = [geometry.aligned(n, search.x, search.surface.masses) for n in out.nodes[1:]]
    return out
