"""relax() in 2,000 random landscapes whose minima are known: it ends in the basin in which it starts.

On a line the slope is E' = m(s) (s - r0) (s - r1) ... with minima at r0, r2, ... and tops at r1, r3, ... between them.
m is positive: it jumps at a kink, and is nearly 0 at a fold. At a tip, which is a minimum, s - r is only a sign. In more
dimensions the energy is a sum of such lines along the axes of a turned frame, of which some are a hundred times as stiff:
the flow downhill is that of each line. Noise is of a part of the energy, and of the largest slope.
"""
import math
import random
import struct

import hapgrid
import pytest

STEP, TOLERANCE, LANDSCAPES = 0.1, 1e-6, 2000


def product(*factors):
    """Polynomials multiplied; coefficients begin with that of s^0."""
    p = [1.0]
    for factor in factors:
        q = [0.0] * (len(p) + len(factor) - 1)
        for i, a in enumerate(p):
            for j, b in enumerate(factor):
                q[i + j] += a * b
        p = q
    return p


def value(p, s):
    total = 0.0
    for a in reversed(p):
        total = total * s + a
    return total


class Line:
    def __init__(self, dice, kind):
        self.roots = [dice.uniform(-2, -1)]
        for _ in range(dice.choice((2, 4))):
            self.roots.append(self.roots[-1] + dice.uniform(0.4, 1.2))
        self.tip = dice.choice(self.roots[::2]) if kind == "tip" else math.nan
        self.kink = dice.uniform(self.roots[0], self.roots[-1]) if kind == "kink" else math.inf
        self.steeper = 10**dice.uniform(-1, 1)
        fold, least = dice.uniform(self.roots[0], self.roots[-1]), 10**dice.uniform(-2.5, -1)
        factors = [[-r, 1.0] for r in self.roots if r != self.tip]
        self.slopes = product(*factors, *([[fold * fold + least * least, -2 * fold, 1.0]] if kind == "fold" else []))
        self.energies = [0.0, *(a / (i + 1) for i, a in enumerate(self.slopes))]

    def __call__(self, s):
        """Energy and slope."""
        energy, slope = value(self.energies, s), value(self.slopes, s)
        if self.tip == self.tip:
            sign = 1 if s > self.tip else -1
            energy, slope = sign * (energy - value(self.energies, self.tip)), sign * slope
        if s > self.kink:
            at = value(self.energies, self.kink)
            energy, slope = at + self.steeper * (energy - at), self.steeper * slope
        return energy, slope

    def start(self, dice):
        """Anywhere, or near a top, or on it."""
        if dice.random() < 0.6:
            return dice.uniform(self.roots[0] - 0.5, self.roots[-1] + 0.5)
        return dice.choice(self.roots[1::2]) + dice.choice((0, 1, -1)) * 10**dice.uniform(-9, -3)

    def minimum(self, s):
        return self.roots[2 * sum(s >= top for top in self.roots[1::2])]


