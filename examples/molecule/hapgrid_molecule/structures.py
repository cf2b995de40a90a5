"""The conformation, the saddles around it and the paths to them, in several processes.

What one process finds is kept as a file (work.Steps); the results are taken in the order of the
rotors, so that they do not depend on the number of processes.
"""

import multiprocessing
from dataclasses import dataclass, field

import numpy as np
from hapgrid_command.files import read_text
from hapgrid_command.programs import end_with_parent

from . import beyond, ensemble, files, geometry, naming, rotors, torsions, work, xyz
from .elements import MASSES
from .molecule import BadInput
from .xtb import BOHR, HARTREE, SYMBOLS
from .xyz import frames

RESTARTS = 4
LOWER = 0.5  # kJ/mol: a minimum that is lower by this is another one


@dataclass
class Options:
    """work: work.Options; search: whether conformers are searched; keep_conformation: whether lower minima are left
    alone; basins: whether paths go on behind their saddles; ensemble: shapes in angstrom by the numbers of their frames,
    between which paths are looked for instead, [(number, x)]."""
    work: work.Options
    search: bool
    keep_conformation: bool
    basins: bool
    threads: int
    ensemble: list = field(default_factory=list)


@dataclass
class Found:
    """result: work.Result; lower: (path, kJ/mol below the conformation) of the minima from which there was no new
    start."""
    result: work.Result
    lower: list = field(default_factory=list)


_search = None  # the work.Work of this process and of those that it starts


def _conformer(shape):
    return _search.relax(shape)


def _saddle(number):
    return _search.saddle(number)


def _path(number):
    return _search.path(number)


def _beyond(number):
    torsion = _search.driven[number]

    def compute():
        one = beyond.whole(_search, torsion)
        return {"nodes": [n.tolist() for n in one.nodes], "energies": one.energies, "start": one.start,
                "kinds": list(one.kinds.items()), "why": one.why}
    return _search.kept("beyond", [torsion.atoms], compute)


def _minimum(shape):
    def compute():
        x, energy, hessian = ensemble.minimum(_search, shape)
        return {"x": x.tolist(), "energy": energy, "hessian": hessian.tolist()}
    return _search.kept("minimum", [shape.tolist()], compute)


def _between(number):
    one = _search.minima[number][1]

    def compute():
        nodes, energies, kinds = ensemble.way(_search, (np.array(one["x"]), one["energy"], np.array(one["hessian"])))
        return {"nodes": [n.tolist() for n in nodes], "energies": energies, "start": 0, "kinds": list(kinds.items())}
    return _search.kept("between", [one["x"]], compute)


def _in_processes(folder, what, function, values, threads):
    """(value, function(value)) in the order of the values."""
    if not values:
        return
    tell = folder.counted(what, len(values))
    context = multiprocessing.get_context("fork")
    with context.Pool(min(threads, len(values)), initializer=end_with_parent) as pool:
        for done, result in enumerate(pool.imap(function, values), 1):
            tell(done)
            yield values[done - 1], result


def explore(molecule, driven, options, folder):
    """The Found of a molecule. driven: the bonds that are turned; options: Options."""
    global _search
    keep = not options.search
    look, finish = (_beyond_all, _basins) if options.basins else (_saddles, _paths)
    restarts = 0 if options.keep_conformation else RESTARTS
    shapes = [] if options.keep_conformation else [x for _, x in options.ensemble]
    for start in range(restarts + 1):
        _search = search = work.Work(molecule, rotors.find(molecule)[0], driven, options.work)
        search.ensemble, search.minima = options.ensemble, []
        search.find_conformation(keep, lambda starts: _relaxed(starts, folder, options.threads), shapes)
        folder.say("  conformation: a minimum" + (f", {options.work.method}" if start == 0 else ""))
        if options.ensemble:
            ways = _between_all(search, folder, options.threads)
            if search.minima:
                return _ensemble(search, ways, folder)
        tops, lower = look(search, folder, options.threads, start < restarts)
        if start == restarts or lower is None:
            break
        name, shape, below = lower
        folder.say(f"  {name} leads to a minimum that is {below:.1f} kJ/mol lower: from there once more")
        molecule.positions = shape * BOHR
        keep = True
    return finish(search, tops, folder, options.threads)


