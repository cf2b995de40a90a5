"""Plots, pictures, and the page that sums up. Names and texts in it may come from anybody; none of them is trusted."""

import html
import json
import re
import shlex

import numpy as np
from hapgrid_command import plots
from rdkit import Chem

from . import choice, files, geometry
from .elements import COLOURS, SYMBOLS
from .molecule import placed, signed
from .pushing import read_log
from .xyz import frames, frames_of

ALL_BONDS = 4 | 8  # of RDKit: bonds between all atoms, each once
MOVES = 2.0  # degrees: what turns less is not drawn
METHODS = {"gfn2": "GFN2-xTB", "gfnff": "GFN-FF"}
SPINS = ("singlet", "doublet", "triplet", "quartet", "quintet")


def write(start, turned, ways):
    """Writes the page and returns the names of its files. start: steps.Start; turned: the torsions that
    the grid's paths turn; ways: files of the probe's ways, the best first."""
    kept, run = start.folder, start.folder.run
    run("play", f"{kept.name()}.grid", "--device", f"path:{ways[0]}", "--log", "played.log", "--frames", "played.frames",
        watch=lambda gone: kept.waiting("playing the way", gone, None))
    run("view", "played.frames", "--xyz", "played.xyz")
    # The probe is no element: it comes as the last atom, and as helium.
    probed = frames_of(run("view", "played.frames", "--xyz", "-", "--hip-label", "He").out, "played.frames")
    kept.write("played.pdb", pdb(start.molecule.rd, probed))
    log = read_log(kept.path("played.log"))
    draw_curves(kept, log, probed, turned)
    x, y = (log[a][len(log[a]) // 2] - log[a][0] for a in "xy")
    azimuth = f"{np.degrees(np.arctan2(y, x)):.0f}"  # from which the probe comes from the left
    run("view", "played.frames", "--azimuth", azimuth, "--elevation", "10", "--html", "played.html")
    kept.write("index.html", page(start, turned, ways))
    return ["played.log", "played.frames", "played.xyz", "played.pdb", "course.png", "played.html", "index.html"]


def pdb(rd, shapes):
    """The text of a PDB file of xyz.Frames, each a model, whose last atom is the probe. rd: RDKit's molecule without it."""
    rd, probe = Chem.RWMol(rd), Chem.Atom(0)
    probe.SetMonomerInfo(Chem.AtomPDBResidueInfo(" X  ", residueName="HIP", residueNumber=2, isHeteroAtom=True))
    rd.AddAtom(probe)
    for one in shapes:
        rd.AddConformer(placed(rd, one.x).GetConformer(), assignId=True)
    return Chem.MolToPDBBlock(rd, flavor=ALL_BONDS)


def draw_curves(folder, log, shapes, torsions):
    """Writes the picture of torsions, energies and the force over time. shapes: xyz.Frames that play showed; torsions: those
    that the grid's paths turn."""
    times = [float(one.words["time"]) for one in shapes]
    angles = {t.name: np.degrees(np.unwrap([geometry.torsion(one.x, *t.atoms) for one in shapes])) for t in torsions}
    t, hybrid, own = log["t"], log["energy"], log["own_energy"]
    force = np.sqrt(log["sent_x"]**2 + log["sent_y"]**2 + log["sent_z"]**2)
    moving = [name for name, values in angles.items() if np.ptp(values) > MOVES] or list(angles)[:1]
    panels = [("torsion / degrees", [(name, times, angles[name]) for name in moving])] if moving else []
    panels += [("energy / (kJ/mol)", [("with probe and anchors", t, hybrid), ("the molecule alone", t, own)]),
               ("force on the hand / N", [("", t, force)])]
    style = plots.style(folder)
    drawn = style.figure(5.6, 8.4)
    with style.house_style():
        every = []
        for k, (label, curves) in enumerate(panels):
            axes = drawn.add_subplot(len(panels), 1, k + 1, sharex=every[0] if every else None)
            every.append(axes)
            for colour, (said, x, y) in zip(style.COLOURS * len(curves), curves):
                axes.plot(x, y, color=colour, label=style.plain(said) or None)
            axes.set_ylabel(label)
            style.limits(axes, np.concatenate([y for _, _, y in curves]))
            style.legend(axes)
        every[-1].set_xlabel("time / s")
        drawn.align_ylabels(every)
    style.save(drawn, folder.path("course.png"))


def page(start, turned, ways):
    kept = start.folder
    name = kept.name()
    one = frames(kept.path("conformation.xyz"))[0]
    words = one.words
    method = re.sub("gfn2|gfnff", lambda found: METHODS[found[0]], words.get("method", "own energies"))
    box = json.loads(kept.run("stats", f"{name}.grid", "--format", "json").out)["box"]
    spins = start.molecule.unpaired
    facts = {"Formula": formula(start.molecule.formula), "Charge": signed(start.molecule.charge),
             "Spin": SPINS[spins] if spins < len(SPINS) else f"multiplicity {spins + 1}", "Made from": start.source,
             "Energies": f"{method}, of libxtb {library_version()}" if "GFN" in method else method,
             "Conformation": f"{words['E']} hartree" if "E" in words else "",
             "Grid": f"{' × '.join(map(str, box['counts']))} points, {box['spacing']:g} Å apart"}
    molecule = {"symbols": [SYMBOLS[z] for z in one.numbers], "colours": [COLOURS[z] for z in one.numbers],
                "places": np.round(one.x, 3).tolist(),
                "bonds": [[a, b] for a, near in enumerate(start.molecule.neighbours) for b in near if a < b],
                "torsions": [[t.name, *t.atoms, t in turned] for t in start.turning]}
    parts = {
        "TITLE": html.escape(start.source), "HEAD": formula(start.molecule.formula),
        "SAID": html.escape(kept.read(ways[0]).split("\n", 1)[0].lstrip("# ")),
        "FACTS": "".join(f"<dt>{key}<dd>{value if key == 'Formula' else html.escape(value)}"
                         for key, value in facts.items() if value),
        "GRID": html.escape(shlex.quote(f"{name}.grid")), "WAY": html.escape(shlex.quote(f"path:{ways[0]}")),
        "TOML": html.escape(f"{name}.toml"), "TABLE": barriers(kept), "METHOD": html.escape(method),
        "MOLECULE": json.dumps(molecule).replace("<", "\\u003c"), "VERIFY": html.escape(kept.read("verify.txt"))}
    return re.sub("@([A-Z]+)@", lambda found: parts[found[1]], TEMPLATE)


def barriers(kept):
    """Rows of a table: each path with its barrier and what lies behind it."""
    report = {row["name"]: row for row in files.rows(kept, "report.tsv", files.REPORT)}
    rows = []
    for row in files.rows(kept, "rotors.tsv", choice.ROTORS):
        one = report.get(row["path"], {})
        behind = [other["energy_kJ_mol"] for name, other in report.items()
                  if name.startswith(row["path"] + ":") and other["kind"].startswith("minimum")]
        cells = [row["path"], row["atoms"], row["barrier_kJ_mol"], one.get("nu1_cm-1", "-"), ", ".join(behind) or "-",
                 "in the grid" if row["taken"] == "yes" else row["why"]]
        rows.append("<tr>" + "".join(f"<td>{html.escape(cell)}" for cell in cells))
    return "\n".join(rows)


def formula(text):
    """C4H10O with its numbers below the line; a charge above it."""
    return re.sub(r"(\d+)", r"<sub>\1</sub>", re.sub(r"(\d*[+-]+\d*)$", "", html.escape(text)))


def library_version():
    """Of the libxtb that computes here, by the file's name, since the library does not tell it."""
    with open("/proc/self/maps", encoding="utf-8") as file:
        found = re.search(r"/libxtb\.so\.([0-9.]+)", file.read())
    return found[1] if found else ""


with open(__file__.removesuffix(".py") + ".html", encoding="utf-8") as _file:
    TEMPLATE = _file.read()
