"""Plots like a paper's. Each function returns a figure of matplotlib, which a notebook shows and style.save() writes.

    hapgrid.plot.slice("ball.grid", "y=0")                              how many levels the points of a plane have
    hapgrid.plot.field("alanine.grid", "z=0")                           energy contours and force arrows in a plane
    hapgrid.plot.columns("there-and-back.log", "x", "s0", grid="ball.grid")  a column over another one, there and back
    hapgrid.plot.session("a.session")                                   what happened in a play, over time
    hapgrid.plot.error(["coarse.grid", "fine.grid"])                    how far play is from the model, over the spacing
    hapgrid.plot.save(figure, "a.svg")                                  PNG, SVG or PDF, by the file's name

Files are given by name, several as a list. Errors are ValueError and OSError with one line.
"""
from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterable, Sequence
from typing import Any, TypeAlias

from hapgrid.fields import field
from hapgrid.files import program
from hapgrid.quantities import AXES, Play, beside, plane_arrays, plane_name, report
from hapgrid.style import (BLUE, COLOURS, ENERGY, GREY, MARKERS, ORANGE, PURPLE, SNAP, TEXT, figure, house_style, label, legend,
                           limits, plain, save)

Name: TypeAlias = str | os.PathLike[str]
Files: TypeAlias = Name | Iterable[Name]

__all__ = ["columns", "error", "field", "save", "session", "slice"]
MOST_SNAPS = 40  # that are marked one by one
MOST_PATCHES = 8  # of a slice's legend
COLUMNS = 2000  # of a curve over time: more are not seen
LABEL = 22  # letters of an axis beside a panel, in one line
LEAST_US = 0.01  # of a time on a logarithmic axis
DASHED, DOTTED = (0, (5, 2.5)), (0, (1, 1.4))
SNAP_MARK = {"linestyle": ":", "linewidth": 1, "marker": "o", "markersize": 3.5, "markerfacecolor": "white", "markeredgewidth": 1}
SNAP_LINE = {"color": SNAP, "linestyle": (0, (5, 2, 1, 2)), "linewidth": 1, "zorder": 1}
ROW = {"level_changed": "snap", "safety_too-fast": "too fast"}


def slice(grid: str | os.PathLike[str], plane: str | None = None) -> Any:
    """The number of levels of each point in the grid's plane that is nearest to `plane`, as in "y=0"; in the middle where it
    is left out."""
    import numpy

    arrays, axis, index, u, v = plane_arrays(grid, plane)
    origin, spacing, counts, known = arrays["origin"], float(arrays["spacing"]), arrays["counts"].astype(int), report(os.fspath(grid))
    levels = numpy.zeros((counts[v], counts[u]), int)
    points = arrays["point"][arrays["point"][:, axis] == index]
    numpy.add.at(levels, (points[:, v], points[:, u]), 1)
    most = max(int(levels.max()), 1)
    low, high = (origin[[u, v]] - spacing / 2), origin[[u, v]] + (counts[[u, v]] - 0.5) * spacing
    width, height = high - low
    scale = min(4.6 / width, 4.2 / height)
    with house_style() as module:
        drawn = figure(max(width * scale, 1.2) + 1.6, max(height * scale, 0.8) + 0.85)
        axes = drawn.add_subplot()
        colours = _level_colours(module, most)
        axes.imshow(levels, origin="lower", extent=(low[0], high[0], low[1], high[1]), aspect="equal", vmin=-0.5, vmax=most + 0.5,
                    cmap=module.colors.ListedColormap(["white", *colours]))
        unit = known["length_unit"]
        title = f"{known['model']}, levels at {plane_name(axis, origin[axis] + index * spacing, spacing, unit, plane)}"
        axes.set(xlabel=label(AXES[u], unit), ylabel=label(AXES[v], unit), title=plain(title))
        _levels_legend(drawn, axes, levels, colours)
    return drawn


def _level_colours(module: Any, most: int) -> Any:
    """From light to dark; few levels keep to the light half."""
    return [module.colormaps["YlGnBu"](0.16 + 0.79 * k / max(most - 1, 4)) for k in range(most)]


