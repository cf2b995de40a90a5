"""The conformation, the saddles around it and the paths to them, in several processes.

What one process finds is kept as a file (search.Search); the results are taken in the order of the rotors, so that they do
not depend on the number of processes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from hapgrid.apps.common.arrays import Array

from . import ensemble, geometry, holding, rotors, torsion_paths, torsions
from .holding import Hold
from .molecule import listed
from .results import Dropped, Path, Point, Result
from .search import Search
from .xtb import BOHR

if TYPE_CHECKING:
    from .steps import Start

Stationary: TypeAlias = tuple[str, float, Array]  # kind, energy and shape
RESTARTS = 4
HOLDS = 3  # atoms that are tried, where nothing moves the first
TURNED = 60  # degrees: a bond that turns farther gives another conformation
LOWER = 0.5  # kJ/mol: a minimum that is lower by this is another one


def explore(start: Start, shapes: Sequence[tuple[int, Array]]) -> Result:
    """The Result of a molecule. shapes: of an ensemble, as Search has them. An atom that is held is one that a path moves."""
    given = start.molecule.positions
    result = _held(start, shapes)
    turned = []
    for t in [] if start.search or shapes else [t for t in start.turning if not t.rotor]:
        old, new = (float(np.degrees(geometry.torsion(x, *t.atoms))) for x in (given, result.x))
        if abs((new - old + 180) % 360 - 180) > TURNED:
            turned.append(f"{t.name} from {old:.0f} to {new:.0f} degrees")
    if turned:
        start.folder.say(f"  the conformation is not the shape that was given: {listed(turned)}")
    return result


def _held(start: Start, shapes: Sequence[tuple[int, Array]]) -> Result:
    o = start.options
    if o.push:
        return _explored(start, shapes, None)
    holds = holding.candidates(start.molecule, start.turning, o.hold, start.molecule.positions / BOHR)
    result = None
    for hold in holds[:1 if shapes else HOLDS]:
        result = _explored(start, shapes, hold)
        if result.found:
            break
        start.folder.say(f"  no bond leads {holding.words(start.molecule, hold.atoms)} over a barrier")
    return result or _explored(start, shapes, None)


def _explored(start: Start, shapes: Sequence[tuple[int, Array]], hold: Hold | None) -> Result:
    o, keep = start.options, not start.search
    what, method = ("following torsions from minimum to minimum", torsion_paths.whole) if o.goes_on else (
        "driving torsions to their barriers", Search.to_barrier)
    for left in reversed(range(1 if o.keep_conformation else RESTARTS + 1)):
        search, found = Search(start, shapes, hold), {}
        search.find_conformation(keep)
        search.say("conformation: a minimum, " + start.method)
        minima = _minima(search) if shapes else []
        if minima:
            return _ensemble(search, minima)
        for job, one in search.each(what, method, search.jobs, Path):
            found[job] = one
            if isinstance(one, Dropped):
                search.say(f"{job}: {one.why}")
                continue
            points = _points(one)
            search.say(f"{job}: {_words(search, points)}")
            lowest = min((p for p in points if p[0] == "minimum" and search.intact(p[2]) and
                          not start.isomer.differs(p[2])), key=lambda p: round(p[1], 6),
                         default=None)
            if lowest and search.above(lowest[1]) < -LOWER:
                search.say(f"{job} leads to a minimum that is {-search.above(lowest[1]):.1f} kJ/mol lower"
                           + ": from there once more" * (left > 0))
                if left:
                    break
        else:
            return _turned(search, found)
        start.molecule.positions = lowest[2] * BOHR
        keep = True
    raise AssertionError("the last start does not look for another")


def _points(one: Path) -> list[Stationary]:
    """[(kind, energy, shape)] of all that is stationary on the way of a Path, behind its barrier as well."""
    if one.goes_on or one.near is None or one.far is None:
        return one.points()
    return [("minimum", one.near.energy, one.near.x), ("saddle", one.energies[-1], one.nodes[-1]),
            ("minimum", one.far.energy, one.far.x)]


def _words(search: Search, points: Sequence[Stationary]) -> str:
    return ", ".join(f"{kind} {round(search.above(energy), 1) + 0:.1f}" for kind, energy, _ in points) + " kJ/mol"


def _turned(search: Search, found: Mapping[str, Path | Dropped]) -> Result:
    """The Result of {job: its Path or Dropped}, with each saddle once."""
    basins = search.start.options.goes_on
    ways = {job: one for job, one in found.items() if not isinstance(one, Dropped)}
    dropped = {job: one for job, one in found.items() if isinstance(one, Dropped)}
    free = {search.jobs[job][0].name for job, one in dropped.items() if one.free}
    named, other = rotors.names(search.torsions, {
        job: rotors.candidate(search.torsions, search.jobs[job][0], way, free) for job, way in ways.items()},
        set(search.jobs), not basins)
    paths: list[Path] = []
    for one in (replace(ways[job], name=name) for job, name in named.items()):
        same = next((k.name for k in paths if not basins and search.same(k.nodes[-1], one.nodes[-1])), None)
        if one.why:
            search.say(f"{one.name}: no path: {one.why}")
        if one.why or same:
            other.append((one.name, one.why or f"the saddle of {same}"))
        else:
            paths.append(one)
    if search.start.options.push and basins:
        other += [(t.name, "the same shape lies behind its barrier") for t in search.driven if t.rotor]
    return search.result(paths, [(job, one.why) for job, one in dropped.items()] + other)


# Paths between the minima of an ensemble

def _minima(search: Search) -> list[tuple[int, Point]]:
    """[(frame, minimum)] of the ensemble that are not the conformation, each once."""
    say = search.say
    out: list[tuple[int, Point]] = []
    each = search.each("relaxing the ensemble", ensemble.minimum, [x for _, x in search.shapes], Point)
    for (frame, _), (_, one) in zip(search.shapes, each):
        if isinstance(one, Dropped):
            say(f"frame {frame}: {one.why}")
        elif not any(search.same(one.x, x) for x in (search.x, *(other.x for _, other in out))):
            out.append((frame, one))
            say(f"frame {frame}: a minimum, {search.above(one.energy):.1f} kJ/mol")
    if not out:
        say("the ensemble has no other minimum than the conformation, so the bonds are turned")
    return out


def _ensemble(search: Search, minima: list[tuple[int, Point]]) -> Result:
    """The Result of paths to these minima. A path that turns one bond alone, and no ring, has its name."""
    say = search.say
    found: list[Path] = []
    dropped: list[tuple[str, str]] = []
    ways = search.each("looking for paths between the minima", ensemble.path_to, [one for _, one in minima], Path)
    for (frame, one), (_, way) in zip(minima, list(ways)):
        name = f"to-{frame}"
        passed = next((f.name for f in found for k in f.minima() if search.same(f.nodes[k], one.x)), None)
        if passed is not None or isinstance(way, Dropped):
            dropped.append((name, way.why if passed is None else f"{passed} leads there"))
            continue
        turns = torsions.turned(search.torsions, way.nodes)[1]
        turning = [t.name for t, turn in zip(search.torsions, turns) if turn >= torsions.LEAST_TURN]
        flips = [f"the ring {word}" for word in rotors.flipped(search.molecule, way.nodes)]
        if len(turning) == 1 and not flips and turning[0] not in [f.name for f in found]:
            name = turning[0]
        found.append(replace(way, name=name))
        what = ", ".join(flips + turning) or "no bond"
        say(f"frame {frame}: {name}, on which {what} turns: {_words(search, way.points())}")
    for name, why in dropped:
        say(f"{name}: no path: {why}")
    return search.result(found, dropped)
