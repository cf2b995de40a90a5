"""The steps from a molecule's file to the page. Each is a function from the results of those before it to its own;
what it computes is kept as files (stages.py), which the user may change, so its result is what the files say."""

import json
import os
import shlex
import time
from dataclasses import asdict, dataclass

import numpy as np
from preparation import files, optimise, work, xyz
from preparation import molecule as prepared
from preparation.molecule import BadInput
from preparation.xtb import Surface, XtbError

from . import (choice, combined, crossing, faults, formats, page, pushing, reading, resolution, rotors, singles, stages,
               stiffness, structures)
from .definition import PENALTY, Definition, paths_of, write
from .filters import Failed, Filters
from .pieces import signed
from .stages import duration

GFN2_ATOMS = 24
ENSEMBLE = 8  # frames of an ensemble between which paths are looked for
VERIFY_SHARE = 0.15  # of the time that the grid took, about
# Gradients of xtb in units of a Hessian, which are measured: of propan-2-ol and ethanol 9 to 16 for each way of a
# bond, and 21 where it goes on behind its barriers; and what an optimiser's step takes besides its gradient.
HESSIANS, HESSIANS_BEHIND, HESSIANS_AT_FIRST = 15, 12, 15
ALGEBRA = 0.3


class Broken(Failed):
    """verify found a fault in the grid, for which there is no cure."""


@dataclass(frozen=True)
class Run:
    """options: of the command line."""
    options: object
    stages: stages.Stages
    filters: Filters


@dataclass(frozen=True)
class Start:
    """The molecule that is felt. source: of it, in words; search: whether conformers are searched; turning: bonds
    (torsions.Torsion); still: those and rings that keep their place (rotors.Left)."""
    molecule: prepared.Molecule
    source: str
    charge: int
    unpaired: int
    search: bool
    method: str
    turning: list
    still: list

    def turned_by(self, paths):
        """The torsions that these paths turn."""
        return [t for t in self.turning if {t.name, *t.file_names()} & set(paths)]


@dataclass(frozen=True)
class Plan:
    """What the grid is made of. paths: by their barriers, the lowest first; definition: None where a file that was
    changed by hand stands for it; seconds: that the grid takes, about, where a coarse one told it."""
    paths: list
    definition: Definition = None
    seconds: float = None

    by_hand = property(lambda self: self.definition is None)


def run(options):
    """Everything, or all until --until; the line for standard output."""
    at = Run(options, stages.Stages(options.output, options.quiet), Filters(options.output))
    start = read(at)
    shapes = find_structures(at, start)
    if options.until != "structures":
        made = make_grid(at, start, shapes)
        if options.until is None:
            return show(at, start, shapes, made)
    at.stages.say(f"stopped after the {options.until}: the same command without --until goes on")
    return ""


# The molecule

def read(at):
    o, kept = at.options, at.stages
    source = os.path.basename(o.file) if o.file else f"SMILES {o.smiles}"

    def compute():
        one, charge, unpaired, built, said = reading.read(o.file, o.smiles, o.charge, o.uhf)
        for line in said:
            kept.say("  " + line)
        kept.enter()
        files.write_whole(kept.path("start.sdf"), reading.sdf(one, charge, unpaired, built))
        return ["start.sdf"]
    text = stages.digest_of(prepared.read_bytes(o.file)) if o.file else o.smiles
    kept.run("molecule", "", [], [text, o.charge, o.uhf], compute)
    one, charge, unpaired, built = reading.started(kept.path("start.sdf"))
    method = o.method
    if method == "auto":
        method = "gfn2" if len(one.numbers) <= GFN2_ATOMS else "gfnff"
    turning, still = rotors.find(one)
    rings = sum(left.why == rotors.RING for left in still)
    if o.torsions is not None:
        turning, left = only(turning, set(o.torsions.split(",")), o.basins)
        still = still + left
    kept.say(f"  {one.formula}, {len(one.numbers)} atoms, charge {signed(charge)}, {len(turning)} bonds turn"
             + (f"; {rings} rings stay as they are" if rings else ""))
    return Start(one, source, charge, unpaired, o.search or built, method, turning, still)


def only(turning, wanted, basins):
    """(the torsions of --torsions, the others). With basins paths go both ways."""
    known = {t.name for t in turning}
    if not basins:
        known = known.union(*(t.file_names() for t in turning))
    unknown = sorted(wanted - known)
    if unknown:
        raise Failed(f"--torsions: no bond {unknown[0]} turns, only " + ", ".join(t.name for t in turning))
    turn = [t if t.name in wanted else t.only(wanted) for t in turning]
    left = [rotors.Left(t.name, "not among --torsions") for t, one in zip(turning, turn) if not one.signs]
    return [t for t in turn if t.signs], left


