"""The conformation, the saddles around it and the paths to them, in several processes.

What one process finds is kept as a file (work.Steps); the results are taken in the order of the
rotors, so that they do not depend on the number of processes.
"""

import multiprocessing
import signal
import time
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
from preparation import beyond, files, work
from preparation.xtb import BOHR, HARTREE, SYMBOLS

RESTARTS = 4
LOWER = 0.5  # kJ/mol: a minimum that is lower by this is another one


@dataclass
class Options:
    """search: whether conformers are searched; highest: kJ/mol; work: folder of finished steps."""
    method: str
    charge: int
    uhf: int
    search: bool
    threads: int
    highest: float
    work: str
    basins: bool = False  # whether paths go on behind their saddles


@dataclass
class Found:
    """result: work.Result; lower: (path, kJ/mol below the conformation) where the bounded number of
    new starts did not suffice."""
    result: work.Result
    lower: list = field(default_factory=list)


class _Search(work.Work):
    def __init__(self, molecule, rotors, options, stages):
        super().__init__(molecule, rotors, options, {})
        self.stages = stages

    def say(self, text):
        if text.startswith("conformer"):
            self.stages.say("  " + text)

    def _relaxed(self, starts):
        self.starts = starts
        return [one for _, one in _in_processes(self.stages, "relaxing conformers", _conformer,
                                                list(range(len(starts))), self.options.threads)]

    def jobs(self):
        return [(t, s) for t in self.driven for s in t.signs]

    def saddle(self, number):
        """The saddle of a job and the minima that it joins; what is too long to send is left out."""
        torsion, sign = self.jobs()[number]
        name = torsion.file_name(sign)
        key = self._key(name, torsion, sign)
        top = self._kept_saddle(key, name, torsion, sign)
        if "dropped" in top:
            return top, top
        return top, self._kept_ends(key, top)

    def beyond(self, number):
        torsion = self.driven[number]

        def compute():
            one = beyond.whole(self, torsion)
            return {"nodes": [n.tolist() for n in one.nodes], "energies": one.energies, "start": one.start,
                    "kinds": list(one.kinds.items()), "why": one.why}
        return self.steps.take(["beyond", 2, *self._key(torsion.name, torsion, 0)], lambda: self._guarded(compute))

    def path(self, number):
        torsion, sign = self.jobs()[number]
        key = self._key(torsion.file_name(sign), torsion, sign)
        return self._kept_path(key, self._kept_saddle(key, None, torsion, sign))


_search = None  # of this process and of those that it starts


def _conformer(number):
    return work.Work._relaxed(_search, _search.starts[number:number + 1])[0]


def _saddle(number):
    return _search.saddle(number)


def _path(number):
    return _search.path(number)


def _beyond(number):
    return _search.beyond(number)


def _in_processes(stages, what, function, numbers, threads):
    """(number, result) in the order of the numbers."""
    if not numbers:
        return
    began = time.monotonic()
    stages.progress(what, 0, len(numbers), began)
    context = multiprocessing.get_context("fork")
    with context.Pool(min(threads, len(numbers)), initializer=_worker) as pool:
        for done, value in enumerate(pool.imap(function, numbers), 1):
            stages.progress(what, done, len(numbers), began)
            yield numbers[done - 1], value


def _worker():
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process ends the others


def explore(molecule, rotors, options, stages):
    """The Found of a molecule. options: Options."""
    global _search
    keep = not options.search
    look, finish = (_beyond_all, _basins) if options.basins else (_saddles, _paths)
    for start in range(RESTARTS + 1):
        o = SimpleNamespace(smiles=None, file="", method=options.method, charge=options.charge, uhf=options.uhf,
                            keep_conformation=keep, conformers=4, seed=1, highest=options.highest, work=options.work,
                            again=False, quiet=False, threads=options.threads, keep_equal=True, paths=None)
        _search = search = _Search(molecule, rotors, o, stages)
        search._find_conformation()
        stages.say("  conformation: a minimum" + (f", {options.method}" if start == 0 else ""))
        tops, lower = look(search, stages, options.threads, start < RESTARTS)
        if start == RESTARTS or lower is None:
            break
        name, shape, below = lower
        stages.say(f"  {name} leads to a minimum that is {below:.1f} kJ/mol lower: from there once more")
        molecule.positions = shape * BOHR
        keep = True
    return finish(search, tops, stages, options.threads)


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
        points = ", ".join(f"{kind} {search._above(way['energies'][k]):.1f}" for k, kind in kinds.items())
        stages.say(f"  {name}: {points} kJ/mol")
        below, k = max((-search._above(way["energies"][k]), k) for k, kind in kinds.items() if kind == "minimum")
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
        below = -search._above(min(way["energies"]))
        if below > LOWER:
            lower.append((name, below))
    return Found(_result(search, found, dropped), lower)


