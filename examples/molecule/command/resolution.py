"""The spacing of the grid: from a coarse grid, by what `verify --accuracy` finds between its points.

The coarse grid also tells what a finer one would cost. Conversions are as many as points, h^-3, but
each goes a shorter way, in fewer substeps; measured for propanols from 1.1 to 0.3 angstrom: h^-2.3
and h^-2.4.
"""

import json
import math
from dataclasses import dataclass

from preparation import files

from .filters import FilterFailed

WANTED = 0.1  # angstrom RMS, in 99 of 100 places: the tolerance
WALKS = 30
MORE_WALKS = 120  # where the law by which errors fall cannot be told from these
COST_ORDER = 2.4
SECONDS = 150  # that the grid may take on the cores that are given
# Where a push tips over a barrier the grid must be fine: of 150 random pushes of 1,2-dichloroethane 142
# end where the model does at 0.35, and 147 or 148 at 0.2; of butane 143 to 149 at 0.25, and 147 to 150 at 0.2
# (bench_basins, seeds 1 to 5). The others only just tip, or only just do not. Such a grid may take longer.
BETWEEN_BASINS = 0.2  # angstrom
BASINS_SECONDS = 300
FINEST = 0.2  # angstrom: a grid of a small molecule would become large before it becomes better
STEP = 0.05  # spacings are multiples of this, so that they hardly depend on the machine's speed


@dataclass
class Resolution:
    spacing: float
    enough: float  # spacing for the wanted accuracy
    guessed: bool  # whether that is no more than a guess
    error: float  # in 99 of 100 places of the coarse grid, angstrom
    seconds: float  # CPU seconds of the coarse grid
    coarse: float

    def cost(self, spacing):
        """CPU seconds, about."""
        return scaled(self.seconds, self.coarse, spacing)


def scaled(seconds, before, spacing):
    """What a grid takes, from what one of another spacing took."""
    return seconds * (before / spacing) ** COST_ORDER


def compute_grid(filters, stages, what, toml, grid, threads, seconds=None):
    """Computes a grid in the folder, on which an interrupted run goes on. what: it is, for the line of
    progress; seconds: about how long it takes, where that is known."""
    seeds, cost = f"{grid}.seeds", f"{grid}.cost"
    files.remove(stages.path(cost))
    filters.run("seed", toml, "-o", seeds)

    def expand():
        filters.run("expand", "--complete", "-j", threads, seeds, "-o", grid, "--cost", cost,
                    watch=lambda gone: stages.waiting(what, gone, seconds))
    try:
        expand()
    except FilterFailed as why:
        if "remove it to begin anew" not in str(why):
            raise
        files.remove(stages.path(f"{grid}.partial"))  # of a definition that was changed since
        expand()
    files.remove(stages.path(seeds))
    return [grid, cost]


def cpu_seconds(path):
    with open(path, encoding="utf-8") as file:
        return sum(json.loads(line)["cpu_seconds"] for line in file)


def estimated(filters, toml):
    """Seconds on one core that a grid takes, within a factor of 2 or so: by walking about in it. None where the
    report has a broken check, and so no estimate."""
    report = filters.run("check-model", toml, "--steps", 300, "--seconds", 3, "--format", "json", good=(0, 1, 3))[0]
    return ((json.loads(report) if report else {}).get("grid") or {}).get("cpu_seconds")


def measure(filters, stages, grid, threads):
    """The report of verify, as text."""
    def walk(count):
        what = "measuring how far the grid is off between its points"
        return filters.run("verify", grid, "--accuracy", WANTED, "--walks", count, "--recompute", "none", "-j", threads,
                           "--format", "json", good=(0, 3, 4), watch=lambda gone: stages.waiting(what, gone, None))[0]
    report = walk(WALKS)
    return walk(MORE_WALKS) if enough_by(report)[0] is None else report


def enough_by(report):
    """(spacing that suffices, None where it cannot be told; the error in 99 of 100 places)."""
    figures = next(c for c in json.loads(report)["checks"] if c["name"] == "accurate")["figures"]
    value = {f["name"]: f["value"] for f in figures}
    return value.get("sufficient spacing"), value.get("state 99 %") or 0.0


def decide(report, seconds, coarse, threads, basins):
    enough, error = enough_by(report)
    if enough is None and error <= WANTED:
        enough = coarse
    guessed = enough is None
    if guessed:
        # Where contact begins, errors fall in proportion to the spacing, elsewhere sooner.
        enough = coarse * WANTED / error
    # Then as fine as time allows.
    wanted = BETWEEN_BASINS if basins else 0 if guessed else math.floor(min(enough, coarse) / STEP + 1e-9) * STEP
    feasible = coarse * (seconds / ((BASINS_SECONDS if basins else SECONDS) * threads)) ** (1 / COST_ORDER)
    feasible = math.ceil(feasible / STEP - 1e-9) * STEP
    spacing = min(max(wanted, feasible, FINEST), coarse)
    return Resolution(round(spacing, 4), enough, guessed, error, seconds, coarse)
