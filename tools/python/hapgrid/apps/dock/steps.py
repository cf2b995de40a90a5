"""The steps of a host and a ligand from their files to the page."""

from __future__ import annotations

import json
import math
import os
from argparse import Namespace
from typing import Any

import numpy as np
from hapgrid.apps.common import grid as grids, page
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed, digest, pieces, remove
from hapgrid.apps.table import readers
from hapgrid.apps.table.steps import table_text
from hapgrid.apps.table.work import Work, run_steps
from scipy.interpolate import CubicSpline

from . import field, maps, prepare

LARGEST = 10.0  # angstrom: the sides of a box that nobody asked for
MAX_LEVELS = 254
WALL = "wall.table"
MOST_POINTS = 200_000  # of a grid: at each of them, deepest orientations are sought
PART = 250  # points, whose deepest orientations are sought and kept at a time
FORCE_SCALE = 0.02  # newtons for 1 kJ/(mol angstrom), unless this makes the largest force larger than
LARGEST_FORCE = 2.7  # newtons: the search may find a little more, and a hand feels no more than 3
TICKS = 4000  # of the way in, and as many back
# By the number of a link's direction.
STEPS = [np.array((i, j, k)) for k in (-1, 0, 1) for j in (-1, 0, 1) for i in (-1, 0, 1) if (i, j, k) != (0, 0, 0)]


def run(o: Namespace) -> str:
    """Everything; the line for standard output."""
    for given in (o.host, o.ligand):
        next(pieces(given), None)  # says why, where it cannot be read
    options = [o.centre, o.size, o.spacing, o.torsions, o.atoms]

    def define(work: Work, name: str) -> None:
        work.enter()
        given = [o.host, o.ligand, *(field.files(o.host).values() if _is_field(o.host) else ())]
        work.step("definition", "reading host and ligand" if o.atoms else "computing the maps", [], [*map(digest, given), options],
                  lambda: _define(o, work, name))
    return run_steps("dock", o, [o.ligand, o.host], define, _page)


def _is_field(path: str) -> bool:
    return path.lower().endswith(".fld")