# The structures

def single_points(at, start):
    """The SinglePoints of --single-points, or None."""
    o = at.options
    if o.single_points is None:
        return None
    return singles.SinglePoints(o.single_points, start.molecule.numbers, start.charge, start.unpaired, at.stages.steps)


def surface(at, start, x):
    """x: the conformation, bohr."""
    return Surface(start.molecule.numbers, x, start.method, start.charge, unpaired=start.unpaired,
                   solvent=at.options.solvent)


def find_structures(at, start):
    o, kept = at.options, at.stages
    points, shapes = single_points(at, start), ensemble(at, start)

    def compute():
        if o.method == "auto":
            kept.say("  energies by " + ("GFN2-xTB" if start.method == "gfn2" else
                     f"GFN-FF, as for all above {GFN2_ATOMS} atoms (--method gfn2 is better, and slower)"))
        seconds = structures_take(at, start)
        if seconds:
            kept.say(f"  about {duration(seconds)} for conformation and barriers, twice that where a lower minimum is "
                     "found")
        one = structures.explore(start.molecule, start.turning, structures.Options(
            work.Options(start.method, start.charge, start.unpaired, o.highest, kept.path(".work"), o.solvent), start.search,
            o.keep_conformation, o.basins, o.threads, shapes), kept)
        for name, below in one.lower:
            kept.say(f"  {name} leads to a minimum that is {below:.1f} kJ/mol lower")
        one.result.lie_as_before(kept.directory)
        if points is not None:
            points.put_into(one.result, o.threads, kept)
        return files.write_set(kept.directory, one.result, f"hapgrid molecule: {start.source}, {start.method}, "
                               f"charge {signed(start.charge)}, {start.unpaired} unpaired electrons")
    kept.run("structures", "looking for the conformation and the barriers around it", ["start.sdf"],
             [start.method, o.solvent, points and points.key, start.charge, start.unpaired, start.search, o.highest, o.basins,
              o.keep_conformation, [name for t in start.turning for name in t.file_names()], [x.tolist() for _, x in shapes]],
             compute)
    return structures.Structures(kept)


def ensemble(at, start):
    """The frames of an XYZ file between whose minima paths are looked for, as xyz.ensemble() has them."""
    o = at.options
    if not o.basins or not o.file or not o.file.lower().endswith(".xyz"):
        return []
    shapes = xyz.ensemble(formats.decoded(prepared.read_bytes(o.file), o.file), start.molecule.numbers) or []
    if len(shapes) > ENSEMBLE:
        at.stages.say(f"  {len(shapes)} frames: the {ENSEMBLE} lowest are taken")
    return shapes[:ENSEMBLE]


def structures_take(at, start):
    """Seconds, within a factor of 2 or so, by a gradient on this machine. None where xtb refuses the shape: the
    search itself says why."""
    o, x = at.options, start.molecule.positions / work.BOHR
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


# The grid

def make_grid(at, start, shapes):
    """The Plan of the grid that has no fault, after as many as that takes. With --until definition its grid is not
    there yet."""
    kept = at.stages
    name = kept.name()
    if kept.changed_by_hand("definition", f"{name}.toml"):
        kept.say(f"{name}.toml was changed by hand: it is kept")
        plan = Plan(paths_of(kept.path(f"{name}.toml")))
        fault = None if at.options.until else grid_fault(at, plan, False)
        if fault is not None:
            raise refusal(fault)
        return plan
    key = [kept.digest("report.tsv"), at.options.paths, at.options.basins, at.options.spacing]
    known = kept.recall("remedies", key)
    remedies = faults.Remedies(**known) if known else faults.Remedies()
    while True:
        plan, fault = planned(at, start, shapes, remedies)
        if fault is None and at.options.until is None:
            fault = grid_fault(at, plan, remedies.widened < faults.WIDENED)
        if fault is None:
            return plan
        rule = plan.definition.stiffness
        cure = remedies.after(fault, plan.paths[-1] if plan.paths else None, rule != rule.softer(2))
        if cure is None:
            raise refusal(fault)
        remedies, words = cure
        kept.remember("remedies", key, remedies.as_json())
        kept.say("  " + words)


def refusal(fault):
    return (Broken if fault.kind == faults.RULE else Failed)(fault.text)


