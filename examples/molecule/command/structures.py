"""The conformation, the saddles around it and the paths to them, in several processes.

What one process finds is kept as a file (work.Steps); the results are taken in the order of the
rotors, so that they do not depend on the number of processes.
"""

import multiprocessing
import signal
import time
from dataclasses import dataclass, field

import numpy as np
from preparation import beyond, files, work
from preparation.xtb import BOHR, HARTREE

RESTARTS = 4
LOWER = 0.5  # kJ/mol: a minimum that is lower by this is another one


@dataclass
class Options:
    """work: work.Options; search: whether conformers are searched; keep_conformation: whether lower minima are left
    alone; basins: whether paths go on behind their saddles."""
    work: work.Options
    search: bool
    keep_conformation: bool
    basins: bool
    threads: int


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
    return _search.kept("beyond", torsion, 0, compute)


def _in_processes(stages, what, function, values, threads):
    """(value, function(value)) in the order of the values."""
    if not values:
        return
    began = time.monotonic()
    stages.progress(what, 0, len(values), began)
    context = multiprocessing.get_context("fork")
    with context.Pool(min(threads, len(values)), initializer=_worker) as pool:
        for done, result in enumerate(pool.imap(function, values), 1):
            stages.progress(what, done, len(values), began)
            yield values[done - 1], result


def _worker():
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process ends the others


def explore(molecule, rotors, options, stages):
    """The Found of a molecule. options: Options."""
    global _search
    keep = not options.search
    look, finish = (_beyond_all, _basins) if options.basins else (_saddles, _paths)
    restarts = 0 if options.keep_conformation else RESTARTS
    for start in range(restarts + 1):
        _search = search = work.Work(molecule, rotors, options.work)
        search.find_conformation(keep, lambda starts: _relaxed(starts, stages, options.threads))
        stages.say("  conformation: a minimum" + (f", {options.work.method}" if start == 0 else ""))
        tops, lower = look(search, stages, options.threads, start < restarts)
        if start == restarts or lower is None:
            break
        name, shape, below = lower
        stages.say(f"  {name} leads to a minimum that is {below:.1f} kJ/mol lower: from there once more")
        molecule.positions = shape * BOHR
        keep = True
    return finish(search, tops, stages, options.threads)


def _relaxed(starts, stages, threads):
    out = []
    for _, one in _in_processes(stages, "relaxing conformers", _conformer, starts, threads):
        out.append(one)
        if one[-1]:
            stages.say(f"  conformer {len(out)}: left out: {one[-1]}")
    return out


def _beyond_all(search, stages, threads, may_restart):
    """({number of a torsion: its way on behind its saddles}, the first lower minimum)."""
    ways = {}
    numbers = [n for n, t in enumerate(search.driven) if not t.rotor]
    for n, way in _in_processes(stages, "following torsions from minimum to minimum", _beyond, numbers, threads):
        ways[n] = way
        name = search.driven[n].name
        if "dropped" in way:
            stages.say(f"  {name}: {way['dropped']}")
            continue
        kinds = dict(way["kinds"])
        points = ", ".join(f"{kind} {search.above(way['energies'][k]):.1f}" for k, kind in kinds.items())
        stages.say(f"  {name}: {points} kJ/mol")
        below, k = max((-search.above(way["energies"][k]), k) for k, kind in kinds.items() if kind == "minimum")
        if may_restart and below > LOWER:
            return ways, (name, np.array(way["nodes"][k]), below)
    return ways, None


def _basins(search, ways, stages, threads):
    """The Found of paths that go on behind their saddles. Behind the saddle of a methyl group is the same
    shape once more."""
    found, lower = [], []
    dropped = [(t.name, "the same shape lies behind its barrier") for t in search.driven if t.rotor]
    for n, way in ways.items():
        name = search.driven[n].name
        if "dropped" in way:
            dropped.append((name, way["dropped"]))
            continue
        found.append(beyond.Beyond(name, name, [np.array(x) for x in way["nodes"]], way["energies"], way["start"],
                                   dict(way["kinds"]), way["why"]))
        below = -search.above(min(way["energies"]))
        if below > LOWER:
            lower.append((name, below))
    return Found(search.result(found, dropped), lower)


def _name(search, number):
    torsion, sign = search.jobs[number]
    return torsion.file_name(sign)


def _saddles(search, stages, threads, may_restart):
    """({number of a job: (its saddle, the minima that it joins)}, the first lower minimum)."""
    tops = {}
    for n, (top, ends) in _in_processes(stages, "driving torsions to their barriers", _saddle,
                                        range(len(search.jobs)), threads):
        tops[n] = top, ends
        if "dropped" in ends:
            stages.say(f"  {_name(search, n)}: {ends['dropped']}")
            continue
        stages.say(f"  {_name(search, n)}: barrier {search.above(top['energy']):.1f} kJ/mol, "
                   f"behind it {search.above(ends['far_energy']):.1f}")
        for side in ("near", "far"):
            below = -search.above(ends[side + "_energy"])
            shape = np.array(ends[side])
            if may_restart and below > LOWER and search.intact(shape):
                return tops, (_name(search, n), shape, below)
    return tops, None


def _paths(search, tops, stages, threads):
    dropped, found, known, lower = [], [], {}, []
    wanted = []
    for n, (top, ends) in tops.items():
        name = _name(search, n)
        if "dropped" in ends:
            dropped.append((name, ends["dropped"]))
            continue
        other = search.one_of(top, known)
        if other is not None:
            dropped.append((name, f"the saddle of {other}"))
            continue
        known[name] = top
        wanted.append(n)
    for n, way in _in_processes(stages, "following paths to the barriers", _path, wanted, threads):
        name = _name(search, n)
        if "dropped" in way:
            dropped.append((name, way["dropped"]))
            stages.say(f"  {name}: no path: {way['dropped']}")
            continue
        found.append(search.found(n, way))
        below = -search.above(way["far_energy"])
        if below > LOWER:
            lower.append((name, below))
    return Found(search.result(found, dropped), lower)


def least_t(path):
    """Of a path's file: below 0 where the conformation is inside."""
    rises = [float(words.get("dE", "nan")) for words, _, _ in files.frames(path)]
    return -rises.index(0) / (len(rises) - 1) if 0 in rises else 0.0


class PathFile:
    """A path as its file has it. nodes in bohr, energies in hartree above the conformation."""

    def __init__(self, name, frames):
        self.name = name
        self.nodes = [x / BOHR for _, _, x in frames]
        self.energies = [float(words["dE"]) / HARTREE for words, _, _ in frames]
        self.barrier = max(self.energies)


class Structures:
    """What the files of the folder say, changed by hand or not. Energies above the conformation."""

    def __init__(self, stages):
        _, self.numbers, x = files.frames(stages.path("conformation.xyz"))[0]
        self.x, self.energy = x / BOHR, 0.0
        report = stages.path("report.tsv")
        self.found = [PathFile(name[:-4], files.frames(stages.path(name))) for name in files.listed(report)]
        with open(report, encoding="utf-8") as file:
            rows = [line.rstrip("\n").split(": ", 2) for line in file if line.startswith("# no path: ")]
        self.dropped = [(row[1], row[2]) for row in rows]