def _define(o: Namespace, work: Work, name: str) -> list[str]:
    remove(work.path(f"{name}.toml"))  # where this run is refused, the next one must not take its files for good
    own = _is_field(o.host)
    if own and o.atoms:
        raise Failed(f"{o.host}: --atoms needs the file of the host's atoms, not of its maps")
    host = field.host(o.host) if own else maps.pdbqt(work, o.host, "host", maps.MOST_BY_ATOMS if o.atoms else maps.MOST_HOST)
    ligand = maps.pdbqt(work, o.ligand, "ligand", maps.MOST_LIGAND)
    reach = maps.reach(ligand, work.read("ligand.pdbqt"), o.torsions > 0)
    if own:
        names, tables = field.read(o.host, ligand)
        low = tables[0].origin
        high = low + tables[0].axes[0, 0] * (np.array(tables[0].values.shape) - 1)
        if reach > np.linalg.norm(high - low) / 2:
            raise Failed(f"{o.ligand}: atoms {reach:.1f} angstrom from the ligand's centre: it is larger than the maps")
    else:
        places = np.array([place for _, place, _ in host])
        low, high = places.min(axis=0), places.max(axis=0)
    centre = np.array(o.centre) if o.centre else (low + high) / 2
    size = np.array(o.size) if o.size else np.minimum(high - low, LARGEST)
    counts = [max(int(np.floor(s / o.spacing + 1e-6)) + 1, 2) for s in size]
    if math.prod(counts) > MOST_POINTS:
        raise Failed(f"the box has {math.prod(counts):,} points, at most {MOST_POINTS:,} are possible: make --size "
                     "smaller or --spacing larger")
    size = (np.array(counts) - 1) * o.spacing
    if own and not ((centre - size / 2 >= low - 1e-6) & (centre + size / 2 <= high + 1e-6)).all():
        raise Failed(f"the box is not inside the maps, which go from {_point(low)} to {_point(high)}")
    low, high = centre - size / 2, centre + size / 2
    prepare.require_near(host, low, high, reach)
    made = []
    if o.atoms:
        names, tables = [], []
    elif own:
        tables = [field.fitted(table, low - reach, high + reach) for table in tables]
    else:
        made = maps.compute(work, host, ligand, low - reach, high + reach)
        names, tables = field.read(work.path("host.maps.fld"), ligand)
    files = [] if o.atoms else maps.write(work, names, tables, host, low, high)
    by = "atom by atom" if o.atoms else f"maps {', '.join(names)}, {tables[0].axes[0, 0]:g} angstrom apart"
    work.say(f"  host of {len(host)} atoms, ligand of {len(ligand)} atoms, without hydrogens on carbon, which count with it; "
             f"grid of {' x '.join(map(str, counts))} points, {o.spacing:g} angstrom apart; {by}")
    types = "" if o.atoms else f"types = {json.dumps(names)}   # what the maps are of: AutoDock's types of atoms, charge e, desolvation d\n"

    def definition(force_scale: float) -> str:
        return f"""\
# {name}: made by `hapgrid dock`, which keeps what is changed here and computes the grid anew when it is run
# again. Lengths in Å.

[model]
plugin = "docking"

[model.files]             # the grid carries their contents
ligand = "ligand.pdbqt"
{'host = "host.pdbqt"' if o.atoms else f"maps = {json.dumps(files)}"}
wall = "{WALL}"       # the energy of the deepest pose at each point, with `soft` and `torsions` as they were made here

[model.parameters]
{types}soft = 20                 # kJ/mol: energies E above it, of an atom and of all, become soft (1 + ln(E / soft))
highest = 0               # kJ/mol: a pose that is higher turns over to the deepest one at the nearest point of the wall
torsions = {o.torsions}              # so many of the ligand's bonds turn, those around which its own energy changes least
substep = {0.05 if o.torsions else 0.1:<16g}# of the HIP between two minimisations, Å
tolerance = 0.1           # orientations whose atoms are no farther apart, RMS, are one; Å
force_scale = {force_scale:<12.3g}# newtons on the device for 1 kJ/(mol Å)

[grid]
origin = {[round(float(v), 6) for v in low]}
spacing = {o.spacing:g}
counts = {counts}

[search]
max_levels = {MAX_LEVELS}           # orientations that a place may have
store = ["energy", "force"]
"""
    work.write(WALL, "")  # until it is known
    work.write(".records.toml", definition(FORCE_SCALE))
    largest = _wall(work, low, o.spacing, counts, o.threads)
    remove(work.path(".records.toml"))
    work.write(f"{name}.toml", definition(FORCE_SCALE * LARGEST_FORCE / max(largest, LARGEST_FORCE)))
    return [*([] if own else ["host.pdbqt"]), "ligand.pdbqt", WALL, f"{name}.toml", *files, *made]


def _point(place: Array) -> str:
    return ",".join(f"{v:g}" for v in place.round(2))


def _wall(work: Work, low: Array, spacing: float, counts: list[int], threads: int) -> float:
    """Makes the table of the wall by .records.toml, and returns the largest force of poses and wall. Refuses a box in which
    the ligand overlaps with the host everywhere."""
    points = (low + spacing * np.argwhere(np.ones(counts[::-1]))[:, ::-1]).round(6).tolist()
    given = [work.version, work.read(".records.toml"), [work.digest(file) for file in work.inputs_of(".records.toml")]]

    def part(begin: int) -> Array:
        of = points[begin:begin + PART]

        def seek() -> list[float]:
            seeds = f".records.{begin}"
            work.run("seed", ".records.toml", "--set", f"seeds.points={of}", "-o", seeds)
            found = grids.records(work, seeds)
            os.remove(work.path(seeds))
            at = found["point"].astype(int) @ (1, counts[0], counts[0] * counts[1]) - begin
            lowest = np.full(len(of), np.inf)
            np.minimum.at(lowest, at, found["energy"])
            poses = np.linalg.norm(found["force"][found["energy"] <= 0], axis=1)
            return [*lowest.tolist(), float(poses.max(initial=0))]
        return work.cache.take([*given, begin], seek, lambda kept: np.array([*kept], float).reshape(len(of) + 1))
    found = work.each("seeking the deepest orientation at each point", part, range(0, len(points), PART), threads)
    lowest = np.concatenate([one[:-1] for one in found])
    if lowest.min() > 0:
        raise Failed(f"the ligand overlaps with the host everywhere in the box: its best energy is {lowest.min():.1f} kJ/mol: "
                     "give another --centre or --size")
    # A spline needs four points along each axis.
    values = np.pad(lowest.reshape(counts, order="F"), 1, mode="reflect", reflect_type="odd")
    work.write(WALL, table_text(readers.Table(values, low - spacing, spacing * np.eye(3))))
    # By the spline of the plug-in, which is "not a knot" as well.
    slopes = np.linalg.norm([CubicSpline(np.arange(n), values, axis=axis)(np.arange(n), 1) for axis, n in
                             enumerate(values.shape)], axis=0)[1:-1, 1:-1, 1:-1] / spacing
    return max(*(one[-1] for one in found), FORCE_SCALE * slopes.max(where=lowest.reshape(counts, order="F") > 0, initial=0))