def _levels_legend(drawn: Any, axes: Any, levels: Any, colours: Any) -> None:
    from matplotlib import cm, colors, patches

    there = sorted(set(levels.flat))
    if len(there) <= MOST_PATCHES:
        words = {0: "not reached", 1: "1 level"}
        handles = [patches.Patch(facecolor="white" if k == 0 else colours[k - 1], edgecolor="#444444", linewidth=0.6,
                                 label=words.get(k, f"{k} levels")) for k in there]
        axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.02, 1), handlelength=1, handleheight=1)
        return
    scale = cm.ScalarMappable(colors.Normalize(0.5, len(colours) + 0.5), colors.ListedColormap(colours))
    drawn.colorbar(scale, ax=axes, label="levels")


def columns(files: Files, x: str, y: str, *, grid: Name | None = None, allow_process: Name | None = None,
            names: Iterable[str] | None = None, labels: Sequence[str] | None = None) -> Any:
    """Column `y` over column `x` of logs, sessions and files of frames, one over the other. The columns are those of
    hapgrid-play(1), and "force" and "sent" for the length of the vectors.

    grid           the file of the grid that was played: it tells the units, and gives a session its states and energies
    allow_process  the definition whose command may be run as the model for that, as in play
    names          of the files in the legend
    labels         of the two axes, in place of the columns' names

    The way back is told from the way there, where x is a place. What the model does when it snaps is dotted."""
    plays = [Play(file, grid, allow_process) for file in _each(files)]
    names = [os.path.basename(play.path) for play in plays] if names is None else list(names)
    if len(names) != len(plays):
        raise ValueError(f"{len(names)} names for {len(plays)} files")
    with house_style():
        drawn = figure()
        axes = drawn.add_subplot()
        every = []
        for k, (play, name) in enumerate(zip(plays, names)):
            wanted = [one for one in beside(y) if one[0] == y or one[0] in _there(play)] if len(plays) == 1 else [(y, "")]
            for number, (column, _) in enumerate(wanted):
                every.append(play.column(column))
                colours = (BLUE, ORANGE) if len(plays) == 1 else (COLOURS[k % len(COLOURS)],) * 2
                styles = [(DOTTED,) * 2, ("-", DASHED)][number == 0] if len(plays) == 1 else ("-", DASHED)
                said = name if len(plays) > 1 else "" if number == 0 else None
                _curve(axes, play.column(x), every[-1], play.snaps(), said, colours, styles, x)
            for number, (_, said) in enumerate(wanted if len(wanted) > 1 else []):
                axes.plot([], [], color=GREY, linestyle=DOTTED if number else "-", label=said)
        if len(plays) > 1 and any(x != "t" and turn(play.column(x)) < len(play.ticks) - 1 for play in plays):
            for style, said in (("-", "there"), (DASHED, "back")):
                axes.plot([], [], color=GREY, linestyle=style, label=said)
        if any(len(play.snaps()) for play in plays):
            axes.plot([], [], color=GREY, label="the model snaps", **SNAP_MARK)
        _limits_of(axes, every)
        axes.set(xlabel=plain(labels[0]) if labels else plays[0].label(x), ylabel=plain(labels[1]) if labels else plays[0].label(y))
        axes.margins(x=0.02)
        legend(axes)
    return drawn


def _each(files: Files) -> list[Name]:
    return [files] if isinstance(files, (str, os.PathLike)) else list(files)


def _there(play: Play) -> list[str]:
    """Names of the columns that have a value somewhere."""
    names = []
    for name in play.names():
        try:
            values = play.column(name)
        except ValueError:
            continue
        if (values == values).any():
            names.append(name)
    return names


def turn(x: Any) -> int:
    """The tick in which the way back begins: x is the farthest from its beginning there, for the first time. The last one
    where there is no way back."""
    import numpy

    return int(numpy.argmax(numpy.abs(x - x[0])))


