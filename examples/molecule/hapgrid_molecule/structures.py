"""The conformation, the saddles around it and the paths to them, in several processes.

What one process finds is kept as a file (search.Search); the results are taken in the order of the rotors, so that they do
not depend on the number of processes.
"""

from . import rotors, torsions
from .results import Dropped, Path, Way
from .search import Search
from .xtb import BOHR

RESTARTS = 4
LOWER = 0.5  # kJ/mol: a minimum that is lower by this is another one


def explore(start, shapes):
    """The Result of a molecule. shapes: of an ensemble, as Search has them."""
    o = start.options
    what, method, finish = ("following torsions from minimum to minimum", Search.beyond, _basins) if o.basins else (
        "driving torsions to their barriers", Search.saddle, _paths)
    keep = not start.search
    for left in reversed(range(1 if o.keep_conformation else RESTARTS + 1)):
        search, found = Search(start, shapes), {}
        search.find_conformation(keep)
        search.say("conformation: a minimum, " + start.method)
        minima = _minima(search) if shapes else []
        if minima:
            return _ensemble(search, minima)
        for job, one in search.each(what, method, search.jobs):
            found[job] = one
            if isinstance(one, Dropped):
                search.say(f"{job}: {one.why}")
                continue
            search.say(f"{job}: {_points(search, one)}")
            sides = [(energy, x) for kind, energy, x in one.points() if kind == "minimum" and search.intact(x)]
            energy, shape = min(sides, key=lambda side: round(side[0], 6), default=(search.energy, search.x))
            if search.above(energy) < -LOWER:
                search.say(f"{job} leads to a minimum that is {-search.above(energy):.1f} kJ/mol lower"
                           + ": from there once more" * (left > 0))
                if left:
                    break
        else:
            return finish(search, found)
        start.molecule.positions = shape * BOHR
        keep = True


def _points(search, one):
    return ", ".join(f"{kind} {round(search.above(energy), 1) + 0:.1f}" for kind, energy, _ in one.points()) + " kJ/mol"


def _named(search, found, signed):
    """rotors.names() of what was found, with what is dropped."""
    dropped = {job: one for job, one in found.items() if isinstance(one, Dropped)}
    free = {search.jobs[job][0].name for job, one in dropped.items() if one.free}
    ways = {job: one if isinstance(one, Way) else Way([search.x, one.saddle.x], [one.saddle.energy])
            for job, one in found.items() if job not in dropped}
    named, other = rotors.names(search.torsions, {
        job: rotors.candidate(search.torsions, search.jobs[job][0], way, free) for job, way in ways.items()},
        set(search.jobs), signed)
    return named, [(job, one.why) for job, one in dropped.items()] + other


def _paths(search, tops):
    """The Result of paths to the saddles of {job: its Ends}, each saddle once."""
    found, wanted = [], {}
    named, dropped = _named(search, tops, True)
    for job, name in named.items():
        same = next((known for other, known in wanted.items() if search.same(tops[job].saddle.x, tops[other].saddle.x)), None)
        if same is not None:
            dropped.append((name, f"the saddle of {same}"))
        else:
            wanted[job] = name
    for job, way in search.each("following paths to the barriers", Search.path, [job for job in tops if job in wanted]):
        name, ends = wanted[job], tops[job]
        if isinstance(way, Dropped):
            dropped.append((name, way.why))
            search.say(f"{name}: no path: {way.why}")
        else:
            found.append(Path(**vars(way), name=name, nu1=ends.saddle.nu1, far=ends.far))
    return search.result(found, dropped)


def _basins(search, ways):
    """The Result of ways on behind their saddles. Behind the saddle of a methyl group is the same shape once more."""
    named, dropped = _named(search, ways, False)
    same = [(t.name, "the same shape lies behind its barrier") for t in search.driven if t.rotor]
    return search.result([Path(**vars(ways[job]), name=name) for job, name in named.items()], same + dropped)


# Paths between the minima of an ensemble

def _minima(search):
    """[(frame, minimum)] of the ensemble that are not the conformation, each once."""
    out, say = [], search.say
    each = search.each("relaxing the ensemble", Search.minimum, [x for _, x in search.shapes])
    for (frame, _), (_, one) in zip(search.shapes, each):
        if isinstance(one, Dropped):
            say(f"frame {frame}: {one.why}")
        elif not any(search.same(one.x, x) for x in (search.x, *(other.x for _, other in out))):
            out.append((frame, one))
            say(f"frame {frame}: a minimum, {search.above(one.energy):.1f} kJ/mol")
    if not out:
        say("the ensemble has no other minimum than the conformation, so the bonds are turned")
    return out


def _ensemble(search, minima):
    """The Result of paths to these minima. A path that turns one bond alone, and no ring, has its name."""
    found, dropped, say = [], [], search.say
    ways = search.each("looking for paths between the minima", Search.between, [one for _, one in minima])
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
        found.append(Path(**vars(way), name=name))
        say(f"frame {frame}: {name}, on which {', '.join(flips + turning) or 'no bond'} turns: {_points(search, way)}")
    for name, why in dropped:
        say(f"{name}: no path: {why}")
    return search.result(found, dropped)
