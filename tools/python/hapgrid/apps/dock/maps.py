"""What Open Babel and AutoGrid, both of Debian, make of a host and a ligand."""

from __future__ import annotations

import math
import os
import tempfile
from typing import TypeAlias

import numpy as np
from hapgrid.apps.common import sandbox
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed, read_bytes, read_text
from hapgrid.apps.common.work import Work
from hapgrid.apps.table import readers, steps
from hapgrid.apps.table.readers import Table
from hapgrid.files import write_whole

from . import pqr, prepare

Atoms: TypeAlias = list[tuple[str, Array, float]]  # type, place and charge
MOST_HOST, MOST_LIGAND = 20_000, 200  # atoms
MOST_BY_ATOMS = 500  # of a host without maps (ligand.hpp)
MOST_REMARKS = 2000  # lines
MOST_BYTES = 64 << 20
FAR = 1e6  # angstrom or elementary charges: no atom has as much, though eight columns can say 1e308
MOST_AUTOGRID = 7200  # seconds of CPU time: twenty thousand atoms and the largest maps need minutes
MOST_CELLS = 126  # of a map along an axis: AutoGrid has no more
SPACING, WIDEST = 0.25, 0.5  # of the maps' points, angstrom: the usual one, and that of the largest boxes


def pdbqt(work: Work, given: str, name: str, most: int) -> Atoms:
    """Writes NAME.pdbqt from a file that Open Babel reads, and says what its user must know of it."""
    stem, kind = os.path.splitext(given.lower())
    data = read_bytes(given, MOST_BYTES)
    if kind == ".gz":
        kind, data = os.path.splitext(stem)[1], readers.inflated(data, 31, MOST_BYTES)
    if kind == ".map":
        raise Failed(f"{given}: one map is no {name}: give the .maps.fld of AutoGrid's maps, or the file of its atoms. Vina's own "
                     "maps have neither charges nor desolvation")
    text = data.decode("utf-8", "replace").replace("\r\n", "\n").replace("\r", "\n")
    if kind in (".pdb", ".ent", ".pqr") or kind == ".pdbqt" and name == "host":
        text = prepare.without_others(text, given, work.say, has_alternates=kind != ".pqr")
        data = text.encode()
    formal = _formal_charge(text) if kind in (".pdb", ".ent") else 0
    if kind != ".pdbqt":
        lines = text.splitlines()
        counted = sum(line.startswith(("ATOM", "HETATM")) for line in lines) or len(lines) - MOST_REMARKS
        if counted > 4 * most:  # what follows would need minutes to say so; hydrogens of carbon go into their atoms
            raise Failed(f"{given}: it has more than {most:,} atoms")
        text = pqr.pdbqt(text, given) if kind == ".pqr" else _converted(given, data, kind, name)
    work.write(f"{name}.pdbqt", text)
    _keep_first(work, given, f"{name}.pdbqt")
    found = atoms(work.read(f"{name}.pdbqt"), given)
    if not found:
        raise Failed(f"{given}: no atoms are found in it: Open Babel may not know the kind of file, or Gasteiger's "
                     "method has no charge for an element: give a .mol2 or .pdbqt with charges")
    if len(found) > most:
        raise Failed(f"{given}: {len(found):,} atoms, at most {most:,} are possible")
    if name == "ligand" and len(found) < 2:
        raise Failed(f"{given}: one atom cannot turn: `hapgrid table` makes a grid of a map")
    prepare.require_known(found, given)
    if len(found) > 1 and not np.ptp([place for _, place, _ in found], axis=0).any():
        raise Failed(f"{given}: all atoms lie at one place: it has no coordinates, `obabel --gen3d` makes some")
    if len(found) > 1 and all(charge == 0 for _, _, charge in found):
        raise Failed(f"{given}: no atom has a charge")
    total = sum(charge for _, _, charge in found)
    if formal and abs(total - formal) > 0.3:
        said = (f"{given}: its atoms say that it has a charge of {formal:+d}, and Open Babel gives them {total:+.2f}: give a file "
                "with charges, .mol2, .pqr or .pdbqt")
        if name == "ligand":
            raise Failed(said)
        work.say("  " + said)
    if name == "ligand" and kind not in (".pdbqt", ".pqr"):
        _remark_on_missing(work, given, data, kind)
    prepare.remark_on_hydrogens(found, given, work.say)
    return found


