"""Which stereoisomer a shape is of: its centres (R or S), double bonds (E or Z), allenes and axes (M or P).

RDKit finds the centres. Its double bonds have no =NH, and it knows neither allenes nor axes, so those are found here: a row
of n double bonds is flat where n is odd, and is handed like a screw where n is even. An axis is a single bond between two rings,
or between a ring and the nitrogen of a tertiary amide, of which three of the four places beside it are taken, so that its sides
do not pass each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from hapgrid.apps.common.arrays import Array
from rdkit import Chem
from rdkit.Chem import rdCIPLabeler, rdDistGeom

from . import geometry
from .elements import SYMBOLS
from .molecule import AXIS, placed, rows_of_double_bonds

CENTRE, FLAT, SCREW = "centre", "double bond", "axis"
OTHER = dict(zip("RSrsEZMP", "SRsrZEPM"))
LEAST = 0.17  # of a sine, cosine or volume: below it a shape is of neither kind
LEAST_RING = 8  # atoms of a ring in which a double bond may be E
TAKEN = 3  # of the four places beside an axis
ANILIDE = Chem.MolFromSmarts("[NX3]([#6])([#6])C=O")  # the nitrogen of an amide beside two carbon atoms
TRIES = 5  # of distance geometry, until an isomer counts as impossible
SMILES_TAGS = {Chem.ChiralType.CHI_TETRAHEDRAL_CCW: 1, Chem.ChiralType.CHI_TETRAHEDRAL_CW: -1}


@dataclass(frozen=True)
class Element:
    """atoms: of a centre, itself and its neighbours; else the four of a torsion. sign: which of both it is; label: that as
    chemists call it."""
    kind: str
    name: str
    atoms: tuple[int, ...]
    sign: int = 0
    label: str = "?"

    def sign_in(self, x: Array) -> int:
        """1 or -1; 0 of a shape that is of neither."""
        if self.kind == CENTRE:
            at, *near = x[list(self.atoms)]
            away = [(y - at) / np.linalg.norm(y - at) for y in near]
            first = away[0] if len(near) > 3 else 0
            value = float(np.linalg.det([y - first for y in away[-3:]]))
        else:
            turn = geometry.torsion(x, *self.atoms)
            value = float(np.cos(turn) if self.kind == FLAT else np.sin(turn))
        return int(np.sign(value)) if abs(value) > LEAST else 0

    @property
    def place(self) -> tuple[int, ...]:
        """The atom of a centre, or the two at the ends of others."""
        return self.atoms[:1] if self.kind == CENTRE else tuple(sorted(self.atoms[1:3]))

    def __str__(self) -> str:
        return f"{self.name} {self.label}"


@dataclass(frozen=True)
class Isomer:
    elements: Sequence[Element]

    def differs(self, x: Array, axes: bool = True) -> str:
        """In which element a shape is of another isomer, in words, or nothing. axes: whether those of rings count, which may
        turn over a barrier."""
        for one in self.elements:
            sign = one.sign_in(x)
            if sign != one.sign and (axes or one.kind != SCREW or "=" in one.name):
                return f"another molecule: {one.name} is {OTHER[one.label] if sign else 'neither'}, not {one.label}"
        return ""


def of(rd: Chem.Mol, x: Array) -> Isomer:
    """The Isomer of a shape in angstrom. rd: RDKit's molecule with all hydrogens."""
    one = placed(rd, x)
    Chem.AssignStereochemistryFrom3D(one)
    Chem.AssignStereochemistry(one, cleanIt=False, force=True, flagPossibleStereoCenters=True)
    try:
        rdCIPLabeler.AssignCIPLabels(one)
    except (RuntimeError, ValueError):  # of valences that it does not know
        pass
    found = []
    for place in Chem.FindPotentialStereo(one):
        atom = one.GetAtomWithIdx(place.centeredOn) if place.type == Chem.StereoType.Atom_Tetrahedral else None
        if atom is not None and atom.HasProp("_CIPCode"):  # not those of nitrogen that turns inside out
            near = sorted(n.GetIdx() for n in atom.GetNeighbors())
            found.append(Element(CENTRE, _label(one, atom.GetIdx()), (atom.GetIdx(), *near), label=atom.GetProp("_CIPCode")))
    found += _rows(one) + _axes(one)
    signed = [Element(e.kind, e.name, e.atoms, e.sign_in(x), e.label) for e in found]
    return Isomer(tuple(_labelled(one, e) for e in signed if e.sign))


