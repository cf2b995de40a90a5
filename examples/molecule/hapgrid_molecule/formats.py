"""The texts of molecules' files, as records of one molecule or several pieces each.

RDKit reads MDL's formats (SDF, MOL) and SMILES, Open Babel (babel.py) the others. What both misread is put right in
the text before: symbols in capitals, alternate locations, lone pairs, headers, units.
"""

import re
from dataclasses import dataclass, field

import numpy as np
from rdkit import Chem

from . import babel, pdb
from .elements import COVALENT, NUMBERS, SYMBOLS
from .molecule import BadInput
from .xtb import BOHR

KINDS = {"sdf": "sdf", "mol": "sdf", "xyz": "xyz", "mol2": "mol2", "pdb": "pdb", "ent": "pdb"}
MOST_RECORDS = 1000
MOST_CHARGE = 9


@dataclass
class Record:
    """mol: RDKit's molecule, not sanitized, with a conformer unless it is of SMILES. drawing: whether its coordinates
    are said to be a drawing's. charge, unpaired: what the text says of all of it, or None. energy: in whatever unit."""
    mol: Chem.Mol
    drawing: bool = False
    charge: int = None
    unpaired: int = None
    energy: float = None


@dataclass
class Input:
    """what: the file or SMILES, as messages name it; kind: a value of KINDS, or "smi"; said: what was put right."""
    what: str
    kind: str
    records: list = field(default_factory=list)
    said: list = field(default_factory=list)

    def say(self, text):
        if text not in self.said:
            self.said.append(text)


def decoded(content, what):
    """Text of UTF-8, UTF-16 with its mark, or else Latin-1, with single line feeds."""
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = content.decode("utf-16", "replace")
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = content.decode("latin-1")
    if "\0" in text:
        raise BadInput(f"{what}: not a text file")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read(text, what, kind):
    """The Input of a file's text. Errors: BadInput."""
    given = Input(what, kind)
    {"sdf": _sdf, "xyz": _xyz, "mol2": _mol2, "pdb": _pdb}[kind](text, given)
    if not given.records:
        raise BadInput(f"{what}: not understood as {kind.upper()}")
    return given


def smiles(text):
    given = Input(f"SMILES '{text}'", "smi")
    parameters = Chem.SmilesParserParams()
    parameters.sanitize = parameters.removeHs = False
    # A second word would be read as a name.
    mol = Chem.MolFromSmiles(text, parameters) if re.fullmatch(r"\S+", text) else None
    if mol is None or mol.GetNumAtoms() == 0:
        raise BadInput(f"{given.what}: not understood")
    given.records.append(Record(mol))
    return given


def _add(given, record):
    if len(given.records) == MOST_RECORDS:
        raise BadInput(f"{given.what}: more than {MOST_RECORDS} records: give the one to feel")
    given.records.append(record)


# MDL's formats

def _sdf(text, given):
    for block in re.split(r"^\$\$\$\$.*\n?", text, flags=re.M):
        if not block.strip():
            continue
        lines = _with_header(block.split("\n"), given)
        if lines is None:
            continue
        x = _sdf_positions(lines)
        flat = x is not None and is_flat(x)
        drawing = flat and lines[1][20:22].upper() == "2D"
        if flat and len(x) > 1:  # only of what is called a drawing does RDKit look at the wedges
            lines[1] = f"{lines[1][:20]:<20}2D{lines[1][22:]}"
        _spell_radicals(lines)
        mol = Chem.MolFromMolBlock("\n".join(lines), sanitize=False, removeHs=False, strictParsing=False)
        if mol is None or mol.GetNumAtoms() == 0:
            raise BadInput(f"{given.what}: record {len(given.records) + 1} is not understood as SDF: its atoms or bonds are damaged")
        if mol.GetNumBonds() == 0 and mol.GetNumAtoms() > 1 and x is not None and np.ptp(x, axis=0).max() > 0.1:
            given.say("no bonds are in the file: they are found from the distances")
            numbers = [a.GetAtomicNum() for a in mol.GetAtoms()]
            mol = babel.with_bonds(numbers, mol.GetConformer().GetPositions(), given.what)
        _add(given, Record(mol, drawing, unpaired=_radicals(lines)))


def _with_header(lines, given):
    """The lines with three of a header, as the format has it; None where there is no line of counts."""
    at = next((n for n, line in enumerate(lines[:8]) if re.search(r"V[23]000\s*$", line)), None)
    if at is None:
        at = next((n for n, line in enumerate(lines[:8]) if re.match(r"[ \d]{2}\d[ \d]{2}\d( |$)", line)), None)
        if at is None:
            return None
        lines[at] = f"{lines[at][:6]}  0  0  0  0  0  0  0  0999 V2000"
    if at == 3:
        return lines
    given.say(f"the header has {at} line{'s' * (at != 1)} in place of 3: the atoms are taken from line {at + 2} on")
    header = [line for line in lines[:at] if line.strip()][-2:]
    return ["", *(header or [""])[-1:], "", *lines[at:]]


