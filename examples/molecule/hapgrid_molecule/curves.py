"""What a chemist looks at while the probe goes its way: the torsions that turn, in degrees, and the
energy of the molecule itself beside that which the hand works against, over time."""

import subprocess

import numpy as np
from hapgrid_command.files import Failed
from preparation import geometry

MOVES = 2.0  # degrees: what turns less is not drawn
SCRIPT = """\
set terminal pngcairo noenhanced size 900,1400 font 'DejaVu Sans,18'
set output '{picture}'
set datafile separator '\\t'
set multiplot layout {panels},1
set key outside top center horizontal
set grid lc rgb '#dddddd'
set xlabel 't / s'
{torsions}
set ylabel 'energy / (kJ/mol)'
plot 'energies.tsv' using 1:2 with lines lw 3 lc rgb '#888888' title 'with probe and anchors', \\
     'energies.tsv' using 1:3 with lines lw 3 lc rgb '#d55e00' title 'the molecule alone'
set ylabel 'force / N'
plot 'energies.tsv' using 1:4 with lines lw 3 lc rgb '#333333' title 'force on the hand'
"""


def draw(folder, log, shapes, torsions, times):
    """Writes torsions.tsv, energies.tsv and their picture, and returns the names of the files.
    log: (names, rows) of play; shapes: (frames, atoms, 3) in angstrom at `times`; torsions: those
    that the grid's paths turn."""
    columns = [np.degrees(np.unwrap([geometry.torsion(x, *t.atoms) for x in shapes])) for t in torsions]
    moving = [k for k, values in enumerate(columns) if np.ptp(values) > MOVES] or list(range(len(torsions)))[:1]
    _table(folder, "torsions.tsv", ["t_s", *(f"{t.name}_deg" for t in torsions)], [times, *columns])
    names, rows = log
    t, hybrid, own, *sent = (rows[:, names.index(n)] for n in ("t", "energy", "own_energy", "sent_x", "sent_y", "sent_z"))
    _table(folder, "energies.tsv", ["t_s", "hybrid_kJ_mol", "molecule_kJ_mol", "force_N"],
           [t, hybrid, own, np.sqrt(np.square(sent).sum(axis=0))])
    curves = ", ".join(f"'torsions.tsv' using 1:{k + 2} with lines lw 3 title '{torsions[k].name}'" for k in moving)
    script = SCRIPT.format(picture="course.png", panels=3 if torsions else 2,
                           torsions=torsions and f"set ylabel 'torsion / degrees'\nplot {curves}" or "")
    try:
        done = subprocess.run(["gnuplot"], input=script, cwd=folder.directory, text=True, capture_output=True,
                              check=False)
    except FileNotFoundError:
        raise Failed("gnuplot not found: install the Debian package gnuplot-nox") from None
    if done.returncode:
        raise Failed(f"gnuplot: {done.stderr.strip().splitlines()[-1]}")
    return ["course.png", "torsions.tsv", "energies.tsv"]


def _table(folder, name, heads, columns):
    lines = ["# " + "\t".join(heads), *("\t".join(f"{v:.4f}" for v in row) for row in zip(*columns))]
    folder.write(name, "\n".join(lines) + "\n")
