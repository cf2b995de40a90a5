"""reached.py all|reached RADIUS SPACING ORIGIN COUNTS < dump: the records of a grid (dump.py) of the
hung ball against the closed form.

all: each point has all of its feasible states, S(x). reached: it has those that a search over the
closed form reaches from the corners.
"""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(__file__), ".."))
from closed_form import convert, feasible

TOLERANCE = 1e-6  # rad, the model's own

mode, radius, spacing, origin, counts = sys.argv[1:]
radius, spacing = float(radius), float(spacing)
origin = [float(v) for v in origin.split(",")]
counts = [int(v) for v in counts.split(",")]


def position(at):
    return [o + spacing * i for o, i in zip(origin, at)]


def known(states, alpha):
    return any(abs(alpha - s) <= TOLERANCE for s in states)


def search():
    corners = {tuple(b * (n - 1) for b, n in zip(bits, counts)) for bits in
               [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]}
    found = {at: [0.0] for at in corners}
    front = [(at, 0.0) for at in corners]
    steps = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if (i, j, k) != (0, 0, 0)]
    while front:
        at, alpha = front.pop()
        p = position(at)
        for step in steps:
            to = tuple(a + s for a, s in zip(at, step))
            if not all(0 <= a < n for a, n in zip(to, counts)):
                continue
            reached = convert(alpha, p, [spacing * s for s in step], radius)
            states = found.setdefault(to, [])
            if not known(states, reached):
                states.append(reached)
                front.append((to, reached))
    return found


grid = {}
sys.stdin.readline()  # the names of the columns
for line in sys.stdin:
    fields = line.rstrip("\n").split("\t")
    at, level, alpha = tuple(map(int, fields[:3])), int(fields[3]), float(fields[4])
    states = grid.setdefault(at, [])
    if level != len(states):
        sys.exit("point %s: level %d where level %d was expected" % (at, level, len(states)))
    states.append(alpha)

points = counts[0] * counts[1] * counts[2]
if len(grid) != points:
    sys.exit("%d of %d points have a level" % (len(grid), points))
reached = search() if mode == "reached" else {at: feasible(position(at), radius) for at in grid}
several = unreachable = 0
for at, states in grid.items():
    right = feasible(position(at), radius)
    for alpha in states:
        if not known(right, alpha):
            sys.exit("point %s: α = %.17g is none of the feasible %s" % (at, alpha, right))
    if len(states) != len(reached[at]) or not all(known(states, a) for a in reached[at]):
        sys.exit("point %s: levels %s, reachable are %s" % (at, states, reached[at]))
    several += len(states) > 1
    unreachable += len(right) - len(states)
print("%d points, %d with several levels, %d feasible states out of reach" % (points, several, unreachable))
if not several and (mode == "all" or not unreachable):
    sys.exit("these points prove too little")
