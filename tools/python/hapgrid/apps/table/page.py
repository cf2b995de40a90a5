"""A line through the table, pictures, and the page that sums up."""

from __future__ import annotations

import itertools
import json
import tomllib
from collections.abc import Sequence

import numpy as np
from hapgrid import style
from hapgrid.apps.common import page
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.work import Work


class Values:
    """The energies at the points of the table, as the plug-in has them (field.hpp)."""

    def __init__(self, work: Work, name: str) -> None:
        definition = tomllib.loads(work.read(f"{name}.toml"))
        grid, model = definition["grid"], definition["model"]
        parameters = model["parameters"]
        self.low = np.array(grid["origin"], float)  # the corners of the grid's box
        self.high = self.low + grid["spacing"] * (np.array(grid["counts"]) - 1)
        head, _, body = work.read(model["files"]["table"]).partition("values\n")
        rows = [line.split() for line in head.splitlines()]
        counts = next([int(n) for n in row[1:]] for row in rows if row[0] == "counts")
        self.origin = next(np.array(row[1:], float) for row in rows if row[0] == "origin")
        self.axes = np.array([row[1:] for row in rows if row[0] == "axis"], float)
        self.atoms = sum(row[0] == "atom" for row in rows)
        energy = np.array(body.split(), float).reshape(counts[::-1]).transpose(2, 1, 0)
        energy = energy * parameters.get("factor", 1.0)
        self.wall = parameters.get("wall")
        if self.wall is not None:
            begin = (np.nanmin(energy) + self.wall) / 2
            room = self.wall - begin
            energy = np.where(np.isnan(energy), np.inf, energy)
            pressed = begin - room * np.expm1(-np.maximum(energy - begin, 0) / room)
            energy = np.where(energy > begin, pressed, energy)
        self.energy = energy
        self.unit = parameters.get("energy_unit", "")
        self.length_unit = parameters.get("length_unit", "")
        self.force = parameters.get("largest_force", 3)

    def lowest(self) -> tuple[int, ...]:
        """Indices of the lowest point, inside rather than at the edge."""
        inside = self.energy[1:-1, 1:-1, 1:-1]
        return tuple(int(n) + 1 for n in np.unravel_index(int(inside.argmin()), inside.shape))

    def place(self, index: Sequence[int] | Array) -> Array:
        return self.origin + np.asarray(index, float) @ self.axes


def line_through_lowest(values: Values) -> tuple[Array, Array]:
    """(start, end): a line through the lowest point along an axis or a diagonal of the table, that which climbs
    least. It ends at the edge of the table, or of the grid's box, which may be smaller."""
    lowest = np.array(values.lowest())
    last = np.array(values.energy.shape) - 1

    def ray(step: Array) -> list[Array]:
        count = min(int((last[a] - lowest[a]) if step[a] > 0 else lowest[a]) for a in range(3) if step[a])
        return [lowest + n * step for n in range(count + 1)]

    def climbs(step: Array) -> float:
        both = ray(step) + ray(-step)
        return max(values.energy[tuple(p)] for p in both)
    steps = [np.array(s) for s in itertools.product((-1, 0, 1), repeat=3) if s > (0, 0, 0)]
    best = min(steps, key=climbs)
    start, end = values.place(ray(-best)[-1]), values.place(ray(best)[-1])
    along = [a for a in range(3) if start[a] != end[a]]
    parts = [sorted((bound[a] - start[a]) / (end[a] - start[a]) for bound in (values.low, values.high)) for a in along]
    into, out = max(part[0] for part in parts), min(part[1] for part in parts)
    # A little inside the box where it ends the line, since the numbers of a path are rounded.
    into, out = into + 1e-6 if into > 0 else 0.0, out - 1e-6 if out < 1 else 1.0
    return (start + into * (end - start), start + out * (end - start)) if into < out else (start, end)


def slices(work: Work, values: Values) -> str:
    """slices.png: the three planes of the table through its lowest point."""
    drawn = style.figure(8.2, 3)
    at = values.lowest()
    steps = np.linalg.norm(values.axes, axis=1)
    # A sheared table has no places along x, y and z: its pictures begin at 0.
    begin = values.origin if np.allclose(values.axes, np.diag(steps)) else np.zeros(3)
    with style.house_style():
        every = [drawn.add_subplot(1, 3, k + 1) for k in range(3)]
        for axes, (a, b, across) in zip(every, ((0, 1, 2), (0, 2, 1), (1, 2, 0))):
            plane = np.take(values.energy, at[across], axis=across)
            edges = [(begin[n] - steps[n] / 2, begin[n] + (plane.shape[k] - 0.5) * steps[n]) for k, n in enumerate((a, b))]
            image = axes.imshow(plane.T, origin="lower", extent=(*edges[0], *edges[1]), aspect="equal", cmap="viridis",
                                vmin=values.energy.min(), vmax=values.energy.max())
            axes.set(xlabel=style.label("xyz"[a], values.length_unit), ylabel=style.label("xyz"[b], values.length_unit))
            place = style.place(begin[across] + at[across] * steps[across], steps[across])
            axes.set_title(style.plain(f"{'xyz'[across]} = {place} {style.sign(values.length_unit)}".rstrip()))
        drawn.colorbar(image, ax=every, label=style.label("energy", values.unit), shrink=0.85)
    style.save(drawn, work.path("slices.png"))
    return "slices.png"


def write(work: Work, name: str, values: Values) -> list[str]:
    grid = f"{name}.grid"
    made = [slices(work, values), *page.play(work, grid)]
    scale = json.loads(work.run("stats", grid, "--format", "json")[0]).get("force_scale")
    e = values.energy
    unit, length = values.unit or "units of energy", values.length_unit or "units of length"
    steps = np.linalg.norm(values.axes, axis=1)
    facts = {"values": " × ".join(map(str, e.shape)), "lowest, highest energy": f"{e.min():.4g}, {e.max():.4g} {unit}",
             "wall": "none" if values.wall is None else f"{values.wall:g} {unit}",
             "lowest point": ", ".join(map(style.place, values.place(values.lowest()), steps)) + f" {length}",
             "largest force": f"{values.force:g} N",
             "force on the device": scale and f"{scale:.4g} N for 1 {unit} in 1 {length}"}
    return [*made, *page.write(work, "table/page.html", facts=facts)]
