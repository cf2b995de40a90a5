"""A molecule from a file or from SMILES, ready for quantum chemistry: three-dimensional, with its hydrogens, one piece. What
cannot be felt is refused here, in one line that says what to do."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from hapgrid.apps.common import sandbox
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import read_bytes
from rdkit import Chem
from rdkit.Chem import rdMolDescriptors

from . import building, formats, geometry, molecule as prepared, stereo, valences, xyz
from .elements import MASSES, METALS, SYMBOLS
from .formats import Input, Record, check_count
from .molecule import BadInput, Molecule, is_flat, listed, numbers_of, places_of, signed

ADVICE = "the file is damaged or too complicated: give it in another format, or --smiles"
FARTHEST = 9999  # angstrom: columns of SDF have no more digits
LEAST_DISTANCE = 0.5  # angstrom
TRIPLE = 0.85  # of the sum of the covalent radii: a carbon whose only bond is longer has no triple bond
# The last has too many neighbours to lie in a plane with them.
CARBON_HYDROGEN, BULKY = map(Chem.MolFromSmarts, ("[#1]~[#6]", "[D{4-}]"))


def read(path: str | None, smiles: str | None, charge: int | None = None, unpaired: int | None = None) -> Molecule:
    """The Molecule of a file or SMILES. charge, unpaired: what the command line says, or None."""
    what = f"SMILES '{smiles}'" if path is None else path
    kind = formats.KINDS.get(os.path.splitext(path or "")[1][1:].lower(), "")
    if path is not None and not kind:
        raise BadInput(f"{path}: not an .sdf, .mol, .mol2, .pdb, .cif or .xyz file")
    content = b"" if path is None else read_bytes(path, prepared.MOST_BYTES)

    def work() -> dict[str, Any]:
        given = formats.smiles(smiles or "") if path is None else formats.read(formats.decoded(content, path), path, kind)
        return _one(given, charge, unpaired)
    one = Molecule(what, **sandbox.run(work, what, ADVICE))
    electrons = sum(one.numbers) - one.charge
    if electrons < max(1, one.unpaired) or (electrons - one.unpaired) % 2:
        raise BadInput(f"{what}: {electrons} electrons with charge {signed(one.charge)} do not go with {one.unpaired} unpaired ones: "
                       "give the right --charge, or --uhf 1 for a radical")
    return one


def sdf(one: Molecule) -> str:
    """The text of an SDF file, which started() reads."""
    mol = prepared.placed(one.rd, one.positions)
    Chem.AssignStereochemistryFrom3D(mol)  # or its double bonds are marked as of either side
    mol.SetProp("_Name", f"charge={one.charge} unpaired={one.unpaired} built={int(one.built)}")
    return Chem.MolToMolBlock(mol, kekulize=True) + "$$$$\n"


def started(path: str) -> Molecule:
    """The molecule of what sdf() wrote, changed by hand or not."""
    content = read_bytes(path, prepared.MOST_BYTES)

    def work() -> list[dict[str, Any]]:
        text = formats.decoded(content, path)
        mol = formats.read(text, path, "sdf").records[0].mol
        _check(places_of(mol), path)
        return [_plain(mol), dict(word.split("=", 1) for word in text.split("\n", 1)[0].split() if "=" in word)]
    plain, words = sandbox.run(work, path, ADVICE)
    try:
        charge, unpaired = int(words.get("charge", sum(plain["charges"]))), int(words.get("unpaired", 0))
    except ValueError:
        raise BadInput(f"{path}: its title is not as it was written: remove the file") from None
    return Molecule(path, **plain, charge=charge, unpaired=unpaired, built=words.get("built") == "1")


def ensemble(path: str | None) -> tuple[list[tuple[int, Array]], bool]:
    """([(number of the frame, positions in angstrom)], whether all have energies) of a file of XYZ whose frames are one molecule,
    the lowest energy first; none of another file, and where it is one frame, or several molecules."""
    if not path or formats.KINDS.get(os.path.splitext(path)[1][1:].lower()) != "xyz":
        return [], False
    what = path
    content = read_bytes(path, prepared.MOST_BYTES)

    def work() -> tuple[list[tuple[int, Any]], bool]:
        frames = xyz.frames_of(formats.decoded(content, what), what)
        order, known = formats.lowest_first(frames)
        return [(k + 1, frames[k].x.tolist()) for k in order], known
    shapes, known = sandbox.run(work, path, ADVICE)
    return [(number, np.array(x)) for number, x in shapes], known


def _one(given: Input, charge: int | None, unpaired: int | None) -> dict[str, Any]:
    """What makes a Molecule, as JSON can hold it."""
    for record in given.records:
        _refuse_no_coordinates(given, record.mol)
    record, others = _largest(given)
    charge = record.charge if charge is None else charge
    unpaired = record.unpaired if unpaired is None else unpaired
    strange = [a for a in record.mol.GetAtoms() if a.GetAtomicNum() not in set(MASSES) - METALS]
    if strange:
        raise BadInput(f"{given.what}: {valences.named(record.mol, [strange[0].GetIdx()])}: only molecules of "
                       f"{' '.join(SYMBOLS[z] for z in MASSES if z not in METALS)} can be felt: take the part without it"
                       + (", or give frames of a path (--path)" if strange[0].GetAtomicNum() in METALS else ""))
    mol, built = _completed(given, record, charge, unpaired)
    charge = Chem.GetFormalCharge(mol) if charge is None else charge
    _check(places_of(mol), given.what)
    said = [_left_out(given, mol, charge, others)] if others else []
    return {**_plain(mol), "charge": charge, "unpaired": unpaired or 0, "built": built, "said": said + given.said}


def _plain(mol: Chem.Mol) -> dict[str, Any]:
    """Its atoms and bonds, as JSON can hold them."""
    Chem.Kekulize(mol, clearAromaticFlags=True)
    bonds = [(b.GetBeginAtomIdx(), b.GetEndAtomIdx(), min(max(int(b.GetBondTypeAsDouble()), 1), 3)) for b in mol.GetBonds()]
    return {"numbers": numbers_of(mol), "positions": places_of(mol).tolist(),
            "charges": [a.GetFormalCharge() for a in mol.GetAtoms()], "bonds": bonds}


def _refuse_no_coordinates(given: Input, mol: Chem.Mol) -> None:
    """What can be seen only before a file's atoms are sorted into molecules."""
    what, numbers, x = given.what, numbers_of(mol), places_of(mol)
    if 0 in numbers:
        raise BadInput(f"{what}: atom {numbers.index(0) + 1} is of no known element: correct its symbol")
    far = np.abs(x).max(axis=1, initial=0)
    if far.max(initial=0) > FARTHEST:
        raise BadInput(f"{what}: atom {far.argmax() + 1} is {far.max():.3g} angstrom from the origin: these are no coordinates "
                       "of a molecule")
    if given.kind != "smi" and len(x) > 1 and (x == 0).all() and (given.kind in ("xyz", "pdb") or mol.GetNumBonds() == 0):
        raise BadInput(f"{what}: no coordinates and no bonds: give a file that has them, or --smiles")
    if given.kind == "xyz" and is_flat(x) and (len(Chem.GetMolFrags(mol)) > 1 or mol.HasSubstructMatch(BULKY)):
        raise BadInput(f"{what}: flat, and XYZ has no bonds to build a shape from: give an SDF file or --smiles")