def _sdf_positions(lines):
    """Of the atoms that a V2000 or V3000 text lists, or None."""
    if lines[3].rstrip().endswith("V3000"):
        rows = [line.split()[4:7] for line in lines if re.match(r"M  V30 +\d+ +\S+ +\S+ +\S+ +\S+ +\d", line)]
    else:
        count = int(lines[3][:3])
        rows = [(line[:10], line[10:20], line[20:30]) for line in lines[4:4 + count]]
    try:
        return np.array(rows, float).reshape(-1, 3)
    except ValueError:
        return None


def _spell_radicals(lines):
    """The old column of charges has 4 for a radical, which RDKit passes over."""
    if lines[3].rstrip().endswith("V3000") or any(line.startswith(("M  CHG", "M  RAD")) for line in lines):
        return
    count = int(lines[3][:3])
    radicals = [n + 1 for n, line in enumerate(lines[4:4 + count]) if line[36:39].strip() == "4"]
    end = next((n for n, line in enumerate(lines) if line.startswith("M  END")), len(lines))
    lines[end:end] = [f"M  RAD  1{atom:4d}   2" for atom in radicals]


def _radicals(lines):
    """How many electrons are unpaired, or None where no radical is marked. 1 is a singlet, 2 a doublet, 3 a triplet."""
    kinds = [int(kind) for line in lines if line.startswith("M  RAD") for kind in line[9:].split()[1::2] if kind.isdigit()]
    kinds += [int(kind) for line in lines if line.startswith("M  V30 ") for kind in re.findall(r"\bRAD=(\d)\b", line)]
    return sum(max(kind - 1, 0) for kind in kinds) if kinds else None


# XYZ

def _xyz(text, given):
    _xyz_frames(text, given)
    _keep_lowest(given)


def frames(text, what):
    """The Records of all frames of an XYZ text. Errors: BadInput."""
    given = Input(what, "xyz")
    _xyz_frames(text, given)
    return given.records


def _xyz_frames(text, given):
    lines = text.rstrip().split("\n")
    at = 0
    while at < len(lines):
        if not lines[at].strip():
            at += 1
            continue
        at = _xyz_frame(lines, at, given)


def _xyz_frame(lines, at, given):
    """Adds the record that begins in line `at`, and returns the line after it."""
    what, title = given.what, ""
    if re.fullmatch(r"\s*\d+\s*", lines[at]):
        count, first = int(lines[at]), at + 2
        title = lines[at + 1] if at + 1 < len(lines) else ""
        if _atom(title, given) and (at + 1 + count == len(lines) or not _atom(_line(lines, at + 1 + count), given)):
            given.say("the line of the title is missing: the atoms are taken from the line after their number on")
            first, title = at + 1, ""
    else:
        title = "" if _atom(lines[at], given) else lines[at]
        first = at + bool(title)
        count = next((n for n in range(first, len(lines)) if not _atom(lines[n], given)), len(lines)) - first
        if count:
            given.say("the line with the number of atoms is missing: all lines of atoms are taken")
    if count == 0:
        raise BadInput(f"{what}: line {at + 1} has no atoms: not understood as XYZ")
    atoms = []
    for n in range(first, first + count):
        atoms.append(_atom(_line(lines, n), given))
        if atoms[-1] is None:
            raise BadInput(f"{what}: line {n + 1} is no atom, but line {at + 1} says that {count} follow")
    if first > at + 1 or title == "":
        after = _line(lines, first + count)
        if _atom(after, given):
            raise BadInput(f"{what}: line {at + 1} says that {count} atoms follow, but there are more")
    charge, unpaired = _charge_in(title, what)
    numbers, x = [a[0] for a in atoms], np.array([a[1:] for a in atoms])
    if 0 in numbers:
        raise BadInput(f"{what}: atom {numbers.index(0) + 1} is of no known element: correct its symbol")
    if not np.isfinite(x).all():
        raise BadInput(f"{what}: a coordinate is not a finite number")
    if _is_in_bohr(numbers, x):
        given.say("the atoms are 1.9 times too far apart: the coordinates are taken to be in bohr")
        x = x * BOHR
    _add(given, Record(babel.unbonded(numbers, x), False, charge, unpaired, energy_in(title)))
    return first + count


def _line(lines, at):
    return lines[at] if at < len(lines) else ""


def _atom(line, given):
    """(atomic number, x, y, z) of a line, or None."""
    words = line.split()
    if any(re.fullmatch(r"[+-]?\d+,\d+", w) for w in words[1:4]):
        given.say("decimal commas are read as points")
        words = [w.replace(",", ".") for w in words]
    elif "," in line:
        words = line.replace(",", " ").split()
    try:
        x = [float(re.sub("[dD]", "e", w)) for w in words[1:4]]
    except ValueError:
        return None
    if len(x) < 3:
        return None
    symbol = re.fullmatch(r"([A-Za-z]{1,2})\d*|(\d{1,3})", words[0])
    if symbol is None:
        return None
    number = int(symbol[2]) if symbol[2] else NUMBERS.get(symbol[1].upper(), 0)
    return (number if number < len(SYMBOLS) else 0, *x)


