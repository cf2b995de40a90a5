"""A molecule from a file or from SMILES, ready for quantum chemistry: three-dimensional, with its
hydrogens, one piece. What Open Babel does not do is left to nobody else: what cannot be felt is
refused here, in one line that says what to do."""

import os
import re
from dataclasses import dataclass

import numpy as np
from preparation import molecule as prepared
from preparation.molecule import BadInput, Molecule
from preparation.xtb import MASSES, SYMBOLS

from . import pieces
from .pieces import signed

KINDS = {"sdf": "sdf", "mol": "sdf", "xyz": "xyz", "mol2": "mol2", "pdb": "pdb", "ent": "pdb"}
MOST_ATOMS = 100
MOST_RECORDS = 1000
LEAST_DISTANCE = 0.5  # angstrom
# Elements with a van der Waals radius in the model, and with a mass.
KNOWN = set(MASSES) & {1, 6, 7, 8, 9, 14, 15, 16, 17, 34, 35, 53}


@dataclass
class Input:
    """what: the file or SMILES, as messages name it; kind: of Open Babel's formats; records: its molecules."""
    what: str
    kind: str
    records: list
    charge: int = None  # that an XYZ file's comment gives, of all that is in it


def read(path, smiles, say, unpaired=0):
    """(molecule, whether its shape was built here). say(text) tells what was decided."""
    openbabel = prepared.open_babel()
    if smiles is not None:
        given = Input(f"SMILES '{smiles}'", "smi", [prepared.parsed(smiles)])
    else:
        given = _from_file(openbabel, path)
    for ob in given.records:
        _refuse_no_coordinates(openbabel, given, ob)
    ob = pieces.largest(given, say)
    _refuse_elements(ob, given.what)
    built = _completed(openbabel, ob, given, say, unpaired)
    one = Molecule(ob, given.what)
    if built:
        one = prepared.repeatable(one)
    _check(one, given.what)
    return one, built


def _from_file(openbabel, path):
    ending = os.path.splitext(path)[1][1:].lower()
    kind = KINDS.get(ending)
    if kind is None:
        raise BadInput(f"{path}: not an .sdf, .mol, .mol2, .pdb or .xyz file")
    try:
        text = prepared.read_text(path)
    except UnicodeDecodeError:
        raise BadInput(f"{path}: not a text file") from None
    conversion, ob = openbabel.OBConversion(), openbabel.OBMol()
    conversion.SetInFormat(kind)
    records, more = [], conversion.ReadString(ob, text)
    while more and ob.NumAtoms():
        if len(records) == MOST_RECORDS:
            raise BadInput(f"{path}: more than {MOST_RECORDS} records: give the one to feel")
        records.append(ob)
        ob = openbabel.OBMol()
        more = conversion.Read(ob)
    if not records:
        raise BadInput(f"{path}: not understood as {ending.upper()}")
    charge = re.search(r"\bcharge=([+-]?\d+)\b", text.split("\n", 2)[1] if "\n" in text else "")
    return Input(path, kind, records, int(charge[1]) if kind == "xyz" and charge else None)


def _places(openbabel, ob):
    return np.array([[a.GetX(), a.GetY(), a.GetZ()] for a in openbabel.OBMolAtomIter(ob)])


def _refuse_no_coordinates(openbabel, given, ob):
    """What can be seen only before a file's atoms are sorted into molecules, by their bonds or, in XYZ,
    by their distances."""
    what, x = given.what, _places(openbabel, ob)
    nameless = next((n for n, a in enumerate(openbabel.OBMolAtomIter(ob)) if a.GetAtomicNum() == 0), None)
    if nameless is not None:
        raise BadInput(f"{what}: atom {nameless + 1} is of no known element: correct its symbol")
    if given.kind == "smi":
        return
    if not np.isfinite(x).all():
        raise BadInput(f"{what}: a coordinate is not a finite number")
    if ob.NumBonds() == 0 and (x == 0).all():
        raise BadInput(f"{what}: no coordinates and no bonds: give a file that has them, or --smiles")
    if given.kind == "xyz" and _is_flat(x) and (len(ob.Separate()) > 1 or _is_bulky(openbabel, ob)):
        raise BadInput(f"{what}: flat, and XYZ has no bonds to build a shape from: give an SDF file or --smiles")


def _is_flat(x):
    return len(x) > 3 and np.ptp(x[:, 2]) < 0.01


def _is_bulky(openbabel, ob):
    """Whether an atom has too many neighbours to lie in a plane with them."""
    return any(a.GetExplicitDegree() > 3 for a in openbabel.OBMolAtomIter(ob))


