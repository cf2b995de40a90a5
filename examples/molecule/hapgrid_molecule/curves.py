"""What a chemist looks at while the probe goes its way: the torsions that turn, in degrees, and the
energy of the molecule itself beside that which the hand works against, over time."""

import numpy as np
from hapgrid_command import plots

from . import geometry

MOVES = 2.0  # degrees: what turns less is not drawn


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
    _picture(plots.style(folder), folder.path("course.png"), times,
             [(torsions[k].name, columns[k]) for k in moving], t, hybrid, own, np.sqrt(np.square(sent).sum(axis=0)))
    return ["course.png", "torsions.tsv", "energies.tsv"]


def _table(folder, name, heads, columns):
    lines = ["# " + "\t".join(heads), *("\t".join(f"{v:.4f}" for v in row) for row in zip(*columns))]
    folder.write(name, "\n".join(lines) + "\n")


def _picture(style, name, times, torsions, t, hybrid, own, force):
    """Torsions, energies and force over time, in the house style of hapgrid's plots."""
    drawn = style.figure(5.6, 8.4)
    panels = [("torsion / degrees", [(name, times, values) for name, values in torsions])] if torsions else []
    panels += [("energy / (kJ/mol)", [("with probe and anchors", t, hybrid), ("the molecule alone", t, own)]),
               ("force on the hand / N", [("", t, force)])]
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
    style.save(drawn, name)