def _relaxed(starts, folder, threads):
    out = []
    for _, one in _in_processes(folder, "relaxing conformers", _conformer, starts, threads):
        out.append(one)
        if one[-1]:
            folder.say(f"  conformer {len(out)}: left out: {one[-1]}")
    return out


def _beyond_all(search, folder, threads, may_restart):
    """({number of a torsion: its way on behind its saddles}, the first lower minimum)."""
    ways = {}
    numbers = [n for n, t in enumerate(search.driven) if not t.rotor]
    for n, way in _in_processes(folder, "following torsions from minimum to minimum", _beyond, numbers, threads):
        ways[n] = way
        name = search.driven[n].name
        if "dropped" in way:
            folder.say(f"  {name}: {way['dropped']}")
            continue
        kinds = dict(way["kinds"])
        points = ", ".join(f"{kind} {search.above(way['energies'][k]):.1f}" for k, kind in kinds.items())
        folder.say(f"  {name}: {points} kJ/mol")
        below, k = max((-search.above(way["energies"][k]), k) for k, kind in kinds.items() if kind == "minimum")
        if may_restart and below > LOWER:
            return ways, (name, np.array(way["nodes"][k]), below)
    return ways, None


def _basins(search, ways, folder, threads):
    """The Found of paths that go on behind their saddles. Behind the saddle of a methyl group is the same
    shape once more."""
    found, lower = [], []
    dropped = [(t.name, "the same shape lies behind its barrier") for t in search.driven if t.rotor]
    dropped += [(search.driven[n].name, way["dropped"]) for n, way in ways.items() if "dropped" in way]
    ways = {n: way for n, way in ways.items() if "dropped" not in way}
    candidates = {n: search.candidate(search.driven[n], search.driven[n].name, np.array(way["nodes"]), way["energies"],
                                      True) for n, way in ways.items()}
    named, other = naming.names(search.torsions, candidates, {t.name for t in search.driven if not t.rotor}, False)
    for n, name in named.items():
        way = ways[n]
        found.append(beyond.Beyond(name, name, [np.array(x) for x in way["nodes"]], way["energies"], way["start"],
                                   dict(way["kinds"]), way["why"]))
        below = -search.above(min(way["energies"]))
        if below > LOWER:
            lower.append((name, below))
    return Found(search.result(found, _without(found, dropped + other)), lower)


def _without(found, dropped):
    """The dropped names without those that a path has, whose bond it turns though another one was driven."""
    have = {one.name for one in found}
    return [(name, why) for name, why in dropped if name not in have]


def _between_all(search, folder, threads):
    """{number of a minimum of the ensemble: its way}. Sets the minima that are not the conformation, each once."""
    shapes = [x for _, x in search.ensemble]
    frames_of = iter([number for number, _ in search.ensemble])
    for _, one in _in_processes(folder, "relaxing the ensemble", _minimum, shapes, threads):
        frame = next(frames_of)
        if "dropped" in one:
            folder.say(f"  frame {frame}: {one['dropped']}")
            continue
        x = np.array(one["x"])
        if not any(search.same(x, other) for other in (search.x, *(np.array(m["x"]) for _, m in search.minima))):
            search.minima.append((frame, one))
            folder.say(f"  frame {frame}: a minimum, {search.above(one['energy']):.1f} kJ/mol")
    if not search.minima:
        folder.say("  the ensemble has no other minimum than the conformation, so the bonds are turned")
    return dict(_in_processes(folder, "looking for paths between the minima", _between, range(len(search.minima)), threads))


def _ensemble(search, ways, folder):
    """The Found of paths to the other minima of an ensemble. A path that turns one bond alone, and no ring, has its name."""
    found, dropped = [], []
    for n, way in ways.items():
        frame, one = search.minima[n]
        name = f"to-{frame}"
        passed = next((f.name for f in found for k, kind in f.kinds.items()
                       if kind == "minimum" and search.same(f.nodes[k], np.array(one["x"]))), None)
        if passed is not None:
            dropped.append((name, f"{passed} leads there"))
        elif "dropped" in way:
            dropped.append((name, way["dropped"]))
        else:
            kinds = dict(way["kinds"])
            nodes = [np.array(x) for x in way["nodes"]]
            turns = torsions.turned(search.torsions, nodes)[1]
            turning = [t.name for t, turn in zip(search.torsions, turns) if turn >= torsions.LEAST_TURN]
            flips = [f"the ring {word}" for word in rotors.flipped(search.molecule, nodes)]
            if len(turning) == 1 and not flips and turning[0] not in [f.name for f in found]:
                name = turning[0]
            found.append(beyond.Beyond(name, name, nodes, way["energies"], 0, kinds, f"the minimum of frame {frame}"))
            points = ", ".join(f"{kind} {search.above(way['energies'][k]):.1f}" for k, kind in kinds.items())
            folder.say(f"  frame {frame}: {name}, on which {', '.join(flips + turning) or 'no bond'} turns: {points} kJ/mol")
    for name, why in dropped:
        folder.say(f"  {name}: no path: {why}")
    return Found(search.result(found, dropped))


