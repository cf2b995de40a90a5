"""The texts of molecules' files, as records of one molecule or several pieces each.

RDKit reads MDL's formats (SDF, MOL) and SMILES, Open Babel PDB and MOL2, and xyz.py XYZ. What they misread is put right in the
text before: symbols in capitals, alternate locations, lone pairs, headers, units.
"""

import re
from dataclasses import dataclass, field

import numpy as np
from rdkit import Chem

from . import geometry, xyz
from .elements import NUMBERS
from .molecule import BadInput, is_flat, numbers_of, placed, places_of, unsanitized

KINDS = {"sdf": "sdf", "mol": "sdf", "xyz": "xyz", "mol2": "mol2", "pdb": "pdb", "ent": "pdb"}
MOST_RECORDS = 1000
MOST_ATOMS = 100
MOST_CHARGE = 9
AMINO_ACIDS = set("ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL ACE NME".split())
# Atoms that stand alone in structures of proteins and salts.
ION_CHARGES = {3: 1, 9: -1, 11: 1, 12: 2, 17: -1, 19: 1, 20: 2, 25: 2, 26: 2, 27: 2, 28: 2, 29: 2, 30: 2, 35: -1, 48: 2,
               53: -1}


@dataclass
class Record:
    """mol: RDKit's molecule, not sanitized, with a conformer unless it is of SMILES. drawing: whether its coordinates
    are said to be a drawing's. charge, unpaired: what the text says of all of it, or None; known: whether the text says the
    orders of its bonds."""
    mol: Chem.Mol
    drawing: bool = False
    charge: int = None
    unpaired: int = None
    known: bool = True


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

    def add(self, record):
        if len(self.records) == MOST_RECORDS:
            raise BadInput(f"{self.what}: more than {MOST_RECORDS} records: give the one to feel")
        self.records.append(record)