def _largest(given: Input) -> tuple[Record, list[Record]]:
    """(the formats.Record of the one molecule that is felt, the others). One rule holds for the records of a file, for the pieces
    of a record, and for SMILES with dots: that with the most atoms beside hydrogen, then with the most atoms, then the first."""
    parts = []
    for record in given.records:
        some = Chem.GetMolFrags(record.mol, asMols=True, sanitizeFrags=False)
        if len(some) == 1:
            parts.append(record)
        else:  # what the text says is of all pieces
            parts += [replace(record, mol=mol, charge=None, unpaired=None) for mol in some]
    for part in parts:
        part.mol.UpdatePropertyCache(strict=False)  # counts the hydrogens that are not written
    one = max(parts, key=lambda p: (p.mol.GetNumHeavyAtoms(), p.mol.GetNumAtoms(onlyExplicit=False)))  # the first of equal ones
    others = [p for p in parts if p is not one]
    if one.mol.GetNumAtoms(onlyExplicit=False) == 1 and others:
        raise BadInput(f"{given.what}: only single atoms or ions, {_counted(parts)}: none has a shape to feel: "
                       "give a molecule with bonds")
    return one, others


def _left_out(given: Input, mol: Chem.Mol, charge: int, others: Sequence[Record]) -> str:
    """What is taken, and what is not."""
    return (f"{given.what}: {len(others) + 1} molecules or shapes: the largest is taken, {rdMolDescriptors.CalcMolFormula(mol)} "
            f"with charge {signed(charge)}; left out: {_counted(others)}")


