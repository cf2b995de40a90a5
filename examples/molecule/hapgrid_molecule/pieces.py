"""Which of several molecules is felt. One rule holds for the records of a file, for the pieces of a
record, and for SMILES with dots: that with the most atoms beside hydrogen, then with the most atoms,
then the first. What is left out is named, with its charge."""

from collections import Counter
from dataclasses import replace

from .molecule import BadInput
from rdkit import Chem
from rdkit.Chem import rdMolDescriptors


METALS = {3, 4, 11, 12, 13, *range(19, 32), *range(37, 51), *range(55, 85), *range(87, 104)}
MOST_PIECES = 8  # of a record in which no piece is half of it: more are no molecules, but noise
NAMED = 4


def signed(charge):
    return f"{charge:+d}" if charge else "0"


def largest(given):
    """The formats.Record of the one molecule that is felt of all that there are in `given`, a formats.Input."""
    parts = []
    for record in given.records:
        some = Chem.GetMolFrags(record.mol, asMols=True, sanitizeFrags=False)
        if len(some) > MOST_PIECES and 2 * max(p.GetNumAtoms() for p in some) < record.mol.GetNumAtoms():
            raise BadInput(f"{given.what}: {len(some)} pieces that are not bonded: no coordinates of one molecule")
        if len(some) == 1:
            parts.append(record)
        else:  # what the text says is of all pieces
            parts += [replace(record, mol=mol, charge=None, unpaired=None) for mol in some]
    for part in parts:
        part.mol.UpdatePropertyCache(strict=False)  # counts the hydrogens that are not written
    one = max(parts, key=lambda p: (p.mol.GetNumHeavyAtoms(), size(p.mol)))  # the first of equal ones
    others = [p for p in parts if p is not one]
    if size(one.mol) == 1 and others:
        raise BadInput(f"{given.what}: only single atoms or ions, {_named(parts)}: none has a shape to feel: "
                       "give a molecule with bonds")
    if others:
        metals = sorted({a.GetSymbol() for p in others for a in p.mol.GetAtoms() if a.GetAtomicNum() in METALS})
        given.say(f"{given.what}: {len(parts)} molecules or shapes: the largest is taken, {rdMolDescriptors.CalcMolFormula(one.mol)} with charge "
                  f"{signed(Chem.GetFormalCharge(one.mol))}; left out: {_named(others)}"
                  + ("".join(f"; {m} is a metal and is not felt" for m in metals))
                  + ("; the file's charge is of all pieces: --charge gives that of the one"
                     if any(r.charge for r in given.records) and one not in given.records else ""))
    return one


def size(mol):
    """Atoms, with the hydrogens that are not written."""
    return sum(1 + a.GetTotalNumHs() for a in mol.GetAtoms())


def _named(parts):
    """C2H6O, 2 of Na+ with charge +1"""
    counts = Counter((rdMolDescriptors.CalcMolFormula(p.mol), Chem.GetFormalCharge(p.mol)) for p in parts)
    words = [(f"{n} of " if n > 1 else "") + formula + (f" with charge {charge:+d}" if charge else "")
             for (formula, charge), n in counts.items()]
    return ", ".join(words[:NAMED]) + (f" and {len(words) - NAMED} more" if len(words) > NAMED else "")