class Landscape:
    def __init__(self, dice, number):
        self.size = 1 if number % 2 else dice.randint(2, 5)
        self.noise = (0, 1e-14, 1e-7)[number // 2 % 3]
        kinds = ("smooth", "kink", "fold", "tip") if self.size == 1 else ("smooth", "fold")
        self.lines = [Line(dice, dice.choice(kinds)) for _ in range(self.size)]
        self.stiff = [1.0 if i == 0 else 10**dice.uniform(0, 2) for i in range(self.size)]
        self.axes = []
        for _ in range(self.size):  # by Gram and Schmidt
            axis = [dice.gauss(0, 1) for _ in range(self.size)] if self.size > 1 else [1.0]
            for _ in range(2):
                for other in self.axes:
                    along = sum(a * b for a, b in zip(axis, other))
                    axis = [a - along * b for a, b in zip(axis, other)]
            self.axes.append([a / math.hypot(*axis) for a in axis])

    def along(self, s):
        return [sum(a * b for a, b in zip(axis, s)) for axis in self.axes]

    def place(self, q):
        return [sum(q[i] * axis[j] for i, axis in enumerate(self.axes)) for j in range(self.size)]

    def exact(self, s):
        parts = [[k * a for a in line(q)] for k, line, q in zip(self.stiff, self.lines, self.along(s))]
        return sum(energy for energy, _ in parts), self.place([slope for _, slope in parts])

    def __call__(self, s):
        energy, gradient = self.exact(s)
        if not self.noise:
            return energy, gradient
        dice = random.Random(struct.pack(f"{len(s)}d", *s))
        size = self.noise * max(map(abs, gradient))
        return energy * (1 + self.noise * dice.uniform(-1, 1)), [a + size * dice.uniform(-1, 1) for a in gradient]


def on_tops(landscape, q):
    return [abs(k * line(a)[1]) < 3 * TOLERANCE for k, line, a in zip(landscape.stiff, landscape.lines, q)]


def sides(landscape, s):
    return [line.minimum(a) for line, a in zip(landscape.lines, landscape.along(s))]


def test_it_ends_in_the_basin_in_which_it_starts():
    for number in range(LANDSCAPES):
        dice = random.Random(number)
        landscape = Landscape(dice, number)
        q = [line.start(dice) for line in landscape.lines]
        start = landscape.place(q)
        reached = hapgrid.relax(landscape, start, step=STEP, tolerance=TOLERANCE)
        for k, line, a, b, is_top in zip(landscape.stiff, landscape.lines, q, landscape.along(reached), on_tops(landscape, q)):
            # To either side of a top.
            either = {line.minimum(a - 1e-3), line.minimum(a + 1e-3)} if is_top else {line.minimum(a)}
            assert line.minimum(b) in either, (number, k, a, b, line.roots)
            # Noise is added to the gradient, which is within the tolerance with it; at a tip only the place tells.
            assert abs(k * line(b)[1]) < 3 * TOLERANCE or abs(b - line.tip) < 1e-6, (number, b, k * line(b)[1])
        if landscape.size == 1 and abs(landscape(start)[1][0]) < TOLERANCE / 2:
            assert reached[0] > q[0], (number, q, reached)
        # Where it stands on tops and is at rest otherwise, rounding of the start does not choose the side.
        still = [a if is_top else line.minimum(a) for line, a, is_top in zip(landscape.lines, q, on_tops(landscape, q))]
        if still != [line.minimum(a) for line, a in zip(landscape.lines, q)] and not landscape.noise:
            still = [min(line.roots, key=lambda root: abs(root - a)) for line, a in zip(landscape.lines, still)]
            ends = [hapgrid.relax(landscape, landscape.place([a + b for a in still]), step=STEP, tolerance=TOLERANCE)
                    for b in (0, 1e-15, -1e-15)]
            assert sides(landscape, ends[0]) == sides(landscape, ends[1]) == sides(landscape, ends[2]), (number, still)
            # No top is left but one at a fold, which is as good as flat.
            assert all(abs(b - a) > 0.1 for k, line, a, b in zip(landscape.stiff, landscape.lines, still, landscape.along(ends[0]))
                       if a in line.roots[1::2] and k * line(a + STEP / 10)[1] < -1e3 * TOLERANCE), (number, still)


def well(factor=1.0, more=0.0):
    return lambda s: ((s[0]**2 - 1)**2 + more * s[0], [factor * 4 * s[0] * (s[0]**2 - 1)])


def leads_round(s):
    return s[0]**2 + 3 * s[1]**2, [6 * s[1], 2 * s[0]]


@pytest.mark.parametrize("function, start, why", [
    *((wrong, [0.5], "it is not the gradient of the energy") for wrong in (well(-1), well(10), well(0.1), well(more=0.3))),
    (leads_round, [0.5, 0.3], "it is not the gradient of the energy"),
    (lambda s: (10 * abs(s[0]) + s[1]**2, [math.copysign(10, s[0]), 2 * s[1]]), [0.5, 1], "the gradient jumps"),
    (lambda s: (-s[0], [-1]), [0.5], "when all evaluations are made"),
    (lambda s: 0.25, [1], "must return the energy and its gradient, it returned 0.25"),
    (well(), 0.3, "s must be a sequence of numbers, it is 0.3"),
])
def test_what_it_says_is_true(function, start, why):
    with pytest.raises((ArithmeticError, ValueError), match=why):
        hapgrid.relax(function, start, most=1000)


def test_the_tip_of_a_cone_is_a_minimum():
    assert isinstance(hapgrid.relax(lambda s: (math.hypot(*s), [a / math.hypot(*s) for a in s]), [0.5, 1]), list)


def test_a_component_that_stands_on_a_top_is_pushed_off_it():
    # Of twelve components, the first stands on a top at which no other one pushes it.
    stiff = [-1.0, *(10 + 7 * i for i in range(11))]

    def soft(s):
        return sum(k * a * a for k, a in zip(stiff, s)) + s[0]**4, [2 * k * a + (4 * a**3 if k < 0 else 0) for k, a in zip(stiff, s)]

    for start in ([0.0] * 12, [0.0] + [0.5] * 11):
        assert abs(hapgrid.relax(soft, start)[0] - math.sqrt(0.5)) < 1e-6, start


def test_energies_may_be_rounded_to_float32():
    def rounded(s):  # to steps that are larger than the last falls
        return struct.unpack("f", struct.pack("f", -30 + sum(a**2 for a in s)))[0], [2 * a for a in s]

    assert max(map(abs, hapgrid.relax(rounded, [0.3, -0.7, 0.2], tolerance=1e-8))) < 1e-8
