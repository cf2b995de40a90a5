"""What the hand holds, what of the molecule is fixed, and how stiff the tie between hand and atom is.

A torsion turns two parts of the molecule against each other. The hand holds an atom of one part, and the other part, with
both atoms of the bond, is fixed: the model aligns each shape to that part alone, so that the held atom goes on a circle and
the hand feels the torsion. Without that both parts would turn half as far, and the anchors would yield instead.

Along the held atom's way the torsion's energy E has the curvature E''. A tie that is stiffer than the largest -E'' leads the
atom over the top of a barrier, where it can be balanced; a softer one lets it snap over.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.cli import UsageError
from hapgrid.apps.common.files import Failed
from rdkit import Chem
from scipy.interpolate import CubicSpline

from . import geometry, rotors
from .elements import MASSES, SYMBOLS
from .molecule import Molecule, listed
from .results import Path, Result
from .torsions import Torsion
from .xtb import BOHR, HARTREE

if TYPE_CHECKING:
    from .steps import Start

STIFF, SOFT = 2.0, 0.5  # times the largest -E'': the tie's stiffness
LEAST_TIE, MOST_TIE = 20.0, 4000.0  # kJ/(mol Å²); a softer one is a rubber band, where barriers are low
PULLS = 4.0  # times the largest slope: the most that the tie pulls
LEAST_PULL, MOST_PULL = 20.0, 1e4  # kJ/(mol Å)
ANCHORS = 5.0  # times the tie, at the held atom: so much stiffer are the springs that hold the molecule
LEAST_WAY = 0.4  # angstrom: a torsion that moves the held atom less far cannot be felt there
TURN = np.radians(120)  # by which it is turned to see that
ROOM = 0.8  # angstrom from the held atom's way to the sides of the box
STEP = 0.002  # angstrom a tick, of a way


@dataclass(frozen=True)
class Hold:
    """atoms: whose centre is held; fixed: those that stay; torsions: those that move what is held; counted from 0."""
    atoms: tuple[int, ...]
    fixed: tuple[int, ...]
    torsions: tuple[Torsion, ...]


@dataclass(frozen=True)
class Tie:
    """force: the most, kJ/(mol Å); stiffness: at the atom, kJ/(mol Å²); arm: of what is held from the centre of what is
    fixed, Å."""
    force: float
    stiffness: float
    arm: float

    def rounded(self) -> tuple[float, float, float, float]:
        """What a definition says: (force, width, shift stiffness, rotation stiffness)."""
        force, tie = (float(f"{v:.2g}") for v in (self.force, self.stiffness))
        shift = min(ANCHORS * tie, 1e5)
        return force, float(f"{force / tie:.3g}"), float(f"{shift:.2g}"), float(f"{min(shift * max(self.arm, 1)**2, 1e6):.2g}")


def named(molecule: Molecule, text: str) -> tuple[int, ...]:
    """The atoms of --hold: names as in the pictures, numbers from 1, or a SMARTS, with commas between.
    Errors: UsageError, where there is no such atom."""
    names = {rotors.label(molecule.numbers, a): a for a in range(len(molecule.numbers))}
    names.update({str(a + 1): a for a in names.values()})
    names.update({rotors.pdb_name(SYMBOLS[z], a): a for a, z in enumerate(molecule.numbers)})  # as in played.pdb
    words = [word.strip() for word in text.split(",")]
    if all(word in names for word in words):
        return tuple(sorted({names[word] for word in words}))
    pattern = Chem.MolFromSmarts(text)
    if pattern is None or all(re.fullmatch(r"[A-Z][a-z]?\d+|\d+", word) for word in words):
        missing = next(word for word in words if word not in names)
        known = listed([rotors.label(molecule.numbers, a) for a in range(len(molecule.numbers))])
        raise UsageError(f"--hold: no atom {missing}, and no SMARTS: the atoms are {known}")
    match = molecule.matches(text)
    if not match:
        raise UsageError(f"--hold: the SMARTS {text} matches nothing in the molecule")
    return tuple(sorted(match[0]))


def words(molecule: Molecule, atoms: Sequence[int]) -> str:
    return ("the centre of " if len(atoms) > 1 else "") + ", ".join(rotors.label(molecule.numbers, a) for a in atoms)


def _sides(torsion: Torsion, count: int) -> tuple[frozenset[int], frozenset[int]]:
    """The two parts that a torsion turns against each other, without the atoms of its bond."""
    moved = frozenset(torsion.moved)
    return moved, frozenset(range(count)) - moved - set(torsion.atoms[1:3])


def _fixed_by(torsion: Torsion, atoms: Sequence[int], count: int) -> tuple[int, ...] | None:
    """What is fixed where these atoms are held and the torsion turns; None where it does not part them from anything."""
    for here, there in (_sides(torsion, count), _sides(torsion, count)[::-1]):
        if set(atoms) <= here:
            return tuple(sorted(there | set(torsion.atoms[1:3])))
    return None


def way(x: Array, atoms: Sequence[int]) -> Array:
    return np.asarray(x)[list(atoms)].mean(axis=0)


def _goes(torsion: Torsion, x: Array, hold: Hold, masses: Array) -> float:
    """How far a torsion alone moves what is held, angstrom."""
    turned = geometry.aligned(torsion.turned(x, TURN), x, weights(masses, hold.fixed))
    return float(np.linalg.norm(way(turned, hold.atoms) - way(x, hold.atoms))) * BOHR


def still(start: Start, hold: Hold, result: Result) -> list[str]:
    """The names of the torsions that do not move what is held."""
    return [t.name for t in start.turning if _goes(t, result.x, hold, result.masses) < LEAST_WAY]


def weights(masses: Array, fixed: Sequence[int]) -> Array:
    if not fixed:
        return masses
    out = np.zeros(len(masses))
    out[list(fixed)] = masses[list(fixed)]
    return out


def _of(molecule: Molecule, torsions: Sequence[Torsion], atoms: Sequence[int], x: Array) -> Hold | None:
    """The Hold of these atoms, where a torsion moves them; fixed is what the nearest such bond parts them from."""
    count, masses = len(molecule.numbers), np.array([MASSES[z] for z in molecule.numbers])
    fixed = [one for one in (_fixed_by(t, atoms, count) for t in torsions) if one]
    if not fixed:
        return None
    held = Hold(tuple(atoms), max(fixed, key=len), ())
    moving = tuple(t for t in torsions if _goes(t, x, held, masses) >= LEAST_WAY)
    return Hold(held.atoms, held.fixed, moving) if moving else None


def candidates(molecule: Molecule, torsions: Sequence[Torsion], wanted: str | None, x: Array) -> list[Hold]:
    """The Holds that are tried, the best first. wanted: of --hold, or None: the atom at which a torsion's lighter side ends,
    first that of the torsion whose lighter side is heaviest, and methyl groups last. x: a shape, bohr."""
    if wanted is not None:
        atoms = named(molecule, wanted)
        held = _of(molecule, torsions, atoms, x)
        if not torsions:
            raise Failed("--hold: no bond of the molecule turns: --push pushes at it as a whole")
        if held is None:
            moving = sorted({a for t in torsions for side in _sides(t, len(molecule.numbers)) for a in side})
            raise Failed(f"--hold: no bond that turns moves {words(molecule, atoms)}: hold "
                         + listed([rotors.label(molecule.numbers, a) for a in moving]))
        return [held]

    def weight(side: Collection[int]) -> float:
        return round(sum(MASSES[molecule.numbers[a]] for a in side), 3)

    def order(torsion: Torsion) -> tuple[bool, float]:
        return torsion.rotor, -min(map(weight, _sides(torsion, len(molecule.numbers))))
    out: list[Hold] = []
    for torsion in sorted(torsions, key=order):
        moved, rest = _sides(torsion, len(molecule.numbers))
        end = torsion.atoms[3] if weight(moved) <= weight(rest) else torsion.atoms[0]
        held = _of(molecule, torsions, [end], x)
        if held and all(held.atoms != other.atoms for other in out):
            out.append(held)
    return out


def decided(start: Start, result: Result) -> Hold | None:
    """The Hold for the paths that were found, or None where none was. An ensemble's paths turn several bonds: what moves
    farthest on them is held, and the molecule stays by its mass."""
    o, found = start.options, {f.name for f in result.found}
    if o.push or not found:
        return None
    if start.given:
        from . import along_hold  # which imports this one
        return along_hold.hold(start.molecule, result, o.hold)
    for hold in candidates(start.molecule, start.turning, o.hold, result.x):
        hold = replace(hold, torsions=tuple(t for t in hold.torsions if t.name in found))
        if hold.torsions:
            return hold if o.hold is not None else _led(start, result, hold)
    if o.hold is not None:
        return Hold(named(start.molecule, o.hold), (), ())
    count = len(result.numbers)
    far = [max(np.ptp(places, axis=0).max() for places, _ in ways(result, Hold((a,), (), ()), found).values())
           for a in range(count)]
    return Hold((int(np.argmax(far)),), (), ())


def _led(start: Start, result: Result, hold: Hold) -> Hold:
    """This Hold, or where its way turns back the one that needs the least force on ways that do not. Where a hydrogen bond
    breaks, the molecule goes on while an end of its chain rests, so the hand cannot lead this end on."""
    if np.isfinite(_steepest(result, hold)):
        return hold
    count, names, out = len(result.numbers), {t.name for t in hold.torsions}, [hold]
    found = [t for t in start.turning if t.name in names]
    for here, there, bond in ((*sides, t.atoms[1:3]) for t in start.turning
                              for sides in (_sides(t, count), _sides(t, count)[::-1])):
        for atom in sorted(here):
            other = Hold((atom,), tuple(sorted(there | set(bond))), hold.torsions)
            if all(_goes(t, result.x, other, result.masses) >= LEAST_WAY for t in found):
                out.append(other)
    return min(out, key=lambda one: _steepest(result, one))


def _steepest(result: Result, hold: Hold) -> float:
    """The most force that leads what is held along all paths, kJ/(mol Å); infinite where a way turns back."""
    most = 0.0
    for places, energies in ways(result, hold, {t.name for t in hold.torsions}).values():
        steps = np.diff(places, axis=0)
        if ((steps[1:] * steps[:-1]).sum(axis=1) <= 0).any():
            return float("inf")
        most = max(most, float((np.abs(np.diff(energies)) / np.linalg.norm(steps, axis=1)).max()))
    return most


def ways(result: Result, hold: Hold, names: Collection[str]) -> dict[str, tuple[Array, Array]]:
    """{name of a path: (places of what is held at its nodes, Å; energies at the nodes, kJ/mol)}"""
    weight, out = weights(result.masses, hold.fixed), {}
    for f in result.found:
        if f.name in names:
            shapes = [geometry.aligned(node, result.x, weight) for node in f.nodes]
            out[f.name] = (np.array([way(shape, hold.atoms) for shape in shapes]) * BOHR,
                           (np.array(f.energies) - result.energy) * HARTREE)
    return out


def tie(result: Result, hold: Hold, names: Collection[str], soft: bool) -> Tie:
    """The Tie for these paths."""
    slope = bend = 0.0
    for places, energies in ways(result, hold, names).values():
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
        keep = np.concatenate([[True], np.diff(along) > 1e-4])
        if keep.sum() < 4:
            continue
        energy = CubicSpline(along[keep], energies[keep])
        fine = np.linspace(0, along[-1], 20 * len(along))
        slope, bend = max(slope, np.abs(energy(fine, 1)).max()), max(bend, -energy(fine, 2).min())
    stiffness = float(np.clip((SOFT if soft else STIFF) * bend, 0 if soft else LEAST_TIE, MOST_TIE))
    force = float(np.clip(PULLS * slope, LEAST_PULL, MOST_PULL))
    weight = weights(result.masses, hold.fixed)
    centre = weight @ result.x / weight.sum()
    # The tie's width, force / stiffness, is at most 10 Å.
    return Tie(force, max(stiffness, force / 10), float(np.linalg.norm(way(result.x, hold.atoms) - centre)) * BOHR)


def box(result: Result, hold: Hold, names: Collection[str]) -> tuple[Array, Array]:
    """(low, high): corners of a box with all places of what is held, and room to pull it. Where several torsions move it their
    ways add up."""
    rest = way(result.x, hold.atoms) * BOHR
    low, high = np.zeros(3), np.zeros(3)
    for places, _ in ways(result, hold, names).values():
        low += np.minimum((places - rest).min(axis=0), 0)
        high += np.maximum((places - rest).max(axis=0), 0)
    return rest + low - ROOM, rest + high + ROOM


def there_and_back(path: Path, places: Array) -> Array:
    """Places of the hand, a tick each, on which it leads what is held along its way and back: all round and back where the path
    closes, else to both ends."""
    start, last = path.start, len(places) - 1
    if path.closes:
        nodes = [*range(start, last + 1), *range(1, start + 1)]
        nodes += nodes[-2::-1]
    else:
        nodes = [*range(start, last + 1), *range(last - 1, -1, -1), *range(1, start + 1)]
    chain = places[nodes]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(chain, axis=0), axis=1))])
    keep = np.concatenate([[True], np.diff(along) > 1e-6])
    ticks = np.linspace(0, along[-1], max(int(along[-1] / STEP), 2))
    return np.column_stack([np.interp(ticks, along[keep], chain[keep, a]) for a in range(3)])