def decoded(content, what):
    """Text of UTF-8, UTF-16 with its mark, or else Latin-1, with single line feeds."""
    try:
        text = content.decode("utf-16" if content[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if "\0" in text:
        raise BadInput(f"{what}: not a text file")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read(text, what, kind):
    given = Input(what, kind)
    if kind == "sdf":
        _sdf(text, given)
    elif kind == "xyz":
        frames = xyz.frames_of(text, what, given.say)
        order, known = lowest_first(frames)
        if order:  # an ensemble, a path, or the log of an optimisation
            given.say(f"{len(order)} frames of one molecule" + (
                f": frame {order[0] + 1}, of lowest energy, is taken" if known else ", without energies: the first is taken"))
        for one in [frames[order[0]]] if order else frames:
            given.add(Record(placed(unsanitized(one.numbers, [0] * len(one.x), ()), one.x), False,
                             *_charge_in(one.title, what), known=False))
    else:
        if kind == "pdb":
            text = "\n".join(map(_with_element, _without_alternates(text.split("\n"), given.say)))
        for mol in _babel(text, given):
            given.add(Record(mol, known=kind == "mol2"))
    if not given.records:
        raise BadInput(f"{what}: not understood as {kind.upper()}")
    return given


def smiles(text):
    given = Input(f"SMILES '{text}'", "smi")
    # A second word would be read as a name.
    mol = Chem.MolFromSmiles(text, sanitize=False) if re.fullmatch(r"\S+", text) else None
    if mol is None or mol.GetNumAtoms() == 0:
        raise BadInput(f"{given.what}: not understood")
    given.records.append(Record(mol))
    return given


# MDL's formats

def _sdf(text, given):
    for block in re.split(r"^\$\$\$\$.*\n?", text, flags=re.M):
        if not block.strip():
            continue
        lines = _with_header(block.split("\n"), given)
        if lines is None:
            continue
        unpaired, known = _radicals(lines), True
        mol = _block(lines, given)
        x = places_of(mol)
        drawing = is_flat(x) and lines[1][20:22].upper() == "2D"
        if is_flat(x) and not drawing:  # only of what is called a drawing does RDKit look at the wedges
            lines[1] = f"{lines[1][:20]:<20}2D{lines[1][22:]}"
            mol = _block(lines, given)
        if mol.GetNumBonds() == 0 and mol.GetNumAtoms() > 1 and np.ptp(x, axis=0).max() > 0.1:
            given.say("no bonds are in the file: they are found from the distances")
            mol, known = with_bonds(numbers_of(mol), x), False
        given.add(Record(mol, drawing, unpaired=unpaired, known=known))


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


def _block(lines, given):
    mol = Chem.MolFromMolBlock("\n".join(lines), sanitize=False, removeHs=False, strictParsing=False)
    if mol is None or mol.GetNumAtoms() == 0:
        raise BadInput(f"{given.what}: record {len(given.records) + 1} is not understood as SDF: its atoms or bonds are damaged")
    return mol


def _radicals(lines):
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


def lowest_first(frames):
    """(the numbers of several xyz.Frames of one molecule, that of the lowest energy first; whether all have an energy). No
    numbers where they are of several molecules."""
    energies = [energy_in(one.title) for one in frames]
    if len(frames) < 2 or any(one.numbers != frames[0].numbers for one in frames):
        return [], False
    known = None not in energies
    return sorted(range(len(frames)), key=lambda k: energies[k] if known else k), known


# PDB. Source: the format's description 3.3. Columns are counted from 0 here. 12-15 have the atom's name, with its element
# right-aligned in 12-13 but for hydrogens whose name has four letters; 16 the alternate location, 17-19 the residue, 21-26
# its place, 54-59 the occupancy, 76-77 the element, 78-79 the charge.

PDB_ATOM = ("ATOM  ", "HETATM")


def _without_alternates(lines, say):
    """In each residue the alternate location of highest occupancy stays, of equal ones the first."""
    named = {line for line in lines if line.startswith(PDB_ATOM) and line[16:17].strip()}
    found = {}
    for line in filter(named.__contains__, lines):
        occupancy = float(line[54:60]) if re.fullmatch(r"\s*\d*\.?\d+\s*", line[54:60]) else 1.0
        found.setdefault(line[21:27], {}).setdefault(line[16], []).append(occupancy)
    means = {residue: {name: sum(v) / len(v) for name, v in locations.items()} for residue, locations in found.items()}
    kept = {residue: min(mean, key=lambda name: (-mean[name], name)) for residue, mean in means.items()}
    several = [residue for residue in means if len(means[residue]) > 1]
    if several:
        name, more = kept[several[0]], f" and {len(several) - 1} more" if len(several) > 1 else ""
        say(f"alternate locations of residue {' '.join(several[0].split())}{more}: {name} is kept, of highest occupancy, "
            f"{means[several[0]][name]:.2f}")
    return [line[:16] + " " + line[17:] if line in named else line for line in lines
            if line not in named or line[16] == kept[line[21:27]]]


def _with_element(line):
    """With its element in the columns for it, wherever the line has it."""
    if not line.startswith(PDB_ATOM):
        return line
    line = f"{line:<80}"
    name, element = line[12:16].upper(), line[76:78].strip().upper()
    two, letters = name[:2].strip(), re.sub(r"[^A-Z]", "", name)
    is_one = line[17:20].strip().upper() in AMINO_ACIDS or two[:1] == "H" and len(name.strip()) == 4
    if element not in NUMBERS:
        element = two if two in NUMBERS and (len(two) == 1 or not is_one) else letters[:1] if letters[:1] in NUMBERS else "X"
    charge = line[78:80] if re.fullmatch(r"\d[+-]|[+-]\d|  ", line[78:80]) else "  "
    return f"{line[:76]}{element:>2}{charge}"


# Open Babel's molecules as RDKit's

def with_bonds(numbers, x):
    """RDKit's molecule of atoms with single bonds between those that are near each other."""
    near = geometry.bonds_of(numbers, x)
    return placed(unsanitized(numbers, [0] * len(x), [(j, k, 1) for j, some in enumerate(near) for k in some if j < k]), x)


def check_count(count, what, most=MOST_ATOMS):
    if count > most:
        raise BadInput(f"{what}: {count} atoms, at most {MOST_ATOMS} are feasible: cut out the part that "
                       "matters, and close it with hydrogen")
    if count < 2:
        raise BadInput(f"{what}: a single atom has no shape to feel")


def _babel(text, given):
    """RDKit's molecules of the records that Open Babel reads. It would look for the bonds of a large molecule for minutes."""
    try:
        from openbabel import openbabel
    except ImportError:
        raise BadInput("Open Babel not found: install the Debian package python3-openbabel") from None
    openbabel.obErrorLog.SetOutputLevel(-1)
    conversion, ob = openbabel.OBConversion(), openbabel.OBMol()
    conversion.SetInFormat(given.kind)
    conversion.AddOption("b", conversion.INOPTIONS)  # bonds are found below
    more = conversion.ReadString(ob, text)
    while more and ob.NumAtoms():
        atoms = list(openbabel.OBMolAtomIter(ob))
        if given.kind == "pdb":
            check_count(len(atoms), given.what, 40 * MOST_ATOMS)
            near = with_bonds([a.GetAtomicNum() for a in atoms], np.array([(a.GetX(), a.GetY(), a.GetZ()) for a in atoms]))
            check_count(max(2, *map(len, Chem.GetMolFrags(near))), given.what)
            ob.ConnectTheDots()
            ob.PerceiveBondOrders()
        dummies = [atom for atom in atoms if given.kind == "mol2" and atom.GetType().upper() in ("LP", "DU")]
        if dummies:
            given.say(f"{len(dummies)} lone pairs or dummy atoms are left out")
        for dummy in dummies:
            ob.DeleteAtom(dummy)
        for atom in openbabel.OBMolAtomIter(ob):
            openbabel.OBAtomAssignTypicalImplicitHydrogens(atom)
        yield _from_babel(openbabel, ob)
        ob = openbabel.OBMol()
        more = conversion.Read(ob)


def _from_babel(openbabel, ob):
    atoms = list(openbabel.OBMolAtomIter(ob))
    bonds = [(b.GetBeginAtomIdx() - 1, b.GetEndAtomIdx() - 1, b.GetBondOrder()) for b in openbabel.OBMolBondIter(ob)]
    mol = unsanitized([a.GetAtomicNum() for a in atoms], [a.GetFormalCharge() for a in atoms],
                      [(j, k, order if 1 <= order <= 3 else 1) for j, k, order in bonds])
    for from_, atom in zip(atoms, mol.GetAtoms()):
        if from_.GetExplicitDegree() > 0 or from_.GetAtomicNum() not in ION_CHARGES:
            atom.SetNumExplicitHs(from_.GetImplicitHCount())
        elif atom.GetFormalCharge() == 0:
            atom.SetFormalCharge(ION_CHARGES[atom.GetAtomicNum()])
    return placed(mol, [(a.GetX(), a.GetY(), a.GetZ()) for a in atoms])
