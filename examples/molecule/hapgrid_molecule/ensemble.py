"""Paths between minima that are given, as an ensemble of conformers has them.

From the conformation to another minimum a chain of shapes is laid, each of which relaxes across the chain. Its top leads to
a saddle, and that to two minima. Where these are not the two ends, the gaps are closed in the same way. So a path is a row of
legs, each from a minimum over a saddle to the next. Rings flip along such paths, which no single bond could do.

Alternative: a nudged elastic band. Its springs need hundreds of steps; here each shape takes quasi-Newton steps of its own.
"""

import numpy as np

from . import geometry, optimise, path
from .xtb import BOHR

SHAPES = 11  # of a chain, with its ends
ROUNDS = 3  # of relaxing across the chain
STEPS = 6  # of each shape in a round
HELD = 1.0  # hartree/bohr²: what holds a shape in its place along the chain
MOST_LEGS = 6
FIRST_LEG = 10  # segments from the conformation to the first saddle; their length holds for all


def minimum(work, x):
    """(x, energy, hessian) of the minimum near a shape in angstrom, which lies as the conformation does."""
    x, _, hessian = optimise.minimum(work.surface, numbered_alike(work.molecule, x / BOHR, work.x))
    if not work.intact(x):
        raise optimise.NoPath("its bonds change")
    turned = np.round(geometry.aligned(x, work.x, work.surface.masses) * BOHR, 8) / BOHR  # as in the file
    return turned, work.surface.energy(turned), hessian


def numbered_alike(molecule, x, reference):
    """x with equal atoms exchanged where an atom with four neighbours is the mirror image of that in the reference: programs
    that embed shapes number the hydrogens of a CH2 group either way. Errors: optimise.NoPath, for another stereoisomer."""
    x = x.copy()
    for at, near in enumerate(molecule.neighbours):
        if len(near) != 4:
            continue
        here, there = (np.linalg.det(y[near[1:]] - y[near[0]]) for y in (x, reference))
        if here * there > 0:
            continue
        ends = [a for a in near if len(molecule.neighbours[a]) == 1]
        pair = next(((a, b) for a in ends for b in ends if a < b and molecule.numbers[a] == molecule.numbers[b]), None)
        if pair is None:
            raise optimise.NoPath(f"another stereoisomer, at atom {at + 1}")
        x[list(pair)] = x[list(pair[::-1])]
    return x


def _chain(work, a, b):
    """Shapes from a to b, straight in internal coordinates: torsions turn the short way."""
    tree = work.tree
    q = tree.read(a)
    change = tree.read(b) - q
    change[2] = geometry.wrapped(change[2])
    shapes = [tree.build(q + t * change) for t in np.linspace(0, 1, SHAPES)]
    # Where a tree of bonds cuts rings open, the straight line is in space.
    straight = geometry.aligned(b, a, work.surface.masses)
    if any(not work.intact(x) for x in shapes):
        shapes = [a + t * (straight - a) for t in np.linspace(0, 1, SHAPES)]
    return path.resampled([a, *shapes[1:-1], straight], work.surface.masses, SHAPES)


def _across(work, shapes, hessians):
    """The shapes of a chain, each relaxed but for its place along the chain, which it keeps."""
    surface, out = work.surface, [shapes[0]]
    for k in range(1, len(shapes) - 1):
        x = shapes[k]
        along = (shapes[k + 1] - shapes[k - 1]).ravel()
        along /= np.linalg.norm(along)

        def held(y, x=x, along=along):
            energy, gradient = surface(y)
            off = along @ (y - x).ravel()
            return energy + HELD * off**2 / 2, gradient + (HELD * off * along).reshape(-1, 3)
        wall = HELD * np.outer(along, along)
        y, _, bend = optimise.search(held, x, hessians[k] + wall, tolerance=5e-4, steps=STEPS, strict=False)
        hessians[k] = bend - wall
        out.append(geometry.aligned(y, out[-1], surface.masses))
    return [*out, geometry.aligned(shapes[-1], out[-1], surface.masses)]


def _top(work, a, b):
    """(guess of the highest saddle between two minima, the chain's direction there)."""
    shapes = _chain(work, a, b)
    hessians = [work.surface.hessian(x) for x in shapes]
    for _ in range(ROUNDS):
        shapes = path.resampled(_across(work, shapes, hessians), work.surface.masses, SHAPES)
    energies = [work.surface.energy(x) for x in shapes]
    k = int(np.argmax(energies))
    if k in (0, len(shapes) - 1):
        raise optimise.NoPath("no barrier lies between the two minima")
    return shapes[k], (shapes[k + 1] - shapes[k - 1]).ravel()


def legs(work, a, b, left=MOST_LEGS):
    """[(saddle, its hessian, (near side, far side))] on a way from minimum a to minimum b, in this order; each is (x, energy,
    hessian). A side is (sign, x, energy, hessian). Errors: optimise.NoPath."""
    if left < 1:
        raise optimise.NoPath(f"more than {MOST_LEGS} barriers lie on the way")
    guess, along = _top(work, a[0], b[0])
    saddle, top, bend, _ = work.climbed(guess, along)
    if work.above(top) > work.options.highest:
        raise optimise.NoPath(f"a barrier of {work.above(top):.0f} kJ/mol lies on the way")
    one, two = work.sides(saddle, bend)
    if not (work.intact(one[1]) and work.intact(two[1])):
        raise optimise.NoPath("bonds change")
    # The side that is a comes first; otherwise the pair that leaves less to go.
    gap = work.apart(one[1], a[0]) + work.apart(two[1], b[0]) - work.apart(two[1], a[0]) - work.apart(one[1], b[0])
    near, far = (one, two) if gap <= 0 else (two, one)
    if work.same(near[1], far[1]):
        raise optimise.NoPath("its highest barrier leads back to where it began")
    out = [(saddle, bend, (near, far))]
    if not work.same(near[1], a[0]):
        out = legs(work, a, near[1:], left - 1) + out
    if not work.same(far[1], b[0]):
        out = out + legs(work, far[1:], b, left - len(out))
    return out


def way(work, b):
    """(nodes, energies, {node: "minimum" or "saddle"}) from the conformation to minimum b, as beyond.Way has them."""
    nodes, energies, kinds, apart = [work.x], [work.energy], {}, None
    x, energy = work.x, work.energy
    for saddle, bend, (near, far) in legs(work, (work.x, work.energy, work.hessian), b):
        up, rise = path.nodes(work.surface, work.tree, saddle, bend, near[0], x, energy, FIRST_LEG + 1, apart)
        if apart is None:
            apart = path.length(up, work.surface.masses) / FIRST_LEG
        x = np.round(far[1] * BOHR, 8) / BOHR
        energy = work.surface.energy(x)
        down, fall = path.nodes(work.surface, work.tree, saddle, bend, far[0], x, energy, apart=apart)
        for more, heights, kind in ((up, rise, "saddle"), (down[::-1], fall[::-1], "minimum")):
            nodes += more[1:]
            energies += heights[1:]
            kinds[len(nodes) - 1] = kind
    nodes = [nodes[0], *(geometry.aligned(n, work.x, work.surface.masses) for n in nodes[1:])]
    return nodes, energies, kinds
