"""The texts of molecules' files, as records of one molecule or several pieces each.

RDKit reads MDL's formats (SDF, MOL), MOL2 and SMILES, and xyz.py XYZ. Of a PDB file the atoms are read here. A bond whose order
the text does not say is UNSPECIFIED, and an atom whose hydrogens may be missing can have implicit ones: valences.py finds both.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.pdb import kept_locations
from rdkit import Chem

from . import geometry, stereo, titles, xyz
from .elements import NUMBERS
from .molecule import BadInput, is_flat, numbers_of, placed, places_of, unsanitized

KINDS = {"sdf": "sdf", "mol": "sdf", "xyz": "xyz", "allxyz": "xyz", "extxyz": "xyz", "mol2": "mol2", "pdb": "pdb", "ent": "pdb",
         "cif": "cif"}
MOST_ATOMS = 100
MOST_CHARGE = 9
AMINO_ACIDS = set("ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL ACE NME".split())


@dataclass
class Record:
    """mol: RDKit's molecule, not sanitized, with a conformer unless it is of SMILES. drawing: whether its coordinates
    are said to be a drawing's. charge, unpaired: what the text says of all of it, or None."""
    mol: Chem.Mol
    drawing: bool = False
    charge: int | None = None
    unpaired: int | None = None


@dataclass
class Input:
    """what: the file or SMILES, as messages name it; kind: a value of KINDS, or "smi"; said: what was put right."""
    what: str
    kind: str
    records: list[Record] = field(default_factory=list)
    said: list[str] = field(default_factory=list)

    def say(self, text: str) -> None:
        if text not in self.said:
            self.said.append(text)


