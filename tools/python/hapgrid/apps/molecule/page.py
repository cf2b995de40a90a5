"""The play along the hand's path, and the page that sums up."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from hapgrid.apps.common import page
from hapgrid.apps.common.arrays import Neighbours
from hapgrid.apps.common.work import Work
from markupsafe import Markup
from rdkit import Chem

from . import files, geometry, path_selection, rotors
from .definition import paths_of
from .elements import COLOURS, SYMBOLS
from .molecule import placed, signed
from .probe_lines import read_log
from .xtb import BOHR, HARTREE
from .xyz import Frame, frames

if TYPE_CHECKING:
    from .steps import Start
    from .torsions import Torsion

ALL_BONDS = 4 | 8  # of RDKit: bonds between all atoms, each once
METHODS = {"gfn2": "GFN2-xTB", "gfnff": "GFN-FF"}
SPINS = ("singlet", "doublet", "triplet", "quartet", "quintet")


def write(start: Start, turned: Sequence[Torsion], paths: Sequence[str]) -> list[str]:
    """Writes the page and returns the names of its files. start: steps.Start; turned: the torsions that
    the grid's paths turn; paths: files of the hand's paths, the best first."""
    folder, run = start.folder, start.folder.run
    run("play", f"{folder.name()}.grid", "--device", f"path:{paths[0]}", "--log", "played.log", "--frames", "played.frames",
        watch=lambda gone: folder.waiting("playing the path", gone, None))
    run("view", "played.frames", "--xyz", "played.xyz")
    folder.write("played.pdb", pdb(start.molecule.rd, frames(folder.path("played.xyz"))[0]))
    log = read_log(folder.read("played.log"))
    x, y = (log[a] - log[a][0] for a in "xy")
    far = int((x**2 + y**2).argmax())
    azimuth = np.arctan2(y[far], x[far])  # from here or from behind, the hand moves across the picture
    side = sum(np.mean(log[a]) * part for a, part in (("x", np.sin(azimuth)), ("y", -np.cos(azimuth))))
    azimuth = f"{np.degrees(azimuth) + (180 if side < 0 else 0):.0f}"  # the one to which the hand is nearer
    run("view", "played.frames", "--from", f"{azimuth},10", "--html", "played.html")
    words = _words(start, turned, folder.read(paths[0]).split("\n", 1)[0].lstrip("# "))
    return [*page.write(folder, "molecule/page.html", **words), "played.log", "played.frames", "played.xyz", "played.pdb", "played.html"]


def pdb(rd: Chem.Mol, first: Frame) -> str:
    """The text of a PDB file with the names and bonds of the atoms, where they are in a frame. rd: RDKit's molecule."""
    rd = Chem.Mol(placed(rd, first.x))
    for atom in rd.GetAtoms():
        name = rotors.pdb_name(atom.GetSymbol(), atom.GetIdx())
        if len(atom.GetSymbol()) == 1 and len(name) < 4:
            name = " " + name  # the element ends in the second column
        atom.SetMonomerInfo(Chem.AtomPDBResidueInfo(f"{name:4}", residueName="UNL", residueNumber=1, isHeteroAtom=True))
    return Chem.MolToPDBBlock(rd, flavor=ALL_BONDS)


def _words(start: Start, turned: Sequence[Torsion], hand: str) -> dict[str, Any]:
    """What the template names. hand: a sentence on what the hand does."""
    folder = start.folder
    name = folder.name()
    taken = paths_of(folder.path(f"{name}.toml"))
    one = frames(folder.path("conformation.xyz"))[0]
    words = one.words
    words.update({"method": f"the titles of {start.source}"} if words.get("method") == "given" else {})
    if any(folder.changed_by_hand(name, "structures") for name in ("conformation.xyz", *(f"{path}.xyz" for path in taken))):
        words["method"] = "the titles of the paths' files, which were changed by hand"
    method = re.sub("gfn2|gfnff", lambda found: METHODS[str(found[0])], words.get("method", "own energies"))
    box = json.loads(folder.run("stats", f"{name}.grid", "--format", "json").out)["box"]
    spins = start.molecule.unpaired
    facts = {"Formula": formula(start.molecule.formula), "Charge": signed(start.molecule.charge),
             "Spin": SPINS[spins] if spins < len(SPINS) else f"multiplicity {spins + 1}", "Isomer": start.told, "Made from": start.source,
             "Energies": f"{method}, of libxtb {library_version()}" if "GFN" in method else method,
             "Conformation": f"{words['E']} hartree" if "E" in words else "",
             "Grid": f"{' × '.join(map(str, box['counts']))} points, {box['spacing']:g} Å apart"}
    molecule = {"symbols": [SYMBOLS[z] for z in one.numbers], "colours": [COLOURS[z] for z in one.numbers],
                "places": np.round(one.x, 3).tolist(),
                "bonds": _pairs(start.molecule.neighbours), "orders": _orders(start.molecule.rd),
                "torsions": [[t.name, *t.atoms, t in turned] for t in start.turning]}
    molecule["paths"] = _profiles(start, taken)
    return {"title": start.source, "formula": formula(start.molecule.formula), "facts": facts, "hand": hand,
            "nothing_turns": None if taken else path_selection.nothing_turns(folder), "given": start.given is not None,
            "barriers": barriers(folder), "method": method, "is_of_xtb": words.get("method") in METHODS, "molecule": molecule}


