"""The steps of a table from its file to the page."""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Iterable

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed, digest, pieces
from hapgrid.apps.common.page import path_text

from . import page, readers, units
from .readers import Table
from .work import Work, run_steps

MOST_POINTS = 2_200_000  # of a grid whose spacing nobody asked for: 130 along each side
TICKS = 4000  # of the way there, and as many back: at 1 kHz a few seconds


def run(o: Namespace) -> str:
    """Everything; the line for standard output."""
    next(pieces(o.file), None)  # says why, where it cannot be read
    if o.factor == 0:
        raise Failed("--factor 0 leaves nothing to feel")
    return run_steps("table", o, [o.file], lambda work, name: _define(o, work, name), _page)


def _define(o: Namespace, work: Work, name: str) -> None:
    def compute() -> list[str]:
        work.say(f"reading {o.file}")
        table = readers.read(o.file, o.array)
        units.convert(table, o.file, o.unit, o.length_unit)
        for note in table.notes:
            work.say("  " + note)
        work.enter()
        text = definition(o, work, name, table)
        work.write(f"{name}.table", table_text(table))
        work.write(f"{name}.toml", text)
        return [f"{name}.table", f"{name}.toml"]
    options = [o.force, o.wall, o.factor, o.spacing, o.array, o.unit, o.length_unit]
    work.step("definition", "", [], [digest(o.file), options], compute)


def table_text(table: Table) -> str:
    """The file that the plug-in reads (lattice.hpp says how)."""
    def row(word: str, numbers: Iterable[float]) -> str:
        return word + "".join(f" {v:.10g}" for v in numbers) + "\n"
    lines = ["hapgrid-table\n", row("counts", table.values.shape), row("origin", table.origin)]
    lines += [row("axis", axis) for axis in table.axes]
    lines += [row(f"atom {symbol}", x) for symbol, x in table.atoms]
    lines.append("values\n")
    flat = table.values.ravel(order="F").tolist()
    width = table.values.shape[0]
    lines += [" ".join([f"{v:.8g}" for v in flat[k:k + width]]) + "\n" for k in range(0, len(flat), width)]
    return "".join(lines)


def wall_of(o: Namespace, table: Table) -> tuple[float | None, int, int]:
    """The energy of the wall, or None when none is needed; how many values are missing, and how many are higher."""
    values = table.values[~np.isnan(table.values)] * o.factor
    missing = table.values.size - values.size
    wall = o.wall
    if wall == math.inf:
        if missing:
            raise Failed(f"{o.file}: --wall none: {missing:,} values are missing, and only a wall can stand there")
        return None, 0, 0
    if wall is None:
        low, median = float(values.min()), float(np.median(values))
        wall = low + 5 * (median - low) if median > low else float(values.max())
        if not missing and values.max() <= wall:
            return None, 0, 0
        wall = float(f"{wall:.3g}") if float(f"{wall:.3g}") > low else wall
    if not wall > values.min():
        raise Failed(f"{o.file}: no value is below the wall, {wall:g}: the lowest is {values.min():g}")
    return wall, missing, int((values > wall).sum())


def box_of(table: Table, spacing: float | None) -> tuple[Array, float, list[int]]:
    """(origin, spacing, counts) of the grid: a box of whole cells around the table, so that each value can be felt."""
    steps = np.linalg.norm(table.axes, axis=1)
    size = np.array(table.values.shape) - 1
    corners = np.array([table.origin + np.array([i, j, k]) * size @ table.axes
                        for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    low, high = corners.min(axis=0), corners.max(axis=0)
    if spacing and spacing > (high - low).min() * (1 + 1e-6):
        raise Failed(f"--spacing {spacing:g}: the table has only {(high - low).min():g} along an axis")
    h = spacing or float(steps.min())

    def counts(h: float) -> list[int]:
        return [max(int(c), 1) + 1 for c in np.ceil((high - low) / h - 1e-6)]

    if not spacing and math.prod(counts(h)) > MOST_POINTS:
        h = float(f"{h * (math.prod(counts(h)) / MOST_POINTS) ** (1 / 3):.3g}")
    return low, h, counts(h)


def definition(o: Namespace, work: Work, name: str, table: Table) -> str:
    wall, missing, higher = wall_of(o, table)
    low, h, counts = box_of(table, o.spacing)
    energy, length = table.energy_unit, table.length_unit
    work.say(f"  {' x '.join(map(str, table.values.shape))} values, {np.nanmin(table.values * o.factor):.4g} at the "
             f"lowest; grid of {' x '.join(map(str, counts))} points, {h:g}{' ' * bool(length)}{length} apart")
    if wall is not None:
        begin = (float(np.nanmin(table.values * o.factor)) + wall) / 2
        bent = int((table.values * o.factor > begin).sum())
        work.say(f"  a wall of {wall:g}{' ' * bool(energy)}{energy} for {missing:,} values that are missing and {higher:,} that are "
                 f"higher, of {table.values.size:,}; the {bent:,} above {begin:.4g} bend towards it (--wall none: no wall)")
    wall_line = "" if wall is None else (
        f"wall = {wall:.10g}            # energy where values are higher or missing, {energy or 'in the unit of values'}\n")
    return f"""\
# {name}: made by `hapgrid table`, which keeps what is changed here and computes the grid anew when it is
# run again.

[model]
plugin = "table"

[model.files]
table = "{name}.table"    # the values; the grid carries them

[model.parameters]
energy_unit = "{energy}"
length_unit = "{length}"
factor = {o.factor:.10g}                # all values are multiplied by it
{wall_line}largest_force = {o.force:g}         # newtons on the device where the energy is steepest
marker = {0.7 * h:.3g}              # radius of the ball that shows the HIP; those of the deepest minima have half of it

[grid]
origin = [{", ".join(f"{v:.10g}" for v in low)}]
spacing = {h:.10g}
counts = {counts}

[search]
max_levels = 1            # a table has one energy at each place
"""


def _page(work: Work, name: str) -> list[str]:
    values = page.Values(work, name)
    work.write("path.txt", path_text(page.line_through_lowest(values), values.length_unit, TICKS))
    return ["path.txt", *page.write(work, name, values)]