def _label(rd: Chem.Mol, *atoms: int) -> str:
    return "=".join(f"{SYMBOLS[rd.GetAtomWithIdx(a).GetAtomicNum()]}{a + 1}" for a in atoms)


def _labelled(rd: Chem.Mol, one: Element) -> Element:
    """With E or Z, M or P, by the higher neighbours at both ends."""
    if one.kind == CENTRE:
        return one
    i, j, k, l = one.atoms
    sign, bond = one.sign, rd.GetBondBetweenAtoms(j, k)
    for end, at, other in ((i, j, k), (l, k, j)):
        ranks = {n.GetIdx(): int(n.GetProp("_CIPRank")) for n in rd.GetAtomWithIdx(at).GetNeighbors() if n.HasProp("_CIPRank") and
                 n.GetIdx() != other and (bond or rd.GetBondBetweenAtoms(at, n.GetIdx()).GetBondType() == Chem.BondType.SINGLE)}
        if ranks and ranks.get(end, 0) < max(ranks.values()):
            sign = -sign
    if one.kind == FLAT:
        label = "Z" if sign > 0 else "E"
        label = bond.GetProp("_CIPCode") if bond and bond.HasProp("_CIPCode") else label
    else:
        label = "P" if sign > 0 else "M"
    return Element(one.kind, one.name, one.atoms, one.sign, label)


def _end(rd: Chem.Mol, at: int, before: int, alone: bool) -> int | None:
    """The atom at which a torsion ends there: the first of its neighbours, where these are not equal, or are one and alone
    may be."""
    ranks = list(Chem.CanonicalRankAtoms(rd, breakTies=False))
    near = sorted(n.GetIdx() for n in rd.GetAtomWithIdx(at).GetNeighbors() if n.GetIdx() != before)
    unequal = len(near) == 2 and ranks[near[0]] != ranks[near[1]]
    return near[0] if unequal or alone and len(near) == 1 else None


def _rows(rd: Chem.Mol) -> list[Element]:
    """Double bonds, allenes and longer ones."""
    out, rings = [], rd.GetRingInfo()
    for row in rows_of_double_bonds(rd):
        bond = rd.GetBondBetweenAtoms(*row[:2])
        if len(row) == 2 and bond.IsInRing() and rings.MinBondRingSize(bond.GetIdx()) < LEAST_RING:
            continue
        i, l = _end(rd, row[0], row[1], len(row) == 2), _end(rd, row[-1], row[-2], len(row) == 2)
        if i is not None and l is not None:
            out.append(Element(SCREW if len(row) % 2 else FLAT, _label(rd, *row), (i, row[0], row[-1], l)))
    return out


def _axes(rd: Chem.Mol) -> list[Element]:
    out, amide = [], {at for match in rd.GetSubstructMatches(ANILIDE) for at in match[:1]}
    for bond in rd.GetBonds():
        ends = sorted((bond.GetBeginAtom(), bond.GetEndAtom()), key=lambda a: a.GetIdx())
        if bond.IsInRing() or bond.GetBondType() != Chem.BondType.SINGLE or not any(a.IsInRing() for a in ends) or not all(
                (a.IsInRing() or a.GetIdx() in amide) and a.GetDegree() == 3 and a.GetHybridization() == Chem.HybridizationType.SP2
                for a in ends):
            continue
        j, k = (a.GetIdx() for a in ends)
        beside = [(a, n) for a in ends for n in a.GetNeighbors() if n.GetIdx() not in (j, k)]
        taken = sum(sum(m.GetAtomicNum() > 1 for m in n.GetNeighbors()) > 2 or a.GetIdx() in amide for a, n in beside)
        i, l = _end(rd, j, k, False), _end(rd, k, j, False)
        if taken >= TAKEN and i is not None and l is not None:
            out.append(Element(SCREW, f"{_label(rd, j)}-{_label(rd, k)}", (i, j, k, l)))
    return out


