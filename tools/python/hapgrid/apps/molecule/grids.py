"""The grid: from the paths that are chosen to one that verify finds fine, after as many trials as that takes.

Room is one of the things that can be wrong with a grid: how far the molecule can be pushed or turned before the probe slips
past is measured, not guessed. Where a grid has a record at a side of its box in which the molecule is not in its place, the
probe holds it there, and what lies behind is cut off. The box is then made a cell wider on that side.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from dataclasses import asdict, astuple, dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from hapgrid.apps.common import grid
from hapgrid.apps.common.cli import BreaksRule
from hapgrid.apps.common.files import Failed
from hapgrid.apps.common.work import Work, about, duration

from . import along_hold, holding, path_selection, resolution, stiffness, xyz
from .definition import MAX_LEVELS, PENALTY, Definition, paths_of
from .results import Result
from .xtb import BOHR, HARTREE

if TYPE_CHECKING:
    from .steps import Start

VERIFY_SHARE = 0.15  # of the time that the grid took, about
MOST_ROOM = 4.0  # angstrom that a side of the box is moved outwards, before no more room is looked for
LONG = 900  # seconds: for a grid that takes longer a coarser one is named
RIGID = 6  # the last numbers of a state: shift and rotation
ROOM, RULE = "room", "rule"
# What else is wrong with a grid, and what that means for its stiffest path: why expand cannot compute it, by the word that
# it writes to the file of --cost, or that verify finds it broken where the anchors cannot be softer.
HOPELESS = {"levels": f"with it a point has more than {MAX_LEVELS} states",
            "model": "with it the molecule does not come to rest", RULE: "with it the grid breaks {}: see {}; try {}"}


@dataclass(frozen=True)
class Fault:
    """Of a grid. kind: ROOM or one of HOPELESS; text: for people; sides: how much more room each side of the box needs,
    low x, y, z and high x, y, z, angstrom."""
    kind: str
    text: str
    sides: tuple[float, ...] = ()
    rule: str = ""  # that verify finds broken, in words


@dataclass(frozen=True)
class Remedies:
    """What was learnt from grids that had a fault. unwanted: paths, and why; softer: how many times softer anchors are
    than the rule has them; sides: as in Fault."""
    unwanted: dict[str, str] = field(default_factory=dict)
    softer: int = 1
    sides: tuple[float, ...] = (0.0,) * 6

    @property
    def may_widen(self) -> bool:
        return max(self.sides) < MOST_ROOM

    @classmethod
    def of(cls, stored: Any) -> Remedies:
        """Those that asdict() gave, or none where `stored` is something else: it may come from a stranger."""
        try:
            one = cls({str(k): str(why) for k, why in stored["unwanted"].items()}, int(stored["softer"]),
                      tuple(map(float, stored["sides"])))
        except (TypeError, ValueError, KeyError, AttributeError, OverflowError):
            return cls()
        return one if len(one.sides) == 6 and all(0 <= v < 100 for v in one.sides) and 0 < one.softer < 1 << 20 else cls()


def make_grid(start: Start, shapes: Result) -> Definition:
    """The Definition of the grid that has no fault, after as many as that takes. With --until definition its grid is not
    there yet."""
    folder = start.folder
    name = folder.name()
    toml = f"{name}.toml"
    by_hand = folder.changed_by_hand(toml)
    if by_hand:
        folder.say(f"{toml} was changed by hand: it is kept")
    o = start.options
    key = [folder.digest("report.tsv"), o.goes_on, o.push, o.hold, o.soft, o.spacing]
    remedies = Remedies.of(folder.recall("remedies", key))
    while True:
        one, fault = (Definition(name, paths_of(folder.path(toml))), None) if by_hand else planned(start, shapes, remedies)
        if fault is None and start.options.until is None:
            # Where a coarse grid told the spacing it told the room, too.
            look = start.options.spacing and remedies.may_widen and not by_hand and not one.held
            fault = grid_fault(start, one, look)
        if fault is None:
            return one
        cured = None if by_hand else cure(remedies, fault, one)
        if cured is None:
            raise (BreaksRule if fault.kind == RULE else Failed)(fault.text)
        if fault.kind == RULE and len(cured[0].unwanted) > len(remedies.unwanted):
            folder.write(report_without(one.paths[-1]), folder.read("verify.txt"))
        remedies, words = cured
        folder.remember("remedies", key, asdict(remedies))
        folder.say("  " + words)


def report_without(path: str) -> str:
    """The file that keeps verify's report on the grid that had this path."""
    return f"verify-{path}.txt"


