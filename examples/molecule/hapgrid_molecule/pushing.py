"""The probe's ways. One that turns a torsion comes from outside, pushes at an atom in the direction in which the path moves it,
and goes back on the same line. Several such lines are played, and the one that turns the torsion farthest is kept.

Where paths go on behind their barriers, a way pushes a torsion into the minimum behind, leaves it there, goes round the
molecule without touching it, and pushes it back from another side.
"""

import itertools
import json

import numpy as np
from hapgrid_command import files

from . import choice
from .definition import CLEAR, PROBE, RADII, paths_of
from .rotors import label
from .xtb import BOHR

TRIED = 5
STEP, COARSE_STEP = 0.002, 0.02  # angstrom a tick
BEYOND = 2.0  # angstrom that the probe follows the atom beyond its way
LINES = 60  # of those along which the atoms go, at most
RANDOM = 240
DEEPEST = 2.0  # angstrom behind an atom
NEAR = 0.02  # of a t: the molecule is in this minimum
AROUND = 0.96  # of the box: where the probe goes round


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


def straight(start, end, step, least=2):
    count = max(int(np.ceil(np.linalg.norm(end - start) / step)), least)
    return [start + (end - start) * k / count for k in range(count + 1)]


def there_and_back(start, end, step):
    there = straight(start, end, step)
    return there + there[-2::-1]


def write_way(folder, name, way, title):
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
        box = json.loads(folder.run("stats", grid, "--get", "box").out)
        self.low = np.array(box["origin"])
        self.high = self.low + box["spacing"] * (np.array(box["counts"]) - 1)
        self.middle, half = (self.low + self.high) / 2, AROUND * (self.high - self.low) / 2
        self.inner = self.middle - half, self.middle + half  # the box in which the probe goes round
        self.clear = CLEAR + box["spacing"], CLEAR  # from touching to where a line begins, or less where there is no room
        self.taken = paths_of(folder.path(grid.removesuffix(".grid") + ".toml"))
        self.radius = np.array([RADII[z] for z in structures.numbers])

    def write(self):
        found, x = {f.name: f for f in self.structures.found}, self.structures.x * BOHR
        tries = [(k, line) for k, name in enumerate(self.taken) for line in self._lines(x, found[name].nodes[-1] * BOHR - x)]

        def turned(n):
            k, (start, end, _) = tries[n]
            return float(self._played(there_and_back(start, end, COARSE_STEP), n)[:, k].max())
        most = self.folder.each("pushing the molecule to see which way turns it", turned, range(len(tries)), self.threads)
        best = {}
        for turn, (k, line) in sorted(zip(most, tries), key=lambda one: -one[0]):
            best.setdefault(k, (turn, self.taken[k], line))
        if not best:  # nothing turns: past the molecule, against its broad side
            best = {k: (0.0, "past", line) for k, line in enumerate(self._lines(x, np.tile([0.0, 0, 1], (len(x), 1)), 1))}
        names = []
        for turn, name, (start, end, atom) in best.values():
            names.append(f"path-{name}.txt")
            far = f": {name} goes {min(100 * turn, 100):.0f} % of the way to its barrier" if self.taken else ""
            write_way(self.folder, names[-1], there_and_back(start, end, STEP), "The probe pushes at "
                      f"{label(self.structures.numbers, atom)}{far}, and goes back on the same line.")
        return names

    def _lines(self, x, move, most=TRIED, alike=0.7):
        """Lines (start, end, atom) from free places into the molecule, the most promising first. x: atoms, move: where they
        go, angstrom; most: lines; alike: the cosine above which two lines at an atom are one."""
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
            if not any(line[2] == other[2] and u @ v > alike for v, other in out):
                out.append((u, line))
        return [line for _, line in out[:most]]

    def _played(self, way, number):
        """The t at each place of a way. number: of this way among those that are played at once."""
        text, log = f".way-{number}.txt", f".way-{number}.log"
        try:
            write_way(self.folder, text, way, "tried")
            self.folder.run("play", self.grid, "--device", f"path:{text}", "--log", log)
            columns = read_log(self.folder.path(log))
            return np.array([columns[f"s{k}"] for k in range(len(self.taken))]).T
        finally:
            files.remove(self.folder.path(text))
            files.remove(self.folder.path(log))