def _curve(axes: Any, x: Any, y: Any, snaps: Any, name: str | None, colours: Sequence[str], styles: Any, over: str) -> None:
    """One curve: there and back, broken where the model snaps. Without a name, None, it is not in the legend."""
    import numpy

    back = len(x) - 1 if over == "t" else turn(x)
    whole = back == len(x) - 1
    snaps = [int(k) for k in snaps if 0 < k < len(x)]
    halves = [(0, back + 1, "there")] + ([] if whole else [(back, len(x), "back")])
    for (begin, end, half), colour, style in zip(halves, colours, styles):
        inside = [k for k in snaps if begin < k < end]
        at = [k - begin for k in inside]
        said = None if name is None else name if half == "there" and name else "" if whole or name else half
        axes.plot(numpy.insert(x[begin:end], at, numpy.nan), numpy.insert(y[begin:end], at, numpy.nan), color=colour, linestyle=style,
                  label=said or None)
        for k in inside[:MOST_SNAPS]:
            if name is not None:
                axes.plot(x[k - 1:k + 1], y[k - 1:k + 1], color=colour, zorder=3, **SNAP_MARK)


def session(file: Name, grid: Name | None = None, allow_process: Name | None = None) -> Any:
    """What happened in a play, over time: force, HIP, energy, times, and what was flagged. `file` is a session, a log or a file
    of frames; `grid`, the grid that was played, adds units, and the energies of a session. allow_process: see columns()."""
    import numpy

    play = Play(file, grid, allow_process)
    panels = [_force_panel, _hip_panel]
    panels += [_work_panel] if play.report and "flags" in play.ticks.dtype.names else []
    panels += [_energy_panel] if "energy" in _there(play) else []
    panels += [_time_panel] if "lateness_us" in play.ticks.dtype.names and play.column("lateness_us").max() > 0 else []
    rows = _flags(play)
    heights = [1.5] * len(panels) + ([0.22 * len(rows) + 0.1] if rows else [])
    t, snaps = play.column("t"), play.snaps()
    with house_style():
        drawn = figure(7.6, sum(heights) + 0.32 * len(heights) + 0.6)
        grid_of_axes = drawn.add_gridspec(len(heights), 1, height_ratios=heights)
        every: list[Any] = []
        for k in range(len(heights)):
            axes = drawn.add_subplot(grid_of_axes[k], sharex=every[0] if every else None)
            every.append(axes)
            if k < len(panels):
                panels[k](axes, play, t)
                for at in t[snaps] if len(snaps) <= MOST_SNAPS else []:
                    axes.axvline(at, **SNAP_LINE)
                if len(axes.get_ylabel()) > LABEL:
                    axes.set_ylabel(axes.get_ylabel().replace(" / ", "\n/ "))
                legend_beside(axes, bool(len(snaps)) and k == 0 and len(snaps) <= MOST_SNAPS)
            else:
                _strip(axes, t, rows)
            axes.tick_params(labelbottom=k == len(heights) - 1)
        for axes in every:
            axes.set_xlim(t[0], max(t[-1], numpy.nextafter(t[0], numpy.inf)) if t[-1] > t[0] else t[0] + 1)
        every[-1].set_xlabel(label("time", "s"))
        drawn.align_ylabels(every)
    return drawn


def legend_beside(axes: Any, snaps: bool) -> None:
    """The legend to the right of a panel."""
    if snaps:
        axes.plot([], [], label="the model snaps", **SNAP_LINE)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.04))


