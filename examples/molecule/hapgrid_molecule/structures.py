"""The conformation, the saddles around it and the paths to them, in several processes.

What one process finds is kept as a file (search.Search); the results are taken in the order of the rotors, so that they do
not depend on the number of processes.
"""

import multiprocessing

from hapgrid_command.programs import end_with_parent

from . import naming, rotors, torsions
from .results import Dropped, Path, Way
from .search import SAME_ENERGY, Search
from .xtb import BOHR, HARTREE

RESTARTS = 4
LOWER = 0.5  # kJ/mol: a minimum that is lower by this is another one

_search = None  # of this process and of those that it starts


def _ask(question):
    method, value = question
    return method(_search, value)


def _each(search, what, method, values):
    """(value, method(search, value)) in the order of the values."""
    global _search
    _search, values = search, list(values)
    if not values:
        return
    tell = search.options.folder.counted(what, len(values))
    with multiprocessing.get_context("fork").Pool(min(search.options.threads, len(values)), end_with_parent) as pool:
        for done, result in enumerate(pool.imap(_ask, [(method, value) for value in values]), 1):
            tell(done)
            yield values[done - 1], result


def explore(molecule, driven, options):
    """The Result of a molecule. driven: the bonds that are turned; options: search.Options."""
    keep = not options.search
    look, finish = (_beyond, _basins) if options.basins else (_saddles, _paths)
    restarts = 0 if options.keep_conformation else RESTARTS
    for start in range(restarts + 1):
        search = Search(molecule, rotors.find(molecule)[0], driven, options)
        search.find_conformation(keep, lambda starts: _relaxed(search, starts))
        options.folder.say("  conformation: a minimum" + (f", {options.method}" if start == 0 else ""))
        minima = _minima(search) if options.ensemble else []
        if minima:
            return _ensemble(search, minima)
        found, lower = look(search, start < restarts)
        if start == restarts or lower is None:
            break
        name, shape, below = lower
        options.folder.say(f"  {name} leads to a minimum that is {below:.1f} kJ/mol lower: from there once more")
        molecule.positions = shape * BOHR
        keep = True
    return finish(search, found)


def _relaxed(search, starts):
    out = []
    for _, one in _each(search, "relaxing conformers", Search.relax, starts):
        out.append(one)
        if one[-1]:
            search.options.folder.say(f"  conformer {len(out)}: left out: {one[-1]}")
    return out


def _points(search, way):
    return ", ".join(f"{kind} {search.above(way.energies[k]):.1f}" for k, kind in way.kinds.items()) + " kJ/mol"


def _path(name, way, **more):
    return Path(**{**vars(way), "name": name, "torsion": name, **more})


# Paths to barriers

def _saddles(search, may_restart):
    """({number of a job: (its saddle, its Ends)}, (name, shape, kJ/mol below) of the first lower minimum or None)."""
    tops, say = {}, search.options.folder.say
    for n, (top, ends) in _each(search, "driving torsions to their barriers", Search.saddle, range(len(search.jobs))):
        tops[n] = top, ends
        if isinstance(ends, Dropped):
            say(f"  {_name(search, n)}: {ends.why}")
            continue
        say(f"  {_name(search, n)}: barrier {search.above(top.energy):.1f} kJ/mol, "
            f"behind it {search.above(ends.far.energy):.1f}")
        for side in (ends.near, ends.far):
            below = -search.above(side.energy)
            if may_restart and below > LOWER and search.intact(side.x):
                return tops, (_name(search, n), side.x, below)
    return tops, None


def _name(search, number):
    torsion, sign = search.jobs[number]
    return torsion.file_name(sign)


