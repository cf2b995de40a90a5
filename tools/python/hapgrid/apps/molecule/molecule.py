"""A molecule, its force field, and sampling its conformers, with RDKit."""

from __future__ import annotations

import numpy as np
from hapgrid.apps.common.files import Failed
from rdkit import Chem, RDLogger
from rdkit.Chem import rdDistGeom, rdForceFieldHelpers, rdMolDescriptors, rdMolTransforms
from rdkit.ForceField import rdForceField  # Python must know the type of force fields
from collections.abc import Callable, Sequence
from hapgrid.apps.common.arrays import Array, Neighbours

RDLogger.DisableLog("rdApp.*")  # what it says is for programmers

MOST_BYTES = 8 << 20  # of a file from outside
STEPS = 500  # of the force field for a conformer
SEED, TRIES, ITERATIONS = 1, 100, 20  # of distance geometry
AMIDE = "[CX3](=O)-[#7]"
NAMED = 5  # of a list, at most
AXIS = "_axis"  # of an atom in the middle of an allene: the sign that SMILES gives the torsion of its ends' first neighbours


class BadInput(Failed):
    """A molecule that cannot be read or built; the message names it."""


class Molecule:
    """numbers: elements; positions: angstrom; neighbours: of each atom; double: pairs (j < k) of the bonds that do not turn,
    which are double bonds and amides; charge: e; unpaired: electrons; built: whether its shape was; said: what was decided
    when it was read, in lines; formula: with the charge; rd: RDKit's molecule; bonds_change: whether they do on its paths,
    where it may be several molecules."""

    def __init__(self, what: str, numbers: Sequence[int], positions: Array | Sequence[Sequence[float]],
                 charges: Sequence[int], bonds: Sequence[tuple[int, int, int]], charge: int, unpaired: int = 0,
                 built: bool = False, said: Sequence[str] = (), bonds_change: bool = False) -> None:
        """charges: of the atoms; bonds: (atom, atom, order 1, 2 or 3)."""
        self.numbers = [int(z) for z in numbers]
        self.positions = np.array(positions, float).reshape(-1, 3)
        if len(self.numbers) < 2 or 0 in self.numbers:
            raise BadInput(f"{what}: not a molecule of two atoms or more")
        self.rd = rdkit_molecule(self.numbers, charges, bonds)
        self.bonds_change = bonds_change
        if len(Chem.GetMolFrags(self.rd)) > 1 and not bonds_change:
            raise BadInput(f"{what}: more than one molecule")
        self.charge, self.unpaired, self.built, self.said = charge, unpaired, built, said
        self.formula = rdMolDescriptors.CalcMolFormula(self.rd)
        self.neighbours = neighbours_of(self.rd)
        amides = [tuple(sorted(match[::2])) for match in self.matches(AMIDE)]
        self.amides = [a for a in amides if not self.rd.GetBondBetweenAtoms(*a).IsInRing()]
        self.double = {*amides, *((min(j, k), max(j, k)) for j, k, order in bonds if order != 1)}

    def matches(self, smarts: str) -> list[tuple[int, ...]]:
        """The atoms, counted from 0, of each place that a pattern matches."""
        return [tuple(m) for m in self.rd.GetSubstructMatches(Chem.MolFromSmarts(smarts), maxMatches=10000)]

    def rings(self) -> list[list[int]]:
        """The atoms, counted from 0, of each of the smallest rings, in the order of its bonds."""
        return [list(ring) for ring in Chem.GetSSSR(self.rd)]


def unsanitized(numbers: Sequence[int], charges: Sequence[int], bonds: Sequence[tuple[int, int, int]]) -> Chem.RWMol:
    """RDKit's molecule of atoms that get no other hydrogens. bonds: (atom, atom, order)."""
    rd = Chem.RWMol()
    for z, charge in zip(numbers, charges):
        atom = Chem.Atom(int(z))
        atom.SetFormalCharge(int(charge))
        atom.SetNoImplicit(True)
        rd.AddAtom(atom)
    for j, k, order in bonds:
        rd.AddBond(int(j), int(k), Chem.BondType.values[order])
    return rd


def rdkit_molecule(numbers: Sequence[int], charges: Sequence[int], bonds: Sequence[tuple[int, int, int]]) -> Chem.Mol:
    """The same, sanitized. Where RDKit knows no such valences it has them all the same."""
    for leave in (Chem.SANITIZE_NONE, Chem.SANITIZE_PROPERTIES, Chem.SANITIZE_PROPERTIES | Chem.SANITIZE_KEKULIZE):
        one = Chem.Mol(unsanitized(numbers, charges, bonds))
        if Chem.SanitizeMol(one, Chem.SANITIZE_ALL ^ Chem.SANITIZE_CLEANUP ^ leave, catchErrors=True) == Chem.SANITIZE_NONE:
            return one
    raise BadInput("a molecule whose bonds RDKit does not understand")


def placed(rd: Chem.Mol, positions: Array) -> Chem.Mol:
    """A copy of RDKit's molecule with these coordinates alone, angstrom."""
    rd = Chem.Mol(rd)
    rd.RemoveAllConformers()
    conformer = Chem.Conformer(rd.GetNumAtoms())
    conformer.Set3D(True)
    for n, place in enumerate(np.asarray(positions, float)):
        conformer.SetAtomPosition(n, place)
    rd.AddConformer(conformer)
    return rd


