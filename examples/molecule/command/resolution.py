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
COST_ORDER = 2.4
SECONDS = 150  # that the grid may take on the cores that are given
# Where a push tips over a barrier the grid must be fine: of 150 random pushes of 1,2-dichloroethane 142
# end where the model does at 0.35, 143 at 0.3, and 146 to 148 at 0.25, by where the points lie (bench_basins,
# means of the seeds 1 to 5).
BETWEEN_BASINS = 0.25  # angstrom
STEP = 0.05  # spacings are multiples of this, so that they hardly depend on the machine's speed


@dataclass
class Resolution:
    spacing: float
    enough: float  # spacing for the wanted accuracy; 0 where it is not known
    error: float  # in 99 of 100 places of the coarse grid, angstrom
    seconds: float  # CPU seconds of the coarse grid
    coarse: float

    def cost(self, spacing):
        """CPU seconds, about."""
        return self.seconds * (self.coarse / spacing) ** COST_ORDER


def compute_grid(filters, stages, toml, grid, threads, seconds=None):
    """Computes a grid in the folder, on which an interrupted run goes on. seconds: about how long it
    takes, where that is known."""
    seeds, cost = f"{grid}.seeds", f"{grid}.cost"
    files.remove(stages.path(cost))
    filters.run("seed", toml, "-o", seeds)

    def expand():
        filters.run("expand", "--complete", "-j", threads, seeds, "-o", grid, "--cost", cost,
                    watch=lambda gone: stages.waiting(f"computing {grid}", gone, seconds))
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


def measure(filters, grid, threads):
    """The report of verify, as text."""
    return filters.run("verify", grid, "--accuracy", WANTED, "--walks", WALKS, "--recompute", "none", "-j", threads,
                       "--format", "json", good=(0, 3, 4))[0]


def decide(report, seconds, coarse, threads):
    figures = next(c for c in json.loads(report)["checks"] if c["name"] == "accurate")["figures"]
    value = {f["name"]: f["value"] for f in figures}
    error = value.get("state 99 %") or 0.0
    enough = value.get("sufficient spacing", 0.0)
    if error <= WANTED and not enough:
        enough = coarse
    # Where the law cannot be told, as fine as time allows.
    wanted = math.floor(min(enough, coarse) / STEP + 1e-9) * STEP
    feasible = coarse * (seconds / (SECONDS * threads)) ** (1 / COST_ORDER)
    feasible = math.ceil(feasible / STEP - 1e-9) * STEP
    spacing = min(max(wanted, feasible, STEP), coarse)
    return Resolution(round(spacing, 4), enough, error, seconds, coarse)
