"""Paths that one has (--path): what of the hand's way is given with them, in place of a search.

A path is a row of frames with energies. Its conformation is the minimum that lies downhill of its first frame. Several
paths that have an end in common are a tree: two of them make one path through that end, and more meet there; the model
keeps the molecule on one of them at a time.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from hapgrid.apps.common import sandbox
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed, read_bytes
from scipy.interpolate import PchipInterpolator, make_interp_spline

from . import files, formats, geometry, mending, titles, xyz
from .elements import MASSES, SYMBOLS
from .mending import Shape, apart
from .molecule import MOST_BYTES, BadInput, Molecule, signed
from .results import Path, Result
from .xtb import BOHR, HARTREE

if TYPE_CHECKING:
    from .steps import Start

DENT = 1.0  # kJ/mol: a barrier is higher, and a minimum deeper. The model has the same limit.
MOST_RANGE = 1000.0  # kJ/mol between frames: else the unit is another one
ONE_END = 0.05  # angstrom between ends of paths that are one
ONE_ENERGY = 1.0  # kJ/mol, there
UNEVEN, MOST_NODES = 2.5, 61  # steps of a path, the longest by the shortest; nodes of it
EVEN_STEP = 1e-6


# Reading

def read(paths: Sequence[str], charge: int | None, unpaired: int | None, unit: str | None, anew: bool) -> dict[str, Any]:
    """{paths: [(name, Shapes)], charge, unpaired, unit, said} of files. anew: without the energies in titles. Errors: BadInput."""
    said: list[str] = []
    given = [_shapes(path, unit, said.append) for path in paths]
    if anew and any(one.energy is not None for shapes, _ in given for one in shapes):
        said.append("the energies in the titles are not taken: --calculator computes them")
        given = [([replace(one, energy=None) for one in shapes], words) for shapes, words in given]
    first = given[0][0][0]
    for path, (shapes, _) in zip(paths, given):
        if shapes[0].numbers != first.numbers:
            raise BadInput(f"{path}: its atoms are not those of {paths[0]}, in their order")
    strange = sorted(set(first.numbers) - set(MASSES))
    if strange:
        raise BadInput(f"{paths[0]}: {SYMBOLS[strange[0]] if strange[0] else 'an unknown element'}: only molecules of "
                       f"{' '.join(SYMBOLS[z] for z in MASSES)} can be felt")
    formats.check_count(len(first.numbers), paths[0])
    charges = [words for _, words in given]
    charge = next((w[0] for w in charges if w[0] is not None), 0) if charge is None else charge
    unpaired = next((w[1] for w in charges if w[1] is not None), None) if unpaired is None else unpaired
    unpaired = (sum(first.numbers) - charge) % 2 if unpaired is None else unpaired
    known = {one.energy is not None for shapes, _ in given for one in shapes}
    if len(known) > 1:
        path, bare = next((path, one) for path, (shapes, _) in zip(paths, given) for one in shapes if one.energy is None)
        raise BadInput(f"{path}: frame {bare.number} has no energy, and others have one: remove theirs, and xtb computes all")
    energies = [(one.energy, path, one.number) for path, (shapes, _) in zip(paths, given) for one in shapes if one.energy is not None]
    if len(energies) >= mending.LEAST:
        low, high = min(energies), max(energies)
        if not 0.01 < high[0] - low[0] < MOST_RANGE:
            raise BadInput(f"{high[1]}: frame {high[2]} is {high[0] - low[0]:.3g} kJ/mol above frame {low[2]}, in the units of the titles: "
                           "is it of another molecule or method, or its unit another one (--unit)?")
    return {"paths": [(_name(path), mending.mended(shapes, path, said.append)) for path, (shapes, _) in zip(paths, given)],
            "charge": charge, "unpaired": unpaired, "said": said, "known": bool(energies)}


def _name(path: str) -> str:
    """Of the path's file in the folder of results."""
    name = re.sub(r"[^A-Za-z0-9_+-]+", "-", os.path.splitext(os.path.basename(path))[0]).strip("-")
    return name if name and name != "conformation" else "path"


