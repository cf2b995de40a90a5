"""The conformation, the saddles around it and the paths to them, in several processes.

What one process finds is kept as a file (search.Search); the results are taken in the order of the rotors, so that they do
not depend on the number of processes.
"""

from . import rotors, torsions
from .results import Dropped, Path, Way
from .search import SAME_ENERGY, Search
from .xtb import BOHR, HARTREE

RESTARTS = 4
LOWER = 0.5  # kJ/mol: a minimum that is lower by this is another one


def explore(start, shapes):
    """The Result of a molecule. shapes: of an ensemble, as Search has them."""
    o = start.options
    look, finish = (_beyond, _basins) if o.basins else (_saddles, _paths)
    keep = not start.search
    for left in reversed(range(1 if o.keep_conformation else RESTARTS + 1)):
        search = Search(start, shapes)
        search.find_conformation(keep)
        search.say("conformation: a minimum, " + start.method)
        minima = _minima(search) if shapes else []
        if minima:
            return _ensemble(search, minima)
        found, lower = look(search, left > 0)
        if left == 0 or lower is None:
            return finish(search, found)
        name, shape, below = lower
        search.say(f"{name} leads to a minimum that is {below:.1f} kJ/mol lower: from there once more")
        start.molecule.positions = shape * BOHR
        keep = True


def _points(search, way):
    return ", ".join(f"{kind} {search.above(way.energies[k]):.1f}" for k, kind in way.kinds.items()) + " kJ/mol"


def _path(name, way, **more):
    return Path(**{**vars(way), "name": name, **more})


def _named(search, found, allowed, signed):
    """rotors.names() of {what was driven: (its torsion, its Way or the Dropped)}, with what is dropped."""
    dropped = [(job, way.why) for job, (_, way) in found.items() if isinstance(way, Dropped)]
    free = {torsion.name for torsion, way in found.values() if isinstance(way, Dropped) and way.free}
    named, other = rotors.names(search.torsions, {
        job: rotors.candidate(search.torsions, torsion, way, free)
        for job, (torsion, way) in found.items() if not isinstance(way, Dropped)}, allowed, signed)
    return named, dropped + other


def _say_lower(search, name, energy):
    if -search.above(energy) > LOWER:
        search.say(f"{name} leads to a minimum that is {-search.above(energy):.1f} kJ/mol lower")


# Paths to barriers

def _saddles(search, may_restart):
    """({job: its Ends}, (name, shape, kJ/mol below) of the first lower minimum or None)."""
    tops = {}
    for job, ends in search.each("driving torsions to their barriers", Search.saddle, search.jobs):
        tops[job] = ends
        if isinstance(ends, Dropped):
            search.say(f"{job}: {ends.why}")
            continue
        search.say(f"{job}: barrier {search.above(ends.saddle.energy):.1f} kJ/mol, "
                   f"behind it {search.above(ends.far.energy):.1f}")
        for side in (ends.near, ends.far):
            if may_restart and search.above(side.energy) < -LOWER and search.intact(side.x):
                return tops, (job, side.x, -search.above(side.energy))
    return tops, None


def _paths(search, tops):
    """The Result of paths to the saddles, each saddle once."""
    found, wanted = [], {}
    named, dropped = _named(search, {job: (search.jobs[job][0], ends if isinstance(ends, Dropped) else
                                           Way([search.x, ends.saddle.x], [ends.saddle.energy])) for job, ends in tops.items()},
                            {name for torsion in search.driven for name in torsion.file_names()}, True)
    for job, name in named.items():
        top = tops[job].saddle
        same = next((known for known, other in ((known, tops[other].saddle) for other, known in wanted.items())
                     if abs(top.energy - other.energy) * HARTREE <= SAME_ENERGY and search.same(top.x, other.x)), None)
        if same is not None:
            dropped.append((name, f"the saddle of {same}"))
        else:
            wanted[job] = name
    for job, way in search.each("following paths to the barriers", Search.path, [job for job in tops if job in wanted]):
        name, ends = wanted[job], tops[job]
        if isinstance(way, Dropped):
            dropped.append((name, way.why))
            search.say(f"{name}: no path: {way.why}")
            continue
        found.append(_path(name, way, nu1=ends.saddle.nu1, far=ends.far, equal=ends.equal))
        _say_lower(search, name, ends.far.energy)
    return search.result(found, dropped)


# Paths that go on behind their saddles

def _beyond(search, may_restart):
    """({torsion: its way on behind its saddles}, the first lower minimum as of _saddles())."""
    ways = {}
    turning = [torsion for torsion in search.driven if not torsion.rotor]
    for torsion, way in search.each("following torsions from minimum to minimum", Search.beyond, turning):
        ways[torsion] = way
        search.say(f"{torsion.name}: " + (way.why if isinstance(way, Dropped) else _points(search, way)))
        if isinstance(way, Dropped):
            continue
        k = max(way.minima(), key=lambda k: (-way.energies[k], k))
        if may_restart and search.above(way.energies[k]) < -LOWER:
            return ways, (torsion.name, way.nodes[k], -search.above(way.energies[k]))
    return ways, None


def _basins(search, ways):
    """The Result of these. Behind the saddle of a methyl group is the same shape once more."""
    by_name = {torsion.name: (torsion, way) for torsion, way in ways.items()}
    named, dropped = _named(search, by_name, {t.name for t in search.driven if not t.rotor}, False)
    same = [(t.name, "the same shape lies behind its barrier") for t in search.driven if t.rotor]
    found = [_path(name, by_name[job][1]) for job, name in named.items()]
    for one in found:
        _say_lower(search, one.name, min(one.energies))
    return search.result(found, same + dropped)


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
        found.append(_path(name, way, why=f"the minimum of frame {frame}"))
        say(f"frame {frame}: {name}, on which {', '.join(flips + turning) or 'no bond'} turns: {_points(search, way)}")
    for name, why in dropped:
        say(f"{name}: no path: {why}")
    return search.result(found, dropped)