def _counted(parts: Sequence[Record]) -> str:
    """C2H6O, 2 of Na+ with charge +1"""
    counts = Counter((rdMolDescriptors.CalcMolFormula(p.mol), Chem.GetFormalCharge(p.mol)) for p in parts)
    words = [(f"{n} of " if n > 1 else "") + formula + (f" with charge {charge:+d}" if charge else "")
             for (formula, charge), n in counts.items()]
    return listed(words)


def _completed(given: Input, record: Record, charge: int | None, unpaired: int | None) -> tuple[Chem.Mol, bool]:
    """(the molecule with all hydrogens and a shape, whether that was built)."""
    what, x = given.what, places_of(record.mol)
    nowhere = np.ptp(x, axis=0).max() < 0.1 and len(x) > 1
    mol = _closed(given, record.mol, nowhere, charge, unpaired)
    mol = building.understood(mol, what, given.kind == "xyz" or charge is not None or unpaired is not None)
    added = mol.GetNumAtoms(onlyExplicit=False) - mol.GetNumAtoms()
    if given.kind == "smi":
        free = {a.GetIdx(): a.GetNumRadicalElectrons() for a in mol.GetAtoms() if a.GetNumRadicalElectrons()}
        if unpaired is None and free and sum(free.values()) % 2 == 0:  # the number of electrons does not tell it
            raise BadInput(f"{what}: open valences of {valences.named(mol, free)}: write the hydrogen that is missing, or give "
                           "--uhf: 0 for a singlet, 2 for a triplet")
        return _built(mol, given), True
    share = geometry.shares(numbers_of(mol), x)
    # Bonds are shorter or longer than any in a drawing, also where that says it is none.
    drawn = record.drawing or not all(0.75 < share[b.GetBeginAtomIdx(), b.GetEndAtomIdx()] < 1.35 for b in mol.GetBonds())
    flat = is_flat(x) and (added > 0 or drawn or mol.HasSubstructMatch(BULKY))
    if added:
        given.say(f"{added} hydrogen atoms were added" if added > 1 else "1 hydrogen atom was added")
    if not nowhere and not flat:
        return building.with_hydrogens(mol, True), False
    if given.kind == "xyz":
        raise BadInput(f"{what}: no coordinates, and XYZ has no bonds to build a shape from: give an SDF file or --smiles")
    given.say(f"{what}: {'no coordinates' if nowhere else 'flat'}: a shape was built")
    return _built(mol, given), True