def _formal_charge(text: str) -> int:
    """Of the atoms of a PDB file that say one: "1+" or "2-" behind the element."""
    signs = [line[78:80] for line in text.splitlines() if line.startswith(("ATOM", "HETATM"))]
    return sum(int(one[0]) * (1 if one[1] == "+" else -1) for one in signs if len(one) == 2 and one[0].isdecimal() and one[1] in "+-")


def _remark_on_missing(work: Work, given: str, data: bytes, kind: str) -> None:
    """Says of a file without hydrogens that it lacks some."""
    def hydrogens(*options: str) -> int:
        ran = sandbox.program(["obabel", f"-i{kind[1:]}", "-oxyz", "-l1", *options], given, "openbabel", data)
        return sum(line.split()[:1] == ["H"] for line in ran.out.splitlines())
    if hydrogens() == 0 and (lacking := hydrogens("-h")):
        work.say(f"  {given}: it has no hydrogens, and lacks {lacking}: `obabel -h` adds them")


def _converted(given: str, data: bytes, kind: str, name: str) -> str:
    """What Open Babel makes of a file's content."""
    charges = [] if kind == ".mol2" else ["--partialcharge", "gasteiger"]
    rigid = ["-xr"] if name == "host" else []
    ran = sandbox.program(["obabel", f"-i{kind[1:]}", "-opdbqt", *rigid, *charges], given, "openbabel", data)
    if ran.code != 0:
        raise Failed(f"{given}: {ran.fault('obabel')}")
    return ran.out


def _keep_first(work: Work, given: str, name: str) -> None:
    """Of several molecules, or several poses of one, the first is taken."""
    first, end, rest = work.read(name).partition("ENDMDL")
    if end:
        work.write(name, "".join(line for line in first.splitlines(keepends=True) if not line.startswith("MODEL")))
    if "ATOM" in rest:
        work.say(f"  {given} has several molecules or poses: the first is taken")


def atoms(text: str, given: str) -> Atoms:
    """[(type, place, charge)] of a PDBQT text."""
    found = []
    try:
        for line in text.splitlines():
            if line.startswith(("ATOM", "HETATM")):
                place = np.array([float(line[c:c + 8]) for c in (30, 38, 46)])
                found.append((line[77:79].strip(), place, float(line[70:76])))
    except ValueError:
        raise Failed(f"{given}: an atom of the PDBQT has no place or charge") from None
    if any(not kind or not kind.isalnum() or not (np.abs([*place, charge]) < FAR).all() for kind, place, charge in found):
        raise Failed(f"{given}: an atom of the PDBQT has no type, place or charge")
    return found


def kinds_of(ligand: Atoms) -> list[str]:
    return sorted({kind for kind, _, _ in ligand})


def reach(ligand: Atoms, text: str, bends: bool) -> float:
    """How far an atom can be from the ligand's centre, at most, in angstrom. text: of the ligand's PDBQT; bends: whether
    its bonds turn."""
    places = np.array([place for _, place, _ in ligand])
    if not bends:
        return np.linalg.norm(places - places.mean(axis=0), axis=1).max()
    # A piece in which nothing turns begins with the bond that carries it. Between pieces an atom is no farther than along
    # the bonds that carry them, whatever their angles.
    pieces: list[list[int]] = [[]]
    opened = [0]
    numbers: dict[str, int] = {}
    for line in text.splitlines():
        if line.startswith("BRANCH"):
            pieces.append([numbers.get("".join(line.split()[1:2]), 0)])
            opened.append(len(pieces) - 1)
        elif line.startswith("ENDBRANCH") and len(opened) > 1:
            opened.pop()
        elif line.startswith(("ATOM", "HETATM")):
            if len(pieces[opened[-1]]) == 1 and len(opened) > 1:  # the bond's other end belongs to both
                pieces[opened[-2]].append(len(numbers))
            numbers[line[6:11].strip()] = len(numbers)
            pieces[opened[-1]].append(len(numbers) - 1)
    away = np.full((len(places), len(places)), np.inf)
    for piece in pieces:
        part = places[piece]
        away[np.ix_(piece, piece)] = np.linalg.norm(part[:, None] - part, axis=2)
    for via in range(len(places)):  # Floyd and Warshall
        away = np.minimum(away, away[:, via, None] + away[via])
    return away.mean(axis=1).max()


