"""The files that are written: XYZ files and the report."""

import os

import numpy as np
from hapgrid_command.files import is_plain, read_text, remove, write_whole

from . import geometry
from .elements import SYMBOLS
from .molecule import BadInput
from .xtb import BOHR, HARTREE


def frame(numbers, x, comment):
    lines = [str(len(numbers)), comment]
    for z, row in zip(numbers, np.asarray(x) * BOHR):
        lines.append(f"{SYMBOLS[z]:<2}" + "".join(f" {v + 0.0:13.8f}" for v in row))
    return "\n".join(lines) + "\n"


def angles(torsions, x):
    """Torsions in whole degrees, -179 to 180, by name."""
    whole = {t.name: round(float(np.degrees(geometry.torsion(x, *t.atoms)))) for t in torsions}
    return {name: 180 if value == -180 else value for name, value in whole.items()}


def words(torsions, x):
    return " ".join(f"{name}={value}" for name, value in angles(torsions, x).items())


def imaginary(wave_number):
    return f"i{-wave_number:.0f}"


def conformation_text(result):
    comment = (f"dE=0.0000 E={result.energy:.9f} method={result.method} "
               + ("nimag=0 " if result.nu1 is not None else "") + words(result.torsions, result.x))
    return frame(result.numbers, result.x, comment.rstrip())


def path_text(result, found):
    """A path, work.Found or beyond.Beyond."""
    out = []
    last = len(found.nodes) - 1
    for k, (x, energy) in enumerate(zip(found.nodes, found.energies)):
        rise = 0.0 if k == found.start else (energy - result.energy) * HARTREE
        t = (k - found.start) / last
        comment = f"dE={rise:.4f} t={t:.{4 if found.goes_on else 1}f} E={energy:.9f} method={result.method}"
        out.append(frame(result.numbers, x, comment + _point(result, found, k)))
    return "".join(out)


def _point(result, found, k):
    """What the title of a stationary point has behind that of other nodes."""
    angles_there = words(result.torsions, found.nodes[k])
    if k == found.start:
        return (" nimag=0 " if found.goes_on or result.nu1 is not None else " ") + angles_there
    if found.goes_on:
        return f" nimag={int(found.kinds[k] == 'saddle')} {angles_there}" if k in found.kinds else ""
    if k < len(found.nodes) - 1:
        return ""
    saddle = f" nimag=1 nu1={imaginary(found.nu1)}" if found.nu1 is not None else ""
    return f"{saddle} torsion={found.torsion} {angles_there}"


def _beyond_rows(result, found):
    """The path, which is as high as its highest node, and its stationary points."""
    def row(name, kind, node, imaginary, joins):
        rise = (found.energies[node] - result.energy) * HARTREE
        return (name, kind, f"{rise:.2f}", imaginary, "-", joins, result.method,
                words(result.torsions, found.nodes[node]))
    ends = f"ends: {found.why}"
    rows = [row(found.name, "path", int(np.argmax(found.energies)), "-", ends)]
    for n, (node, kind) in enumerate(found.kinds.items(), 1):
        rows.append(row(f"{found.name}:{n}", f"{kind} on the path", node,
                        str(int(kind == "saddle")), "-"))
    return rows


def report_text(result, command):
    """The table of stationary points, tab-separated; lines that begin with # are remarks."""
    header = ("name", "kind", "energy_kJ_mol", "imaginary", "nu1_cm-1", "joins", "method",
              "torsions_deg")
    known = ("0", f"{result.nu1:.0f}") if result.nu1 is not None else ("-", "-")
    rows = [("conformation", "minimum", "0.00", *known, "-", result.method, words(result.torsions, result.x))]
    before = angles(result.torsions, result.x)
    for found in result.found:
        if found.goes_on:
            rows += _beyond_rows(result, found)
            continue
        after = angles(result.torsions, found.nodes[-1])
        change = " ".join(f"{n}={before[n]}>{after[n]}" for n in before)
        far = f"{found.name}:far"
        if found.far_is_equal:
            far = "conformation, equal atoms exchanged"
        rise = (found.energies[-1] - result.energy) * HARTREE
        saddle = ("1", imaginary(found.nu1)) if found.nu1 is not None else ("-", "-")
        rows.append((found.name, "saddle", f"{rise:.2f}", *saddle,
                     "conformation and " + far if found.far is not None else "-", result.method, change))
        if not found.far_is_equal and found.far is not None:
            rise = (found.far_energy - result.energy) * HARTREE
            rows.append((f"{found.name}:far", "minimum", f"{rise:.2f}", "0",
                         f"{found.far_nu1:.0f}", "-", result.method,
                         words(result.torsions, found.far)))
    lines = ["# " + command,
             "# energies above the conformation; torsions in degrees, of a saddle before>after",
             "\t".join(header)]
    lines += ["\t".join(row) for row in rows]
    lines += [f"# no path: {name}: {why}" for name, why in result.dropped]
    return "\n".join(lines) + "\n"


def listed(report):
    """The path files that a report names. Errors: BadInput, where a name is none of a file beside it."""
    try:
        rows = [line.split("\t") for line in read_text(report).splitlines() if not line.startswith("#")]
    except FileNotFoundError:
        return []
    names = [row[0] for row in rows if len(row) > 1 and row[1] in ("saddle", "path")]
    strange = next((name for name in names if not is_plain(name)), None)
    if strange is not None:
        raise BadInput(f"{report}: '{strange}' is no name of a path: remove the report, and all is computed anew")
    return [name + ".xyz" for name in names]


def write_set(directory, result, command):
    """Writes all files of a molecule and returns their names. The report is written last: where
    there is one, the set is whole."""
    report = os.path.join(directory, "report.tsv")
    texts = {"conformation.xyz": conformation_text(result)}
    for found in result.found:
        texts[found.name + ".xyz"] = path_text(result, found)
    old = listed(report)
    os.makedirs(directory, exist_ok=True)
    remove(report)
    for name in set(old) - set(texts):  # paths from another conformation would be wrong
        remove(os.path.join(directory, name))
    for name, text in texts.items():
        write_whole(os.path.join(directory, name), text)
    write_whole(report, report_text(result, command))
    return [*texts, "report.tsv"]
