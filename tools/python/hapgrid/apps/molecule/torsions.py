"""Which torsions are driven, and how: a relaxed scan towards a barrier.

A scan only gives a guess. Other modules refine it to a saddle and check its frequencies. Some
torsions lead to no saddle from a given minimum; their scans only climb.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from hapgrid.apps.common.arrays import Array, Neighbours, Shapes

from . import geometry, optimise
from .results import Point
from .xtb import HARTREE, Potential

LEAST_BARRIER = 0.1  # kJ/mol; a lower one is not told from noise, and no hand feels it
LEAST_TURN = np.radians(10)  # of a torsion, or the path turns none
STIFFNESS = 0.5  # of the restraint, hartree/rad^2: ten times that of the stiffest torsion
Atoms: TypeAlias = tuple[int, int, int, int]
# How far an atom is from the plane of its neighbours, bohr: one that is nearer is flat (0.7 in ammonia), and one that is farther
# is a pyramid.
FLAT, PYRAMID = 0.3, 0.3


@dataclass(frozen=True)
class Torsion:
    name: str
    atoms: tuple[int, int, int, int]  # four, counted from 0
    moved: tuple[int, ...]  # atoms that turn with the last one, about the bond in the middle
    signs: tuple[int, ...]  # the directions to drive: +1, -1
    rotor: bool  # a methyl or a like group: both directions are the same, file names need none

    def file_name(self, sign: float) -> str:
        return self.name if self.rotor else self.name + ("-plus" if sign > 0 else "-minus")

    def file_names(self) -> list[str]:
        return [self.file_name(sign) for sign in self.signs]

    def turned(self, x: Array, turn: float) -> Array:
        return geometry.rotated_about(x, *self.atoms[1:3], list(self.moved), turn)


def make(numbers: Sequence[int], neighbours: Neighbours, i: int | None, j: int, k: int, l: int | None) -> Torsion | None:
    """A torsion without a name about the bond j-k, whose k's side turns; None in a ring. i, l: where it ends, or None: at the
    heaviest neighbour, among equal ones the first."""
    moved = geometry.side_of(neighbours, j, k)
    if moved is None:
        return None
    sides = [n for n in neighbours[j] if n != k], [n for n in neighbours[k] if n != j]
    i, l = (min(side, key=lambda n: (-numbers[n], n)) if end is None else end for side, end in zip(sides, (i, l)))
    # CH3, NH3+, CF3 and the like.
    rotor = any(len(side) == 3 and len({numbers[n] for n in side}) == 1 and all(len(neighbours[n]) == 1 for n in side)
                for side in sides)
    return Torsion("", (i, j, k, l), tuple(moved), (1,) if rotor else (1, -1), rotor)


def _held_at(surface: Potential, targets: Mapping[Atoms, float]) -> Callable[[Array], tuple[float, Array]]:
    """(energy, gradient) of shapes whose torsions springs hold near angles."""
    def restrained(y: Array) -> tuple[float, Array]:
        energy, gradient = surface(y)
        for atoms, target in targets.items():
            off = geometry.wrapped(geometry.torsion(y, *atoms) - target)
            energy, gradient = (energy + STIFFNESS * off * off / 2, gradient + STIFFNESS * off * geometry.torsion_gradient(y, *atoms))
        return energy, gradient
    return restrained


def _bend(x: Array, held: Iterable[Atoms]) -> Array:
    """The springs' part of the Hessian, near their targets."""
    slopes = np.array([geometry.torsion_gradient(x, *atoms).ravel() for atoms in held])
    return STIFFNESS * slopes.T @ slopes