def cure(remedies: Remedies, fault: Fault, definition: Definition) -> tuple[Remedies, str] | None:
    """(Remedies that also cure the fault of a grid, what is done in words), None where there is no cure."""
    rule, paths = definition.stiffness, definition.paths
    if fault.kind == ROOM:
        more = tuple(a + b for a, b in zip(remedies.sides, fault.sides))
        return replace(remedies, sides=more), f"{fault.text}, which is made wider"
    if fault.kind == RULE and rule != rule.softer(2) and not definition.held:
        # Where the molecule cannot yield, the probe goes through it, and the spacing does not resolve that.
        return replace(remedies, softer=2 * remedies.softer), f"{fault.text}: anchors half as stiff are tried"
    if fault.kind in HOPELESS and paths:
        stiffest = paths[-1]
        why = HOPELESS[fault.kind].format(fault.rule, report_without(stiffest), tries(definition))
        return Remedies({**remedies.unwanted, stiffest: why}), f"{stiffest} is left out: {why}"
    return None


def tries(definition: Definition) -> str:
    """The options that can keep the stiffest path, with which the grid breaks a rule."""
    alone = definition.paths[-1]
    turns = len(definition.paths) > 1 and any(alone in (t.name, *t.file_names()) for t in definition.torsions)
    return ", or ".join([f"--spacing below {definition.spacing:g}"] + ["--hold with another atom"] * bool(definition.held)
                        + [f"--torsions {alone} alone"] * turns)


def planned(start: Start, shapes: Result, remedies: Remedies) -> tuple[Definition, Fault | None]:
    """(the Definition of the grid, the Fault of its coarse grid or None)."""
    o, folder = start.options, start.folder
    hold = holding.decided(start, shapes)
    still: dict[str, str] = {}
    if hold and hold.torsions:
        moving = {t.name for t in hold.torsions}
        why = f"does not move {holding.words(start.molecule, hold.atoms)}, which is held"
        still = {f.name: why for f in shapes.found if f.name not in moving}
    paths = path_selection.choose(start, shapes, still | remedies.unwanted)
    if not paths:
        hold = None
    corners = holding.box(shapes, hold, paths) if hold else None
    one = Definition.around(start.molecule, shapes, paths, o.goes_on, o.spacing or 0.0, remedies.sides, corners)
    one.torsions = start.turned_by(paths)
    if hold is None:
        one.stiffness = stiffness_of(start, shapes, paths, remedies.softer)
    else:
        one.held = (hold.atoms, hold.fixed, holding.tie(shapes, hold, paths, o.soft))
        if start.given:
            one.force_scale = along_hold.force_scale(shapes, hold)
        folder.say(f"  the hand holds {holding.words(start.molecule, hold.atoms)}")
        idle = holding.still(start, hold, shapes) if hold.torsions else []  # the paths of others turn several bonds
        if idle:
            folder.say(f"  {', '.join(idle)} {'stays' if len(idle) == 1 else 'stay'} as in the conformation: turned, the held atom would "
                       f"move by less than {holding.LEAST_WAY:g} angstrom. Hold another one by --hold, or push by --push")
    if not o.spacing:
        one, fault = resolved(start, shapes, one, remedies.may_widen and not one.held)
        if fault is not None:
            return one, fault
    text = one.text()

    def compute() -> list[str]:
        folder.write(f"{folder.name()}.toml", text)
        return [f"{folder.name()}.toml"]
    folder.step("definition", f"writing {folder.name()}.toml", [], [text, folder.name()], compute)
    return one, None


def stiffness_of(start: Start, shapes: Result, paths: Sequence[str], softer: int) -> stiffness.Stiffness:
    folder = start.folder
    if not paths or start.options.goes_on:
        return stiffness.Stiffness()

    def compute() -> tuple[float, ...]:
        folder.say("computing how stiff the torsions are")
        surface = start.surface(shapes.x)
        tangents = [stiffness.tangent(surface.tree, [node * BOHR for node in f.nodes], f.start, surface.masses)
                    for f in shapes.found if f.name in paths]
        hessian = surface.hessian(shapes.x) * HARTREE / BOHR**2
        return astuple(stiffness.rule(hessian, shapes.x * BOHR, surface.masses, tangents, PENALTY).rounded())
    digests = [folder.digest(name) for name in ("conformation.xyz", *(name + ".xyz" for name in paths))]
    key = ["stiffness", folder.version, start.words, start.molecule.charge, start.molecule.unpaired, digests]
    return folder.cache.take(key, compute, lambda values: stiffness.Stiffness(*map(xyz.finite, values))).softer(softer)