def _refuse_elements(ob, what):
    for n in range(ob.NumAtoms()):
        z = ob.GetAtom(n + 1).GetAtomicNum()
        name = f"{pieces.symbol(z)}{n + 1}"
        if z in pieces.METALS:
            raise BadInput(f"{what}: {name} is a metal, whose bonds are no single bonds that turn: "
                           "take the part without it")
        if z not in KNOWN:
            raise BadInput(f"{what}: {name}: no radius is known for this element, only for "
                           + " ".join(SYMBOLS[k] for k in sorted(KNOWN)))


def _completed(openbabel, ob, given, say, unpaired):
    """Adds hydrogens that a format may leave out, and builds a shape where there is none. Returns
    whether it was built."""
    x = _places(openbabel, ob)
    nowhere = np.ptp(x, axis=0).max() < 0.1 and len(x) > 1
    added = 0
    if given.kind != "xyz":
        before = ob.NumAtoms()
        ob.AddHydrogens()
        added = ob.NumAtoms() - before
    _check_count(ob.NumAtoms(), given.what)
    if given.kind == "smi":
        _build(openbabel, ob, given.what)
        return True
    flat = _is_flat(x) and (added > 0 or _is_bulky(openbabel, ob))
    if added:
        say(f"{added} hydrogen atoms were added")
    elif given.kind == "xyz" and not nowhere and not unpaired:
        _refuse_without_hydrogen(openbabel, ob, given.what)
    if not nowhere and not flat:
        return False
    if given.kind == "xyz":
        raise BadInput(f"{given.what}: no coordinates, and XYZ has no bonds to build a shape from: give an SDF file "
                       "or --smiles")
    _build(openbabel, ob, given.what)
    say(f"{given.what}: {'no coordinates' if nowhere else 'flat'}: a shape was built")
    return True


def _build(openbabel, ob, what):
    if not openbabel.OBBuilder().Build(ob):
        raise BadInput(f"{what}: no shape could be built: give one with coordinates")


def _refuse_without_hydrogen(openbabel, ob, what):
    """XYZ cannot say which hydrogens it leaves out. A carbon with one or two neighbours and free
    valences has lost some, except in CO and isocyanides, where Open Babel gives it three."""
    for n, atom in enumerate(openbabel.OBMolAtomIter(ob)):
        degree, valence = atom.GetExplicitDegree(), atom.GetExplicitValence()
        if atom.GetAtomicNum() == 6 and (degree == 1 and valence < 3 or degree == 2 and valence < 4):
            raise BadInput(f"{what}: C{n + 1} lacks hydrogen, and XYZ has no bonds to add it by: give an SDF file or "
                           "--smiles; a radical needs --uhf")


def _check_count(count, what):
    if count > MOST_ATOMS:
        raise BadInput(f"{what}: {count} atoms, at most {MOST_ATOMS} are feasible: cut out the part that "
                       "matters, and close it with hydrogen")
    if count < 2:
        raise BadInput(f"{what}: a single atom has no shape to feel")


def _check(one, what):
    count = len(one.numbers)
    _check_count(count, what)
    distance = np.linalg.norm(one.positions[:, None] - one.positions[None], axis=2) + 9 * np.eye(count)
    a, b = divmod(int(distance.argmin()), count)
    if distance[a, b] < LEAST_DISTANCE:
        raise BadInput(f"{what}: atoms {a + 1} and {b + 1} are {distance[a, b]:.2f} angstrom apart: these are no "
                       "coordinates of a molecule")


def check_electrons(one, what, charge, unpaired):
    """Refuses a number of unpaired electrons that does not fit."""
    electrons = sum(one.numbers) - charge
    if electrons % 2 == unpaired % 2 and unpaired <= electrons:
        return
    if unpaired:
        raise BadInput(f"{what}: {electrons} electrons, of which {unpaired} cannot be the unpaired ones (--uhf)")
    raise BadInput(f"{what}: {electrons} electrons with charge {signed(charge)}: a radical needs --uhf 1; otherwise "
                   "give the right --charge")


def sdf(one):
    """A molecule as the text of an SDF file."""
    from openbabel import openbabel
    for n, place in enumerate(one.positions):
        one.ob.GetAtom(n + 1).SetVector(*map(float, place))
    one.ob.SetDimension(3)
    conversion = openbabel.OBConversion()
    conversion.SetOutFormat("sdf")
    return conversion.WriteString(one.ob)