def _shapes(path: str, unit: str | None, say: Callable[[str], object]) -> tuple[list[Shape], tuple[int | None, int | None]]:
    """(Shapes of a file, (charge, unpaired electrons) that its titles give)."""
    content = read_bytes(path, MOST_BYTES)

    def work() -> dict[str, Any]:
        said: list[str] = []
        if content.startswith(b"- of Ulm"):
            numbers, x, energies = _trajectory(content, path)
            words: Any = (None, None)
            units = ["ev"] * len(x)
        else:
            frames = xyz.frames_of(formats.decoded(content, path), path, said.append)
            found = [titles.energy(one.title, unit) for one in frames]
            numbers, x = [one.numbers for one in frames], [one.x for one in frames]
            energies, units = [f[0] if f else None for f in found], [f[1] for f in found if f]
            words = next((w for w in (formats.charge_in(one.title, path) for one in frames) if w != (None, None)), (None, None))
        return {"numbers": numbers, "x": [np.asarray(one).tolist() for one in x], "energies": energies, "words": words,
                "said": sorted(set(said)), "units": sorted(set(units))}
    got = sandbox.run(work, path, "the file is damaged")
    if not got["numbers"]:
        raise BadInput(f"{path}: has no frames")
    for line in got["said"]:
        say(line)
    if len(got["units"]) > 1:
        raise BadInput(f"{path}: its titles have energies in {' and in '.join(got['units'])}: say by --unit which is right")
    shapes = [Shape(k, tuple(n), np.array(x), e) for k, (n, x, e) in enumerate(zip(got["numbers"], got["x"], got["energies"]), 1)]
    for one in shapes:
        distance = np.linalg.norm(one.x[:, None] - one.x[None], axis=2) + 9 * np.eye(len(one.x))
        if not np.isfinite(one.x).all() or len(one.x) < 2 or distance.min() < 0.5:
            raise BadInput(f"{path}: frame {one.number}: two atoms in one place, or a coordinate that is no number")
    return shapes, (got["words"][0], got["words"][1])


def _trajectory(content: bytes, path: str) -> tuple[list[list[int]], list[Array], list[float | None]]:
    """(numbers, positions, energies in kJ/mol) of a trajectory of ASE."""
    try:
        import io

        from ase.io.trajectory import TrajectoryReader
    except ImportError:
        raise BadInput(f"{path}: a trajectory of ASE: install the Debian package python3-ase, or write extended XYZ") from None
    numbers, x, energies = [], [], []
    for atoms in TrajectoryReader(io.BytesIO(content)):
        results = atoms.calc.results if atoms.calc else {}
        numbers.append(atoms.numbers.tolist())
        x.append(atoms.positions)
        energies.append(float(results["energy"]) * titles.EV if "energy" in results else None)
    return numbers, x, energies


def molecule(given: dict[str, Any]) -> Molecule:
    """That of the first frame, with the bonds that it has there."""
    first = given["paths"][0][1][0]
    near = geometry.bonds_of(first.numbers, first.x)
    bonds = [(j, k, 1) for j, some in enumerate(near) for k in some if j < k]
    one = Molecule("the path", first.numbers, first.x, [0] * len(first.numbers), bonds, given["charge"], given["unpaired"],
                   bonds_change=True)
    one.formula = mending.formula(first.numbers)
    return one


# From frames to paths around a conformation

def found(start: Start) -> Result:
    """The Result as the folder's files have it."""
    o, folder, one = start.options, start.folder, start.molecule
    given = start.given or {}

    def compute() -> list[str]:
        def energies(some: list[Array]) -> list[float]:
            if start.calculator is not None:
                return start.surface(some[0]).energies(some)
            return folder.each("energies of the frames", lambda x: start.surface(x).energy(x), some, o.threads)
        if not given["known"]:
            folder.say(f"  no energies in the titles: they are those of {start.words}, with charge {signed(one.charge)} and "
                       f"{one.unpaired} unpaired electrons")
        return files.write_set(folder, result(start, energies), f"hapgrid molecule --path: {start.source}")
    key = [[name, [[s.x.tolist(), s.energy] for s in shapes]] for name, shapes in given["paths"]]
    method = None if given["known"] else [start.method, o.solvent, one.charge, one.unpaired]
    folder.step("structures", "", [], [key, method], compute)
    return files.read_set(folder)


