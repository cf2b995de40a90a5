"""Molecules that Open Babel reads, since it finds bonds from distances, as RDKit's."""

from rdkit import Chem

from .elements import SYMBOLS
from .molecule import BadInput, placed, unsanitized

# Atoms that stand alone in structures of proteins and salts.
ION_CHARGES = {3: 1, 9: -1, 11: 1, 12: 2, 17: -1, 19: 1, 20: 2, 25: 2, 26: 2, 27: 2, 28: 2, 29: 2, 30: 2, 35: -1, 48: 2,
               53: -1}


def with_bonds(numbers, x, what):
    """RDKit's molecule of atoms that are all there, with bonds that Open Babel finds."""
    rows = "".join(f"{SYMBOLS[z]} {x:.10f} {y:.10f} {w:.10f}\n" for z, (x, y, w) in zip(numbers, x))
    mols = list(molecules(f"{len(numbers)}\n\n{rows}", "xyz", what, hydrogens=False))
    if len(mols) != 1 or mols[0].GetNumAtoms() != len(numbers):
        raise BadInput(f"{what}: not understood as XYZ")
    return mols[0]


def molecules(text, kind, what, hydrogens=True, say=None):
    """RDKit's molecules of the records that Open Babel reads. hydrogens: whether atoms get those that the text leaves out;
    say: what tells that lone pairs were left out."""
    try:
        from openbabel import openbabel
    except ImportError:
        raise BadInput("Open Babel not found: install the Debian package python3-openbabel") from None
    openbabel.obErrorLog.SetOutputLevel(-1)
    conversion, ob = openbabel.OBConversion(), openbabel.OBMol()
    conversion.SetInFormat(kind)
    more = conversion.ReadString(ob, text)
    while more and ob.NumAtoms():
        dummies = [atom for atom in openbabel.OBMolAtomIter(ob) if kind == "mol2" and atom.GetType().upper() in ("LP", "DU")]
        if dummies:
            say(f"{len(dummies)} lone pairs or dummy atoms are left out")
        for dummy in dummies:
            near = list(openbabel.OBAtomAtomIter(dummy))
            ob.DeleteAtom(dummy)
            for atom in near:
                openbabel.OBAtomAssignTypicalImplicitHydrogens(atom)
        yield _from_babel(openbabel, ob, hydrogens)
        ob = openbabel.OBMol()
        more = conversion.Read(ob)


def _from_babel(openbabel, ob, hydrogens):
    atoms = list(openbabel.OBMolAtomIter(ob))
    bonds = [(b.GetBeginAtomIdx() - 1, b.GetEndAtomIdx() - 1, b.GetBondOrder()) for b in openbabel.OBMolBondIter(ob)]
    mol = unsanitized([a.GetAtomicNum() for a in atoms], [a.GetFormalCharge() for a in atoms],
                      [(j, k, order if 1 <= order <= 3 else 1) for j, k, order in bonds])
    for from_, atom in zip(atoms, mol.GetAtoms()):
        if hydrogens and (from_.GetExplicitDegree() > 0 or from_.GetAtomicNum() not in ION_CHARGES):
            atom.SetNumExplicitHs(from_.GetImplicitHCount())
    for atom in mol.GetAtoms():
        double = [b for b in atom.GetBonds() if b.GetBondTypeAsDouble() == 2]
        if atom.GetAtomicNum() == 7 and len(double) == 2 and all(n.GetDegree() > 1 for n in atom.GetNeighbors()):
            double[1].SetBondType(Chem.BondType.SINGLE)  # a triazine's nitrogen; pair_up() gives the carbon another one
        if atom.GetDegree() == 0 and atom.GetTotalNumHs() == 0 and atom.GetFormalCharge() == 0:
            atom.SetFormalCharge(ION_CHARGES.get(atom.GetAtomicNum(), 0))
    return placed(mol, [(a.GetX(), a.GetY(), a.GetZ()) for a in atoms])
