"""The files of structures: XYZ files and the report, written and read."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import is_plain, remove
from hapgrid.apps.common.work import Work

from . import geometry, xyz
from .elements import MASSES, SYMBOLS
from .molecule import BadInput
from .results import Path, Result
from .torsions import Torsion
from .xtb import BOHR, HARTREE

REPORT = ("name", "kind", "energy_kJ_mol", "nu1_cm-1", "torsions_deg")  # heads of report.tsv
# A node that is nearer to the conformation (bohr) is the conformation, and has its energy but for what rounding leaves. No path
# goes higher than MOST. Both in kJ/mol.
SAME_NODE, ITS_OWN, MOST = 1e-3, 0.5, 1e4
NO_PATH = "# no path: "


def frame(numbers: Sequence[int], x: Array, comment: str) -> str:
    lines = [str(len(numbers)), comment.rstrip()]
    for z, row in zip(numbers, np.asarray(x) * BOHR):
        lines.append(f"{SYMBOLS[z]:<2}" + "".join(f" {v + 0.0:13.8f}" for v in row))
    return "\n".join(lines) + "\n"


def words(torsions: Sequence[Torsion], x: Array) -> str:
    """Torsions in whole degrees, -179 to 180."""
    return " ".join(f"{t.name}={180 - (180 - round(float(np.degrees(geometry.torsion(x, *t.atoms))))) % 360}" for t in torsions)


def _path_text(result: Result, found: Path) -> str:
    out, last = [], len(found.nodes) - 1
    stationary = {found.start: "minimum", **(found.kinds or {last: "saddle"})}
    for k, (x, energy) in enumerate(zip(found.nodes, found.energies)):
        rise, t = (energy - result.energy) * HARTREE, (k - found.start) / last
        title = f"dE={rise:.4f} t={t:.{4 if found.goes_on else 1}f} E={energy:.9f} method={result.method}"
        nu1 = result.nu1 if k == found.start else found.nu1
        if k in stationary:
            title += f" nimag={int(stationary[k] == 'saddle')}" if found.goes_on or nu1 is not None else ""
            title += f" nu1=i{-nu1:.0f}" if nu1 is not None and stationary[k] == "saddle" else ""
            title += " " + words(result.torsions, x)
        out.append(frame(result.numbers, x, title))
    return "".join(out)


def report_text(result: Result, command: str) -> str:
    """The table of stationary points, tab-separated; lines that begin with # are remarks."""
    table = [REPORT]

    def add(name: str, kind: str, energy: float, nu1: float | None, x: Array) -> None:
        wave_number = "-" if nu1 is None else f"{nu1:.0f}".replace("-", "i")
        table.append((name, kind, f"{round((energy - result.energy) * HARTREE, 2) + 0:.2f}", wave_number, words(result.torsions, x)))
    add("conformation", "minimum", result.energy, result.nu1, result.x)
    for found in result.found:
        top = int(np.argmax(found.energies)) if found.goes_on else -1
        add(found.name, "path" if found.goes_on else "saddle", found.energies[top], found.nu1, found.nodes[top])
        for n, (kind, energy, x) in enumerate(found.points(), 1):
            add(f"{found.name}:{n}", f"{kind} on the path", energy, None, x)
        if found.far is not None:
            add(f"{found.name}:far", "minimum", found.far.energy, found.far.nu1, found.far.x)
    return "\n".join(["# " + command, "# energies above the conformation; torsions in degrees",
                      *("\t".join(row) for row in table), *(f"{NO_PATH}{name}: {why}" for name, why in result.dropped)]) + "\n"


def rows(folder: Work, name: str, heads: Sequence[str]) -> list[dict[str, str]]:
    """A table of the folder, [{head: cell}], without remarks. Errors: BadInput, where it lacks heads or cells."""
    lines = [line.split("\t") for line in folder.read(name).splitlines() if not line.startswith("#")]
    if not lines or not set(heads) <= set(lines[0]) or any(len(line) != len(lines[0]) for line in lines):
        raise BadInput(f"{folder.path(name)}: is no table as it was written: remove it")
    return [dict(zip(lines[0], line)) for line in lines[1:]]


def write_set(folder: Work, result: Result, command: str) -> list[str]:
    """Writes all files of a molecule and returns their names."""
    known = "nimag=0 " if result.nu1 is not None else ""
    title = f"dE=0.0000 E={result.energy:.9f} method={result.method} {known}{words(result.torsions, result.x)}"
    texts = {"conformation.xyz": frame(result.numbers, result.x, title)}
    texts.update((found.name + ".xyz", _path_text(result, found)) for found in result.found)
    texts["report.tsv"] = report_text(result, command)
    for name in set(folder.made("structures")) - set(texts):  # paths from another conformation would be wrong
        remove(folder.path(name))
    for name, text in texts.items():
        folder.write(name, text)
    return list(texts)


def read_set(folder: Work) -> Result:
    """The Result that the files of the folder have, changed by hand or not. Energies are above the conformation. Errors:
    BadInput, also where the report names a file that is not beside it."""
    first = folder.path("conformation.xyz")
    conformation = xyz.frames(first)[0]
    strange = set(conformation.numbers) - set(MASSES)
    if strange:
        raise BadInput(f"{first}: {SYMBOLS[min(strange)]} is no element that can be felt")
    names = [row["name"] for row in rows(folder, "report.tsv", REPORT) if row["kind"] in ("saddle", "path")]
    for name in names:
        if not is_plain(name):
            raise BadInput(f"{folder.path('report.tsv')}: '{name}' is no name of a path: remove the report, and all is computed "
                           "anew")
    found = [_path(name, folder.path(name + ".xyz"), conformation) for name in names]
    dropped = re.findall(f"^{NO_PATH}(.*?): (.*)$", folder.read("report.tsv"), re.M)
    return Result(conformation.numbers, np.array([MASSES[z] for z in conformation.numbers]), "", [], conformation.x / BOHR, 0.0,
                  None, found, dropped)


def _path(name: str, path: str, conformation: xyz.Frame) -> Path:
    read, at = xyz.frames(path), conformation.x / BOHR
    if any(one.numbers != conformation.numbers for one in read):
        raise BadInput(f"{path}: has other atoms than the conformation")
    nodes = [one.x / BOHR for one in read]
    energies = [xyz.above(one.words, conformation.words, f"{path} frame {n}") / HARTREE for n, one in enumerate(read, 1)]
    if len(read) == 1:  # only the transition state
        nodes, energies = [at, *nodes], [0.0, *energies]
    even = np.ones(len(at))
    away = [geometry.rms(geometry.aligned(x, at, even), at) for x in nodes]
    start = int(np.argmin(away))
    rise = energies[start] * HARTREE
    if away[start] < SAME_NODE and abs(rise) > ITS_OWN or max(energies) * HARTREE > MOST:
        raise BadInput(f"{path}: its energies and that of conformation.xyz are not of one method: the conformation itself has "
                       f"{rise:.6g} kJ/mol in it")
    return Path(nodes, energies, start, name=name)
