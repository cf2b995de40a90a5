"""The way of the probe that turns one torsion: it comes from outside, pushes at an atom that moves
far along the path, in the direction in which that moves, and goes back on the same line.

The molecule as a whole yields, too. So several such lines are played, and the one that turns the
torsion farthest is kept.
"""

import json

import numpy as np
from hapgrid_command import files

from .definition import CLEAR, PROBE, RADII, paths_of
from .rotors import label
from .xtb import BOHR

TRIED = 5
STEP, COARSE_STEP = 0.002, 0.02  # angstrom a tick
BEYOND = 2.0  # angstrom that the probe follows the atom beyond its way


def directions(count=150):
    """Even on a sphere (golden spiral)."""
    k = np.arange(count) + 0.5
    z = 1 - 2 * k / count
    turn = np.pi * (1 + 5**0.5) * k
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def lines(x, move, radius, low, high, clear, most=TRIED, alike=0.7):
    """Lines (start, end, atom) from free places into the molecule, the most promising first.
    x: atoms, move: where they go, angstrom; low, high: the corners of the box; clear: from touching
    to where a line begins; most: lines; alike: the cosine above which two lines at an atom are one."""
    length = np.linalg.norm(move, axis=1)
    reach = radius + PROBE
    found = []
    for atom in np.flatnonzero(length > 0.4 * length.max()):
        for u in directions():
            along = float(move[atom] @ u)
            if along < 0.5 * length[atom]:
                continue
            begin = _begin(x, reach, atom, u, clear)
            if begin is None:
                continue
            start, end = x[atom] + begin * u, x[atom] + (along + BEYOND - reach[atom]) * u
            if (start < low).any() or (start > high).any():
                continue
            end = start + (end - start) * _inside(start, end, low, high)
            found.append((along, int(atom), start, end))
    found.sort(key=lambda f: -f[0])
    out, atoms = [], []
    for along, atom, start, end in found:  # different atoms and directions
        u = (end - start) / np.linalg.norm(end - start)
        if not any(atom == a and u @ v > alike for a, v in atoms):
            atoms.append((atom, u))
            out.append((start, end, atom))
    return out[:most]


def _begin(x, reach, atom, u, clear):
    """Where a line towards an atom, that touches no other atom first, is free: its place before the
    atom (negative), None when another atom is in the way."""
    along = (x - x[atom]) @ u
    across = np.linalg.norm(x - x[atom] - along[:, None] * u, axis=1)

    def enters(reach):
        """Where the probe comes as near as this to each atom."""
        return np.where(across < reach, along - np.sqrt(np.clip(reach**2 - across**2, 0, None)), np.inf)
    return float(enters(reach + clear).min()) if enters(reach).argmin() == atom else None


def _inside(start, end, low, high):
    """The share of the way that is in the box."""
    way = end - start
    with np.errstate(divide="ignore", invalid="ignore"):
        limits = np.where(way > 0, (high - start) / way, np.where(way < 0, (low - start) / way, np.inf))
    return float(min(1.0, 0.98 * limits.min()))


def straight(start, end, step, least=2):
    """Places from start to end, in so many steps at least."""
    count = max(int(np.ceil(np.linalg.norm(end - start) / step)), least)
    return [start + (end - start) * k / count for k in range(count + 1)]


def there_and_back(start, end, step):
    there = straight(start, end, step)
    return there + there[-2::-1]


def write_way(folder, name, way, title):
    """A path for play."""
    rows = [" ".join(f"{v:.4f}" for v in p) for p in way]
    folder.write(name, "\n".join([f"# {title}", "# x y z of the probe in angstrom, a line a tick", *rows]) + "\n")


def read_log(path):
    """{name: column} of what play --log wrote."""
    with open(path, encoding="utf-8") as file:
        names = file.readline().lstrip("# ").rstrip("\n").split("\t")
        return dict(zip(names, np.loadtxt(file, ndmin=2).T))


class Ways:
    """The files path-NAME.txt of the paths in a grid, the one that turns a torsion farthest first."""

    def __init__(self, folder, grid, structures, threads):
        self.folder, self.grid, self.structures, self.threads = folder, grid, structures, threads
        header = json.loads(folder.run("stats", grid, "--format", "json").out)
        box = header["box"]
        self.low = np.array(box["origin"])
        self.high = self.low + box["spacing"] * (np.array(box["counts"]) - 1)
        self.clear = CLEAR + box["spacing"]
        self.taken = paths_of(folder.path(grid.removesuffix(".grid") + ".toml"))
        self.radius = np.array([RADII[z] for z in structures.numbers])

    def write(self):
        found = {f.name: f for f in self.structures.found}
        x = self.structures.x * BOHR
        ways = [self._lines(x, found[name].nodes[-1] * BOHR - x) for name in self.taken]
        turned = self._played([(k, line) for k, lines_of in enumerate(ways) for line in lines_of])
        best = []
        for k, name in enumerate(self.taken):
            if ways[k]:
                most, turned = turned[:len(ways[k])], turned[len(ways[k]):]
                best.append((max(most), name, ways[k][int(np.argmax(most))]))
        if not best:  # nothing turns: past the molecule, against its broad side
            best = [(0.0, "past", line) for line in self._lines(x, np.tile([0.0, 0.0, 1.0], (len(x), 1)))[:1]]
        best.sort(key=lambda b: -b[0])
        names = []
        for turned, name, (start, end, atom) in best:
            at = label(self.structures.numbers, atom)
            names.append(f"path-{name}.txt")
            far = f": {name} goes {min(100 * turned, 100):.0f} % of the way to its barrier" if self.taken else ""
            write_way(self.folder, names[-1], there_and_back(start, end, STEP),
                      f"The probe pushes at {at}{far}, and goes back on the same line.")
        return names

    def _lines(self, x, move):
        return (lines(x, move, self.radius, self.low, self.high, self.clear)
                or lines(x, move, self.radius, self.low, self.high, CLEAR))

    def _played(self, lines_of):
        """The largest t of path k for each (k, line)."""
        names = [f".way-{n}" for n in range(len(lines_of))]
        commands = []
        for name, (_, line) in zip(names, lines_of):
            write_way(self.folder, name + ".txt", there_and_back(*line[:2], COARSE_STEP), "tried")
            commands.append(["play", self.grid, "--device", f"path:{name}.txt", "--log", name + ".log"])
        try:
            self.folder.run_each("pushing the molecule to see which way turns it", commands, self.threads)
            return [float(read_log(self.folder.path(name + ".log"))[f"s{k}"].max()) for name, (k, _) in zip(names, lines_of)]
        finally:
            self._clean(names)

    def _clean(self, names):
        for name in names:
            files.remove(self.folder.path(name + ".txt"))
            files.remove(self.folder.path(name + ".log"))
