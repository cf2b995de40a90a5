"""Hydrogens and shapes that a file does not have, by RDKit.

Distance geometry with the torsions of the Cambridge Structural Database (ETKDG), relaxed by MMFF94 or UFF. Open Babel's
builder is not used: it gives up or lets atoms overlap for 16 of 62 everyday molecules, and it is random where rings meet
chains.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from hapgrid.apps.common.arrays import Array
from rdkit import Chem
from rdkit.Chem import rdDistGeom

from . import geometry, stereo
from .elements import COVALENT
from .molecule import BadInput, is_flat, neighbours_of, numbers_of, placed, places_of, relaxed

SEED = 1
TRIES = 10  # shapes, of which the one of lowest energy is taken: rings have several
MORE_TRIES = 30  # where all others are of another isomer
FEW_STEPS, STEPS = 300, 5000  # of the force field, to tell shapes apart, and for the one that is taken
SMALL_RINGS = 60  # atoms, up to which a shape takes well below a second


def understood(mol: Chem.Mol, what: str, forced: bool) -> Chem.Mol:
    """The molecule with its aromatic rings and implicit hydrogens, and with the handedness that its coordinates or wedges give
    it. forced: whether its bonds are as they should be, also where RDKit knows no such valences. Errors: BadInput, which names
    the atom."""
    one = Chem.Mol(mol)
    try:
        Chem.SanitizeMol(one)
    except ValueError as why:
        if isinstance(why, Chem.AtomValenceException) and not forced:
            atom = one.GetAtomWithIdx(why.cause.GetAtomIdx())
            bonds = int(sum(b.GetBondTypeAsDouble() for b in atom.GetBonds())) + atom.GetNumExplicitHs()
            raise BadInput(f"{what}: {atom.GetSymbol()}{atom.GetIdx() + 1} has {bonds} bonds, too many for its charge of "
                           f"{atom.GetFormalCharge()}: correct its bonds or its charge") from None
        if isinstance(why, (Chem.KekulizeException, Chem.AtomKekulizeException)) and not forced:
            raise BadInput(f"{what}: not understood: its aromatic rings have no alternating bonds: mark the hydrogen of a "
                           "nitrogen, as in [nH], or write single and double bonds") from None
        if not forced:
            raise BadInput(f"{what}: not understood: {why}") from None
        one = Chem.Mol(mol)
        for atom in one.GetAtoms():
            atom.SetNoImplicit(True)
        Chem.SanitizeMol(one, Chem.SANITIZE_ALL ^ Chem.SANITIZE_PROPERTIES ^ Chem.SANITIZE_CLEANUP)
    if one.GetNumConformers() and is_flat(places_of(one)):
        Chem.DetectBondStereoChemistry(one, one.GetConformer())
    elif one.GetNumConformers() and one.GetConformer().Is3D():
        Chem.AssignStereochemistryFrom3D(one)
    Chem.AssignStereochemistry(one, cleanIt=True, force=True)
    return one


def with_hydrogens(mol: Chem.Mol, shaped: bool) -> Chem.Mol:
    """All hydrogens as atoms, those that were added relaxed while the others stay. shaped: whether it has a shape."""
    count = mol.GetNumAtoms()
    one = Chem.AddHs(mol, addCoords=shaped)
    if not shaped or one.GetNumAtoms() == count:
        return one
    x = places_of(one)
    # RDKit finds no place for those at the end of a straight chain, as allene's: they begin near their atom, in no plane.
    lost = np.flatnonzero(~np.isfinite(x).all(axis=1))
    x[lost] = x[[one.GetAtomWithIdx(int(n)).GetNeighbors()[0].GetIdx() for n in lost]] + np.cos(np.arange(3 * len(lost))).reshape(-1, 3)
    return placed(one, relaxed(one, x, STEPS, range(count))[1])


def shape(mol: Chem.Mol, what: str) -> Array:
    """Positions (atoms, 3), angstrom, of a molecule with all its hydrogens. They are the same each time."""
    if mol.GetNumAtoms() == 1:
        return np.zeros((1, 3))
    near, other = neighbours_of(mol), False
    for shapes in _embedded(mol):
        best = None
        for x in shapes:
            energy, x = relaxed(mol, x, FEW_STEPS)
            if not np.isfinite(x).all():
                continue
            if not stereo.is_as_given(mol, x):
                other = True
                continue
            strained = geometry.bonds_of(numbers_of(mol), x) != near
            if best is None or (strained, energy) < best[:2]:
                best = strained, energy, x
        if best is not None:
            x = relaxed(mol, best[2], STEPS)[1]
            if stereo.is_as_given(mol, x):
                return x
            other = True
    raise BadInput(f"{what}: no shape could be built" + (" that is the isomer it names" if other else "") +
                   ": is its handedness possible? Otherwise give a file with a shape")


def _embedded(mol: Chem.Mol) -> Iterator[list[Array]]:
    """Shapes by distance geometry, as they come, in one way after the other."""
    one = Chem.Mol(mol)
    options = rdDistGeom.ETKDGv3()
    options.randomSeed = SEED
    options.useSmallRingTorsions = True
    crowded = [a for a in one.GetAtoms() if a.GetDegree() > 4]
    bounds = _bounds(one, crowded) if crowded else stereo.bounds(one)
    if bounds is not None:
        options.SetBoundsMat(bounds)
    few = one.GetNumAtoms() > SMALL_RINGS or not one.GetRingInfo().NumRings()
    # A handedness that no shape can have would be tried for hours.
    # Aromatic rings that are bent, and E double bonds in rings of eight, need a way that knows of no flat ones.
    for random, knowing, count, options.maxIterations in (
            (False, True, 3 if few else TRIES, 20), (True, True, 3, 20), (True, False, 3, 60), (False, False, MORE_TRIES, 20)):
        options.useRandomCoords, options.ignoreSmoothingFailures = random, not knowing
        options.useBasicKnowledge = options.useExpTorsionAnglePrefs = knowing
        found = list(rdDistGeom.EmbedMultipleConfs(one, count, options))
        if found:
            yield [one.GetConformer(n).GetPositions() for n in found]


def _bounds(mol: Chem.Mol, crowded: list[Chem.Atom]) -> Array:
    """Bounds of distances, above and below the diagonal, angstrom. RDKit's leave no place for six fluorine atoms at sulphur.
    crowded: atoms with more than four neighbours."""
    bounds = rdDistGeom.GetMoleculeBoundsMatrix(mol)
    for atom in crowded:
        near = sorted(atom.GetNeighbors(), key=lambda n: n.GetIdx())
        for k, one in enumerate(near):
            length = COVALENT[atom.GetAtomicNum()] + COVALENT[one.GetAtomicNum()]
            for other, low, high in [(atom, 0.95, 1), *((other, 1.3, 2) for other in near[:k])]:
                a, b = sorted((one.GetIdx(), other.GetIdx()))
                bounds[a, b], bounds[b, a] = high * length, low * length
    return bounds