def planned(at, start, shapes, remedies):
    """(Plan, the Fault of its coarse grid or None)."""
    o, kept = at.options, at.stages
    paths = choose(at, start, shapes, remedies.unwanted)
    one = Definition.around(start.molecule, shapes, paths, o.basins, o.spacing or 0.0, remedies.sides)
    one.torsions = start.turned_by(paths)
    one.stiffness = stiffness_of(at, start, shapes, paths, remedies.softer)
    plan = Plan(paths, one)
    if not o.spacing:
        plan, fault = resolved(at, shapes, plan, remedies.widened < faults.WIDENED)
        if fault is not None:
            return plan, fault
    text = plan.definition.text()

    def compute():
        write(kept.path(f"{kept.name()}.toml"), text)
        return [f"{kept.name()}.toml"]
    kept.run("definition", f"writing {kept.name()}.toml", [], [text, kept.name()], compute)
    return plan, None


def choose(at, start, shapes, unwanted):
    """The paths of the grid, the lowest barrier first; rotors.tsv has them all."""
    o, kept = at.options, at.stages

    def missed(one):
        if not o.basins:
            return ""
        points = single_points(at, start)
        return combined.missed(at.filters, kept, one, shapes.x, (points or surface(at, start, shapes.x)).energy,
                               "single points" if points else "xtb")

    def compute():
        taken, left = choice.choose(at.filters, kept, start.molecule, shapes, o.paths, unwanted, o.basins, missed)
        kept.say("  taken: " + (", ".join(taken) or "no path: the molecule keeps its shape"))
        files.write_whole(kept.path("rotors.tsv"), choice.table(shapes, start.turning, start.still, taken, left))
        for line in choice.left_out(table(kept, "rotors.tsv")):
            kept.say("  " + line)
        return ["rotors.tsv"]
    kept.run("choice", "choosing the softest paths that are sane together", [*shapes_files(shapes), "report.tsv"],
             [o.paths, unwanted, o.basins, o.single_points], compute)
    taken = {row[0] for row in table(kept, "rotors.tsv") if row[3:4] == ["yes"]}
    return [f.name for f in sorted(shapes.found, key=lambda f: f.barrier) if f.name in taken]


def table(kept, name):
    """The rows of a file, without its heads."""
    with open(kept.path(name), encoding="utf-8") as file:
        return [line.rstrip("\n").split("\t") for line in file][1:]


def shapes_files(shapes):
    return ["conformation.xyz", *(f.name + ".xyz" for f in shapes.found)]


def stiffness_of(at, start, shapes, paths, softer):
    o, kept = at.options, at.stages
    if not paths or o.basins:
        return stiffness.Stiffness()

    def compute():
        found = [f for f in shapes.found if f.name in paths]
        one = stiffness.of_paths(start.molecule, surface(at, start, shapes.x), shapes.x, found, PENALTY).rounded()
        files.write_whole(kept.path("stiffness.json"), json.dumps(asdict(one), indent=1) + "\n")
        return ["stiffness.json"]
    kept.run("stiffness", "computing how stiff the torsions are", ["conformation.xyz", *(
        name + ".xyz" for name in paths)], [start.method, start.charge, start.unpaired, o.solvent], compute)
    try:
        with open(kept.path("stiffness.json"), encoding="utf-8") as file:
            return stiffness.Stiffness(**{name: float(v) for name, v in json.load(file).items()}).softer(softer)
    except (ValueError, TypeError, AttributeError):
        raise BadInput(f"{kept.path('stiffness.json')}: is not what was written: remove it") from None


