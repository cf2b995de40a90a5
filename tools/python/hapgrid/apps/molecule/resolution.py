"""The spacing of the grid: from a coarse grid, by what `verify --accuracy` finds between its points. It follows from
the molecule alone, so that the same molecule gives the same grid on every machine.

The coarse grid also tells what a finer one costs on this machine. Conversions are as many as points, h^-3, but
each goes a shorter way, in fewer substeps; measured for propanols from 1.1 to 0.3 angstrom: h^-2.3 and h^-2.4.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import TYPE_CHECKING

from hapgrid.apps.common.files import Failed

if TYPE_CHECKING:
    from .definition import Definition
    from .steps import Start

# In 99 of 100 places the shape is off by WANTED at most, as far as verify can tell the spacing for that. This is about places
# in one branch: where branches end, play asks the model itself beside the grid.
WANTED = 0.25  # angstrom, root mean square over the atoms
FINEST = 0.2  # angstrom
# In 94 to 99 % of the ticks that touch one of 14 molecules of up to 8 atoms the nearest branch of a grid of 0.3 to 0.45 Å has
# the model's shape to 0.3 Å, and in 82 to 95 % at 0.5 to 0.85 Å, which would be enough for WANTED (bench_branches).
COARSEST = 0.45  # angstrom, where MOST_POINTS allows it
MOST_POINTS = 28000
# Where a push tips over a barrier the grid is as fine as that: of 150 random pushes of 1,2-dichloroethane 142 end where
# the model does at 0.35, and 147 or 148 at 0.2; of butane 143 to 149 at 0.25, and 147 to 150 at 0.2 (bench_basins,
# seeds 1 to 5). The others only just tip, or only just do not.
MOST_POINTS_BETWEEN_BASINS = 200000

STEP = 0.05  # spacings are multiples of this
WALKS = 30
MORE_WALKS = 120  # where the law by which errors fall cannot be told from these
COST_ORDER = 2.4


def decide(report: str, definition: Definition) -> float:
    """The spacing of the grid, angstrom. report: of verify about the coarse grid, whose definition is given."""
    enough, error = enough_by(report)
    coarse = definition.spacing
    # Where contact begins, errors fall in proportion to the spacing, elsewhere sooner.
    wanted = min(COARSEST, coarse * WANTED / max(error, WANTED) if enough is None else enough)
    tips = definition.basins and not definition.held
    spacing = FINEST if tips else max(FINEST, math.floor(wanted / STEP + 1e-9) * STEP)
    most = MOST_POINTS_BETWEEN_BASINS if tips else MOST_POINTS
    while spacing < coarse and math.prod(replace(definition, spacing=spacing).counts()) > most:
        spacing += STEP
    return round(min(spacing, coarse), 4)


def enough_by(report: str) -> tuple[float | None, float]:
    """(spacing that suffices, None where it cannot be told; the error in 99 of 100 places)."""
    try:
        figures = next(c for c in json.loads(report)["checks"] if c["name"] == "accurate")["figures"]
        value = {f["name"]: None if f["value"] is None else float(f["value"]) for f in figures}
    except (ValueError, TypeError, KeyError, StopIteration):
        raise Failed("coarse.json is no report of verify: remove it") from None
    return value.get("sufficient spacing"), value.get("state 99 %") or 0.0


def scaled(seconds: float, before: float, spacing: float) -> float:
    return seconds * (before / spacing) ** COST_ORDER


def coarser(spacing: float) -> float:
    """One with which a grid takes about a quarter of the time."""
    return round(math.ceil(spacing * 4 ** (1 / COST_ORDER) / STEP - 1e-9) * STEP, 2)


def measure(start: Start, grid: str) -> str:
    """The report of verify, as text."""
    for count in (WALKS, MORE_WALKS):
        report = start.folder.run(
            "verify", grid, "--accuracy", WANTED, "--walks", count, "--recompute", "none", "-j", start.options.threads,
            "--format", "json", good=(0, 3, 4),
            watch=lambda gone: start.folder.waiting("measuring how far the grid is off between its points", gone, None)).out
        if enough_by(report)[0] is not None:
            break
    return report