def result(start: Start, energies: Callable[[list[Array]], list[float]]) -> Result:
    """The Result of the paths that were read. energies(shapes): hartree of positions in bohr, where the frames have none."""
    given = start.given
    assert given is not None
    everything = [one for _, shapes in given["paths"] for one in shapes]
    if not given["known"]:
        left = iter([value * HARTREE for value in energies([one.x / BOHR for one in everything])])
        given = {**given, "paths": [(name, [replace(one, energy=next(left)) for one in shapes]) for name, shapes in given["paths"]]}
    rows = [(name, _evened(start, name, [(one.x, float(one.energy)) for one in shapes], energies)) for name, shapes in given["paths"]]
    heights = [e for _, row in rows for _, e in row]
    if max(heights) - min(heights) <= DENT:
        raise Failed(f"--path: its energies differ by {max(heights) - min(heights):.2g} kJ/mol at most, and a barrier that is felt is "
                     f"higher than {DENT:g} kJ/mol")
    branches = _tree(rows)
    numbers = list(everything[0].numbers)
    masses = np.array([MASSES[z] for z in numbers])
    at = 0
    if len(branches) == 1:
        at, row = _cut(branches[0][1])
        branches = [(branches[0][0], row)]
    x0 = geometry.as_in_file(geometry.on_principal_axes(branches[0][1][at][0], masses) / BOHR)
    rest = branches[0][1][at][1]
    made: list[Path] = []
    for name, row in branches:
        made.append(_path(name, row, at, x0, rest, masses))
    return Result(numbers, masses, "given" if given["known"] else start.words, [], x0, rest / HARTREE, None, made)


Row = list[tuple[Array, float]]  # positions, angstrom, and energies, kJ/mol


def _foot(row: Row) -> int:
    """The node of the minimum downhill of the first one; dents do not count."""
    energies = [e for _, e in row]
    ways = []
    for k in range(len(row)):
        lowest = int(np.argmin(energies[:k + 1]))
        if max(energies[lowest:k + 1]) - energies[lowest] > DENT:
            break
        ways.append(lowest)
    return ways[-1]


def _cut(row: Row) -> tuple[int, Row]:
    """(the node of the conformation, the row); one that closes begins and ends in its highest node."""
    at = _foot(row)
    if apart(row[0][0], row[-1][0]) > mending.SAME:
        return at, row
    last = len(row) - 1
    top = max(range(last), key=lambda k: row[k][1])
    return (at - top) % last, [*row[top:last], *row[:top], row[top]]


def kinds(energies: Sequence[float], start: int) -> dict[int, str]:
    """{node: minimum or saddle} of a path, without its start; ends that are higher than their neighbours are none."""
    out: dict[int, str] = {}
    for step in (-1, 1):
        top = bottom = start
        climbs = True
        for k in range(start + step, -1 if step < 0 else len(energies), step):
            if climbs:
                top = k if energies[k] > energies[top] else top
                if energies[top] - energies[k] > DENT and energies[top] - energies[bottom] > DENT:
                    out[top], bottom, climbs = "saddle", k, False
                elif energies[k] < energies[bottom]:
                    bottom = top = k
            else:
                bottom = k if energies[k] < energies[bottom] else bottom
                if energies[k] - energies[bottom] > DENT:
                    out[bottom], top, climbs = "minimum", k, True
        if not climbs:
            out[bottom] = "minimum"
    out.pop(start, None)
    return dict(sorted(out.items()))


def _path(name: str, row: Row, start: int, x0: Array, rest: float, masses: Array) -> Path:
    """A path around its node `start`, whose shape is x0 and whose energy is `rest`."""
    energies = [e for _, e in row]
    closes = apart(row[0][0], row[-1][0]) < mending.SAME
    if closes:
        energies[-1] = energies[0]
    nodes: list[Array] = [x / BOHR for x, _ in row]
    nodes[start] = x0
    for k in [*range(start + 1, len(row)), *range(start - 1, -1, -1)]:
        nodes[k] = geometry.as_in_file(geometry.aligned(nodes[k], nodes[k - 1 if k > start else k + 1], masses))
    if closes:
        nodes[-1 if start < len(row) - 1 else 0] = nodes[0 if start < len(row) - 1 else -1]
    stationary = kinds(energies, start)
    return Path(nodes, [(e if k != start else rest) / HARTREE for k, e in enumerate(energies)], start, stationary, name=name)


