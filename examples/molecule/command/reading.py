"""A molecule from a file or from SMILES, ready for quantum chemistry: three-dimensional, with its
hydrogens, one piece. What Open Babel does not do is left to nobody else: what cannot be felt is
refused here, in one line that says what to do."""

import os
import re

import numpy as np
from preparation import molecule as prepared
from preparation.molecule import BadInput, Molecule
from preparation.xtb import MASSES, SYMBOLS

KINDS = {"sdf": "sdf", "mol": "sdf", "xyz": "xyz", "mol2": "mol2", "pdb": "pdb", "ent": "pdb"}
MOST_ATOMS = 100
LEAST_DISTANCE = 0.5  # angstrom
# Elements with a van der Waals radius in the model, and with a mass.
KNOWN = set(MASSES) & {1, 6, 7, 8, 9, 14, 15, 16, 17, 34, 35, 53}
METALS = {3, 4, 11, 12, 13, *range(19, 32), *range(37, 51), *range(55, 85), *range(87, 104)}


def read(path, smiles, say):
    """(molecule, whether its shape was built here). say(text) tells what was decided."""
    openbabel = prepared._quiet()
    if smiles is not None:
        one = prepared.from_smiles(_largest_of_smiles(smiles, say))
        _check(one, f"SMILES '{smiles}'")
        return one, True
    ob, kind = _from_file(openbabel, path, say)
    ob = _largest(openbabel, ob, path, say)
    _refuse_elements(ob, path)
    built = _completed(openbabel, ob, kind, path, say)
    one = Molecule(ob, path)
    if built:
        one = prepared._repeatable(one)
    _check(one, path)
    return one, built


def _largest_of_smiles(smiles, say):
    parts = smiles.split(".")
    if len(parts) == 1 or not all(parts):
        return smiles
    largest = max(parts, key=lambda p: len(re.findall(r"[A-Z]|[cnops]", p)))
    say(f"{len(parts)} molecules: the largest is taken, {largest}")
    return largest


def _from_file(openbabel, path, say):
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
    if not conversion.ReadString(ob, text) or ob.NumAtoms() == 0:
        raise BadInput(f"{path}: not understood as {ending.upper()}")
    records = {"sdf": r"^\$\$\$\$", "mol2": r"^@<TRIPOS>MOLECULE", "pdb": r"^ENDMDL"}.get(kind)
    count = len(re.findall(records, text, re.M)) if records else _frames(text)
    if count > 1:
        say(f"{path} has {count} molecules or shapes: the first is taken")
    charge = re.search(r"\bcharge=([+-]?\d+)\b", text.split("\n", 2)[1] if "\n" in text else "")
    if kind == "xyz" and charge:
        ob.SetTotalCharge(int(charge[1]))
    return ob, kind


def _frames(text):
    lines, at, count = text.splitlines(), 0, 0
    while at < len(lines) and lines[at].strip().isdigit():
        at += int(lines[at]) + 2
        count += 1
    return count


def signed(charge):
    return f"{charge:+d}" if charge else "0"


def _formula(ob):
    return ob.GetFormula()


def _largest(openbabel, ob, path, say):
    if all(a.GetX() == a.GetY() == a.GetZ() == 0 for a in openbabel.OBMolAtomIter(ob)) and ob.NumBonds() == 0:
        raise BadInput(f"{path}: no coordinates and no bonds: give a file that has them, or --smiles")
    parts = list(ob.Separate())
    if len(parts) == 1:
        return ob
    largest = max(parts, key=lambda p: (p.NumHvyAtoms(), p.NumAtoms()))
    if largest.NumAtoms() * 2 < ob.NumAtoms() and len(parts) > 8:
        raise BadInput(f"{path}: {len(parts)} pieces that are not bonded: no coordinates of one molecule")
    others = " ".join(_formula(p) for p in parts if p is not largest)
    say(f"{path}: {len(parts)} molecules: the largest is taken, {_formula(largest)} with charge "
        f"{signed(largest.GetTotalCharge())}; left out: {others}")
    return largest


def _refuse_elements(ob, path):
    for n in range(ob.NumAtoms()):
        z = ob.GetAtom(n + 1).GetAtomicNum()
        name = f"{SYMBOLS[z] if z < len(SYMBOLS) else 'element ' + str(z)}{n + 1}"
        if z in METALS:
            raise BadInput(f"{path}: {name} is a metal, whose bonds are no single bonds that turn: "
                           "take the part without it")
        if z not in KNOWN:
            raise BadInput(f"{path}: {name}: no radius is known for this element, only for "
                           + " ".join(SYMBOLS[k] for k in sorted(KNOWN)))


def _completed(openbabel, ob, kind, path, say):
    """Adds hydrogens that a format may leave out, and builds a shape where there is none. Returns
    whether it was built."""
    x = np.array([[a.GetX(), a.GetY(), a.GetZ()] for a in openbabel.OBMolAtomIter(ob)])
    if not np.isfinite(x).all():
        raise BadInput(f"{path}: a coordinate is not a finite number")
    nowhere = np.ptp(x, axis=0).max() < 0.1 and len(x) > 1
    before = ob.NumAtoms()
    if kind != "xyz":
        ob.AddHydrogens()
    added = ob.NumAtoms() - before
    _check_count(ob.NumAtoms(), path)
    bulky = any(a.GetExplicitDegree() > 3 for a in openbabel.OBMolAtomIter(ob))
    flat = np.ptp(x[:, 2]) < 0.01 and (bulky or added > 0) and len(x) > 3
    if added:
        say(f"{added} hydrogen atoms were added")
    if not nowhere and not flat:
        return False
    if kind == "xyz":
        raise BadInput(f"{path}: {'no coordinates' if nowhere else 'flat'}, and XYZ has no bonds to build a shape "
                       "from: give an SDF file or --smiles")
    if not openbabel.OBBuilder().Build(ob):
        raise BadInput(f"{path}: no shape could be built: give one with coordinates")
    say(f"{path}: {'no coordinates' if nowhere else 'flat'}: a shape was built")
    return True


def _check_count(count, what):
    if count > MOST_ATOMS:
        raise BadInput(f"{what}: {count} atoms, at most {MOST_ATOMS} are feasible: cut out the part that "
                       "matters, and close it with hydrogen")
    if count < 2:
        raise BadInput(f"{what}: a single atom has no shape to feel")


def _check(one, what):
    count = len(one.numbers)
    _check_count(count, what)
    for n, z in enumerate(one.numbers):
        if z not in KNOWN:
            raise BadInput(f"{what}: {SYMBOLS[z]}{n + 1}: " + (
                "a metal, whose bonds are no single bonds that turn: take the part without it" if z in METALS else
                "no radius is known for this element"))
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
