"""Compares a log of play along y = z = 0 with the closed form of the hung ball (issue, point 5).

usage: along.py LOG H OFFSET TORN
  H       spacing of the grid; its planes in y and z are at OFFSET + k H, in x at OFFSET + k H
  TORN    how many cells in x are torn at each of the two tear-offs: some corners have lost contact

The bound of trilinear interpolation in a cell with a smooth state is
  h^2/8 (max |a_xx| + max |a_yy| + max |a_zz|);
the maxima are taken from second differences of the closed form on a lattice in the cell, with 20 %
for what lies between its points. In a cell with the kink of the first contact the state interpolated
and the true one lie between the smallest and the largest value of the cell.
"""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(__file__), ".."))
from closed_form import contact

LOG, H, OFFSET, TORN = sys.argv[1], float(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4])


def alpha(x, y, z):
    angle = contact((x, y, z))
    return 0.0 if angle is None else max(0.0, angle)


def cell(v):
    """The planes around v; only the one it lies on, where y = z = 0 is such a plane."""
    low = math.floor((v - OFFSET) / H + 1e-9)
    if v == OFFSET:
        return (v,)
    return OFFSET + low * H, OFFSET + (low + 1) * H


def bound(x):
    """For the state at (x, 0, 0); None in a torn cell."""
    box = [(c[0], c[-1]) for c in (cell(x), cell(0.0), cell(0.0))]
    n, e = 5, 1e-4  # second differences over 1e-4 carry rounding errors of some 1e-8
    axis = [[lo + (hi - lo) * i / (n - 1) for i in range(n)] for lo, hi in box]
    lattice = [(u, v, w) for u in axis[0] for v in axis[1] for w in axis[2]]
    values = [alpha(*p) for p in lattice]
    if all(contact(p) is not None and v > 0.01 for p, v in zip(lattice, values)):
        most = [0.0, 0.0, 0.0]
        for p in lattice:
            for a in range(3):
                if box[a][0] == box[a][1]:
                    continue
                up = [c + e * (i == a) for i, c in enumerate(p)]
                down = [c - e * (i == a) for i, c in enumerate(p)]
                most[a] = max(most[a], abs(alpha(*up) - 2 * alpha(*p) + alpha(*down)) / e**2)
        return 1.2 * H * H / 8 * sum(most) + 1e-9
    if x > 0.3:  # far from the first contact: the corners on the other side have lost it
        return None
    return max(values) - min(values) + 1e-12


def corners(x):
    return [(u, v, w) for u in cell(x) for v in cell(0.0) for w in cell(0.0)]


def lost(x):
    """Whether all corners of the cell are past the tear-off."""
    return x > 0.3 and all(contact(p) is None for p in corners(x))


worst = smooth = 0
torn = set()
at_zero = []
ticks = []
for line in open(LOG):
    if not line.startswith("#"):
        f = line.split("\t")
        ticks.append((float(f[1]), float(f[18])))
turn = max(range(len(ticks)), key=lambda i: ticks[i][0])
for i, (x, s) in enumerate(ticks):
    if i > turn:  # from the right it is the mirror image
        x, s = -x, -s
    if abs(x) < 1e-12:
        at_zero.append(ticks[i][1])
    if lost(x):
        assert abs(s) < 1e-12, (x, s)  # fallen back; x can be rounded across the face
        continue
    b = bound(x)
    if b is None:
        torn.add((i > turn, cell(x)[0]))
        continue
    error = abs(s - alpha(x, 0, 0))
    assert error <= b, f"x = {x}: state {s}, closed form {alpha(x, 0, 0)}, bound {b}"
    smooth += 1
    worst = max(worst, error)
assert len(at_zero) == 2 and at_zero[0] > 0.1 and at_zero[1] < -0.1, at_zero
assert len(torn) == 2 * TORN, torn
assert smooth > 0.7 * len(ticks), smooth
print(f"{smooth} ticks within the bound, the worst {worst:.2e} off; {len(torn)} cells torn")