def relaxed(rd: Chem.Mol, positions: Array, steps: int, fixed: Sequence[int] | range = ()) -> tuple[float, Array]:
    """(energy, positions in angstrom) after some steps with MMFF94, or with UFF where that has no parameters; as they
    are where neither has. Energies of one molecule can be compared with each other. fixed: atoms that stay."""
    rd = placed(rd, positions)
    field: rdForceField.ForceField = None
    by_mmff = False
    try:
        properties = rdForceFieldHelpers.MMFFGetMoleculeProperties(rd)
        by_mmff = properties is not None
        if by_mmff:
            field = rdForceFieldHelpers.MMFFGetMoleculeForceField(rd, properties)
        elif rdForceFieldHelpers.UFFHasAllMoleculeParams(rd):
            field = rdForceFieldHelpers.UFFGetMoleculeForceField(rd)
    except Chem.MolSanitizeException:  # of valences that no force field knows
        pass
    if field is None:
        return 0.0, np.array(positions, float)
    field.Initialize()
    _hold_allenes(field, rd, by_mmff, positions)
    for atom in fixed:
        field.AddFixedPoint(int(atom))
    try:
        field.Minimize(maxIts=steps, forceTol=1e-4, energyTol=1e-7)
    except RuntimeError:  # in its minimum already it finds no direction
        pass
    return field.CalcEnergy(), np.array(field.Positions()).reshape(-1, 3)


def rows_of_double_bonds(rd: Chem.Mol) -> list[list[int]]:
    """The atoms of each row of double bonds, as long as it can be."""
    double: dict[int, list[int]] = {}
    for bond in rd.GetBonds():
        if bond.GetBondType() == Chem.BondType.DOUBLE:
            for a, b in ((bond.GetBeginAtomIdx(), bond.GetEndAtomIdx()), (bond.GetEndAtomIdx(), bond.GetBeginAtomIdx())):
                double.setdefault(a, []).append(b)
    out = []
    for first in sorted(a for a, near in double.items() if len(near) == 1):
        row = [first]
        while more := [b for b in double[row[-1]] if b not in row]:
            row.append(more[0])
        if len(double[row[-1]]) == 1 and row[0] < row[-1] and all(rd.GetAtomWithIdx(a).GetDegree() == 2 for a in row[1:-1]):
            out.append(row)
    return out


def _hold_allenes(field: rdForceField.ForceField, rd: Chem.Mol, by_mmff: bool, x: Array) -> None:
    """Keeps the ends of allenes across each other, which no force field here does, on the side on which they are marked, or
    else are."""
    for row in rows_of_double_bonds(rd):
        i, l = (min((n.GetIdx() for n in rd.GetAtomWithIdx(end).GetNeighbors() if n.GetIdx() != inner), default=None)
                for end, inner in ((row[0], row[1]), (row[-1], row[-2])))
        if len(row) % 2 == 0 or i is None or l is None:
            continue
        middle, torsion = rd.GetAtomWithIdx(row[len(row) // 2]), (i, row[0], row[-1], l)
        sign = middle.GetIntProp(AXIS) if middle.HasProp(AXIS) else 1 if rdMolTransforms.GetDihedralDeg(
            placed(rd, x).GetConformer(), *torsion) > 0 else -1
        add = field.MMFFAddTorsionConstraint if by_mmff else field.UFFAddTorsionConstraint
        add(*torsion, False, *sorted((85.0 * sign, 95.0 * sign)), 100.0)


def signed(charge: int) -> str:
    return f"{charge:+d}" if charge else "0"


def listed(words: Sequence[str]) -> str:
    return ", ".join(words[:NAMED]) + (f" and {len(words) - NAMED} more" if len(words) > NAMED else "")


def numbers_of(rd: Chem.Mol) -> list[int]:
    return [a.GetAtomicNum() for a in rd.GetAtoms()]


def places_of(rd: Chem.Mol) -> Array:
    return rd.GetConformer().GetPositions() if rd.GetNumConformers() else np.zeros((rd.GetNumAtoms(), 3))


def neighbours_of(rd: Chem.Mol) -> Neighbours:
    """Of each atom, ascending."""
    return [sorted(n.GetIdx() for n in a.GetNeighbors()) for a in rd.GetAtoms()]


def is_flat(x: Array) -> bool:
    return len(x) > 3 and np.ptp(x[:, 2]) < 0.01


def conformers(molecule: Molecule, number: int, wanted: Callable[[Array], bool] = lambda x: True,
               bounds: Callable[[Chem.Mol], Array | None] = lambda rd: None) -> list[Array]:
    """Up to `number` shapes (angstrom) by distance geometry, relaxed by the force field, the lowest first, none twice. Torsions
    are drawn without the preferences of ETKDG, which are those of crystals. wanted: whether a shape is of this isomer; bounds: of
    its distances, or None for RDKit's.

    Open Babel's Confab leaves hydroxyl groups as they are: its lowest ethylene glycol is 1.6 kcal/mol above the one that this
    finds.
    """
    rd = placed(molecule.rd, molecule.positions)
    Chem.AssignStereochemistryFrom3D(rd)
    found: dict[float, Array] = {}
    limits = bounds(rd)
    for options in (rdDistGeom.KDG(), rdDistGeom.EmbedParameters()):  # the second knows of no flat bonds in rings of eight
        options.randomSeed, options.maxIterations = SEED, ITERATIONS
        if limits is not None:
            options.SetBoundsMat(limits)
        embedded = [rd.GetConformer(n).GetPositions() for n in rdDistGeom.EmbedMultipleConfs(rd, TRIES, options)]
        for x in [molecule.positions, *embedded]:
            energy, x = relaxed(molecule.rd, x, STEPS)
            if wanted(x):
                found.setdefault(round(energy, 2), x)  # equal energies are those of one shape, or of its mirror image
        if limits is None or len(found) > 1:
            break
    return [found[energy] for energy in sorted(found)[:number]]