def compute(work: Work, host: Atoms, ligand: Atoms, low: Array, high: Array) -> list[str]:
    """Runs autogrid4 for a box from `low` to `high` and a cell around it. Returns the files that it made."""
    needed = (high - low).max() / (MOST_CELLS - 2)
    if needed > WIDEST:
        raise Failed(f"box and ligand need maps {needed:.2f} angstrom apart, since AutoGrid has at most {MOST_CELLS} cells; "
                     f"at most {WIDEST:g} are possible: make --size smaller")
    spacing = max(SPACING, math.ceil(100 * needed) / 100)
    cells = np.ceil((high - low) / spacing / 2 + 1).astype(int) * 2
    kinds = kinds_of(ligand)
    work.write("host.gpf", "\n".join([
        f"npts {cells[0]} {cells[1]} {cells[2]}", "gridfld host.maps.fld", f"spacing {spacing:g}",
        "receptor_types " + " ".join(sorted({kind for kind, _, _ in host})), "ligand_types " + " ".join(kinds),
        "receptor host.pdbqt", "gridcenter " + " ".join(f"{c:.3f}" for c in (low + high) / 2), "smooth 0.5",
        *(f"map host.{kind}.map" for kind in kinds), "elecmap host.e.map", "dsolvmap host.d.map",
        "dielectric -0.1465"]) + "\n")
    made = ["host.glg", "host.maps.fld", "host.maps.xyz", *(f"host.{name}.map" for name in [*kinds, "e", "d"])]
    with tempfile.TemporaryDirectory(prefix=".room", dir=work.directory) as room:
        # Of the host AutoGrid gets what it needs, in lines that are not too long.
        atoms = "".join(line[:79] + "\n" for line in work.read("host.pdbqt").splitlines() if line.startswith(("ATOM", "HETATM")))
        write_whole(os.path.join(room, "host.pdbqt"), atoms)
        write_whole(os.path.join(room, "host.gpf"), work.read("host.gpf"))
        ran = sandbox.program(["autogrid4", "-p", "host.gpf", "-l", "host.glg"], "host.pdbqt",
                              "autogrid, or give --atoms, for a small host", folder=room, cpu_seconds=MOST_AUTOGRID)
        texts = {name: read_text(os.path.join(room, name)) for name in made if os.path.lexists(os.path.join(room, name))}
    wrong = [line.strip() for line in texts.get("host.glg", "").splitlines() if "ERROR" in line]
    if ran.code != 0 or len(texts) < len(made):
        raise Failed("autogrid4: " + (wrong[0].removeprefix("autogrid4: ") if wrong else ran.fault("autogrid4")))
    for name, text in texts.items():
        work.write(name, text)
    return ["host.gpf", *made]


def write(work: Work, names: list[str], tables: list[Table], host: Atoms, low: Array, high: Array) -> list[str]:
    """Writes the tables for the plug-in. The first one carries the host's atoms near the box, for pictures."""
    tables[0].atoms = [(kind, place) for kind, place, _ in host if (place > low - 4).all() and (place < high + 4).all()]
    files = [f"host.{name}.table" for name in names]
    for file, table in zip(files, tables):
        work.write(file, steps.table_text(table))
    return files