def _name(search, number):
    torsion, sign = search.jobs[number]
    return torsion.file_name(sign)


def _saddles(search, folder, threads, may_restart):
    """({number of a job: (its saddle, the minima that it joins)}, the first lower minimum)."""
    tops = {}
    for n, (top, ends) in _in_processes(folder, "driving torsions to their barriers", _saddle,
                                        range(len(search.jobs)), threads):
        tops[n] = top, ends
        if "dropped" in ends:
            folder.say(f"  {_name(search, n)}: {ends['dropped']}")
            continue
        folder.say(f"  {_name(search, n)}: barrier {search.above(top['energy']):.1f} kJ/mol, "
                   f"behind it {search.above(ends['far_energy']):.1f}")
        for side in ("near", "far"):
            below = -search.above(ends[side + "_energy"])
            shape = np.array(ends[side])
            if may_restart and below > LOWER and search.intact(shape):
                return tops, (_name(search, n), shape, below)
    return tops, None


def _paths(search, tops, folder, threads):
    found, known, lower = [], {}, []
    dropped = [(_name(search, n), ends["dropped"]) for n, (_, ends) in tops.items() if "dropped" in ends]
    named, other = search.named({n: top for n, (top, ends) in tops.items() if "dropped" not in ends})
    dropped += other
    wanted = []
    for n, name in named.items():
        top = tops[n][0]
        same = search.one_of(top, known)
        if same is not None:
            dropped.append((name, f"the saddle of {same}"))
            continue
        known[name] = top
        wanted.append(n)
    for n, way in _in_processes(folder, "following paths to the barriers", _path, sorted(wanted), threads):
        name = named[n]
        if "dropped" in way:
            dropped.append((name, way["dropped"]))
            folder.say(f"  {name}: no path: {way['dropped']}")
            continue
        found.append(search.found(n, name, way))
        below = -search.above(way["far_energy"])
        if below > LOWER:
            lower.append((name, below))
    return Found(search.result(found, _without(found, dropped)), lower)


class PathFile:
    """A path as its file has it. nodes in bohr, energies in hartree above the conformation, which is the node `start`."""

    def __init__(self, name, path, conformation):
        words, symbols, at = conformation
        read = frames(path)
        if any(own != symbols for _, own, _ in read):
            raise BadInput(f"{path}: has other atoms than the conformation")
        self.name = name
        self.nodes = [x / BOHR for _, _, x in read]
        self.energies = [xyz.above(own, words, f"{path} frame {n}") / HARTREE for n, (own, _, _) in enumerate(read, 1)]
        if len(read) == 1:  # only the transition state
            self.nodes.insert(0, at / BOHR)
            self.energies.insert(0, 0.0)
        even = np.ones(len(at))
        self.start = int(np.argmin([geometry.rms(geometry.aligned(x, at / BOHR, even), at / BOHR) for x in self.nodes]))
        self.barrier = max(self.energies)


class Structures:
    """What the files of the folder say, changed by hand or not. Energies above the conformation."""

    def __init__(self, folder):
        conformation = frames(folder.path("conformation.xyz"))[0]
        _, symbols, x = conformation
        strange = sorted(set(symbols) - {SYMBOLS[z] for z in MASSES})
        if strange:
            raise BadInput(f"{folder.path('conformation.xyz')}: {strange[0]} is no element that can be felt")
        self.numbers = [SYMBOLS.index(s) for s in symbols]
        self.x, self.energy = x / BOHR, 0.0
        report = folder.path("report.tsv")
        self.found = [PathFile(name[:-4], folder.path(name), conformation) for name in files.listed(report)]
        rows = [line.split(": ", 2) for line in read_text(report).splitlines() if line.startswith("# no path: ")]
        self.dropped = [(row[1], row[2]) for row in rows if len(row) == 3]
