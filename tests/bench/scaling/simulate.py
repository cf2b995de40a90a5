#!/usr/bin/python3
"""How long a sharded build takes on how many workers: a discrete-event simulation of the rounds of
Makefile.example, fed with measured costs (costs.json, by costs.sh) and the growth of real grids
(growth.txt, by growth.sh).

A round, as the driver runs it:

  1  the driver looks at the directory, and finds out what is left;
  2  its shards are handed out: equal parts of the frontier's conversions. Handing one out takes a
     time that all share (`serial`), and one that the worker pays (`own`), then conversion follows
     conversion, each taking a time of its own. Who is free first takes the next;
  3  behind a barrier the requests are merged, by ranges, which are handed out in the same way.

What is simulated event by event are shards: a shard's conversions are a stretch of the times that
were measured, one after the other (times.txt), since what is slow at one point is slow beside it.
Machines do not fail here.

`ideal` is conversions * mean / workers; efficiency is ideal / wall.
"""
import argparse
import heapq
import itertools
import json
import multiprocessing
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Round:
    """A generation: its conversions, the chunks of the grid that their requests change, and how
    many requests the busiest of 64 ranges gets."""

    conversions: int
    chunks: int
    busiest: int
    weight: float = 1  # it stands for so many like it


@dataclass(frozen=True)
class Way:
    """How shards are handed out, seconds. All of it can be 0."""

    serial: float = 0  # a shard, one at a time for all workers
    own: float = 0  # a shard, on the worker
    launch: float = 0  # of the tasks, once a round
    launch_task: float = 0  # the i-th starts so much later than the one before
    poll: float = 0  # tasks that stay look so often whether there is something to do
    watch: bool = False  # the driver sleeps between looks whether all of it is there
    once: float = 0  # a build


@dataclass(frozen=True)
class Costs:
    """Seconds of everything between two conversions; requests are conversions that were made."""

    request_write: float = 0  # expand, beyond C
    request_merge: float = 0
    chunk_merge: float = 0  # a chunk read and written again
    merge_start: float = 0
    request_file: float = 0  # merge, a shard of requests opened and read
    sync: float = 0  # until a file is on the disk
    driver_round: float = 0
    driver_part: float = 0


@dataclass
class Result:
    wall: float = 0
    conversions: float = 0
    busy: float = 0  # conversions, seconds of all workers
    shards: int = 0  # of the largest round
    spent: dict = field(default_factory=lambda: dict.fromkeys(PHASES, 0.0))  # wall seconds


# Where the wall time goes: `ideal` is the conversions spread evenly, `tail` the wait for the last shard.
PHASES = ("ideal", "hand out", "tail", "merge", "driver")


class Times:
    """Conversions' times in the order of the search, scaled to `mean` seconds."""

    def __init__(self, sequence, mean):
        sequence = np.asarray(sequence, float)
        sequence = sequence * (mean / sequence.mean())
        self.until = np.concatenate([[0], np.cumsum(sequence)])
        # slowest[j][i]: of 2^j conversions from i on, round and round.
        self.slowest = [sequence]
        while 2 ** len(self.slowest) <= len(sequence):
            last = self.slowest[-1]
            self.slowest.append(np.maximum(last, np.roll(last, -(2 ** (len(self.slowest) - 1)))))

    def shards(self, counts, rng):
        """For each count, what so many conversions in a row take, from somewhere on, round and round;
        and what the slowest of them takes."""
        length = len(self.until) - 1
        begin = rng.integers(length, size=len(counts))
        laps, end = np.divmod(begin + counts, length)
        sums = laps * self.until[-1] + self.until[end] - self.until[begin]
        slowest = np.empty(len(counts))
        power = np.log2(np.minimum(counts, length)).astype(int)
        for j in np.unique(power):
            of = power == j
            last = (begin[of] + counts[of] - 2**j) % length
            slowest[of] = np.maximum(self.slowest[j][begin[of]], self.slowest[j][last])
        slowest[counts >= length] = self.slowest[0].max()
        return sums, slowest


