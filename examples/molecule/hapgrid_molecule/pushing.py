"""The probe's ways. Each comes from outside, pushes at an atom in the direction in which a path moves it, and goes back on the
same line. Several such lines are played, and the best is kept: where a path goes on behind its barriers one that leaves the
molecule in another minimum, otherwise the one that turns the torsion farthest.
"""

import itertools
import json

import numpy as np
from hapgrid_command import files

from .definition import CLEAR, PROBE, RADII, paths_of
from .rotors import label
from .xtb import BOHR

TRIED = 5
STEP, COARSE_STEP = 0.002, 0.02  # angstrom a tick
BEYOND = 2.0  # angstrom that the probe follows the atom beyond its way
ALIKE = 0.7  # cosine above which two lines at an atom are one
STAYS = 0.02  # of a t at the end: the molecule is in another minimum


def directions(count=150):
    """Even on a sphere (golden spiral)."""
    k = np.arange(count) + 0.5
    z = 1 - 2 * k / count
    turn = np.pi * (1 + 5**0.5) * k
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def _begin(x, reach, atom, u, clear):
    """The place on a line towards an atom, before it (negative), where the line is still free; no number where it touches
    another atom first."""
    along = (x - x[atom]) @ u
    across = np.linalg.norm(x - x[atom] - along[:, None] * u, axis=1)

    def enters(reach):
        """Where the probe comes as near as this to each atom."""
        return np.where(across < reach, along - np.sqrt(np.clip(reach**2 - across**2, 0, None)), np.inf)
    return float(enters(reach + clear).min()) if enters(reach).argmin() == atom else np.nan


def _to_side(x, u, low, high):
    """How many times u leads from x, in a box, to its sides."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.where(u == 0, np.inf, (np.where(u > 0, high, low) - x) / u).min())


def there_and_back(start, end, step):
    there = np.linspace(start, end, max(int(np.ceil(np.linalg.norm(end - start) / step)), 2) + 1)
    return np.concatenate([there, there[-2::-1]])


def write_way(folder, name, way, title):
    rows = [" ".join(f"{v:.4f}" for v in p) for p in way]
    folder.write(name, "\n".join([f"# {title}", "# x y z of the probe in angstrom, a line a tick", *rows]) + "\n")


def read_log(path):
    """{name: column} of what play --log wrote."""
    with open(path, encoding="utf-8") as file:
        names = file.readline().lstrip("# ").rstrip("\n").split("\t")
        return dict(zip(names, np.loadtxt(file, ndmin=2).T))


class Ways:
    """The files path-NAME.txt of the paths in a grid: first those that lead over a barrier, then that which turns most."""

    def __init__(self, folder, grid, structures, threads):
        self.folder, self.grid, self.structures, self.threads = folder, grid, structures, threads
        box = json.loads(folder.run("stats", grid, "--get", "box").out)
        self.low = np.array(box["origin"])
        self.high = self.low + box["spacing"] * (np.array(box["counts"]) - 1)
        self.clear = CLEAR + box["spacing"], CLEAR  # from touching to where a line begins, or less where there is no room
        self.taken = paths_of(folder.path(grid.removesuffix(".grid") + ".toml"))
        self.radius = np.array([RADII[z] for z in structures.numbers])

    def write(self):
        found, x = {f.name: f for f in self.structures.found}, self.structures.x * BOHR
        tries = [(k, line) for k, name in enumerate(self.taken) for y in _aims(found[name])
                 for line in self._lines(x, y * BOHR - x)]
        turned = self.folder.each("pushing the molecule to see which way turns it", lambda n: self._turned(n, *tries[n]),
                                  range(len(tries)), self.threads)
        best = {}
        for (stays, turn), (k, line) in sorted(zip(turned, tries), key=lambda one: one[0], reverse=True):
            how = "goes over its barrier, and stays there" if stays else f"goes {min(100 * turn, 100):.0f} % of its way"
            best.setdefault(self.taken[k], (line, f": {self.taken[k]} {how}"))
        if not best:  # nothing turns: past the molecule, against its broad side
            best = {"past": (line, "") for line in self._lines(x, np.tile([0.0, 0, 1], (len(x), 1)), 1)}
        for name, ((start, end, atom), how) in best.items():
            write_way(self.folder, f"path-{name}.txt", there_and_back(start, end, STEP), "The probe pushes at "
                      f"{label(self.structures.numbers, atom)}, and goes back on the same line{how}.")
        return [f"path-{name}.txt" for name in best]

    def _lines(self, x, move, most=TRIED):
        """Lines (start, end, atom) from free places into the molecule, the most promising first. x: atoms, move: where they
        go, angstrom; most: lines."""
        length, reach, found = np.linalg.norm(move, axis=1), self.radius + PROBE, []
        for atom, u in itertools.product(np.flatnonzero(length > 0.4 * length.max()), directions()):
            along = float(move[atom] @ u)
            for clear in self.clear if along >= 0.5 * length[atom] else ():
                start, end = (x[atom] + far * u for far in (_begin(x, reach, atom, u, clear), along + BEYOND - reach[atom]))
                if ((self.low <= start) & (start <= self.high)).all():
                    end = start + (end - start) * min(1.0, 0.98 * _to_side(start, end - start, self.low, self.high))
                    found.append((clear == CLEAR, -along, u, (start, end, int(atom))))
                    break
        out = []
        for _, _, u, line in sorted(found, key=lambda f: f[:2]):  # different atoms and directions
            if not any(line[2] == other[2] and u @ v > ALIKE for v, other in out):
                out.append((u, line))
        return [line for _, line in out[:most]]

    def _turned(self, number, k, line):
        """(whether path k ends elsewhere than it began, how far it goes) on a line. number: of this one among those that are
        played at once."""
        text, log = f".way-{number}.txt", f".way-{number}.log"
        try:
            write_way(self.folder, text, there_and_back(*line[:2], COARSE_STEP), "tried")
            self.folder.run("play", self.grid, "--device", f"path:{text}", "--log", log)
            t = np.abs(read_log(self.folder.path(log))[f"s{k}"])
            return bool(t[-1] > STAYS), float(t.max())
        finally:
            files.remove(self.folder.path(text))
            files.remove(self.folder.path(log))


def _aims(path):
    """The shapes towards which a path is pushed: the minima behind its barriers, or else its end, which is a barrier."""
    e = [np.inf, *path.energies, np.inf]
    return [x for k, x in enumerate(path.nodes) if e[k] > e[k + 1] <= e[k + 2] and k != path.start] or path.nodes[-1:]
