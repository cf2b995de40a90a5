"""The picture of a force field in a plane of a grid: hapgrid.plot.field()."""
from __future__ import annotations

import io
import os
import subprocess
import tempfile
from typing import Any

from hapgrid.files import array_of, program
from hapgrid.quantities import AXES, plane_arrays, plane_name, report
from hapgrid.style import ENERGY, FORCE, GREY, figure, house_style, label, plain, sign

ARROWS = 22  # along the longer side
CONTOURS = 12
WHOLE = 97  # per cent of the points that contours reach: the rest lies inside of something


def field(grid: str | os.PathLike[str], plane: str | None = None) -> Any:
    """Energy contours and force arrows in the grid's plane that is nearest to `plane`, as in "z=0", and where the model's
    spheres cut it; in the middle of y where it is left out. At each point they are those of a hand that comes from the left."""
    import numpy

    arrays, axis, index, u, v = plane_arrays(grid, plane)
    origin, spacing, counts, known = arrays["origin"], float(arrays["spacing"]), arrays["counts"].astype(int), report(os.fspath(grid))
    rows = []
    for k in range(counts[v]):  # to the right, and back, which is not drawn
        for i in [*range(counts[u]), *range(counts[u] - 2, 0, -1)]:
            at = numpy.zeros(3)
            at[[u, v, axis]] = i, k, index
            rows.append(origin + spacing * at)
    log = _played(grid, rows, "--log")
    ticks = numpy.loadtxt(io.BytesIO(log), ndmin=2)
    names = log.split(b"\n", 1)[0].decode().lstrip("# ").split("\t")
    width = max(2 * counts[u] - 2, 1)
    shown = numpy.arange(counts[v])[:, None] * width + numpy.arange(counts[u])

    def column(name: str) -> Any:
        return ticks[shown, names.index(name)] if name in names else numpy.full(shown.shape, numpy.nan)
    energy, force = column("energy"), [column(f"force_{AXES[a]}") for a in (u, v)]
    x, y = (origin[a] + spacing * numpy.arange(counts[a]) for a in (u, v))
    spheres = _cut(_played(grid, rows[:1], "--frames"), axis, origin[axis] + index * spacing)
    length = max(x[-1] - x[0], spacing), max(y[-1] - y[0], spacing)
    scale = min(5.2 / length[0], 4.6 / length[1])
    unit = known["length_unit"]
    with house_style() as module:
        drawn = figure(max(length[0] * scale, 1.4) + 1.8, max(length[1] * scale, 1) + 0.9)
        axes = drawn.add_subplot()
        axes.set_aspect("equal")
        for centre, radius in spheres:
            axes.add_patch(module.patches.Circle(centre[[u, v]], radius, facecolor="#e8eaee", edgecolor=GREY, linewidth=0.8, zorder=0))
        high = numpy.nanpercentile(energy, WHOLE) if numpy.isfinite(energy).any() else numpy.nan
        if high > numpy.nanmin(energy) and min(energy.shape) > 1:
            levels = module.ticker.MaxNLocator(CONTOURS).tick_values(numpy.nanmin(energy), high)
            levels = [one for one in levels if one - numpy.nanmin(energy) > 0.02 * (high - numpy.nanmin(energy))]
            lines = axes.contour(x, y, energy, levels=levels, colors=ENERGY, linewidths=0.8, zorder=2)
            axes.clabel(lines, fontsize=7, fmt=lambda value: f"{value:g}")
        step = -(-max(counts[u], counts[v]) // ARROWS)
        length_of = numpy.hypot(*force)
        most = float(length_of[::step, ::step].max())
        if most > 0:
            arrows = [numpy.where(length_of > 0.01 * most, part, numpy.nan)[::step, ::step] for part in force]
            axes.quiver(x[::step], y[::step], *arrows, color=FORCE, angles="xy",
                        scale_units="xy", scale=most / (1.6 * step * spacing), width=0.004, zorder=3)
        axes.set_xlim(x[0] - spacing / 2, x[-1] + spacing / 2)
        axes.set_ylim(y[0] - spacing / 2, y[-1] + spacing / 2)
        where = f"{known['model']} at {plane_name(axis, origin[axis] + index * spacing, spacing, unit, plane)}"
        energies = f"energy contours in {sign(known['energy_unit']) or 'its unit'}, " if high == high else ""
        axes.set_title(f"{plain(where)}\n{plain(energies)}the longest arrow is {most:.2g} N")
        axes.set(xlabel=label(AXES[u], unit), ylabel=label(AXES[v], unit))
    return drawn


def _played(grid: Any, rows: Any, option: str) -> bytes:
    """What play writes of a path through these places, from the grid alone. Raises ValueError."""
    text = "".join(" ".join(map(repr, map(float, row))) + "\n" for row in rows)
    command = [program("play"), os.fspath(grid), "--beside", "off", "--device", "path:-", option, "-"]
    done = subprocess.run(command, input=text.encode(), capture_output=True, check=False)
    if done.returncode != 0:
        raise ValueError(done.stderr.decode(errors="replace").strip().rsplit("\n", 1)[-1])
    return done.stdout


def _cut(frames: bytes, axis: int, height: float) -> Any:
    """(centre, radius of the circle) of each sphere that a plane cuts, in the first of these frames."""
    with tempfile.TemporaryFile() as file:
        file.write(frames)
        file.seek(0)
        first = array_of("frames", stdin=file)[:1]
    found = []
    for centre, radius in zip(first["shape"].reshape(-1, 3), first["radius"].ravel()):
        part = radius**2 - (centre[axis] - height)**2
        if part > 0:
            found.append((centre, part**0.5))
    return found