def equal_parts(conversions, parts):
    """The sizes of so many equal parts, as expand --part cuts; none is without a conversion."""
    parts = max(min(parts, conversions), 1)
    return np.diff(np.arange(parts + 1) * conversions // parts)


def guided_parts(conversions, workers, share, least=1):
    """Sizes that shrink towards the end of the round (guided self-scheduling, Polychronopoulos and
    Kuck 1987): each a worker's part of what is left, divided by `share`, and at least `least`."""
    sizes = []
    while conversions > 0:
        sizes.append(min(max(conversions // (share * workers), least), conversions))
        conversions -= sizes[-1]
    return np.array(sizes)


def hand_out(free, work, serial, own, cores=None):
    """List scheduling: when the last of `work` is done, by workers that are free from `free` on.
    With `cores` the worker's own costs are CPU time of machines with so many in all."""
    heapq.heapify(free)
    gate = 0.0
    end = 0.0
    machine = [0.0] * cores if cores else None
    for seconds in work:
        start = max(free[0], gate)
        gate = start + serial
        begin = gate + own
        if machine:
            begin = max(gate, machine[0]) + own
            heapq.heapreplace(machine, begin)
        done = begin + seconds
        heapq.heapreplace(free, done)
        end = max(end, done)
    return end


def starts(way, workers, rng):
    """When the workers are there for a step."""
    at = way.launch + way.launch_task * np.arange(1, workers + 1)
    return list(at + rng.uniform(0, way.poll, workers) if way.poll else at)


def watched(way, seconds):
    """A step that took so long, when the driver has seen it: it sleeps 20 ms and 1 % of the step, at
    most 0.9 s, between two looks."""
    return seconds + (min(0.02 + 0.01 * seconds, 0.9) / 2 if way.watch else 0)


def build(rounds, workers, cut, ranges, way, costs, times, rng, cores=None, threads=1):
    """A whole grid, by workers / threads tasks. cut(conversions): the sizes of a round's shards.
    ranges = 0: one merge, by the driver."""
    tasks = workers // threads
    result = Result(wall=way.once)
    result.spent["hand out"] = way.once
    for round_ in rounds:
        sizes = cut(round_.conversions)
        work, slowest = times.shards(sizes, rng)
        conversions = float(work.sum())
        # Graham's bound (1966): threads that take one conversion after the other need no longer.
        work = work / threads + slowest * (1 - 1 / threads)
        # Without anybody between them there is still the wait for the last shard.
        alone = hand_out([0.0] * tasks, work, 0, 0)
        work = work + sizes * costs.request_write + costs.sync
        expand = watched(way, hand_out(starts(way, tasks, rng), work, way.serial, way.own, cores))
        ideal = conversions / workers
        if ranges:
            touched = min(ranges, round_.chunks)
            busiest = max(round_.busiest, round_.conversions / touched)
            rest = (round_.conversions - busiest) / max(touched - 1, 1)
            requests = np.array([busiest] + [rest] * (touched - 1))
            # A range reads what its neighbours get, too.
            load = requests * costs.request_merge + len(sizes) / touched * costs.request_file
            load += round_.chunks / touched * costs.chunk_merge
            load = 3 * load + costs.merge_start + 2 * costs.sync
            merge = watched(way, hand_out(starts(way, tasks, rng), load, way.serial, way.own, cores))
        else:
            merge = costs.merge_start + round_.conversions * costs.request_merge + 2 * costs.sync
            merge += round_.chunks * costs.chunk_merge + len(sizes) * costs.request_file
        driver = costs.driver_round + costs.driver_part * len(sizes)

        result.shards = max(result.shards, len(sizes))
        result.conversions += round_.weight * int(sizes.sum())
        result.busy += round_.weight * conversions
        result.wall += round_.weight * (expand + merge + driver)
        for phase, seconds in zip(PHASES, (ideal, expand - alone, alone - ideal, merge, driver)):
            result.spent[phase] += round_.weight * seconds
    return result


def thinned(rounds, most):
    """At most so many rounds, evenly: those of a large grid are like their neighbours. The sum of
    their conversions stays the same."""
    if len(rounds) <= most:
        return rounds
    step = len(rounds) / most
    kept = [rounds[int((i + 0.5) * step)] for i in range(most)]
    weight = sum(r.conversions for r in rounds) / sum(r.conversions for r in kept)
    return [Round(r.conversions, r.chunks, r.busiest, weight) for r in kept]


def read_growth(path):
    """{(grid, points a side): rounds}"""
    growth = {}
    for line in Path(path).read_text().splitlines():
        if line.startswith("#"):
            continue
        grid, n, _, *numbers = line.split()
        growth.setdefault((grid, int(n)), []).append(Round(*map(int, numbers)))
    return growth


def ways(c):
    """How shards are handed out (examples/cluster/README.md), from measured costs."""
    return {
        "make": Way(serial=c["make_target"], own=c["shard"]),
        "srun": Way(serial=c["srun_serial"], own=c["srun_step"] + c["shard"]),
        "claim": Way(serial=c["mkdir"], own=c["claim"], poll=c["poll"], watch=True,
                     once=c["srun_step"]),
        # If these were started for each step.
        "start": Way(serial=c["mkdir"], own=c["claim"], launch=c["srun_step"],
                     launch_task=c["srun_task"]),
    }


def parser():
    p = argparse.ArgumentParser(description="Wall time and efficiency of sharded builds.")
    p.add_argument("--costs", default=HERE / "costs.json", help="by costs.sh")
    p.add_argument("--growth", default=HERE / "growth.txt", help="by growth.sh")
    p.add_argument("--times", default=HERE / "times.txt",
                   help="of conversions, in their order, in any unit; 'even': all the same; "
                        "'lognormal:SIGMA', which know nothing of each other")
    p.add_argument("--mean", type=float, default=0.056, help="seconds a conversion (%(default)s)")
    p.add_argument("--grid", nargs="+", default=["ball"], help="of --growth: ball, alone")
    p.add_argument("-n", "--points", type=int, nargs="+", default=[30, 50, 128, 256])
    p.add_argument("-w", "--workers", type=int, nargs="+", default=[10, 30, 100, 300, 1000, 3000, 10000])
    p.add_argument("--way", nargs="+", default=["make", "srun", "claim", "start"])
    p.add_argument("--cut", nargs="+", default=["equal:8"],
                   help="equal:K, K shards a task; parts:P; guided:K, shards that shrink")
    p.add_argument("--least", type=int, default=1, help="conversions a thread in a guided shard")
    p.add_argument("--threads", type=int, default=1, help="workers that are threads of one task")
    p.add_argument("--ranges", type=int, default=64, help="of a merge; 0: one merge, by the driver")
    p.add_argument("--cores", type=int, help="what hands shards out shares so many processors")
    p.add_argument("--rounds", type=int, default=40, help="simulate no more rounds than these")
    p.add_argument("--set", nargs="+", default=[], metavar="COST=SECONDS", help="another cost")
    p.add_argument("--seed", type=int, default=1)
    return p


def case(o, grid, points, way, cut, workers):
    measured = json.loads(Path(o.costs).read_text())["seconds"]
    for text in o.set:
        name, value = text.split("=")
        if name not in measured:
            raise SystemExit(f"simulate: no cost {name}")
        measured[name] = float(value)
    costs = Costs(**{f: measured[f] for f in Costs.__dataclass_fields__})
    if o.times == "even":
        sequence = [1.0]
    elif str(o.times).startswith("lognormal:"):
        sequence = np.random.default_rng(0).lognormal(0, float(o.times[10:]), 100000)
    else:
        sequence = Path(o.times).read_text().split()
    kind, number = cut.split(":")
    tasks = max(workers // o.threads, 1)
    cuts = {
        "equal": lambda c: equal_parts(c, int(number) * tasks),
        "parts": lambda c: equal_parts(c, int(number)),
        "guided": lambda c: guided_parts(c, tasks, int(number), o.least * o.threads),
    }
    rounds = thinned(read_growth(o.growth)[grid, points], o.rounds)
    r = build(rounds, workers, cuts[kind], o.ranges, ways(measured)[way], costs,
              Times(sequence, o.mean), np.random.default_rng(o.seed), o.cores,
              workers // tasks)
    share = "".join(f"{100 * r.spent[phase] / r.wall:9.1f}" for phase in PHASES[1:])
    return (f"{grid:6} {points:6} {way:6} {cut:10} {workers:7} {r.shards:8} {r.wall:10.1f}"
            f" {100 * r.busy / workers / r.wall:10.1f}{share}")


def main():
    o = parser().parse_args()
    print("#grid  points way    cut        workers   shards       wall efficiency"
          + "".join(f"{phase.replace(' ', '-'):>9}" for phase in PHASES[1:]), flush=True)
    cases = itertools.product([o], o.grid, o.points, o.way, o.cut, o.workers)
    with multiprocessing.Pool() as pool:
        for line in pool.starmap(case, cases, chunksize=1):
            print(line)


if __name__ == "__main__":
    main()
