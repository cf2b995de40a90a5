"""What a chemist looks at while the probe goes its way: the torsions that turn, in degrees, and the
energy of the molecule itself beside that which the hand works against, over time."""

import subprocess

import numpy as np
from preparation import files, geometry

from .definition import paths_of
from .filters import Failed
from .structures import least_t

MOVES = 2.0  # degrees: what turns less is not drawn
SHAPES = 60  # at which molecule-check is asked for the molecule's own energy
SCRIPT = """\
set terminal pngcairo noenhanced size 900,900 font 'DejaVu Sans,11'
set output '{picture}'
set datafile separator '\\t'
set multiplot layout 2,1
set key outside top center horizontal
set grid lc rgb '#dddddd'
set xlabel 't / s'
set ylabel 'torsion / degrees'
plot {torsions}
set ylabel 'energy / (kJ/mol)'
plot 'energies.tsv' using 1:2 with lines lw 2 lc rgb '#56b4e9' title 'hybrid energy, with probe and anchors', \\
     'energies.tsv' using 1:3 with lines lw 2 lc rgb '#d55e00' title 'the molecule itself'
"""


def draw(filters, stages, toml, log, shapes, torsions, times):
    """Writes torsions.tsv, energies.tsv and their picture, and returns the names of the files.
    log: (names, rows) of play; shapes: (frames, atoms, 3) in angstrom at `times`; torsions: those
    that the grid's paths turn."""
    columns = [np.degrees(np.unwrap([geometry.torsion(x, *t.atoms) for x in shapes])) for t in torsions]
    moving = [k for k, values in enumerate(columns) if np.ptp(values) > MOVES] or list(range(len(torsions)))[:1]
    _table(stages, "torsions.tsv", ["t_s", *(f"{t.name}_deg" for t in torsions)], [times, *columns])
    names, rows = log
    first = names.index("s0")
    count = sum(n[0] == "s" and n[1:].isdigit() for n in names) - 6
    picked = np.unique(np.linspace(0, len(rows) - 1, SHAPES).round().astype(int))
    low = [least_t(stages.path(name + ".xyz")) for name in paths_of(stages.path(toml))]
    own = [_own_energy(filters, toml, rows[n, first:first + count], low) for n in picked]
    _table(stages, "energies.tsv", ["t_s", "hybrid_kJ_mol", "molecule_kJ_mol"],
           [rows[picked, 0], rows[picked, names.index("energy")], own])
    if not torsions:
        return ["torsions.tsv", "energies.tsv"]
    curves = ", ".join(f"'torsions.tsv' using 1:{k + 2} with lines lw 2 title '{torsions[k].name}'" for k in moving)
    script = SCRIPT.format(picture="course.png", torsions=curves)
    try:
        done = subprocess.run(["gnuplot"], input=script, cwd=stages.directory, text=True, capture_output=True,
                              check=False)
    except FileNotFoundError:
        raise Failed("gnuplot not found: install the Debian package gnuplot-nox") from None
    if done.returncode:
        raise Failed(f"gnuplot: {done.stderr.strip().splitlines()[-1]}")
    return ["course.png", "torsions.tsv", "energies.tsv"]


def _own_energy(filters, toml, t, low):
    """Of a shape, above the conformation, kJ/mol. low: the least t."""
    if not len(t):
        return 0.0
    text = filters.run("molecule-check", toml,
                       "--xyz=" + ",".join(repr(float(min(max(v, a), a + 1))) for v, a in zip(t, low)))[0]
    return float(text.splitlines()[1].split()[0].removeprefix("dE="))


def _table(stages, name, heads, columns):
    lines = ["# " + "\t".join(heads), *("\t".join(f"{v:.4f}" for v in row) for row in zip(*columns))]
    files.write_whole(stages.path(name), "\n".join(lines) + "\n")