def resolved(at, shapes, plan, may_widen):
    """(the Plan with the spacing that a coarse grid tells, the Fault of the coarse grid or None)."""
    o, kept = at.options, at.stages
    coarse = plan.definition
    text = coarse.text()

    def compute():
        write(kept.path("coarse.toml"), text)
        seconds = resolution.estimated(at, "coarse.toml")
        what = f"computing a coarse grid, {coarse.spacing:g} Å, from which the box and the spacing follow"
        kept.say(what + (f", about {duration(seconds)}" if seconds else ""))
        made = resolution.compute_grid(at, what, "coarse.toml", "coarse.grid", seconds)
        if not isinstance(made, list):
            return made
        fault = faults.short_of_room(at.filters, kept, "coarse.grid") if may_widen else None
        if fault is not None:
            return fault
        files.write_whole(kept.path("coarse.json"), resolution.measure(at, "coarse.grid"))
        return ["coarse.toml", *made, "coarse.json"]
    fault = kept.run("resolution", "", shapes_files(shapes), [text, resolution.WANTED], compute)
    if fault is not None:
        return plan, fault
    with open(kept.path("coarse.json"), encoding="utf-8") as file:
        found = resolution.decide(file.read(), coarse)
    took = resolution.cpu_seconds(kept.path("coarse.grid.cost")) / o.threads

    def takes(spacing):
        return duration(resolution.scaled(took, coarse.spacing, spacing))
    finer = found.spacing / 2
    better = f"a grid twice as fine, --spacing {finer:.2g}, would take about {takes(finer)}"
    if found.enough is not None and found.enough > found.spacing * 0.99:
        better = f"off by less than {resolution.WANTED:g} Å in 99 of 100 places; " + better
    elif found.enough is not None:
        better = (f"--spacing {found.enough:.2g}, which would take about {takes(found.enough)}, is off by less than "
                  f"{resolution.WANTED:g} Å in 99 of 100 places")
    kept.say(f"  spacing {found.spacing:g} Å, about {takes(found.spacing)}; " + better)
    return Plan(plan.paths, coarse.with_spacing(found.spacing),
                resolution.scaled(took, coarse.spacing, found.spacing)), None


def grid_fault(at, plan, may_widen):
    """Computes and verifies the grid; its Fault, or None."""
    o, kept = at.options, at.stages
    name = kept.name()
    toml, grid = f"{name}.toml", f"{name}.grid"

    def compute():
        what = f"computing {grid}, how the molecule yields at each place of the probe"
        seconds = plan.seconds or resolution.estimated(at, toml)
        kept.say(what + (f", about {duration(seconds)}" if seconds else ""))
        made = resolution.compute_grid(at, what, toml, grid, seconds)
        if not isinstance(made, list) or plan.by_hand:
            return made
        fault = faults.short_of_room(at.filters, kept, grid) if may_widen else None
        if fault is not None and o.spacing:
            return fault
        if fault is not None:
            kept.say(f"  at a side of the box the molecule is held: change origin and counts in {toml} for more room")
        if o.spacing:
            half = resolution.scaled(resolution.cpu_seconds(kept.path(f"{grid}.cost")) / o.threads, 1, 0.5)
            kept.say(f"  a grid twice as fine, --spacing {o.spacing / 2:.2g}, would take about {duration(half)}")
        return made
    inputs = ["conformation.xyz", *(path + ".xyz" for path in plan.paths)]
    fault = kept.run("grid", "", [toml, *inputs], [], compute)
    if fault is not None:
        return fault
    title = "checking that the grid is whole and that its states are the model's"

    def verify():
        share = resolution.cpu_seconds(kept.path(f"{grid}.cost")) * VERIFY_SHARE / o.threads
        out, code = at.filters.run("verify", grid, "-v", "-j", o.threads, good=(0, 3, 4),
                                   watch=lambda gone: kept.waiting(title, gone, share))
        files.write_whole(kept.path("verify.txt"), out)
        if code == 3:
            return faults.Fault(faults.RULE, f"{grid} breaks a rule: see {kept.path('verify.txt')}")
        return ["verify.txt"]
    return kept.run("verify", title, [grid], [], verify)


# The way of the probe, and the page

def show(at, start, shapes, plan):
    """The line that shows the grid."""
    o, kept = at.options, at.stages
    grid = f"{kept.name()}.grid"
    ways = crossing.Crossings if o.basins else pushing.Ways
    kept.run("pushing", "looking for the probe's ways that turn the molecule", [grid], [],
             lambda: ways(at.filters, kept, grid, shapes, o.threads).write())
    made = [n for n in kept.made("pushing") if n.endswith(".txt")]
    facts = [start.source, start.charge, start.unpaired, start.method]
    kept.run("page", "drawing pictures", [grid, *made, "rotors.tsv", "report.tsv", "verify.txt"], facts,
             lambda: page.write(at, start, start.turned_by(plan.paths), made))
    out = o.output.rstrip("/") or "/"
    out = f"./{out}" if out.startswith("-") else out
    kept.say(f"done: {out}/index.html sums up")
    grid, way = (shlex.quote(os.path.join(out, name)) for name in (grid, made[0]))
    kept.say(f"hapgrid feel {grid} is a window in which the mouse is the hand")
    return f"hapgrid play {grid} --device path:{way} --rate 1000 --frames - | hapgrid view --window"