def _closed(given: Input, mol: Chem.Mol, nowhere: bool, charge: int | None, unpaired: int | None) -> Chem.Mol:
    """The molecule with bonds, charges and numbers of hydrogens that fit each other. nowhere: whether it has no coordinates."""
    what, total, finds = given.what, Chem.GetFormalCharge(mol), given.kind in ("pdb", "mol2") and not nowhere
    if finds:  # what follows takes long where dozens of atoms lie at one place
        _refuse_one_place(places_of(mol), what)
    if given.kind == "xyz" and unpaired is None and charge is None:
        _refuse_without_hydrogen(mol, what)
    filled = valences.hydrogens_set(mol, Chem.Atom.GetTotalNumHs)  # as RDKit counts them
    if finds:
        filled = _filled(mol, total) or _filled(mol, None) or filled
    check_count(filled.GetNumAtoms(onlyExplicit=False), what)
    if given.kind == "smi" and charge is None:
        return mol
    drawn = nowhere or given.kind == "smi" or given.kind == "sdf" and is_flat(places_of(mol))
    lack = sum(atom.GetTotalNumHs() > 0 for atom in filled.GetAtoms())
    if drawn or len(mol.GetSubstructMatches(CARBON_HYDROGEN, maxMatches=10000)) < lack:
        if finds and charge not in (None, total):
            filled = _filled(mol, charge) or filled
        Chem.SanitizeMol(filled, Chem.SANITIZE_KEKULIZE, catchErrors=True)
        return valences.closed(filled, what, charge, unpaired)
    # Where most carbons have their hydrogens the file has all that there are, and other bonds or charges are looked for.
    bare = valences.hydrogens_set(mol, lambda atom: 0)
    if finds and not is_flat(places_of(mol)):  # lengths and hydrogens tell more than what programs write to MOL2
        for bond in bare.GetBonds():
            bond.SetBondType(Chem.BondType.UNSPECIFIED)
    return valences.closed(bare, what, charge, unpaired, filled if lack else None)


def _filled(mol: Chem.Mol, total: int | None) -> Chem.Mol | None:
    """With the hydrogens that fit its shape and a total charge, or None. Where charges are is found by closed()."""
    out = Chem.Mol(mol)
    for atom in out.GetAtoms():
        atom.SetNoImplicit(False)
    out = valences.assigned(out, total, 0)
    for atom, before in zip(out.GetAtoms(), mol.GetAtoms()) if out else ():
        atom.SetFormalCharge(before.GetFormalCharge())
    return out


def _built(mol: Chem.Mol, given: Input) -> Chem.Mol:
    """With a shape in place of what it has."""
    mol = building.with_hydrogens(mol, False)
    x = building.shape(mol, given.what)
    for line in stereo.words(stereo.chosen(mol, x)):
        given.say(line)
    return prepared.placed(mol, x)


def _refuse_without_hydrogen(mol: Chem.Mol, what: str) -> None:
    """XYZ cannot say which hydrogens it leaves out. A carbon with one neighbour at the distance of a single bond has lost
    some, and so has one with two neighbours that are not on a line with it."""
    x = places_of(mol)
    share = geometry.shares(numbers_of(mol), x)
    for atom in mol.GetAtoms():
        at, near = atom.GetIdx(), [n.GetIdx() for n in atom.GetNeighbors()]
        if atom.GetAtomicNum() == 6 and (len(near) == 1 and share[at, near[0]] > TRIPLE or
                                         len(near) == 2 and geometry.angle(x, near[0], at, near[1]) < valences.STRAIGHT):
            raise BadInput(f"{what}: C{at + 1} lacks hydrogen, and XYZ has no bonds to add it by: give an SDF file or --smiles; "
                           "an ion needs --charge, a radical --uhf")


def _check(x: Array, what: str) -> None:
    check_count(len(x), what)
    if not np.isfinite(x).all():
        raise BadInput(f"{what}: a coordinate is not a finite number")
    _refuse_one_place(x, what)


def _refuse_one_place(x: Array, what: str) -> None:
    distance = np.linalg.norm(x[:, None] - x[None], axis=2) + 9 * np.eye(len(x))
    a, b = divmod(int(distance.argmin()), len(x))
    if distance[a, b] < LEAST_DISTANCE:
        raise BadInput(f"{what}: atoms {a + 1} and {b + 1} are {distance[a, b]:.2f} angstrom apart: these are no "
                       "coordinates of a molecule")
