"""Which bonds turn, and what they are called: by their four atoms (C1-C2-C3-O4), and in peptides by
phi, psi, omega and chi with the number of the residue. omega0 is the bond of a cap to the first
residue's nitrogen; in a peptide of one residue phi, psi and chi have no number.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from hapgrid.apps.common.arrays import Array, Shapes

from . import geometry, torsions
from .elements import SYMBOLS
from .molecule import Molecule
from .results import Path
from .torsions import Torsion

# N, CA and C of a residue.
RESIDUE = "[NX3;!$(N=*)]-[CX4]-[CX3](=O)[N,O]"
SULPHUR = 16
FLIPPED = np.radians(10)  # of a ring's torsion, on both sides of a plane
LARGELY = 0.5  # of the farthest turn: a torsion that goes so far does turn


def label(numbers: Sequence[int], atom: int) -> str:
    return f"{SYMBOLS[numbers[atom]]}{atom + 1}"


def pdb_name(symbol: str, atom: int) -> str:
    """The same in the four columns of a PDB file, where Cl100 is Cl00."""
    return symbol + str(atom + 1)[len(symbol) - 4:]


def _named(molecule: Molecule, atoms: Sequence[int]) -> str:
    return "-".join(label(molecule.numbers, a) for a in atoms)


def find(molecule: Molecule) -> list[Torsion]:
    """The torsions that turn: about single bonds and amides in no ring, if their atoms do not lie on a line; and about lines as
    those of alkynes, which the atoms at their ends define."""
    near, names, out = molecule.neighbours, peptide_names(molecule), []
    for j, k in ((j, k) for j, some in enumerate(near) for k in some if j < k):
        if min(len(near[j]), len(near[k])) < 2 or (j, k) in molecule.double - set(molecule.amides):
            continue
        name, ends = names.get((j, k), (None, {}))
        one = torsions.make(molecule.numbers, near, ends.get(j), j, k, ends.get(k))
        if one is None or any(len(near[b]) == 2 and np.sin(geometry.angle(molecule.positions, a, b, c)) < geometry.LINEAR
                              for a, b, c in (one.atoms[:3], one.atoms[1:])):
            continue
        out.append(replace(one, name=name or _named(molecule, one.atoms)))
    return out + _about_lines(molecule)


def _about_lines(molecule: Molecule) -> list[Torsion]:
    on_line, out = geometry.straight(molecule.neighbours, molecule.positions), []
    for j, v in ((j, v) for j, some in enumerate(molecule.neighbours) for v in some if v in on_line and j not in on_line):
        *_, w, k = geometry.line(molecule.neighbours, on_line, j, v)
        if k < j or len(molecule.neighbours[k]) < 2 or {_bond(j, v), _bond(w, k)} & molecule.double:
            continue
        near = list(molecule.neighbours)  # as if the line were one bond
        near[j], near[k] = ([b if n == a else n for n in near[at]] for at, a, b in ((j, v, k), (k, w, j)))
        one = torsions.make(molecule.numbers, near, None, j, k, None)
        if one is not None and all(np.sin(geometry.angle(molecule.positions, *some)) > geometry.LINEAR
                                   for some in (one.atoms[:3], one.atoms[1:])):
            out.append(replace(one, name=_named(molecule, one.atoms)))
    return out


def threes(molecule: Molecule) -> list[list[int]]:
    """The three equal atoms of each CH3, NH3+, CF3 and the like."""
    ends = [[n for n in near if len(molecule.neighbours[n]) == 1] for near in molecule.neighbours]
    return [some for some in ends if len(some) == 3 and len({molecule.numbers[n] for n in some}) == 1]


def flipped(molecule: Molecule, shapes: Shapes) -> list[str]:
    """The rings that flip along a chain of nearby shapes: a torsion of theirs changes its sign."""
    def flips(ring: Any) -> bool:
        a, b = (np.array([geometry.torsion(x, *(2 * ring)[k:k + 4]) for k in range(len(ring))]) for x in (shapes[0], shapes[-1]))
        return ((a * b < 0) & (np.minimum(np.abs(a), np.abs(b)) > FLIPPED)).any()
    return [_named(molecule, ring) for ring in molecule.rings() if flips(ring)]


def peptide_names(molecule: Molecule) -> Any:
    """{bond (j < k): (name, {an atom of the bond: the atom at which the torsion ends there, or None})}. Angles are
    those of IUPAC: phi is C-N-CA-C, psi N-CA-C-N, omega CA-C-N-CA."""
    residues = _in_order(molecule, sorted({match[:3] for match in molecule.matches(RESIDUE)}))
    # An amino acid alone, without a peptide bond, is no peptide.
    if not any({n, c} & {a for bond in molecule.amides for a in bond} for n, _, c in residues):
        return {}
    out, backbone = {}, {a for residue in residues for a in residue}
    for r, (n, ca, c) in enumerate(residues):
        number = "" if len(residues) == 1 else str(r + 1)
        before, after = _partner(molecule, n), _partner(molecule, c)
        out[_bond(n, ca)] = f"phi{number}", {n: before, ca: c}
        # The nitrogen behind the residue's carbon, or the oxygen of its hydroxyl group.
        single = max((a for a in molecule.neighbours[c] if a != ca),
                     key=lambda a: (molecule.numbers[a] == 7, len(molecule.neighbours[a])))
        out[_bond(ca, c)] = f"psi{number}", {ca: n, c: single}
        if after is not None:
            out[_bond(c, after)] = f"omega{r + 1}", {c: ca, after: _carbon(molecule, after, c)}
        if before is not None and f"omega{r}" not in {name for name, _ in out.values()}:  # a second chain has no omega0
            out.setdefault(_bond(before, n), (f"omega{r}", {before: _carbon(molecule, before, n), n: ca}))
        # chi, from the alpha carbon outwards along the chain of heavy atoms. It ends at another residue, as that of glutamate
        # does in glutathione, and at a bridge of sulphurs, behind which the other chain has its own numbers.
        seen, at, depth = set(backbone), ca, 1
        while chain := [a for a in molecule.neighbours[at] if molecule.numbers[a] > 1 and a not in seen]:
            to = chain[0]
            if molecule.numbers[at] == molecule.numbers[to] == SULPHUR:
                break
            if _bond(at, to) not in molecule.double:
                out.setdefault(_bond(at, to), (f"chi{number}_{depth}" if number else f"chi{depth}", {}))
            seen.add(to)
            at, depth = to, depth + 1
    return out


def _partner(molecule: Molecule, atom: int) -> Any:
    """The other atom of an amide bond."""
    return next((sum(bond) - atom for bond in molecule.amides if atom in bond), None)


def _carbon(molecule: Molecule, atom: int, without: Any) -> Any:
    return next((a for a in molecule.neighbours[atom] if a != without and molecule.numbers[a] == 6), None)


def _bond(*atoms: Any) -> Any:
    return tuple(sorted(atoms))


def _in_order(molecule: Molecule, residues: Any) -> Any:
    """From the one whose nitrogen no other residue holds."""
    after = {r: s for r in residues for s in residues if r[2] in molecule.neighbours[s[0]]}
    out = []
    for at in [r for r in residues if r not in after.values()] + residues:
        while at is not None and at not in out:
            out.append(at)
            at = after.get(at)
    return out


@dataclass
class Candidate:
    """A path that may be taken. number: of the torsion that was driven; turns: how far each torsion turns, radians; height: of
    its barrier."""
    number: int
    turns: Array
    height: float

    @property
    def bond(self) -> int | None:
        """The number of the torsion that gives it its name, or None where no bond turns."""
        far = np.abs(self.turns)
        if far.max() < torsions.LEAST_TURN:
            return None
        return self.number if far[self.number] >= LARGELY * far.max() else int(far.argmax())


def candidate(bonds: Sequence[Torsion], torsion: Torsion, way: Path, free: Collection[str]) -> Candidate:
    """The Candidate of a Path on behind barriers, or from the conformation to one. bonds: all Torsions that turn; free: names of
    those that turn freely, so that it says nothing how far they do on the way."""
    to_end, extent = torsions.turned(bonds, way.nodes)
    number = next(n for n, t in enumerate(bonds) if t.name == torsion.name)
    held = [n == number or t.name not in free for n, t in enumerate(bonds)]
    return Candidate(number, np.where(held, extent if way.goes_on else to_end, 0.0), way.barrier)


def names(bonds: Sequence[Torsion], candidates: Mapping[str, Candidate], allowed: Collection[str],
          signed: bool) -> tuple[dict[str, str], list[tuple[str, str]]]:
    """({job: name of its path} in the order in which they are taken, [(job, why it has no path)]). candidates: {job, which is
    what was driven, as messages name it: Candidate}; allowed: the names that are wanted; signed: whether a name says in which
    direction its bond turns.

    Driving one bond can lead to the barrier of another: that of P-OH in methyl phosphate leads to the barrier of its methyl
    group. So a path has the name of the bond that was driven only if this turns at least half as far as any other; otherwise
    it has the name of that which turns farthest. Where several paths turn one bond the same way, that is kept for which this
    bond was driven, or else the lowest.
    """
    out: dict[str, str] = {}
    left: list[tuple[str, str]] = []

    def order(job: str) -> tuple[int, float]:
        """Paths whose driven bond turns come first, that whose bond turns farthest before others. Then comes the lowest."""
        one, turns = candidates[job], np.abs(candidates[job].turns)
        return (0, -round(float(turns[one.number] / turns.max()), 1)) if one.bond == one.number else (1, one.height)
    for job in sorted(candidates, key=order):
        one, n = candidates[job], candidates[job].bond
        if n is None:
            left.append((job, "no bond turns on the way to its barrier"))
            continue
        name = bonds[n].file_name(np.sign(one.turns[n])) if signed else bonds[n].name
        turns = "turns {} instead, by {:.0f} degrees against {:.0f}".format(
            name, *np.abs(np.degrees([one.turns[n], one.turns[one.number]])))
        if name in out.values():
            left.append((job, turns if n != one.number else f"turns as {name} does, over another barrier"))
        elif name not in allowed:
            left.append((job, turns + ", which is not looked for"))
        else:
            out[job] = name
            if n != one.number:
                left.append((job, turns))
    return out, left