def resolved(start: Start, shapes: Result, coarse: Definition, may_widen: bool) -> tuple[Definition, Fault | None]:
    """(the Definition with the spacing that a coarse grid tells, the Fault of the coarse grid or None)."""
    folder, threads = start.folder, start.options.threads
    text = coarse.text()

    def compute() -> list[str] | Fault:
        folder.write("coarse.toml", text)
        what = f"computing a coarse grid, {coarse.spacing:g} Å, from which the box and the spacing follow"
        fault = computed(start, what, "coarse", None, may_widen)
        if fault is not None:
            return fault
        folder.write("coarse.json", resolution.measure(start, "coarse.grid"))
        return ["coarse.toml", "coarse.grid", "coarse.grid.cost", "coarse.json"]
    fault = folder.step("resolution", "", shapes.files(), [text, resolution.WANTED], compute)
    if fault is not None:
        return coarse, fault
    spacing = resolution.decide(folder.read("coarse.json"), coarse)
    seconds = resolution.scaled(grid.cpu_seconds(folder, "coarse.grid") / threads, coarse.spacing, spacing)
    one = replace(coarse, spacing=spacing, seconds=seconds)
    folder.say(f"  spacing {spacing:g} Å, {math.prod(one.counts())} points, {about(seconds, threads)}")
    if seconds > LONG:
        coarser = resolution.coarser(spacing)
        points = math.prod(replace(coarse, spacing=coarser).counts())
        folder.say(f"  where that is too long: --spacing {coarser:g} has {points} points and takes about "
                   f"{duration(resolution.scaled(seconds, spacing, coarser))}, but its shapes are farther off")
    return one, None


def computed(start: Start, what: str, name: str, seconds: float | None, look_for_room: bool) -> Fault | None:
    """Computes a grid; its Fault, or None. seconds: that it takes, where they are known."""
    folder, threads = start.folder, start.options.threads
    seconds = seconds or grid.estimated(folder, f"{name}.toml", threads)
    folder.say(what + (", " + about(seconds, threads) if seconds else ""))
    failed = grid.compute(folder, what, f"{name}.toml", f"{name}.grid", threads, seconds)
    if failed is not None:
        return Fault(*failed)
    return short_of_room(folder, f"{name}.grid") if look_for_room else None


def short_of_room(folder: Work, made: str) -> Fault | None:
    """The Fault of a grid at whose sides the molecule is held, or None."""
    records = grid.records(folder, made)
    box = json.loads(folder.run("stats", made, "--get", "box").out)
    # Where the molecule is out of its place something holds it there.
    point = records["point"][(records["state"][:, -RIGID:] != 0).any(axis=1)]
    sides, spacing = np.array([point == 0, point == np.array(box["counts"]) - 1]).any(axis=1).ravel(), box["spacing"]
    if not sides.any():
        return None
    return Fault(ROOM, "the molecule is pushed as far as a side of the box", tuple((spacing * sides).tolist()))


def grid_fault(start: Start, definition: Definition, look_for_room: bool) -> Fault | None:
    """Computes and verifies the grid; its Fault, or None."""
    o, folder = start.options, start.folder
    name = folder.name()
    toml, made = f"{name}.toml", f"{name}.grid"

    def compute() -> list[str] | Fault:
        what = f"computing {made}, how the molecule yields at each place of the hand"
        return computed(start, what, name, definition.seconds, look_for_room) or [made, f"{made}.cost"]
    fault = folder.step("grid", "", [toml, "conformation.xyz", *(path + ".xyz" for path in definition.paths)], [], compute)
    if fault is not None:
        return fault
    title = "checking that the grid is whole and that its states are the model's"

    def verify() -> list[str] | Fault:
        seconds = VERIFY_SHARE * grid.cpu_seconds(folder, made) / o.threads
        fine = grid.verify(folder, title, made, o.threads, seconds)
        if fine:
            return ["verify.txt"]
        broken = re.findall(r"^(\S+) .* (?:broken|BROKEN)$", folder.read("verify.txt"), re.M)
        rule = "the rule " + " and ".join(broken) if broken else "a rule"
        return Fault(RULE, f"{made} breaks {rule}: see {folder.path('verify.txt')}", rule=rule)
    return folder.step("verify", title, [made], [], verify)
