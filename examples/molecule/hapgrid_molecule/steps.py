"""The steps from a molecule's file to the page. Each is a function from the results of those before it to its own;
what it computes is kept as files, which the user may change, so its result is what the files say."""

import os
import shlex
import time

import numpy as np
from hapgrid_command.files import Failed
from hapgrid_command.work import Work, duration

from . import crossing, files, grids, optimise, page, pushing, reading, structures
from .pieces import signed
from .search import Options
from .start import GFN2_ATOMS, Run, read, single_points, surface
from .xtb import BOHR, XtbError

ENSEMBLE = 8  # frames of an ensemble between which paths are looked for
# Gradients of xtb in units of a Hessian, which are measured: of propan-2-ol and ethanol 9 to 16 for each way of a
# bond, and 21 where it goes on behind its barriers; and what an optimiser's step takes besides its gradient.
HESSIANS, HESSIANS_BEHIND, HESSIANS_AT_FIRST = 15, 12, 15
ALGEBRA = 0.3


def run(options):
    """Everything, or all until --until; the line for standard output."""
    at = Run(options, Work("molecule", options.output, options.quiet))
    start = read(at)
    shapes = find_structures(at, start)
    if options.until != "structures":
        made = grids.make_grid(at, start, shapes)
        if options.until is None:
            return show(at, start, shapes, made)
    at.folder.say(f"stopped after the {options.until}: the same command without --until goes on")
    return ""


def find_structures(at, start):
    o, kept = at.options, at.folder
    points, shapes = single_points(at, start), ensemble(at, start)

    def compute():
        if o.method == "auto":
            kept.say("  energies by " + ("GFN2-xTB" if start.method == "gfn2" else
                     f"GFN-FF, as for all above {GFN2_ATOMS} atoms (--method gfn2 is better, and slower)"))
        seconds = structures_take(at, start)
        if seconds:
            kept.say(f"  about {duration(seconds)} for conformation and barriers, twice that where a lower minimum is "
                     "found")
        one = structures.explore(start.molecule, start.turning, Options(
            kept, start.method, start.charge, start.unpaired, o.solvent, o.highest, start.search, o.keep_conformation, o.basins,
            o.threads, shapes))
        for name, below in one.lower:
            kept.say(f"  {name} leads to a minimum that is {below:.1f} kJ/mol lower")
        files.lie_as_before(kept, one)
        if points is not None:
            points.put_into(one, o.threads, kept)
        return files.write_set(kept, one, f"hapgrid molecule: {start.source}, {start.method}, "
                               f"charge {signed(start.charge)}, {start.unpaired} unpaired electrons")
    kept.step("structures", "looking for the conformation and the barriers around it", ["start.sdf"],
             [start.method, o.solvent, points and points.key, start.charge, start.unpaired, start.search, o.highest, o.basins,
              o.keep_conformation, [name for t in start.turning for name in t.file_names()], [x.tolist() for _, x in shapes]],
             compute)
    return files.read_set(kept)


def ensemble(at, start):
    """The frames of an XYZ file between whose minima paths are looked for, as reading.ensemble() has them."""
    o = at.options
    if not o.basins or not o.file or not o.file.lower().endswith(".xyz"):
        return []
    shapes = [(n, x) for n, x in reading.ensemble(o.file) if len(x) == len(start.molecule.numbers)]
    if len(shapes) > ENSEMBLE:
        at.folder.say(f"  {len(shapes)} frames: the {ENSEMBLE} lowest are taken")
    return shapes[:ENSEMBLE]


def structures_take(at, start):
    """Seconds, within a factor of 2 or so, by a gradient on this machine. None where xtb refuses the shape: the
    search itself says why."""
    o, x = at.options, start.molecule.positions / BOHR
    try:
        one = surface(at, start, x)
        each = shortest(lambda: one.energy(x))
    except XtbError:
        return None
    each += ALGEBRA * shortest(lambda: optimise.projected(np.eye(x.size), x))
    ways = sum(len(t.signs) for t in start.turning)
    count = HESSIANS_AT_FIRST + ways * (HESSIANS + (HESSIANS_BEHIND if o.basins else 0))
    return 2 * x.size * count * each / min(o.threads, max(ways, 1))


def shortest(compute):
    """Seconds that it takes, without what else the machine does."""
    times = [time.monotonic()]
    for _ in range(5):
        compute()
        times.append(time.monotonic())
    return min(after - before for before, after in zip(times, times[1:]))


def show(at, start, shapes, plan):
    """The line that shows the grid."""
    o, kept = at.options, at.folder
    grid = f"{kept.name()}.grid"
    ways = crossing.Crossings if o.basins else pushing.Ways
    kept.step("pushing", "looking for the probe's ways that turn the molecule", [grid], [],
             lambda: ways(kept, grid, shapes, o.threads).write())
    made = [n for n in kept.made("pushing") if n.endswith(".txt")]
    if not made:
        raise Failed(f"{kept.path(grid)}: no way of the probe is found that pushes the molecule; hapgrid feel shows the grid")
    facts = [start.source, start.charge, start.unpaired, start.method]
    kept.step("page", "drawing pictures", [grid, *made, "rotors.tsv", "report.tsv", "verify.txt"], facts,
             lambda: page.write(at, start, start.turned_by(plan.paths), made))
    out = o.output.rstrip("/") or "/"
    out = f"./{out}" if out.startswith("-") else out
    kept.say(f"done: {out}/index.html sums up")
    grid, way = (shlex.quote(os.path.join(out, name)) for name in (grid, made[0]))
    kept.say(f"hapgrid feel {grid} is a page in which the mouse is the hand")
    return f"hapgrid play {grid} --device path:{way} --rate 1000 --frames - | hapgrid view --web"
