"""The grid: from the paths that are chosen to one that verify finds fine, after as many trials as that takes."""

import json
from dataclasses import asdict, dataclass

from preparation import files
from preparation.molecule import BadInput

from . import choice, combined, faults, resolution, stiffness
from .definition import PENALTY, Definition, paths_of, write
from .filters import Failed
from .stages import duration
from .start import single_points, surface

VERIFY_SHARE = 0.15  # of the time that the grid took, about


class Broken(Failed):
    """verify found a fault in the grid, for which there is no cure."""


@dataclass(frozen=True)
class Plan:
    """What the grid is made of. paths: by their barriers, the lowest first; definition: None where a file that was
    changed by hand stands for it; seconds: that the grid takes, about, where a coarse one told it."""
    paths: list
    definition: Definition = None
    seconds: float = None

    by_hand = property(lambda self: self.definition is None)


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