def decoded(content: bytes, what: str) -> str:
    """Text of UTF-8, UTF-16 with its mark, or else Latin-1, with single line feeds."""
    try:
        text = content.decode("utf-16" if content[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if "\0" in text:
        raise BadInput(f"{what}: not a text file")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read(text: str, what: str, kind: str) -> Input:
    given = Input(what, kind)
    {"sdf": _sdf, "xyz": _xyz, "mol2": _mol2, "pdb": _pdb, "cif": _cif}[kind](text, given)
    if not given.records:
        raise BadInput(f"{what}: not understood as {kind.upper()}")
    return given


def smiles(text: str) -> Input:
    given = Input(f"SMILES '{text}'", "smi")
    # A second word would be read as a name.
    mol = Chem.MolFromSmiles(text, sanitize=False) if re.fullmatch(r"\S+", text) else None
    if mol is None or mol.GetNumAtoms() == 0:
        raise BadInput(f"{given.what}: not understood")
    stereo.mark_allenes(mol)
    given.records.append(Record(mol))
    return given


# MDL's formats

def _sdf(text: str, given: Input) -> None:
    for block in re.split(r"^\$\$\$\$.*\n?", text, flags=re.M):
        if not block.strip():
            continue
        lines = _with_header(block.split("\n"), given)
        if lines is None:
            continue
        unpaired = _radicals(lines)
        if re.search(r"^M  V30 MDLV30/STE(RAC|REL)\d", "\n".join(lines), re.M):
            given.say("centres are marked as those of a mixture: the form that is drawn is taken")
        mol = _understood(Chem.MolFromMolBlock, "\n".join(lines), given, strictParsing=False)
        x = places_of(mol)
        drawing = is_flat(x) and lines[1][20:22].upper() == "2D"
        if is_flat(x) and not drawing:  # only of what is called a drawing does RDKit look at the wedges
            lines[1] = f"{lines[1][:20]:<20}2D{lines[1][22:]}"
            mol = _understood(Chem.MolFromMolBlock, "\n".join(lines), given, strictParsing=False)
        if mol.GetNumBonds() == 0 and mol.GetNumAtoms() > 1 and np.ptp(x, axis=0).max() > 0.1:
            given.say("no bonds are in the file: they are found from the distances")
            mol = with_bonds(numbers_of(mol), x, given.what)
        given.records.append(Record(mol, drawing, unpaired=unpaired))


def _understood(reader: Callable[..., Chem.Mol], text: str, given: Input, **options: bool) -> Chem.Mol:
    mol = reader(text, sanitize=False, removeHs=False, **options)
    if mol is None or mol.GetNumAtoms() == 0:
        raise BadInput(f"{given.what}: record {len(given.records) + 1} is not understood as {given.kind.upper()}: its atoms or "
                       "bonds are damaged")
    return mol


def _with_header(lines: list[str], given: Input) -> list[str] | None:
    """The lines with three of a header, as the format has it; None where there is no line of counts."""
    counts = re.compile(r"V[23]000\s*$|^[ \d]{2}\d[ \d]{2}\d( |$)")
    at = next((n for n, line in enumerate(lines[:8]) if counts.search(line)), None)
    if at is None:
        return None
    if at == 3:
        return lines
    given.say(f"the header has {at} line{'s' * (at != 1)} in place of 3: the atoms are taken from line {at + 2} on")
    header = [line for line in lines[:at] if line.strip()][-2:]
    return ["", *(header or [""])[-1:], "", *lines[at:]]


def _radicals(lines: list[str]) -> Any:
    """How many electrons are unpaired, or None where no radical is marked. 1 is a singlet, 2 a doublet, 3 a triplet. The old
    column of charges has 4 for a radical, which RDKit passes over: such an atom gets a line of its own."""
    if not lines[3].rstrip().endswith("V3000") and not any(line.startswith(("M  CHG", "M  RAD")) for line in lines):
        old = [n + 1 for n, line in enumerate(lines[4:4 + int(lines[3][:3])]) if line[36:39].strip() == "4"]
        end = next((n for n, line in enumerate(lines) if line.startswith("M  END")), len(lines))
        lines[end:end] = [f"M  RAD  1{atom:4d}   2" for atom in old]
    kinds = [int(kind) for line in lines if line.startswith("M  RAD") for kind in line[9:].split()[1::2] if kind.isdigit()]
    kinds += [int(kind) for line in lines if line.startswith("M  V30 ") for kind in re.findall(r"\bRAD=(\d)\b", line)]
    return sum(max(kind - 1, 0) for kind in kinds) if kinds else None


# XYZ

def _xyz(text: str, given: Input) -> None:
    frames = xyz.frames_of(text, given.what, given.say)
    order, known = lowest_first(frames)
    if order:  # an ensemble, a path, or the log of an optimisation
        given.say(f"{len(order)} frames of one molecule" + (
            f": frame {order[0] + 1}, of lowest energy, is taken" if known else ", without energies: the first is taken"))
        frames = [frames[order[0]]]
    for one in frames:
        charge, unpaired = charge_in(one.title, given.what)
        given.records.append(Record(with_bonds(one.numbers, one.x, given.what), charge=charge, unpaired=unpaired))


def charge_in(title: str, what: str) -> tuple[int | None, int | None]:
    """(charge, unpaired electrons) that a title gives, each None where it does not: charge=-1, charge: -1, charge -1,
    multiplicity 2, or -1 1 alone, as the inputs of most programs have it."""
    pair = re.fullmatch(r"\s*([+-]?\d)\s+([1-9])\s*", title)
    if pair:
        return int(pair[1]), int(pair[2]) - 1
    charge = re.search(r"\b(?:total[_ ]?)?(?:charge|chrg)\s*[=: ]\s*([+-]?\d+)\b(?!\.\d*[1-9])", title, re.I)
    spin = re.search(r"\b(?:multiplicity|mult|spin_multiplicity)\s*[=: ]\s*(\d+)\b", title, re.I)
    for found, least, most in ((charge, -MOST_CHARGE, MOST_CHARGE), (spin, 1, MOST_CHARGE + 1)):
        if found and not least <= int(found[1]) <= most:
            raise BadInput(f"{what}: the title says {found[0]}, it is from {least} to {most}: correct the title")
    return int(charge[1]) if charge else None, int(spin[1]) - 1 if spin else None


def lowest_first(frames: Sequence[xyz.Frame]) -> tuple[list[int], bool]:
    """(the numbers of several xyz.Frames of one molecule, that of the lowest energy first; whether all have an energy). No
    numbers where they are of several molecules."""
    energies = [titles.energy(one.title, None) for one in frames]
    if len(frames) < 2 or any(one.numbers != frames[0].numbers for one in frames):
        return [], False
    known = None not in energies
    return sorted(range(len(frames)), key=lambda k: (energies[k] or (0.0,))[0] if known else k), known


# PDB. Source: the format's description 3.3. Columns are counted from 0 here. 12-15 have the atom's name, with its element
# right-aligned in 12-13 but for hydrogens whose name has four letters; 16 the alternate location, 17-19 the residue, 21-26
# its place, 54-59 the occupancy, 76-77 the element, 78-79 the charge.

def _pdb(text: str, given: Input) -> None:
    for block in re.split(r"^END(?:MDL)?\s*$", text, flags=re.M):
        lines = [f"{line:<80}" for line in block.split("\n") if line.startswith(("ATOM  ", "HETATM"))]
        kept = kept_locations([line for line in lines if line[16] != " "], given.say, together=True)
        lines = [line for line in lines if line[16] in (" ", kept.get(line[21:27]))]
        if not lines:
            continue
        try:
            x = np.array([[xyz.finite(line[k:k + 8]) for k in (30, 38, 46)] for line in lines])
        except ValueError:
            raise BadInput(f"{given.what}: an atom's coordinates are not in columns 31 to 54, where PDB has them") from None
        mol = with_bonds([_element(line) for line in lines], x, given.what, [_charge(line) for line in lines])
        check_count(max(2, *map(len, Chem.GetMolFrags(mol))), given.what)
        for atom in mol.GetAtoms():  # one that stands alone is an ion, or water
            atom.SetNoImplicit(atom.GetDegree() > 0 or atom.GetAtomicNum() != 8)
        given.records.append(Record(mol))


def _element(line: str) -> int:
    """The atomic number, 0 for none, wherever the line has the element."""
    name, element = line[12:16].upper(), line[76:78].strip().upper()
    two, letters = name[:2].strip(), re.sub(r"[^A-Z]", "", name)
    is_one = line[17:20].strip().upper() in AMINO_ACIDS or two[:1] == "H" and len(name.strip()) == 4
    if element not in NUMBERS:
        element = two if two in NUMBERS and (len(two) == 1 or not is_one) else letters[:1]
        if letters in ("CL", "BR") and not is_one:  # of many programs' ligands a column farther right
            element = letters
    return NUMBERS.get(element, 0)


def _charge(line: str) -> int:
    found = re.fullmatch(r"(\d)([+-])|([+-])(\d)", line[78:80])
    return int("".join(found.group(2, 1) if found[1] else found.group(3, 4))) if found else 0


# MOL2

def _sybyl(kind: str) -> str:
    """An atom's type as SYBYL has it, of one of GAFF, whose small letters begin with the element (ca: an aromatic carbon), or of
    capitals."""
    if kind.islower():
        return kind[:2].title() if kind[:2] in ("cl", "br") else kind[0].upper()
    return kind.title() if len(kind) == 2 and kind in NUMBERS else kind


def _mol2(text: str, given: Input) -> None:
    text = re.sub(r"^([ \t]*\d+[ \t]+\S+(?:[ \t]+[-+.\deE]+){3}[ \t]+)([A-Za-z]\w*)(?=[ \t]|$)",
                  lambda found: found[1] + _sybyl(found[2]), text, flags=re.M)
    for block in re.split(r"^@<TRIPOS>MOLECULE", text, flags=re.M)[1:]:
        mol = _understood(Chem.MolFromMol2Block, f"@<TRIPOS>MOLECULE{block}", given, cleanupSubstructures=False)
        told = re.findall(r"^[ \t]*(\d+)[ \t]+\d+[ \t]*\ncharge[ \t]+([+-]?\d)[ \t]*$", block, flags=re.M)
        for atom in mol.GetAtoms():  # RDKit's guess takes all hydrogens to be there
            atom.SetFormalCharge(int(dict(told).get(str(atom.GetIdx() + 1), 0)))
            atom.SetNoImplicit(False)
        # Words end where spaces begin: where they could end anywhere, a long one would take for ever.
        dummies = re.findall(r"^[ \t]*(?:\S+[ \t]+){5}(?:LP|DU)\b", block, flags=re.M | re.I)
        if dummies:  # RDKit leaves out the lone pairs
            given.say(f"{len(dummies)} lone pairs or dummy atoms are left out")
            mol = Chem.DeleteSubstructs(mol, Chem.MolFromSmarts("[#0]"))
        given.records.append(Record(mol))


# CIF of a ligand: mmCIF's categories chem_comp_atom and chem_comp_bond.

# No text in quotes is longer: to look for the end of each one to the end of its line would take quadratic time.
_WORD = re.compile(r"^;(.*?)^;|'([^\n]{0,80}?)'(?=\s)|\"([^\n]{0,80}?)\"(?=\s)|#[^\n]*|(\S+)", re.M | re.S)
_ORDERS = {"SING": 1, "DOUB": 2, "TRIP": 3}


def _table(words: Sequence[str], category: str) -> list[dict[str, str]]:
    """The rows of a category, in a loop or alone. words: of the text, those of quotes behind a blank."""
    prefix = f"_{category}."
    at = next((n for n, word in enumerate(words) if word.lower().startswith(prefix)), len(words))
    if at == len(words) or at == 0 or words[at - 1].lower() != "loop_":
        single = {}
        while at + 1 < len(words) and words[at].lower().startswith(prefix):
            single[words[at][len(prefix):].lower()] = words[at + 1].lstrip(" ")
            at += 2
        return [single] if single else []
    heads = []
    while at < len(words) and words[at].lower().startswith(prefix):
        heads.append(words[at][len(prefix):].lower())
        at += 1
    out: list[dict[str, str]] = []
    while at + len(heads) <= len(words) and not re.match("_|loop_|data_", words[at], re.I):
        out.append(dict(zip(heads, (word.lstrip(" ") for word in words[at:at + len(heads)]))))
        at += len(heads)
    return out


def _cif(text: str, given: Input) -> None:
    words = [found[4] or " " + (found[1] or found[2] or found[3] or "") for found in _WORD.finditer(text)
             if not found[0].startswith("#")]
    rows, bonds = _table(words, "chem_comp_atom"), _table(words, "chem_comp_bond")
    if not rows or not bonds:
        raise BadInput(f"{given.what}: not the CIF of a ligand, which has chem_comp_atom and chem_comp_bond")
    check_count(len(rows), given.what)
    for kind, key in (("ideal", "pdbx_model_cartn_{}_ideal"), ("model", "model_cartn_{}")):
        try:
            x = np.array([[xyz.finite(row[key.format(axis)]) for axis in "xyz"] for row in rows])
            given.say(f"the {kind} coordinates are taken")
            break
        except (KeyError, ValueError):
            continue
    else:
        raise BadInput(f"{given.what}: an atom has no coordinates, neither of the model nor ideal ones")
    numbers = [NUMBERS.get(row.get("type_symbol", "").upper(), 0) for row in rows]
    charges = [int(row["charge"]) if re.fullmatch(r"[+-]?\d", row.get("charge", "")) else 0 for row in rows]
    names = {row.get("atom_id"): n for n, row in enumerate(rows)}
    try:
        ends = [(names[b["atom_id_1"]], names[b["atom_id_2"]], _ORDERS[b["value_order"].upper()]) for b in bonds]
    except KeyError as what:
        raise BadInput(f"{given.what}: a bond has {what}, which is no atom or order") from None
    if len({frozenset((a, b)) for a, b, _ in ends if a != b}) < len(ends):
        raise BadInput(f"{given.what}: a bond is given twice, or leads to its own atom")
    given.records.append(Record(placed(unsanitized(numbers, charges, ends), x)))


# Bonds by distances

def with_bonds(numbers: Sequence[int], x: Array, what: str, charges: Sequence[int] | None = None) -> Chem.Mol:
    """RDKit's molecule of atoms with bonds of open order between those that are near each other. charges: of the atoms."""
    check_count(len(x), what, 40 * MOST_ATOMS)
    near = geometry.bonds_of(numbers, x)
    bonds = [(j, k, 0) for j, some in enumerate(near) for k in some if j < k]
    return placed(unsanitized(numbers, charges or [0] * len(x), bonds), x)


def check_count(count: int, what: str, most: int = MOST_ATOMS) -> None:
    if count > most:
        raise BadInput(f"{what}: {count} atoms, at most {MOST_ATOMS} are feasible: cut out the part that "
                       "matters, and close it with hydrogen")
    if count < 2:
        raise BadInput(f"{what}: a single atom has no shape to feel")
