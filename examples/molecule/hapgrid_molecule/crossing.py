"""The way of the probe that turns a torsion into the minimum behind its saddle, leaves it there, goes
round the molecule without touching it, and pushes it back from another side.

Each push is a straight line, there and back. Lines are tried until one has brought the molecule where
it should be: first those along which the atoms go most, then random ones, deeper. They are played one
after the other in one go, since reading the grid takes longest.
"""

import copy
from concurrent.futures import ThreadPoolExecutor

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
        minima = [m["t"] for m in choice.checked(self.folder, toml)["minima"]]
        if len(minima) < 2:
            return super().write()
        rest, *others = sorted(minima, key=lambda t: np.abs(t).sum())
        searches = []
        for k, name in enumerate(self.taken):
            one = copy.copy(self)
            one.way = f".way-{k}"
            there = [t for t in others if t[k] != 0 and np.count_nonzero(t) == 1]
            searches.append(lambda one=one, name=name, there=there: one._over(toml, name, rest, there))
        tell = self.folder.counted("pushing the molecule over its barriers and back", len(searches))
        names = []
        with ThreadPoolExecutor(self.threads) as pool:
            for done, name in enumerate(pool.map(lambda search: search(), searches), 1):
                tell(done)
                names += [name] if name else []
        return names or super().write()

    def _over(self, toml, name, rest, minima):
        """The file of a way into the first of the minima that can be reached, and back; None without."""
        try:
            for there in minima:
                way = self._there_and_back(toml, rest, there)
                if way is not None:
                    pushing.write_way(self.folder, f"path-{name}.txt", way, f"The probe pushes {name} over its barrier, goes "
                                      "round the molecule, and pushes it back.")
                    return f"path-{name}.txt"
            return None
        finally:
            self._clean([self.way])

    def _there_and_back(self, toml, rest, there):
        """The places of the probe, or None."""
        a, b = (choice.shape(self.folder, toml, t) for t in (rest, there))
        first = self._crossing(a, b, [], there)
        if first is None:
            return None
        return self._crossing(b, a, first, rest)

    def _crossing(self, x, y, before, wanted):
        """`before` and a line after it that brings the molecule from shape x to y, which has the t
        wanted."""
        lines = self._candidates(x, y)
        while lines:
            way, ends = list(before), []
            for start, end in lines:
                way += [*self._round(way[-1] if way else None, start), *there_and_back(start, end, COARSE_STEP)]
                ends.append(len(way) - 1)
            n = self._first(way, ends, len(before))
            if n is None:
                return None
            way = [*before, *self._round(before[-1] if before else None, lines[n][0]),
                   *there_and_back(*lines[n], COARSE_STEP)]
            if self._is_at(self._states(way)[-1], wanted):
                return way
            lines = lines[n + 1:]
        return None

    def _first(self, way, ends, begin):
        """The first line after which the molecule is not where it was before all."""
        states = self._states(way)
        rest = states[max(begin - 1, 0)]
        return next((n for n, end in enumerate(ends) if not self._is_at(states[end], rest)), None)

    @staticmethod
    def _is_at(state, wanted):
        return bool(np.abs(state - wanted).max() < NEAR)

    def _candidates(self, x, y):
        found = []
        for clear in (self.clear, CLEAR):
            found += pushing.lines(x, y - x, self.radius, self.low, self.high, clear, LINES, 0.95)
        return [(start, end) for start, end, _ in found[:LINES]] + self._random(x)

    def _random(self, x):
        draw = np.random.default_rng(1)
        middle, half = (self.low + self.high) / 2, AROUND * (self.high - self.low) / 2
        out = []
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
        names, rows = pushing.read_log(self.folder.path(self.way + ".log"))
        first = names.index("s0")
        return rows[:, first:first + len(self.taken)]

    def _round(self, here, to):
        """From one free place to another, near the sides of the box. All shapes keep away from these."""
        if here is None:
            return []
        middle, half = (self.low + self.high) / 2, AROUND * (self.high - self.low) / 2
        a, b = (p - middle for p in (here, to))
        a, b = a / np.abs(a / half).max(), b / np.abs(b / half).max()
        u, v = a / np.linalg.norm(a), b / np.linalg.norm(b)
        angle = np.arccos(np.clip(u @ v, -1, 1))
        if angle > 3.0:  # over a side
            side = np.cross(u, np.eye(3)[np.abs(u).argmin()])
            corners = [a, side, b]
        else:
            corners = [a, u + v, b]
        corners = [c / np.abs(c / half).max() for c in corners]
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