class Crossings(Ways):
    """Writes path-NAME.txt for the paths whose nearest minimum is reached, and left again."""

    def write(self):
        toml = self.grid.removesuffix(".grid") + ".toml"
        report = json.loads(self.folder.run("molecule-check", toml, "--format", "json", good=(0, 3)).out)
        minima = [m["t"] for m in report["minima"]]
        if len(minima) < 2:
            return super().write()
        rest, *others = sorted(minima, key=lambda t: np.abs(t).sum())
        names = self.folder.each("pushing the molecule over its barriers and back",
                                 lambda k: self._over(toml, k, rest, others), range(len(self.taken)), self.threads)
        return list(filter(None, names)) or super().write()

    def _over(self, toml, k, rest, minima):
        """The file of a way along path k into the first of the minima that can be reached, and back; None without."""
        for there in minima:
            if there[k] == 0 or np.count_nonzero(there) != 1:
                continue
            a, b = (choice.shape(self.folder, toml, t) for t in (rest, there))
            first = self._crossing(k, a, b, [], there)
            way = first and self._crossing(k, b, a, first, rest)
            if way:
                write_way(self.folder, f"path-{self.taken[k]}.txt", way, f"The probe pushes {self.taken[k]} over its barrier, "
                          "goes round the molecule, and pushes it back.")
                return f"path-{self.taken[k]}.txt"
        return None

    def _crossing(self, k, x, y, before, wanted):
        """`before` and a line after it that brings the molecule from shape x to y, which has the t wanted; None without. The
        lines are played one after the other in one go, since reading the grid takes longest."""
        left = self._candidates(x, y)
        while left:
            way, ends = before, []
            for line in left:
                way = self._pushed(way, line)
                ends.append(len(way) - 1)
            states = self._played(way, k)
            rest = states[max(len(before) - 1, 0)]
            n = next((n for n, end in enumerate(ends) if np.abs(states[end] - rest).max() >= NEAR), None)
            if n is None:
                return None
            way = self._pushed(before, left[n])
            if np.abs(self._played(way, k)[-1] - wanted).max() < NEAR:
                return way
            left = left[n + 1:]
        return None

    def _pushed(self, way, line):
        return [*way, *(self._round(way[-1], line[0]) if way else []), *there_and_back(*line, COARSE_STEP)]

    def _candidates(self, x, y):
        """Lines that push shape x towards y: first those along which the atoms go most, then random ones, deeper."""
        out = [(start, end) for start, end, _ in self._lines(x, y - x, LINES, 0.95)]
        draw = np.random.default_rng(1)
        for _ in range(RANDOM):
            u = draw.normal(size=3)
            u /= np.linalg.norm(u)
            aim = x[draw.integers(len(x))] + draw.uniform(-0.8, 0.8, 3)
            start = aim - u * _to_side(aim, -u, *self.inner)
            out.append((start, aim + u * min(draw.uniform(-1, DEEPEST), _to_side(aim, u, *self.inner))))
        return out

    def _round(self, here, to):
        """From one free place to another, near the sides of the box. All shapes keep away from these."""
        u, v = ((p - self.middle) / np.linalg.norm(p - self.middle) for p in (here, to))
        between = u + v + 1e-9 * np.cross(u, np.eye(3)[np.abs(u).argmin()])  # also where u is -v
        between /= np.linalg.norm(between)
        seen = [(1 - s) * a + s * b for a, b in ((u, between), (between, v)) for s in np.linspace(0, 1, 60)]
        out = [here, *(self.middle + c * _to_side(self.middle, c, *self.inner) for c in seen), to]
        return [p for one, two in zip(out, out[1:]) for p in straight(one, two, COARSE_STEP, 1)[:-1]]
