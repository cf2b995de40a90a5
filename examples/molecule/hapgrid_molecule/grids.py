"""The grid: from the paths that are chosen to one that verify finds fine, after as many trials as that takes."""

import json
from dataclasses import asdict, dataclass, replace

from hapgrid_command import grid
from hapgrid_command.cli import BreaksRule
from hapgrid_command.files import Failed
from hapgrid_command.work import about, duration

from . import choice, faults, files, resolution, stiffness
from .definition import Definition, PENALTY, paths_of
from .molecule import BadInput

VERIFY_SHARE = 0.15  # of the time that the grid took, about


@dataclass(frozen=True)
class Plan:
    """What the grid is made of. paths: by their barriers, the lowest first; definition: None where a file that was
    changed by hand stands for it; seconds: that the grid takes, about, where a coarse one told it."""
    paths: list
    definition: Definition = None
    seconds: float = None

    by_hand = property(lambda self: self.definition is None)


def make_grid(start, shapes):
    """The Plan of the grid that has no fault, after as many as that takes. With --until definition its grid is not
    there yet."""
    kept = start.folder
    name = kept.name()
    if kept.changed_by_hand(f"{name}.toml"):
        kept.say(f"{name}.toml was changed by hand: it is kept")
        plan = Plan(paths_of(kept.path(f"{name}.toml")))
        fault = None if start.options.until else grid_fault(start, plan, False)
        if fault is not None:
            refuse(fault)
        return plan
    key = [kept.digest("report.tsv"), start.options.paths, start.options.basins, start.options.spacing]
    remedies = faults.Remedies.of(kept.recall("remedies", key))
    while True:
        plan, fault = planned(start, shapes, remedies)
        if fault is None and start.options.until is None:
            fault = grid_fault(start, plan, remedies.widened < faults.WIDENED)
        if fault is None:
            return plan
        rule = plan.definition.stiffness
        cure = remedies.after(fault, plan.paths[-1] if plan.paths else None, rule != rule.softer(2))
        if cure is None:
            refuse(fault)
        remedies, words = cure
        kept.remember("remedies", key, asdict(remedies))
        kept.say("  " + words)


def refuse(fault):
    raise (BreaksRule if fault.kind == faults.RULE else Failed)(fault.text)


def planned(start, shapes, remedies):
    """(Plan, the Fault of its coarse grid or None)."""
    o, kept = start.options, start.folder
    paths = choose(start, shapes, remedies.unwanted)
    one = Definition.around(start.molecule, shapes, paths, o.basins, o.spacing or 0.0, remedies.sides)
    one.torsions = start.turned_by(paths)
    one.stiffness = stiffness_of(start, shapes, paths, remedies.softer)
    plan = Plan(paths, one)
    if not o.spacing:
        plan, fault = resolved(start, shapes, plan, remedies.widened < faults.WIDENED)
        if fault is not None:
            return plan, fault
    text = plan.definition.text()

    def compute():
        kept.write(f"{kept.name()}.toml", text)
        return [f"{kept.name()}.toml"]
    kept.step("definition", f"writing {kept.name()}.toml", [], [text, kept.name()], compute)
    return plan, None


def choose(start, shapes, unwanted):
    """The paths of the grid, the lowest barrier first; rotors.tsv has them all."""
    o, kept = start.options, start.folder

    def compute():
        taken, left = choice.choose(start, shapes, unwanted)
        kept.say("  taken: " + (", ".join(taken) or "no path: the molecule keeps its shape"))
        kept.write("rotors.tsv", choice.table(shapes, start.turning, start.still, taken, left))
        for line in choice.left_out(files.rows(kept, "rotors.tsv", choice.ROTORS)):
            kept.say("  " + line)
        return ["rotors.tsv"]
    kept.step("choice", "choosing the softest paths that are sane together", [*shapes_files(shapes), "report.tsv"],
             [o.paths, unwanted, o.basins, o.single_points], compute)
    taken = {row["path"] for row in files.rows(kept, "rotors.tsv", choice.ROTORS) if row["taken"] == "yes"}
    return [f.name for f in sorted(shapes.found, key=lambda f: f.barrier) if f.name in taken]


def shapes_files(shapes):
    return ["conformation.xyz", *(f.name + ".xyz" for f in shapes.found)]