def scan(surface: Potential, minimum: Point, torsion: Torsion, sign: int, *, step: float = np.radians(10),
         highest: float = 150 / HARTREE) -> tuple[Array, Array]:
    """The first barrier as a guess of a saddle: (shape, tangent).

    The torsion is turned in steps from the minimum while all else relaxes. The highest shape is taken when the energy has
    fallen after it. step: radians; highest: hartree above the minimum.
    """
    x, hessian = minimum.x, minimum.hessian
    start = surface.energy(x)
    shapes, energies = [x], [start]
    angle = geometry.torsion(x, *torsion.atoms)
    # Two steps more than half a turn: from trans the barrier can be exactly at cis.
    for count in range(1, round(np.pi / step) + 3):
        turned = torsion.turned(shapes[-1], sign * step)
        restrained = _held_at(surface, {torsion.atoms: angle + sign * step * count})
        try:
            y, _, hessian = optimise.search(restrained, turned, hessian + _bend(turned, [torsion.atoms]), tolerance=3e-4, steps=200,
                                            noise=surface.noise)
        except optimise.NotConverged:
            turn = np.degrees(sign * step * count)
            raise optimise.NoPath(f"the scan did not relax at {turn:+.0f} degrees") from None
        hessian = hessian - _bend(y, [torsion.atoms])
        shapes.append(y)
        energies.append(surface.energy(y))
        top = int(np.argmax(energies))
        if energies[top] - start > highest:
            raise optimise.NoPath(f"still climbing at {HARTREE * highest:.0f} kJ/mol")
        if 0 < top and (energies[top] - energies[-1]) * HARTREE > LEAST_BARRIER:
            return _on_top(surface, *shapes[top - 1:top + 2])
    if np.ptp(energies) * HARTREE < LEAST_BARRIER:
        raise optimise.TurnsFreely(f"turns freely, without a barrier of {LEAST_BARRIER} kJ/mol: nothing would be felt, and "
                                   "the grid has it at rest")
    raise optimise.NoPath(f"no barrier within half a turn, at whose end the energy is {HARTREE * (energies[-1] - start):.1f} "
                          "kJ/mol")


def height(x: Array, neighbours: Neighbours, at: int) -> float:
    """How far an atom is from the plane of its three neighbours, bohr, with a sign."""
    a, b, c = x[neighbours[at]]
    normal = np.cross(b - a, c - a)
    return float((x[at] - a) @ normal / np.linalg.norm(normal))


def inverted(surface: Potential, flat: Array, top: Array, torsion: Torsion,
             neighbours: Neighbours) -> Iterator[tuple[Array, Array]]:
    """Guesses of other saddles, as those of scan(). An atom of the bond that is flat in the minimum, as an amide's nitrogen,
    becomes a pyramid on the way: to either side of it there is a saddle, and the scans in both directions lead to mirror
    images of one of them. flat: the minimum; top: a saddle."""
    i, j, k, l = torsion.atoms
    for at, other in ((j, k), (k, j)):
        if len(neighbours[at]) != 3 or abs(height(flat, neighbours, at)) > FLAT or abs(height(top, neighbours, at)) < PYRAMID:
            continue
        a, b, c = top[neighbours[at]]
        normal = np.cross(b - a, c - a)
        x = top.copy()
        x[at] -= 2 * height(top, neighbours, at) * normal / np.linalg.norm(normal)
        # Both bonds that leave it are held: with one alone it would become flat, and the bond would turn back.
        ends = [n for n in neighbours[at] if n != other]
        held: list[Atoms] = [(n, j, k, l) if at == j else (i, j, k, n) for n in ends]
        restrained = _held_at(surface, {atoms: geometry.torsion(x, *atoms) for atoms in held})
        with suppress(optimise.NotConverged):
            x, *_ = optimise.search(restrained, x, surface.hessian(x) + _bend(x, held), tolerance=3e-4, steps=200,
                                    noise=surface.noise)
            yield x, (torsion.turned(x, LEAST_TURN) - x).ravel()


def turned(torsions: Sequence[Torsion], shapes: Shapes) -> tuple[Array, Array]:
    """How far each torsion turns along a chain of nearby shapes, radians: (from the first shape to the last, from the
    least angle to the largest), each an array."""
    angles = np.unwrap([[geometry.torsion(x, *t.atoms) for t in torsions] for x in shapes], axis=0)
    return angles[-1] - angles[0], np.ptp(angles, axis=0)


def _on_top(surface: Potential, before: Array, top: Array, after: Array) -> tuple[Array, Array]:
    """(shape, tangent) from three shapes about the top of a scan.

    When the rest of the molecule snaps over while the torsion turns, each shape lies in one valley
    or the other and none is near the saddle: a search from there would go astray.
    """
    before, after = (geometry.aligned(x, top, surface.masses) for x in (before, after))
    back, ahead = geometry.rms(before, top), geometry.rms(after, top)
    if max(back, ahead) > 3 * min(back, ahead):
        values, _ = optimise.projected(surface.hessian(top), top)
        if values[0] > 0:
            raise optimise.NoPath("the molecule snaps over, far from a saddle")
        return top, ((after - top) if ahead < back else (top - before)).ravel()
    return top, (after - before).ravel()
