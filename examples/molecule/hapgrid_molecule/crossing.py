"""The way of the probe that turns a torsion into the minimum behind its saddle, leaves it there, goes
round the molecule without touching it, and pushes it back from another side.

Each push is a straight line, there and back. Lines are tried until one has brought the molecule where
it should be: first those along which the atoms go most, then random ones, deeper. They are played one
after the other in one go, since reading the grid takes longest.
"""

import copy
import json

import numpy as np

from . import choice, pushing
from .definition import CLEAR
from .pushing import COARSE_STEP, there_and_back

LINES = 60  # of those along which the atoms go, at most
RANDOM = 240
DEEPEST = 2.0  # angstrom behind an atom
NEAR = 0.02  # of a t: the molecule is in this minimum
AROUND = 0.96  # of the box: where the probe goes round


class Crossings(pushing.Ways):
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
        one, file = copy.copy(self), f"path-{self.taken[k]}.txt"
        one.way = f".way-{k}"
        try:
            for there in minima:
                if there[k] == 0 or np.count_nonzero(there) != 1:
                    continue
                a, b = (choice.shape(self.folder, toml, t) for t in (rest, there))
                first = one._crossing(a, b, [], there)
                way = first and one._crossing(b, a, first, rest)
                if way:
                    pushing.write_way(self.folder, file, way, f"The probe pushes {self.taken[k]} over its barrier, goes round "
                                      "the molecule, and pushes it back.")
                    return file
            return None
        finally:
            self._clean([one.way])

    def _crossing(self, x, y, before, wanted):
        """`before` and a line after it that brings the molecule from shape x to y, which has the t wanted; None without."""
        lines = self._candidates(x, y)
        while lines:
            way, ends = before, []
            for line in lines:
                way = self._pushed(way, line)
                ends.append(len(way) - 1)
            states = self._states(way)
            rest = states[max(len(before) - 1, 0)]
            n = next((n for n, end in enumerate(ends) if np.abs(states[end] - rest).max() >= NEAR), None)
            if n is None:
                return None
            way = self._pushed(before, lines[n])
            if np.abs(self._states(way)[-1] - wanted).max() < NEAR:
                return way
            lines = lines[n + 1:]
        return None

    def _pushed(self, way, line):
        """A way, and then a line there and back."""
        return [*way, *(self._round(way[-1], line[0]) if way else []), *there_and_back(*line, COARSE_STEP)]

    def _candidates(self, x, y):
        """Lines that push shape x towards y, the most promising first."""
        found = [line for clear in (self.clear, CLEAR)
                 for line in pushing.lines(x, y - x, self.radius, self.low, self.high, clear, LINES, 0.95)]
        out = [(start, end) for start, end, _ in found[:LINES]]
        draw = np.random.default_rng(1)
        middle, half = (self.low + self.high) / 2, AROUND * (self.high - self.low) / 2
        for _ in range(RANDOM):
            u = draw.normal(size=3)
            u /= np.linalg.norm(u)
            aim = x[draw.integers(len(x))] + draw.uniform(-0.8, 0.8, 3)
            start = aim - u * _reach(aim - middle, -u, half)
            end = aim + u * min(draw.uniform(-1, DEEPEST), _reach(aim - middle, u, half))
            out.append((start, end))
        return out

    def _states(self, way):
        """The t at each place of a way."""
        pushing.write_way(self.folder, self.way + ".txt", way, "tried")
        self.folder.run("play", self.grid, "--device", f"path:{self.way}.txt", "--log", self.way + ".log")
        log = pushing.read_log(self.folder.path(self.way + ".log"))
        return np.column_stack([log[f"s{k}"] for k in range(len(self.taken))])

    def _round(self, here, to):
        """From one free place to another, near the sides of the box. All shapes keep away from these."""
        middle, half = (self.low + self.high) / 2, AROUND * (self.high - self.low) / 2
        a, b = (p - middle for p in (here, to))
        a, b = a / np.abs(a / half).max(), b / np.abs(b / half).max()
        u, v = a / np.linalg.norm(a), b / np.linalg.norm(b)
        angle = np.arccos(np.clip(u @ v, -1, 1))
        between = u + v if angle <= 3.0 else np.cross(u, np.eye(3)[np.abs(u).argmin()])  # over a side
        corners = [c / np.abs(c / half).max() for c in (a, between, b)]
        out = [here]
        for p, q in zip(corners, corners[1:]):
            for s in np.linspace(0, 1, 60):
                c = (1 - s) * p / np.linalg.norm(p) + s * q / np.linalg.norm(q)
                out.append(middle + c / np.abs(c / half).max())
        out.append(to)
        return [p for one, two in zip(out, out[1:]) for p in pushing.straight(one, two, COARSE_STEP, 1)[:-1]]


def _reach(x, u, half):
    """How far from x, which is seen from the middle of the box, a direction leads to its sides."""
    return float(((np.sign(u) * half - x) / u).min())