def _paths(search, tops):
    """The Result of paths to the saddles, each saddle once."""
    found, wanted, lower = [], {}, []
    dropped = [(_name(search, n), ends.why) for n, (_, ends) in tops.items() if isinstance(ends, Dropped)]
    free = {search.jobs[n][0].name for n, (top, _) in tops.items() if isinstance(top, Dropped) and top.free}
    candidates = {n: naming.candidate(search.torsions, search.jobs[n][0], _name(search, n),
                                      Way([search.x, top.x], [top.energy]), free)
                  for n, (top, ends) in tops.items() if not isinstance(ends, Dropped)}
    allowed = {name for torsion in search.driven for name in torsion.file_names()}
    named, other = naming.names(search.torsions, candidates, allowed, True)
    dropped += other
    for n, name in named.items():
        top = tops[n][0]
        same = next((known for m, known in wanted.items()
                     if abs(top.energy - tops[m][0].energy) * HARTREE <= SAME_ENERGY and search.same(top.x, tops[m][0].x)), None)
        if same is not None:
            dropped.append((name, f"the saddle of {same}"))
        else:
            wanted[n] = name
    for n, way in _each(search, "following paths to the barriers", Search.path, sorted(wanted)):
        name, (top, ends) = wanted[n], tops[n]
        if isinstance(way, Dropped):
            dropped.append((name, way.why))
            search.options.folder.say(f"  {name}: no path: {way.why}")
            continue
        bond = name.removesuffix("-plus").removesuffix("-minus")
        found.append(_path(name, way, torsion=bond, nu1=top.nu1, far=ends.far, equal=ends.equal))
        if -search.above(ends.far.energy) > LOWER:
            lower.append((name, -search.above(ends.far.energy)))
    return search.result(found, dropped, lower)


# Paths that go on behind their saddles

def _beyond(search, may_restart):
    """({number of a torsion: its way on behind its saddles}, the first lower minimum as of _saddles())."""
    ways = {}
    numbers = [n for n, t in enumerate(search.driven) if not t.rotor]
    for n, way in _each(search, "following torsions from minimum to minimum", Search.beyond, numbers):
        ways[n] = way
        name = search.driven[n].name
        search.options.folder.say(f"  {name}: " + (way.why if isinstance(way, Dropped) else _points(search, way)))
        if isinstance(way, Dropped):
            continue
        below, k = max((-search.above(way.energies[k]), k) for k in way.minima())
        if may_restart and below > LOWER:
            return ways, (name, way.nodes[k], below)
    return ways, None


def _basins(search, ways):
    """The Result of these. Behind the saddle of a methyl group is the same shape once more."""
    dropped = [(t.name, "the same shape lies behind its barrier") for t in search.driven if t.rotor]
    dropped += [(search.driven[n].name, way.why) for n, way in ways.items() if isinstance(way, Dropped)]
    free = {search.driven[n].name for n, way in ways.items() if isinstance(way, Dropped) and way.free}
    candidates = {n: naming.candidate(search.torsions, search.driven[n], search.driven[n].name, way, free)
                  for n, way in ways.items() if not isinstance(way, Dropped)}
    named, other = naming.names(search.torsions, candidates, {t.name for t in search.driven if not t.rotor}, False)
    found = [_path(name, ways[n]) for n, name in named.items()]
    lower = [(one.name, -search.above(min(one.energies))) for one in found]
    return search.result(found, dropped + other, [one for one in lower if one[1] > LOWER])


# Paths between the minima of an ensemble

def _minima(search):
    """[(frame, minimum)] of the ensemble that are not the conformation, each once."""
    out, say = [], search.options.folder.say
    shapes = [x for _, x in search.options.ensemble]
    for (frame, _), (_, one) in zip(search.options.ensemble, _each(search, "relaxing the ensemble", Search.minimum, shapes)):
        if isinstance(one, Dropped):
            say(f"  frame {frame}: {one.why}")
        elif not any(search.same(one.x, x) for x in (search.x, *(other.x for _, other in out))):
            out.append((frame, one))
            say(f"  frame {frame}: a minimum, {search.above(one.energy):.1f} kJ/mol")
    if not out:
        say("  the ensemble has no other minimum than the conformation, so the bonds are turned")
    return out


def _ensemble(search, minima):
    """The Result of paths to these minima. A path that turns one bond alone, and no ring, has its name."""
    found, dropped, say = [], [], search.options.folder.say
    ways = _each(search, "looking for paths between the minima", Search.between, [one for _, one in minima])
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
        say(f"  frame {frame}: {name}, on which {', '.join(flips + turning) or 'no bond'} turns: {_points(search, way)}")
    for name, why in dropped:
        say(f"  {name}: no path: {why}")
    return search.result(found, dropped)