def _page(work: Work, name: str) -> list[str]:
    grid = f"{name}.grid"
    report = json.loads(work.run("stats", grid, "--format", "json")[0])
    origin, spacing = np.array(report["box"]["origin"]), report["box"]["spacing"]
    counts = np.array(report["box"]["counts"])
    records = grids.records(work, grid)
    points, energy, state, links = records["point"].astype(int), records["energy"], records["state"], records["destination"]
    ends = [origin + spacing * end for end in _line(points, energy, links, counts)]
    work.write("path.txt", page.path_text(ends, "angstrom", TICKS))
    poses = _poses(points, energy, state)
    rows = [(energy[n], *(origin + spacing * points[n]), *state[n]) for n in poses]
    heads = ["energy / (kJ/mol)", "x / angstrom", "y / angstrom", "z / angstrom",
             *(f"R{r}{c}" for c in (1, 2) for r in (1, 2, 3)),
             *(f"torsion {t + 1} / rad" for t in range(state.shape[1] - 6))]
    work.write("poses.tsv", "\t".join(heads) + "\n" + "".join("\t".join(f"{v:.4f}" for v in row) + "\n" for row in rows))
    deepest = points[poses[0]]
    edge = ((deepest == 0) | (deepest == counts - 1)).any()
    if edge:
        work.say("  the deepest pose lies on the edge of the box, so deeper ones may lie outside: see --size and --centre")
    made = ["path.txt", "poses.tsv", *page.play(work, grid)]
    for picture, at in (("outside.png", 0.0), ("inside.png", TICKS / 1000)):
        work.run("view", "played.frames", "--at", at, "--png", picture)
        made.append(picture)
    levels = {"on average": f"{report['average_levels']:.2f}", "at most": len(report["levels_histogram"]) - 1}
    return [*made, *page.write(work, "dock/page.html", facts=levels, at_edge=edge, poses=[row[:4] for row in rows])]


def _line(points: Array, energy: Array, links: Array, counts: Array) -> tuple[Array, Array]:
    """(start, end): from the box's edge straight towards the point of the deepest record, as far as the energy falls. Of the
    directions in which the links from the start's first level lead about as deep, it is one that climbs little and falls
    far, and along an axis rather than not, since the grid knows the energy best along its edges."""
    first: dict[Any, int] = {}
    for n, point in enumerate(map(tuple, points)):
        first.setdefault(point, n)
    deepest = points[energy.argmin()]
    lines = []
    for q, step in enumerate(STEPS):
        at = deepest
        while ((at - step >= 0) & (at - step < counts)).all():
            at = at - step
        if tuple(at) not in first or (at == deepest).all():
            continue
        start, record, along = at, first[tuple(at)], []
        while True:
            along.append(energy[record])
            if (at == deepest).all():
                break
            record, at = int(links[record][q]), at + step
        end = int(np.argmin(along))
        most = max(along[:end + 1])
        if end > 0:
            climbs, falls = most - min(along[0], 0), along[end] - min(along[0], 0)
            lines.append((along[end], (round(climbs / 5), round(falls / 5), np.abs(step).sum(), most), start, start + end * step))
    if not lines:  # the energy rises on all of them
        return deepest, deepest
    deep = min(line[0] for line in lines)
    return min((line for line in lines if line[0] <= deep + abs(deep) / 4), key=lambda line: line[1])[2:]


def _poses(points: Array, energy: Array, state: Array, most: int = 10, apart: float = 1.0) -> list[int]:
    """Numbers of the deepest records, no two of which are neighbours with about the same orientation."""
    taken: list[int] = []
    for n in np.argsort(energy)[:5000]:
        if all(np.abs(points[n] - points[k]).max() > 2 or np.linalg.norm(state[n] - state[k]) > apart for k in taken):
            taken.append(n)
        if len(taken) == most:
            break
    return taken
