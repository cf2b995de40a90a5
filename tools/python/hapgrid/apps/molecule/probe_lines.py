"""The hand's ways. Where it holds an atom, each leads this along the way on which a path moves it: all round and back where
the path closes, otherwise to both ends. Where it pushes with the probe, each comes from outside, pushes at an atom in the
direction in which a path moves it, and goes back on the same line. Several such lines are played, and the best is kept: where
a path goes on behind its barriers one that leaves the molecule in another minimum, otherwise the one that turns the torsion
farthest.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from hapgrid.apps.common import files
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.work import Work

from . import holding
from .definition import CLEAR, PROBE, paths_of
from .elements import RADII
from .holding import Hold
from .results import Path, Result
from .rotors import label
from .xtb import BOHR

if TYPE_CHECKING:
    from .steps import Start

Line: TypeAlias = tuple[Array, Array, int]  # start, end, and the atom that is pushed
TRIED = 5
STEP, COARSE_STEP = 0.002, 0.02  # angstrom a tick
BEYOND = 2.0  # angstrom that the probe follows the atom beyond its way
ALIKE = 0.7  # cosine above which two lines at an atom are one
STAYS = 0.02  # of a t at the end: the molecule is in another minimum
PAST = np.array([0.0, 0, 1])  # against the broad side of a molecule that lies on its principal axes


def directions(count: int = 150) -> Array:
    """Even on a sphere (golden spiral)."""
    k = np.arange(count) + 0.5
    z = 1 - 2 * k / count
    turn = np.pi * (1 + 5**0.5) * k
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def there_and_back(start: Array, end: Array, step: float) -> Array:
    there = np.linspace(start, end, max(int(np.ceil(np.linalg.norm(end - start) / step)), 2) + 1)
    return np.concatenate([there, there[-2::-1]])


def write_way(folder: Work, name: str, way: Array, title: str) -> None:
    rows = [" ".join(f"{v:.4f}" for v in p) for p in way]
    folder.write(name, "\n".join([f"# {title}", "# x y z of the probe in angstrom, a line a tick", *rows]) + "\n")


def read_log(text: str) -> dict[str, Array]:
    """{name: column} of what play --log wrote."""
    head, *rows = text.splitlines()
    return dict(zip(head.lstrip("# ").split("\t"), np.array([row.split("\t") for row in rows], float).T))


def lines(x: Array, move: Array, reach: Array, clear: float, low: Array, high: Array) -> list[Line]:
    """Lines (start, end, atom) from free places into the molecule, the most promising first. x: atoms; move: where they go;
    reach: how near the probe comes to each; clear: from touching to where a line begins; low, high: corners of the box."""
    length, found = np.linalg.norm(move, axis=1), []
    for atom in np.flatnonzero(length > 0.4 * length.max()):
        for u in directions():
            along, places = float(move[atom] @ u), (x - x[atom]) @ u
            across = np.linalg.norm(x - x[atom] - places[:, None] * u, axis=1)
            # Where the probe touches each atom, and where it comes near one.
            touches, near = (np.where(across < far, places - np.sqrt(np.clip(far**2 - across**2, 0, None)), np.inf)
                             for far in (reach, reach + clear))
            start = x[atom] + near.min() * u
            if along >= 0.5 * length[atom] and touches.argmin() == atom and ((low <= start) & (start <= high)).all():
                end = np.clip(x[atom] + (along + BEYOND - reach[atom]) * u, low, high)
                found.append((along, u, (start, end, int(atom))))
    out: list[tuple[Array, Line]] = []
    for _, u, line in sorted(found, key=lambda one: -one[0]):  # different atoms and directions
        if not any(line[2] == other[2] and u @ v > ALIKE for v, other in out):
            out.append((u, line))
    return [line for _, line in out[:TRIED]]


OVER, STAYS_THERE = "over {} of its {} barriers", "goes over its barrier, and stays there"


def write(start: Start, grid: str, structures: Result) -> list[str]:
    """Writes the files path-NAME.txt and returns their names."""
    hold = holding.decided(start, structures)
    taken = paths_of(start.folder.path(grid.removesuffix(".grid") + ".toml"))
    if not hold or not taken:
        return _pushed(start.folder, grid, structures, start.options.threads)
    return _held(start, grid, structures, hold, taken)


def _held(start: Start, grid: str, structures: Result, hold: Hold, taken: Sequence[str]) -> list[str]:
    folder, found = start.folder, {f.name: f for f in structures.found}
    what, made = holding.words(start.molecule, hold.atoms), []
    for k, (name, (places, energies)) in enumerate(holding.ways(structures, hold, taken).items()):
        file, path = f"path-{name}.txt", found[name]
        ticks = holding.there_and_back(path, places)
        write_way(folder, file, ticks, "tried")
        saddles = _saddles(path, energies)
        log = read_log(folder.run("play", grid, "--device", f"path:{file}", "--log", "-",
                                  watch=lambda gone: folder.waiting("playing the hand's ways", gone, None)).out)
        t, snaps = log[f"s{taken.index(name)}"], int(log["snap"].sum())
        over = sum(_crossed(t, at) for at in saddles)
        said = "over all its barriers" if over > 1 else "over its barrier" if saddles else "to its end"
        if over < len(saddles):
            said = OVER.format(over, len(saddles))
        if snaps and not start.options.soft:
            said += f", and the molecule snaps {snaps} times" if snaps > 1 else ", and the molecule snaps once"
        write_way(folder, file, ticks, f"The hand holds {what} and leads it along its own way, and back: {name} goes {said}.")
        made.append((-over, k, file))
    return [file for *_, file in sorted(made)]


def _saddles(path: Path, energies: Array) -> list[float]:
    """The t of each barrier of a path: where its energy is higher than at both neighbours. Both ends of one that closes are one
    barrier."""
    last = len(energies) - 1
    tops = [k for k in range(1, last) if energies[k - 1] < energies[k] >= energies[k + 1]]
    return [(k - path.start) / last for k in tops + [last] * path.closes]


def _crossed(t: Array, at: float) -> bool:
    """Whether t passed a barrier, of which it has one value before and another after."""
    off = (t - at + 0.5) % 1 - 0.5
    return bool(((off[1:] * off[:-1] < 0) & (np.abs(off[1:] - off[:-1]) < 0.3)).any())


def _pushed(folder: Work, grid: str, structures: Result, threads: int) -> list[str]:
    """Writes the files path-NAME.txt of the paths in a grid, and returns their names: first those that lead over a barrier,
    then that which turns most."""
    found, x = {f.name: f for f in structures.found}, structures.x * BOHR
    reach = np.array([RADII[z] for z in structures.numbers]) + PROBE
    box = json.loads(folder.run("stats", grid, "--get", "box").out)
    inside = np.array(box["origin"]), np.array(box["origin"]) + box["spacing"] * (np.array(box["counts"]) - 1)
    taken = paths_of(folder.path(grid.removesuffix(".grid") + ".toml"))

    def towards(move: Array) -> list[Line]:
        return lines(x, move, reach, CLEAR + box["spacing"], *inside)
    tries = [(k, line) for k, name in enumerate(taken) for y in _aims(found[name]) for line in towards(y * BOHR - x)]
    played = folder.each("pushing the molecule to see which way turns it", lambda n: _played(folder, grid, n, *tries[n]),
                         range(len(tries)), threads)
    best: dict[str, tuple[Line, str]] = {}
    for (stays, turn), (k, line) in sorted(zip(played, tries), key=lambda one: one[0], reverse=True):
        how = STAYS_THERE if stays else f"goes {min(100 * turn, 100):.0f} % of its way"
        best.setdefault(taken[k], (line, f": {taken[k]} {how}"))
    if not best:  # nothing turns
        best = {"past": (line, "") for line in towards(np.tile(PAST, (len(x), 1)))[:1]}
    for name, ((start, end, atom), how) in best.items():
        write_way(folder, f"path-{name}.txt", there_and_back(start, end, STEP), "The probe pushes at "
                  f"{label(structures.numbers, atom)}, and goes back on the same line{how}.")
    return [f"path-{name}.txt" for name in best]


def _played(folder: Work, grid: str, number: int, k: int, line: Line) -> tuple[bool, float]:
    """(whether path k ends elsewhere than it began, how far it goes) on a line. number: of this one among those that are
    played at once."""
    text = f".way-{number}.txt"
    try:
        write_way(folder, text, there_and_back(*line[:2], COARSE_STEP), "tried")
        t = np.abs(read_log(folder.run("play", grid, "--device", f"path:{text}", "--log", "-").out)[f"s{k}"])
        return bool(t[-1] > STAYS), float(t.max())
    finally:
        files.remove(folder.path(text))


def _aims(path: Path) -> list[Array]:
    """The shapes towards which a path is pushed: the minima behind its barriers, or else its end, which is a barrier."""
    e = [np.inf, *path.energies, np.inf]
    return [x for k, x in enumerate(path.nodes) if e[k] > e[k + 1] <= e[k + 2] and k != path.start] or path.nodes[-1:]