def _saddles(search, stages, threads, may_restart):
    """({job: (top, ends)}, the first lower minimum)."""
    tops = {}
    jobs = search.jobs()
    for n, (top, ends) in _in_processes(stages, "driving torsions to their barriers", _saddle,
                                        list(range(len(jobs))), threads):
        tops[n] = top, ends
        name = jobs[n][0].file_name(jobs[n][1])
        if "dropped" in top or "dropped" in ends:
            stages.say(f"  {name}: {top.get('dropped') or ends['dropped']}")
            continue
        stages.say(f"  {name}: barrier {search._above(top['energy']):.1f} kJ/mol, "
                   f"behind it {search._above(ends['far_energy']):.1f}")
        for side in ("near", "far"):
            below = -search._above(ends[side + "_energy"])
            shape = np.array(ends[side])
            if may_restart and below > LOWER and search._intact(shape):
                return tops, (name, shape, below)
    return tops, None


def _paths(search, tops, stages, threads):
    dropped, found, wanted = [], [], []
    jobs = search.jobs()
    known = []
    for n, (top, ends) in tops.items():
        torsion, sign = jobs[n]
        name = torsion.file_name(sign)
        why = top.get("dropped") or ends.get("dropped")
        if why is None:
            try:
                search._refuse_known(top, known)
            except work.Dropped as known_saddle:
                why = str(known_saddle)
        if why is not None:
            dropped.append((name, why))
            continue
        known.append(SimpleNamespace(name=name, energies=[top["energy"]], nodes=[np.array(top["x"])]))
        wanted.append(n)
    lower = []
    for n, way in _in_processes(stages, "following paths to the barriers", _path, wanted, threads):
        torsion, sign = jobs[n]
        name = torsion.file_name(sign)
        if "dropped" in way:
            dropped.append((name, way["dropped"]))
            stages.say(f"  {name}: no path: {way['dropped']}")
            continue
        found.append(search._found(name, torsion, tops[n][0], way))
        below = -search._above(way["far_energy"])
        if below > LOWER:
            lower.append((name, below))
    return Found(_result(search, found, dropped), lower)


def _result(search, found, dropped):
    return work.Result(search.molecule.numbers, search.surface.masses, search.options.method, search.driven,
                       search.x, search.energy, search.nu1, found, dropped)


def frames(path):
    """[(words of the comment, symbols, positions in angstrom)]"""
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    out = []
    while lines:
        count = int(lines[0])
        atoms = [line.split() for line in lines[2:2 + count]]
        words = dict(w.split("=", 1) for w in lines[1].split() if "=" in w)
        out.append((words, [a[0] for a in atoms], np.array([[float(v) for v in a[1:4]] for a in atoms])))
        lines = lines[2 + count:]
    return out


def least_t(path):
    """Of a path's file: below 0 where the conformation is inside."""
    rises = [float(words.get("dE", "nan")) for words, _, _ in frames(path)]
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
        _, symbols, x = frames(stages.path("conformation.xyz"))[0]
        self.numbers = [SYMBOLS.index(s) for s in symbols]
        self.x, self.energy = x / BOHR, 0.0
        report = stages.path("report.tsv")
        self.found = [PathFile(name[:-4], frames(stages.path(name))) for name in files.listed(report)]
        with open(report, encoding="utf-8") as file:
            rows = [line.rstrip("\n").split(": ", 2) for line in file if line.startswith("# no path: ")]
        self.dropped = [(row[1], row[2]) for row in rows]