def stiffness_of(start, shapes, paths, softer):
    o, kept = start.options, start.folder
    if not paths or o.basins:
        return stiffness.Stiffness()

    def compute():
        found = [f for f in shapes.found if f.name in paths]
        one = stiffness.of_paths(start.surface(shapes.x), shapes.x, found, PENALTY).rounded()
        kept.write("stiffness.json", json.dumps(asdict(one), indent=1) + "\n")
        return ["stiffness.json"]
    kept.step("stiffness", "computing how stiff the torsions are", ["conformation.xyz", *(
        name + ".xyz" for name in paths)], [start.words, start.molecule.charge, start.molecule.unpaired], compute)
    try:
        return stiffness.Stiffness(**{k: float(v) for k, v in json.loads(kept.read("stiffness.json")).items()}).softer(softer)
    except (ValueError, TypeError, AttributeError):
        raise BadInput(f"{kept.path('stiffness.json')}: is not what was written: remove it") from None


def resolved(start, shapes, plan, may_widen):
    """(the Plan with the spacing that a coarse grid tells, the Fault of the coarse grid or None)."""
    o, kept = start.options, start.folder
    coarse = plan.definition
    text = coarse.text()

    def compute():
        kept.write("coarse.toml", text)
        seconds = grid.estimated(kept, "coarse.toml", o.threads)
        what = f"computing a coarse grid, {coarse.spacing:g} Å, from which the box and the spacing follow"
        kept.say(what + (", " + about(seconds, o.threads) if seconds else ""))
        fault = computed(start, what, "coarse.toml", "coarse.grid", seconds)
        if fault is None and may_widen:
            fault = faults.short_of_room(kept, "coarse.grid")
        if fault is not None:
            return fault
        kept.write("coarse.json", resolution.measure(start, "coarse.grid"))
        return ["coarse.toml", "coarse.grid", "coarse.grid.cost", "coarse.json"]
    fault = kept.step("resolution", "", shapes_files(shapes), [text, resolution.WANTED], compute)
    if fault is not None:
        return plan, fault
    spacing, enough = resolution.decide(kept.read("coarse.json"), coarse)
    took = grid.cpu_seconds(kept, "coarse.grid") / o.threads

    def takes(spacing):
        return resolution.scaled(took, coarse.spacing, spacing)
    is_coarse = enough is not None and enough < 0.99 * spacing
    finer = enough if is_coarse else spacing / 2
    right = f"off by less than {resolution.WANTED:g} Å in 99 of 100 places"
    kept.say(f"  spacing {spacing:g} Å, {about(takes(spacing), o.threads)}"
             + (f", {right}" if enough is not None and not is_coarse else "")
             + f"; --spacing {finer:.2g} would take about {duration(takes(finer))}" + (f" and be {right}" if is_coarse else ""))
    return Plan(plan.paths, replace(coarse, spacing=spacing), takes(spacing)), None


def computed(start, what, toml, name, seconds):
    """Computes a grid; the Fault that makes it hopeless, or None."""
    failed = grid.compute(start.folder, what, toml, name, start.options.threads, seconds)
    if failed is None:
        return None
    kind, said = failed
    if kind not in faults.HOPELESS:
        raise Failed(said)
    return faults.Fault(kind, said)


def grid_fault(start, plan, may_widen):
    """Computes and verifies the grid; its Fault, or None."""
    o, kept = start.options, start.folder
    name = kept.name()
    toml, made = f"{name}.toml", f"{name}.grid"

    def took():
        return grid.cpu_seconds(kept, made) / o.threads

    def compute():
        what = f"computing {made}, how the molecule yields at each place of the probe"
        seconds = plan.seconds or grid.estimated(kept, toml, o.threads)
        kept.say(what + (", " + about(seconds, o.threads) if seconds else ""))
        fault = computed(start, what, toml, made, seconds)
        if fault is not None:
            return fault
        fault = faults.short_of_room(kept, made) if may_widen and not plan.by_hand else None
        if fault is not None and o.spacing:
            return fault
        if fault is not None:
            kept.say(f"  at a side of the box the molecule is held: change origin and counts in {toml} for more room")
        if o.spacing and not plan.by_hand:
            kept.say(f"  --spacing {o.spacing / 2:.2g} would take about {duration(resolution.scaled(took(), 1, 0.5))}")
        return [made, f"{made}.cost"]
    fault = kept.step("grid", "", [toml, "conformation.xyz", *(path + ".xyz" for path in plan.paths)], [], compute)
    if fault is not None:
        return fault
    title = "checking that the grid is whole and that its states are the model's"

    def verify():
        if not grid.verify(kept, title, made, o.threads, VERIFY_SHARE * took()):
            return faults.Fault(faults.RULE, f"{made} breaks a rule: see {kept.path('verify.txt')}")
        return ["verify.txt"]
    return kept.step("verify", title, [made], [], verify)
