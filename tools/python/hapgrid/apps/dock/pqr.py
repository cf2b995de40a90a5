"""A protein or nucleic acid as PDB2PQR writes it, .pqr, with AutoDock's types of atoms. Open Babel gives the
charged groups of proteins no charge, so that it cannot make their PDBQT."""

from __future__ import annotations

import re

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed
from hapgrid.apps.table.readers import is_number

BOND = 1.45  # angstrom: a hydrogen is no farther from its atom, which may be sulphur
RINGS = {"PHE": "CG CD1 CD2 CE1 CE2 CZ", "TYR": "CG CD1 CD2 CE1 CE2 CZ", "HIS": "CG CD2 CE1",
         "TRP": "CG CD1 CD2 CE2 CE3 CZ2 CZ3 CH2"}
BASES = ("A", "C", "G", "U", "T", "DA", "DC", "DG", "DT")
METALS = ("MG", "ZN", "MN", "FE")


def pdbqt(text: str, given: str) -> str:
    """The text of a PDBQT file. Hydrogens of carbon become a part of their atom, as AutoDock has them."""
    atoms = [_atom(line, given) for line in text.splitlines() if line.startswith(("ATOM", "HETATM"))]
    heavy = [n for n, (element, *_) in enumerate(atoms) if element != "H"]
    if not heavy:
        raise Failed(f"{given}: it has no atoms")
    places = np.array([atoms[n][3] for n in heavy])
    charges = [atom[4] for atom in atoms]
    bound = {}  # to which atom a hydrogen is
    for n, (element, _, _, place, _) in enumerate(atoms):
        if element != "H":
            continue
        away = np.linalg.norm(places - place, axis=1)
        if away.min() > BOND:
            raise Failed(f"{given}: a hydrogen has no neighbour within {BOND} angstrom")
        bound[n] = heavy[away.argmin()]
        if atoms[bound[n]][0] == "C":
            charges[bound[n]] += charges[n]
    with_hydrogen = set(bound.values())
    lines: list[str] = []
    for n, (element, name, residue, place, _) in enumerate(atoms):
        if element == "H" and atoms[bound[n]][0] == "C":
            continue
        kind = _kind(element, name, residue, n in with_hydrogen)
        lines.append(f"ATOM  {len(lines) + 1:5}  {name[:3]:<3} {residue[:3]:<3} A   1    "
                     + "".join(f"{c:8.3f}" for c in place) + f"  0.00  0.00    {charges[n]:+6.3f} {kind}\n")
    return "".join(lines)


def _words(line: str) -> list[str]:
    """The words of an atom's line. In PDB's columns they may touch; else there are blanks between them."""
    if re.fullmatch(r"(?:[ 0-9-]{4}\.[0-9]{3}){3}", line[30:54]):
        rest = re.findall(r"[-+]?[0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?", line[54:])
        return [line[:6], line[6:11], line[12:16].strip(), line[17:21].strip(), *(line[c:c + 8] for c in (30, 38, 46)), *rest[:2]]
    words = line.split()
    if len(words) >= 5 and all(is_number(word) for word in words[-5:]):
        return words
    return re.sub(r"(?<=[0-9])-(?=[0-9]*\.)", " -", line).split()


def _atom(line: str, given: str) -> tuple[str, str, str, Array, float]:
    """(element, name, residue, place, charge)"""
    words = _words(line)
    try:
        x, y, z, charge, _ = map(float, words[-5:])
        name, residue = words[2].lstrip("0123456789"), words[3]
        element = name if name in METALS or name == residue else name[0]
    except (ValueError, IndexError):
        raise Failed(f"{given}: no PQR: an atom has no place or charge") from None
    if not np.isfinite([x, y, z, charge]).all() or max(abs(x), abs(y), abs(z)) >= 1e4:
        raise Failed(f"{given}: the place of an atom is not from -1e4 to 1e4")
    return element, name, residue, np.array((x, y, z)), charge


def _kind(element: str, name: str, residue: str, has_hydrogen: bool) -> str:
    """AutoDock's type. Terminal residues may have N or C before their name, and histidine is called by its hydrogens."""
    residue = residue[1:] if len(residue) == 4 and residue[0] in "NC" else residue
    residue = "HIS" if residue in ("HID", "HIE", "HIP", "HSD", "HSE", "HSP") else residue
    if element == "C" and (name in RINGS.get(residue, "").split() or residue in BASES and "'" not in name):
        return "A"
    if element == "N" and not has_hydrogen and (
            residue == "HIS" and name in ("ND1", "NE2") or residue in BASES and name in ("N1", "N3", "N7")):
        return "NA"
    return {"H": "HD", "O": "OA", "S": "SA"}.get(element, element.capitalize())
