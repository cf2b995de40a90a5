#!/usr/bin/python3
"""How efficient many workers are: the rounds of examples/cluster/rounds.sh under srun, simulated.

    simulate.py > curve.tsv          (a line for each size, number of workers and kind of times)

A round starts one task for each `threads` workers, and each task expands one part. The parts are cut
as `expand` cuts them: in blocks, dealt out in turns. The threads of a task take one conversion after the
other. When the last part has ended, one process merges. Machines do not fail here.

Efficiency is conversions * mean / (workers * wall).
"""
import argparse
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


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

    def stretches(self, begin, count):
        """What `count` conversions take from each of `begin` on, round and round; and the slowest of them."""
        length = len(self.until) - 1
        laps, end = np.divmod(begin + count, length)
        sums = laps * self.until[-1] + self.until[end] - self.until[begin]
        if count >= length:
            return sums, np.full(begin.shape, self.slowest[0].max())
        j = int(np.log2(count))
        return sums, np.maximum(self.slowest[j][begin], self.slowest[j][(begin + count - 2**j) % length])


def block_size(conversions, parts):
    """That of libcore/search/frontier.hpp."""
    block = max(conversions // (512 * parts), 1)
    return max(block, 1024) if conversions // (32 * parts) >= 1024 else block


def deal(conversions, parts, times, rng):
    """The work of each part, the slowest conversion in it, and its number of conversions."""
    block = block_size(conversions, parts)
    turns, rest = divmod(conversions, block * parts)
    sizes = np.full((turns + 1, parts), block)
    sizes[turns] = np.clip(rest - block * np.arange(parts), 0, block)  # the last turn
    # The blocks of a turn lie beside each other.
    length = len(times.until) - 1
    begin = (rng.integers(length, size=(turns + 1, 1)) + block * np.arange(parts)) % length
    work, slowest = np.zeros(sizes.shape), np.zeros(sizes.shape)
    for count in np.unique(sizes[sizes > 0]):
        of = sizes == count
        work[of], slowest[of] = times.stretches(begin[of], count)
    return work.sum(axis=0), slowest.max(axis=0), sizes.sum(axis=0)


def round_seconds(conversions, records, workers, threads, costs, times, rng):
    """(wall seconds of the parts, of the merge and the driver, seconds of conversions)"""
    tasks = max(workers // threads, 1)
    work, slowest, sizes = deal(conversions, min(tasks, conversions), times, rng)
    # Graham's bound (1966): threads that take one conversion after the other need no longer.
    threads = workers // tasks
    ends = work / threads + slowest * (1 - 1 / threads) + sizes * costs["request_write"]
    ends += costs["srun"] + costs["srun_task"] * np.arange(len(ends)) + costs["expand_start"]
    merge = costs["merge_start"] + conversions * costs["request_merge"] + records * costs["record_copy"]
    return ends.max(), merge + len(ends) * costs["request_file"] + costs["driver"], work.sum()


def build(rounds, workers, threads, costs, times, rng, most=40):
    """(efficiency, share of the wall time that merges and the driver take), each 0 to 1. Of many
    rounds `most` stand for those beside them."""
    step = max(len(rounds) / most, 1)
    records = np.cumsum(rounds) / 26
    wall = serial = busy = 0.0
    for i in range(min(len(rounds), most)):
        at = int((i + 0.5) * step)
        parts, merge, work = round_seconds(rounds[at], records[at], workers, threads, costs, times, rng)
        wall, serial, busy = wall + parts + merge, serial + merge, busy + work
    return busy / workers / wall, serial / wall


def read_table(name):
    lines = (HERE / name).read_text().splitlines()
    return [line.split("\t") for line in lines if not line.startswith("#")]


def read_growth():
    """{points a side: conversions of each round}"""
    growth = {}
    for n, _, conversions in read_table("growth.tsv"):
        growth.setdefault(int(n), []).append(int(conversions))
    return growth


def read_times(name):
    if name == "log-normal":
        return np.random.default_rng(0).lognormal(0, 0.5, 100000)
    return [float(t) for row in read_table("times.tsv") for t in row[0].split()]


def main():
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--threads", type=int, default=50, help="of a task (50)")
    p.add_argument("--mean", type=float, default=0.056, help="seconds a conversion (0.056, the paper's alanine)")
    p.add_argument("--workers", type=int, nargs="+", default=[10, 30, 100, 300, 1000, 3000, 10000])
    p.add_argument("--points", type=int, nargs="+", default=[30, 50, 128, 256], help="a side")
    p.add_argument("--times", nargs="+", default=["log-normal", "alanine"], choices=["log-normal", "alanine"])
    o = p.parse_args()
    costs = {name: float(seconds) for name, seconds, _ in read_table("costs.tsv")}
    growth = read_growth()
    print("# times\tpoints a side\tworkers\tefficiency %\tmerge and driver %")
    for name in o.times:
        times = Times(read_times(name), o.mean)
        for n in o.points:
            for workers in o.workers:
                efficiency, serial = build(growth[n], workers, o.threads, costs, times, np.random.default_rng(1))
                print(f"{name}\t{n}\t{workers}\t{100 * efficiency:.1f}\t{100 * serial:.1f}")


if __name__ == "__main__":
    main()