def _charge_in(title, what):
    """(charge, unpaired electrons) that a title gives, each None where it does not: charge=-1, charge: -1, charge -1,
    multiplicity 2, or -1 1 alone, as the inputs of most programs have it."""
    pair = re.fullmatch(r"\s*([+-]?\d)\s+([1-9])\s*", title)
    if pair:
        return int(pair[1]), int(pair[2]) - 1
    found = re.search(r"\b(?:total[_ ]?)?(?:charge|chrg)\s*[=: ]\s*([+-]?\d+)\b(?!\.\d*[1-9])", title, re.I)
    spin = re.search(r"\b(?:multiplicity|mult|spin_multiplicity)\s*[=: ]\s*(\d+)\b", title, re.I)
    if found and abs(int(found[1])) > MOST_CHARGE:
        raise BadInput(f"{what}: the title says charge {found[1]}, a charge is from -{MOST_CHARGE} to {MOST_CHARGE}: correct "
                       "the title")
    if spin and not 1 <= int(spin[1]) <= MOST_CHARGE + 1:
        raise BadInput(f"{what}: the title says multiplicity {spin[1]}, it is from 1 to {MOST_CHARGE + 1}: correct the title")
    return int(found[1]) if found else None, int(spin[1]) - 1 if spin else None


def energy_in(title):
    """The energy that a title gives, in whatever unit, or None: dE=, E=, energy:, SCF done, or a number alone."""
    number = r"([+-]?\d+\.?\d*(?:[eE][+-]?\d+)?)"
    found = re.search(rf"(?:\bdE\s*=|\bE\s*=|\benergy\s*[:=]?)\s*{number}", title, re.I) or \
        re.fullmatch(r"\s*([+-]?\d+\.\d+)\s*(?:!.*)?", title)
    return float(found[1]) if found else None


def _is_in_bohr(numbers, x):
    """Whether each atom is as far from its nearest neighbour as if bohr had been written for angstrom."""
    if len(numbers) < 2:
        return False
    radius = np.array([COVALENT.get(z, 1.5) for z in numbers])
    share = np.linalg.norm(x[:, None] - x[None], axis=2) / (radius[:, None] + radius[None])
    np.fill_diagonal(share, np.inf)
    nearest = share.min(axis=1)
    return nearest.min() > 1.5 and nearest.max() < 2.2


def are_alike(records):
    """Whether these are several, of the same atoms in the same order."""
    numbers = [[a.GetAtomicNum() for a in r.mol.GetAtoms()] for r in records]
    return len(numbers) > 1 and all(n == numbers[0] for n in numbers)


def _keep_lowest(given):
    """Of frames of the same atoms in the same order only the one of lowest energy stays: an ensemble, a path, or the log of an
    optimisation."""
    count = len(given.records)
    if not are_alike(given.records):
        return
    energies = [r.energy for r in given.records]
    if None in energies:
        given.records = given.records[:1]
        given.say(f"{count} frames of one molecule, without energies: the first is taken")
    else:
        best = int(np.argmin(energies))
        given.records = [given.records[best]]
        given.say(f"{count} frames of one molecule: frame {best + 1}, of lowest energy, is taken")


# Formats that Open Babel reads

def _mol2(text, given):
    left, out, section, kept = 0, [], "", {}
    for line in text.split("\n"):
        words = line.split()
        if line.startswith("@<TRIPOS>"):
            section = line[9:].strip().upper()
            if section == "MOLECULE":
                kept = {}
        elif section == "ATOM" and len(words) >= 6:
            element, *kind = words[5].split(".")
            if element.upper() in ("LP", "DU"):
                left += 1
                continue
            kept[words[0]] = words[0] = str(len(kept) + 1)
            words[5] = ".".join([element.capitalize(), *kind])
            line = " ".join(words)
        elif section == "BOND" and len(words) >= 4:
            if not (words[1] in kept and words[2] in kept):
                continue
            line = " ".join([words[0], kept[words[1]], kept[words[2]], *words[3:]])
        out.append(line)
    if left:
        given.say(f"{left} lone pairs or dummy atoms are left out")
        out = _recounted(out)
    for mol in babel.molecules("\n".join(out), "mol2", given.what):
        _add(given, Record(mol))


def _recounted(lines):
    """With the numbers of atoms and bonds that are left."""
    counts, section, at = {}, "", 0
    for n, line in enumerate(lines):
        if line.startswith("@<TRIPOS>"):
            section = line[9:].strip().upper()
            at = n if section == "MOLECULE" else at
        elif section in ("ATOM", "BOND") and line.strip():
            counts.setdefault(at, {"ATOM": 0, "BOND": 0})[section] += 1
    for n, count in counts.items():
        lines[n + 2] = f"{count['ATOM']} {count['BOND']} " + " ".join(lines[n + 2].split()[2:])
    return lines


def _pdb(text, given):
    lines = pdb.without_alternates(text.split("\n"), given.say)
    for mol in babel.molecules("\n".join(map(pdb.with_element, lines)), "pdb", given.what):
        _add(given, Record(mol))


def is_flat(x):
    return len(x) > 3 and np.ptp(x[:, 2]) < 0.01
