"""Lines of a PDB file: which alternate location of a residue is kept, and the element of each atom.

Source: the format's description 3.3. Columns are counted from 0 here. 12-15 have the atom's name, with its element
right-aligned in 12-13 but for hydrogens whose name has four letters; 16 the alternate location, 17-19 the residue,
21-26 its place, 54-59 the occupancy, 76-77 the element, 78-79 the charge.
"""

import re

from .elements import NUMBERS

AMINO_ACIDS = set("ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL ACE NME".split())


def is_atom(line):
    return line.startswith(("ATOM  ", "HETATM"))


def without_alternates(lines, say):
    """In each residue the alternate location of highest occupancy stays, of equal ones the first."""
    occupancy = {}
    for line in lines:
        if is_atom(line) and line[16:17].strip():
            occupancy.setdefault(line[21:27], {}).setdefault(line[16], []).append(_number(line[54:60]))
    kept = {}
    for residue, locations in occupancy.items():
        mean = {name: sum(v) / len(v) for name, v in locations.items()}
        kept[residue] = min(mean, key=lambda name: (-mean[name], name))
    several = [r for r, locations in occupancy.items() if len(locations) > 1]
    if several:
        name, first = kept[several[0]], " ".join(several[0].split())
        mean = occupancy[several[0]][name]
        of_all = f" of residue {first}" if len(several) == 1 else f" of residue {first} and {len(several) - 1} more"
        say(f"alternate locations{of_all}: {name} is kept, of highest occupancy, {sum(mean) / len(mean):.2f}")
    out = []
    for line in lines:
        if is_atom(line) and line[16:17].strip():
            if line[16] != kept[line[21:27]]:
                continue
            line = line[:16] + " " + line[17:]
        out.append(line)
    return out


def _number(text):
    try:
        return float(text)
    except ValueError:
        return 1.0


def with_element(line):
    """With its element in the columns for it, wherever the line has it."""
    if not is_atom(line):
        return line
    line = f"{line:<80}"
    written = line[76:78].strip().upper()
    element = written if written in NUMBERS else _by_name(line)
    charge = line[78:80] if re.fullmatch(r"\d[+-]|[+-]\d|  ", line[78:80]) else "  "
    return f"{line[:76]}{element:>2}{charge}"


def _by_name(line):
    name = line[12:16].upper()
    two, letters = name[:2].strip(), re.sub(r"[^A-Z]", "", name)
    in_chain = line[17:20].strip().upper() in AMINO_ACIDS
    if len(two) == 2 and two in NUMBERS and not in_chain and not (two[0] == "H" and len(name.strip()) == 4):
        return two
    if len(two) == 1 and two in NUMBERS:
        return two
    return letters[:1] if letters[:1] in NUMBERS else "X"