def reduced(t: Any, y: Any) -> tuple[Any, Any]:
    """The smallest and the largest value in each of some thousand columns, so that a peak of one tick is seen however long
    the play is. Where ticks are missing the curve is broken."""
    import numpy

    gaps: Any = numpy.flatnonzero(numpy.diff(t) > max(10 * numpy.median(numpy.diff(t)), (t[-1] - t[0]) / COLUMNS)) + 1 if len(t) > 2 else []
    xs: list[Any] = []
    ys: list[Any] = []
    for part_t, part in zip(numpy.split(t, gaps), numpy.split(y, gaps)):
        width = max(len(t) // COLUMNS, 1)
        if width > 1:
            whole = len(part) // width * width
            blocks, rest = part[:whole].reshape(-1, width), part[whole:]
            pairs = [numpy.column_stack([blocks.min(1), blocks.max(1)]).ravel(), rest]
            part_t, part = numpy.concatenate([numpy.repeat(part_t[:whole:width], 2), part_t[whole:]]), numpy.concatenate(pairs)
        xs += [part_t, [numpy.nan]]
        ys += [part, [numpy.nan]]
    return numpy.concatenate(xs), numpy.concatenate(ys)


def _force_panel(axes: Any, play: Play, t: Any) -> None:
    every = []
    styles = {kind: style for kind, style in (("force", DOTTED), ("sent", "-")) if kind in play.ticks.dtype.names}  # frames have one
    for a, name in enumerate(AXES):
        for kind, style in styles.items():
            every.append(play.column(f"{kind}_{name}"))
            axes.plot(*reduced(t, every[-1]), color=COLOURS[a], linestyle=style, label=name if kind == "sent" else None,
                      linewidth=None if kind == "sent" else 1.2)
    for kind, word in (("sent", "as sent"), ("force", "of the model")):
        if kind in styles:
            axes.plot([], [], color=GREY, linestyle=styles[kind], linewidth=1.2, label=word)
    _limits_of(axes, every)
    axes.set_ylabel(label("force", "N"))


def _hip_panel(axes: Any, play: Play, t: Any) -> None:
    for a, name in enumerate(AXES):
        axes.plot(*reduced(t, play.column(name)), color=COLOURS[a], label=name)
    _limits_of(axes, [play.column(name) for name in AXES])
    axes.set_ylabel(label("HIP", play.units["length"]))


def _work_panel(axes: Any, play: Play, t: Any) -> None:
    """The force that was sent, times the way of the HIP until the next tick, since the beginning; a simulated device begins
    anew in each of its sessions."""
    import numpy

    hip, sent = play.ticks["hip"], play.ticks["sent"]
    work = numpy.zeros(len(t))
    work[1:] = (sent[:-1] * numpy.diff(hip, axis=0)).sum(1)
    work[~numpy.isfinite(work)] = 0
    total = numpy.cumsum(work)
    bit = list(play.report["flags"]).index("begins") if "begins" in play.report["flags"] else None
    if bit is not None:
        begins = numpy.flatnonzero(play.ticks["flags"] >> bit & 1)
        for begin, end in zip(begins, [*begins[1:], len(t)]):
            total[begin:end] -= total[begin]
    settings = json.loads(play.report["settings"] or "{}")
    scale = settings.get("scale_per_m", 0) if isinstance(settings, dict) else 0
    factor = 1000 / scale if isinstance(scale, (int, float)) and scale > 0 else 1
    axes.plot(*reduced(t, total * factor), color="black")
    _limits_of(axes, [total * factor])
    axes.set_ylabel(label("work on the hand", play.report["energy"]["unit"]))


def _energy_panel(axes: Any, play: Play, t: Any) -> None:
    curves = [(name, word) for name, word in beside("energy") if name in _there(play)]
    for (name, word), colour in zip(curves, (ENERGY, TEXT)):
        axes.plot(*reduced(t, play.column(name)), color=colour, label=word if len(curves) > 1 else None)
    _limits_of(axes, [play.column(name) for name, _ in curves])
    axes.set_ylabel(play.label("energy"))


def _time_panel(axes: Any, play: Play, t: Any) -> None:
    import numpy

    for name, colour, word in (("lateness_us", PURPLE, "lateness"), ("compute_us", "black", "compute time")):
        axes.plot(*reduced(t, numpy.maximum(play.column(name), LEAST_US)), color=colour, linewidth=1, label=word)
    axes.set_yscale("log")
    axes.set_ylabel(label("time", "µs"))


def _limits_of(axes: Any, columns_: Any) -> None:
    import numpy

    limits(axes, numpy.concatenate(columns_))


def _flags(play: Play) -> list[tuple[str, Any]]:
    """Name and truth values of the flags that are set in some ticks."""
    rows: list[tuple[str, Any]] = []
    if "flags" not in play.ticks.dtype.names:
        return rows
    for bit, name in enumerate((play.report or {}).get("flags", {})):
        values = play.ticks["flags"] >> bit & 1
        if values.any() and name != "begins":
            rows.append((ROW.get(name, name.removeprefix("safety_")), values))
    return rows


def _strip(axes: Any, t: Any, rows: Sequence[tuple[str, Any]]) -> None:
    """A row for each flag, the first on top."""
    import numpy
    tick = numpy.median(numpy.diff(t)) if len(t) > 1 else 1
    for row, (_, values) in enumerate(rows):
        edges = numpy.flatnonzero(numpy.diff(numpy.concatenate([[0], values, [0]])))
        spans = [(t[a], max(t[b - 1] + tick - t[a], (t[-1] - t[0]) / 600)) for a, b in zip(edges[::2], edges[1::2])]
        axes.broken_barh(spans, (row - 0.35, 0.7), facecolor=SNAP if rows[row][0] == "snap" else GREY)
    axes.set(ylim=(len(rows) - 0.4, -0.6), yticks=range(len(rows)))
    axes.set_yticklabels([plain(name) for name, _ in rows])
    axes.tick_params(axis="y", length=0)


def error(grids: Files, *, walks: int = 100, options: Sequence[str] = ()) -> Any:
    """How far play is from the model along random walks of the hand, over the spacing of grids of one or several models:
    `verify --walks` asks the model. options: more options of verify, as ["--allow-process", "model.toml"]."""
    files = [os.fspath(file) for file in _each(grids)]
    found: dict[str, list[Any]] = {}  # model: [(spacing, report, figures)]
    for grid in files:
        known = report(grid)
        found.setdefault(known["model"], []).append((known["box"]["spacing"], known, _accuracy(grid, walks, options)))
    for rows in found.values():
        rows.sort(key=lambda row: row[0])
    panels = [name for name in ("force", "state") if any(f"{name} median" in row[2] for rows in found.values() for row in rows)]
    if not panels:
        raise ValueError(f"{files[0]}: verify has measured no error on these walks")
    with house_style():
        drawn = figure(3.4 * len(panels) + 0.4, 3.5)
        for k, name in enumerate(panels):
            axes = drawn.add_subplot(1, len(panels), k + 1)
            _error_panel(axes, name, found)
            legend(axes, columns=1)
    return drawn


def _accuracy(grid: str, walks: int, options: Sequence[str]) -> dict[str, tuple[Any, str]]:
    """The figures of verify's row `accurate`, by name: value and unit."""
    command = [program("verify"), grid, "--recompute", "none", "--walks", str(walks), "-v", "--format", "json", *options]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    try:
        checks = json.loads(done.stdout)["checks"]
    except ValueError:
        raise ValueError(done.stderr.decode(errors="replace").strip().removeprefix("verify: ")) from None
    figures = [check["figures"] for check in checks if check["name"] == "accurate"]
    return {one["name"]: (one["value"], one["unit"]) for one in (figures[0] if figures else [])}


def _error_panel(axes: Any, name: str, found: dict[str, Any]) -> None:
    import numpy
    from matplotlib import ticker

    every, units, lengths = set(), set(), set()
    for number, (model, rows) in enumerate(found.items()):
        for what, filled in (("median", True), ("99 %", False)):
            points = [(spacing, figures[f"{name} {what}"][0]) for spacing, _, figures in rows
                      if f"{name} {what}" in figures and figures[f"{name} {what}"][0] > 0]
            if not points:
                continue
            x, y = numpy.array(points).T
            order = f", order {numpy.polyfit(numpy.log(x), numpy.log(y), 1)[0]:.1f}" if len(set(x)) > 1 else ""
            colour = COLOURS[number % len(COLOURS)]
            axes.plot(x, y, color=colour, marker=MARKERS[number % len(MARKERS)], linestyle="-" if filled else DASHED,
                      markerfacecolor=colour if filled else "white",
                      label=plain((f"{model}, " if len(found) > 1 else "") + what + (" of the places" if not filled else "") + order))
            every |= set(x)
        units |= {figures[f"{name} median"][1] for _, _, figures in rows if f"{name} median" in figures}
        lengths |= {known["length_unit"] for _, known, _ in rows}
    axes.set(xscale="log", yscale="log")
    axes.xaxis.set_major_locator(ticker.FixedLocator(sorted(every)))
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:.3g}"))
    axes.xaxis.set_minor_locator(ticker.NullLocator())
    axes.margins(x=0.1)
    axes.set(xlabel=label("spacing", lengths.pop() if len(lengths) == 1 else ""),
             ylabel=label(f"error of the {name}", units.pop() if len(units) == 1 else ""))