def _evened(start: Start, name: str, row: Row, energies: Callable[[list[Array]], list[float]]) -> Row:
    """_even(), with the method's energies if it gives those of the frames; what was done is said."""
    even = _even(row)
    if even is row:
        return row
    known = start.given is not None and start.given["known"]
    start.folder.say(f"  {name}: {len(row)} frames, in steps that are uneven or many, become {len(even)} in even ones, with energies "
                     + ("between those of the frames" if known else f"by {start.words}"))
    return even if known else [(x, e * HARTREE) for (x, _), e in zip(even, energies([x / BOHR for x, _ in even]))]


def _even(row: Row) -> Row:
    """The row, or where its steps are uneven or many, one with even steps between what is stationary."""
    steps = np.array([apart(a, b) for (a, _), (b, _) in zip(row, row[1:])])
    if steps.max() <= UNEVEN * max(steps.min(), EVEN_STEP) and len(row) <= MOST_NODES:
        return row
    even = np.ones(len(row[0][0]))
    chain = [row[0][0]]
    for x, _ in row[1:]:
        chain.append(geometry.aligned(x, chain[-1], even))
    along = np.concatenate([[0], np.cumsum(np.maximum(steps, EVEN_STEP))])
    energies = np.array([e for _, e in row])
    shape, height = make_interp_spline(along, chain, k=min(3, len(row) - 1)), PchipInterpolator(along, energies)
    stops = sorted({0, len(row) - 1, *kinds(energies.tolist(), 0)})
    count = min(len(row), MOST_NODES) - 1
    at = [0.0]
    for a, b in zip(along[stops[:-1]], along[stops[1:]]):
        at += np.linspace(a, b, max(2, round(count * (b - a) / along[-1])) + 1)[1:].tolist()
    return [(shape(s), float(height(s))) for s in at]


def _tree(rows: list[tuple[str, Row]]) -> list[tuple[str, Row]]:
    """Paths that begin in the end that all share; two that share one are a single path through it, and so is a chain."""
    while True:
        ends = [(n, side, row[side]) for n, (_, row) in enumerate(rows) for side in (0, -1)]
        meets = {(n, side): [(m, other) for m, other, b in ends if m != n and _one(a, b, rows[n][0], rows[m][0])]
                 for n, side, a in ends}
        pair = next(((end, found[0]) for end, found in meets.items() if len(found) == 1), None)
        if len(rows) < 2:
            return rows
        if pair is None:
            break
        (n, side), (m, other) = pair
        first = rows[n][1] if side else rows[n][1][::-1]
        second = rows[m][1][::-1] if other else rows[m][1]
        joined = (f"{rows[n][0]}+{rows[m][0]}", first + second[1:])
        rows = [joined, *(row for k, row in enumerate(rows) if k not in (n, m))]
    hubs = {end: found for end, found in meets.items() if len(found) == len(rows) - 1}
    if len(hubs) != len(rows) or len({n for n, _ in hubs}) != len(rows):
        raise Failed("--path: the paths share no end, or branch in several places: give those that meet in one shape, "
                     f"to {ONE_END:g} angstrom")
    out = []
    for n, side in sorted(hubs):
        name, row = rows[n]
        row = row[::-1] if side else row
        if min(e for _, e in row) < row[0][1] - 0.1 and _foot(row) != 0:
            raise Failed(f"--path: {name} falls from the end that all paths share, which must be a minimum")
        out.append((name, row))
    return out


def _one(a: tuple[Array, float], b: tuple[Array, float], here: str, there: str) -> bool:
    if apart(a[0], b[0]) > ONE_END:
        return False
    if abs(a[1] - b[1]) > ONE_ENERGY:
        raise Failed(f"--path: {here} and {there} share an end, of which their energies differ by {abs(a[1] - b[1]):.1f} kJ/mol: "
                     "are they of one method?")
    return True
