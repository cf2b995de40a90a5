"""The spacing of the grid: from a coarse grid, by what `verify --accuracy` finds between its points. It follows from
the molecule alone, so that the same molecule gives the same grid on every machine.

The coarse grid also tells what a finer one costs on this machine. Conversions are as many as points, h^-3, but
each goes a shorter way, in fewer substeps; measured for propanols from 1.1 to 0.3 angstrom: h^-2.3 and h^-2.4.
"""

import json
import math
from dataclasses import dataclass

from preparation import files

from .faults import HOPELESS, Fault
from .filters import FilterFailed

# The rule, all of it. In 99 of 100 places the shape is off by WANTED at most, as far as verify can tell the spacing
# for that. The grid is never finer than FINEST, and has at most MOST_POINTS points. This is about places in one branch:
# where branches end, play has the tear fractions (definition.TEARS).
WANTED = 0.25  # angstrom, root mean square over the atoms
FINEST = 0.2  # angstrom
MOST_POINTS = 80000
# Where a push tips over a barrier the grid is as fine as that: of 150 random pushes of 1,2-dichloroethane 142 end where
# the model does at 0.35, and 147 or 148 at 0.2; of butane 143 to 149 at 0.25, and 147 to 150 at 0.2 (bench_basins,
# seeds 1 to 5). The others only just tip, or only just do not.
MOST_POINTS_BETWEEN_BASINS = 200000

STEP = 0.05  # spacings are multiples of this
WALKS = 30
MORE_WALKS = 120  # where the law by which errors fall cannot be told from these
COST_ORDER = 2.4


@dataclass(frozen=True)
class Resolution:
    """spacing: of the grid; enough: for WANTED, None where it cannot be told; error: in 99 of 100 places of the coarse
    grid. All in angstrom."""
    spacing: float
    enough: float
    error: float


def decide(report, definition):
    """The Resolution. report: of verify about the coarse grid, whose definition is given."""
    enough, error = enough_by(report)
    coarse = definition.spacing
    if enough is None and error <= WANTED:
        enough = coarse
    # Where contact begins, errors fall in proportion to the spacing, elsewhere sooner.
    wanted = enough if enough is not None else coarse * WANTED / error
    spacing = FINEST if definition.basins else max(FINEST, math.floor(wanted / STEP + 1e-9) * STEP)
    most = MOST_POINTS_BETWEEN_BASINS if definition.basins else MOST_POINTS
    while spacing < coarse and math.prod(definition.with_spacing(spacing).counts()) > most:
        spacing += STEP
    return Resolution(round(min(spacing, coarse), 4), enough, error)


def enough_by(report):
    """(spacing that suffices, None where it cannot be told; the error in 99 of 100 places)."""
    figures = next(c for c in json.loads(report)["checks"] if c["name"] == "accurate")["figures"]
    value = {f["name"]: f["value"] for f in figures}
    return value.get("sufficient spacing"), value.get("state 99 %") or 0.0


def scaled(seconds, before, spacing):
    """What a grid takes, from what one of another spacing took."""
    return seconds * (before / spacing) ** COST_ORDER


def compute_grid(run, what, toml, grid, seconds=None):
    """Computes a grid in the folder, on which an interrupted run goes on, and returns the names of its files; or the
    Fault that makes it hopeless. what: it is, for the line of progress; seconds: about how long it takes, if that is
    known."""
    filters, stages = run.filters, run.stages
    seeds, cost = f"{grid}.seeds", f"{grid}.cost"
    files.remove(stages.path(cost))
    filters.run("seed", toml, "-o", seeds)
    begun = stages.digest(seeds)
    if stages.recall(f"begun-{grid}", begun) is None:  # what is kept is of a definition that was changed since
        files.remove(stages.path(f"{grid}.partial"))
        stages.remember(f"begun-{grid}", begun, True)
    code = filters.run("expand", "--complete", "-j", run.options.threads, seeds, "-o", grid, "--cost", cost,
                       good=(0, 1), watch=lambda gone: stages.waiting(what, gone, seconds))[1]
    files.remove(stages.path(seeds))
    if code == 0:
        return [grid, cost]
    failed = next((line["failed"] for line in _costs(stages.path(cost)) if "failed" in line), None)
    if failed not in HOPELESS:
        raise FilterFailed(filters.said)
    return Fault(failed, filters.said)


def _costs(path):
    try:
        with open(path, encoding="utf-8") as file:
            return [json.loads(line) for line in file]
    except FileNotFoundError:
        return []


def cpu_seconds(path):
    return sum(line["cpu_seconds"] for line in _costs(path))


def estimated(run, toml):
    """Seconds that a grid takes here, within a factor of 2 or so: by walking about in it. None where the report has a
    broken check, and so no estimate."""
    report = run.filters.run("check-model", toml, "--steps", 300, "--seconds", 3, "--format", "json", good=(0, 1, 3))[0]
    seconds = ((json.loads(report) if report else {}).get("grid") or {}).get("cpu_seconds")
    return seconds and seconds / run.options.threads


def measure(run, grid):
    """The report of verify, as text."""
    def walk(count):
        what = "measuring how far the grid is off between its points"
        return run.filters.run("verify", grid, "--accuracy", WANTED, "--walks", count, "--recompute", "none", "-j",
                               run.options.threads, "--format", "json", good=(0, 3, 4),
                               watch=lambda gone: run.stages.waiting(what, gone, None))[0]
    report = walk(WALKS)
    return walk(MORE_WALKS) if enough_by(report)[0] is None else report