# What is given, and what was chosen

def mark_allenes(rd: Chem.Mol) -> None:
    """Keeps the handedness that SMILES gives allenes, which RDKit drops. rd: not sanitized. In SMILES the neighbours of both
    ends stand in the order in which they are written, a hydrogen that is not behind the first. Source: OpenSMILES, 3.9.6."""
    for row in rows_of_double_bonds(rd):
        tags = [SMILES_TAGS[a.GetChiralTag()] for a in map(rd.GetAtomWithIdx, row[1:-1]) if a.GetChiralTag() in SMILES_TAGS]
        if len(row) % 2 == 0 or not tags:
            continue
        sign = tags[0]
        for end, inner in ((row[0], row[1]), (row[-1], row[-2])):
            near = sorted(n.GetIdx() for n in rd.GetAtomWithIdx(end).GetNeighbors() if n.GetIdx() != inner)
            if len(near) == 1 and near[0] > end:  # a hydrogen is before it
                sign = -sign
            elif len(near) == 2 and (near[1] < end or rd.GetAtomWithIdx(end).IsInRing() and near[0] > end):
                sign = 0  # a ring is closed there, in an order that RDKit does not keep
        if sign:
            rd.GetAtomWithIdx(row[len(row) // 2]).SetIntProp(AXIS, sign)


def is_as_given(rd: Chem.Mol, x: Array) -> bool:
    """Whether a shape has the handedness and the sides of double bonds that a molecule is marked with."""
    one = placed(rd, x)
    Chem.AssignAtomChiralTagsFromStructure(one, replaceExistingTags=True)
    for pair in zip(rd.GetAtoms(), one.GetAtoms()):  # nitrogen where rings meet gets none from a shape
        if len({SMILES_TAGS.get(atom.GetChiralTag()) for atom in pair} - {None}) > 1:
            return False
    for bond in rd.GetBonds():
        if bond.GetStereo() > Chem.BondStereo.STEREOANY:
            a, d = bond.GetStereoAtoms()
            together = np.cos(geometry.torsion(x, a, bond.GetBeginAtomIdx(), bond.GetEndAtomIdx(), d)) > 0
            if together != (bond.GetStereo() in (Chem.BondStereo.STEREOZ, Chem.BondStereo.STEREOCIS)):
                return False
    return all(e.sign_in(x) in (sign, None) for e, sign in _given_axes(rd))


def _given_axes(rd: Chem.Mol) -> list[tuple[Element, int]]:
    out = []
    for e in _rows(rd):
        row = next(row for row in rows_of_double_bonds(rd) if (row[0], row[-1]) == e.place)
        middle = rd.GetAtomWithIdx(row[len(row) // 2])
        if e.kind == SCREW and middle.HasProp(AXIS):
            out.append((e, middle.GetIntProp(AXIS)))
    return out


def chosen(rd: Chem.Mol, x: Array) -> list[Element]:
    """The elements that a molecule is not marked with, of a shape that was built for it, where there was a choice."""
    marked: set[tuple[int, ...]] = {(a.GetIdx(),) for a in rd.GetAtoms() if a.GetChiralTag() in SMILES_TAGS}
    marked |= {tuple(sorted((b.GetBeginAtomIdx(), b.GetEndAtomIdx()))) for b in rd.GetBonds()
               if b.GetStereo() > Chem.BondStereo.STEREOANY}
    marked |= {e.place for e, _ in _given_axes(rd)}
    return _with_choice(rd, x, [e for e in of(rd, x).elements if e.place not in marked])


def told(rd: Chem.Mol, x: Array, isomer: Isomer) -> str:
    """The isomer in words, without what no isomer has otherwise."""
    return ", ".join(map(str, _with_choice(rd, x, isomer.elements)))


def _with_choice(rd: Chem.Mol, x: Array, some: Sequence[Element]) -> list[Element]:
    """Those of some elements that other isomers have otherwise. Centres where rings meet, as those of adamantane, may have no
    choice alone, and may have one together, as those of camphor."""
    one = placed(rd, x)
    Chem.AssignStereochemistryFrom3D(one)
    rings, same = one.GetRingInfo(), Chem.MolToSmiles(one)
    every = {a.GetIdx() for a in one.GetAtoms() if a.GetChiralTag() in SMILES_TAGS}
    centres = {e.atoms[0] for e in some if e.kind == CENTRE}
    meeting = {c for c in centres if rings.NumAtomRings(c) > 1}
    real: set[int] = set()
    for turned in (centres, meeting, *({c} for c in sorted(centres))):
        if turned <= real:
            continue
        other = Chem.Mol(one)
        for c in turned:
            other.GetAtomWithIdx(c).InvertChirality()
        Chem.AssignStereochemistry(other, cleanIt=True, force=True)
        if Chem.MolToSmiles(other) == same:
            continue
        options = rdDistGeom.ETKDGv3()
        options.randomSeed, options.maxIterations = 1, TRIES
        # A mirror image there always is, and a ring's own atom can have its two neighbours exchanged.
        if turned == every or not turned & meeting or rdDistGeom.EmbedMolecule(other, options) >= 0:
            real |= turned
    return [e for e in some if e.kind != CENTRE or e.atoms[0] in real]


def words(chosen_ones: Sequence[Element]) -> list[str]:
    """What is said of those that were chosen, in lines."""
    out = []
    for what, kinds in (("the handedness", (CENTRE, SCREW)), ("the side", (FLAT,))):
        some = [e for e in chosen_ones if e.kind in kinds]
        if some:
            out.append(f"{what} of {', '.join(e.name for e in some)} is not given: {', '.join(e.label for e in some)} is taken")
    return out


# Shapes

def bounds(rd: Chem.Mol) -> Array | None:
    """Bounds of distances, above and below the diagonal, angstrom, with which the double bonds of rings that are E are built so;
    None where there is none. RDKit's own take every ring to be Z."""
    out = None
    for bond in rd.GetBonds():
        if not bond.IsInRing() or bond.GetStereo() not in (Chem.BondStereo.STEREOE, Chem.BondStereo.STEREOTRANS):
            continue
        out = rdDistGeom.GetMoleculeBoundsMatrix(rd) if out is None else out
        j, k = bond.GetBeginAtom(), bond.GetEndAtom()
        a, d = bond.GetStereoAtoms()
        for i in (n.GetIdx() for n in j.GetNeighbors() if n.GetIdx() != k.GetIdx()):
            for l in (n.GetIdx() for n in k.GetNeighbors() if n.GetIdx() != j.GetIdx()):
                _bound(out, (i, j.GetIdx(), k.GetIdx(), l), (i == a) == (l == d))
    return out


def _bound(out: Array, atoms: tuple[int, int, int, int], trans: bool) -> None:
    """Puts bounds between the first and the last atom of a torsion: from 125 to 180 degrees, or from 0 to 55."""
    def mean(a: int, b: int) -> float:
        return float(out[a, b] + out[b, a]) / 2
    i, j, k, l = atoms
    ij, jk, kl = mean(i, j), mean(j, k), mean(k, l)
    one, two = ((ij**2 + jk**2 - mean(i, k)**2) / (2 * ij * jk), (jk**2 + kl**2 - mean(j, l)**2) / (2 * jk * kl))

    def apart(degrees: float) -> float:
        along, p, q = jk - ij * one - kl * two, ij * np.sqrt(1 - one**2), kl * np.sqrt(1 - two**2)
        return float(np.sqrt(along**2 + p**2 + q**2 - 2 * p * q * np.cos(np.radians(degrees))))
    low, high = sorted((i, l))
    out[low, high], out[high, low] = (apart(180) + 0.05, apart(125)) if trans else (apart(55), apart(0) - 0.05)