def _profiles(start: Start, taken: Sequence[str]) -> list[dict[str, Any]]:
    """Of each path energies, shapes as the conformation lies, and bonds, frame by frame."""
    shapes = files.read_set(start.folder)
    usual, out = start.molecule.neighbours, []
    for one in (f for f in shapes.found if f.name in taken):
        places = [geometry.aligned(x, shapes.x, shapes.masses) * BOHR for x in one.nodes]
        near = [geometry.bonds_of(shapes.numbers, x) if start.molecule.bonds_change else usual for x in places]
        out.append({"name": one.name, "energies": [round(e * HARTREE, 3) for e in one.energies], "start": one.start,
                    "places": [np.round(x, 2).tolist() for x in places], "bonds": [_pairs(some) for some in near]})
    return out


def _orders(rd: Chem.Mol) -> dict[str, int]:
    """Of the bonds that are no single ones; those of aromatic rings as in one of their formulas."""
    rd = Chem.Mol(rd)
    Chem.Kekulize(rd, clearAromaticFlags=True)
    ends = [(sorted((b.GetBeginAtomIdx(), b.GetEndAtomIdx())), int(b.GetBondTypeAsDouble())) for b in rd.GetBonds()]
    return {f"{a}-{b}": order for (a, b), order in ends if order > 1}


def _pairs(neighbours: Neighbours) -> list[list[int]]:
    return [[a, b] for a, near in enumerate(neighbours) for b in near if a < b]


def barriers(folder: Work) -> list[dict[str, Any]]:
    """Each path with its barriers and what lies behind it, in kJ/mol as the files have them."""
    report = {row["name"]: row for row in files.rows(folder, "report.tsv", files.REPORT)}
    maxima = {one.name: _maxima([e * HARTREE for e in one.energies]) for one in files.read_set(folder).found}
    return [{"path": row["path"], "atoms": row["atoms"], "barriers": maxima.get(row["path"]) or [row["barrier_kJ_mol"]],
             "imaginary": report.get(row["path"], {}).get("nu1_cm-1", "-"),
             "behind": [other["energy_kJ_mol"] for name, other in report.items()
                        if name.startswith(row["path"] + ":") and other["kind"].startswith("minimum")],
             "why": "in the grid" if row["taken"] == "yes" else row["why"]}
            for row in files.rows(folder, "rotors.tsv", path_selection.ROTORS)]


def _maxima(energies: list[float]) -> list[str]:
    """The different maxima along a path, the lowest first; an end is one if it is above what is next to it."""
    high = [-math.inf, *energies, -math.inf]
    return sorted({f"{e:.1f}" for before, e, after in zip(high, energies, high[2:]) if e > before and e >= after}, key=float)


def formula(text: str) -> Markup:
    """RDKit's C4H10O with its numbers below the line, and without a charge, which stands behind it."""
    return Markup(re.sub(r"(\d+)", r"<sub>\1</sub>", re.sub(r"[+-]\d*$", "", text)))


def library_version() -> str:
    """Of the libxtb that computes here, by the file's name, since the library does not tell it."""
    with open("/proc/self/maps", encoding="utf-8") as file:
        found = re.search(r"/libxtb\.so\.([0-9.]+)", file.read())
    return found[1] if found else ""
