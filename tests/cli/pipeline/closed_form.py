"""closed_form.py all|reached RADIUS SPACING ORIGIN COUNTS < dump: what `stats --dump` prints of a
hung ball against the closed form, in angles, as issue 2 writes it. Nothing of hapgrid is used.

all: each point has all of its feasible states, S(x). reached: it has those that a search over the
closed form reaches from the corners.
"""

import math
import sys

TOLERANCE = 1e-6  # rad, the model's own

mode, radius, spacing, origin, counts = sys.argv[1:]
radius, spacing = float(radius), float(spacing)
origin = [float(v) for v in origin.split(",")]
counts = [int(v) for v in counts.split(",")]


def arc(p):
    """(φ, δ): the balls overlap for |α - φ| < δ. None without such an arc."""
    x, y, z = p
    m = 4 * radius * radius - y * y
    rho = math.hypot(x, 1 - z)
    if m <= 0 or rho == 0:
        return None
    cosine = (1 + rho * rho - m) / (2 * rho)
    if cosine >= 1:
        return None
    return math.atan2(x, 1 - z), math.acos(max(cosine, -1.0))


def settle(alpha, p):
    here = arc(p)
    if here is None:
        return 0.0
    phi, delta = here
    to = max(0.0, phi + delta) if alpha >= phi else min(0.0, phi - delta)
    return to if abs(to) < math.pi else 0.0


def convert(alpha, p, d):
    steps = math.ceil(math.sqrt(sum(c * c for c in d)) / (radius / 16))
    if arc([a + b for a, b in zip(p, d)]) is None:
        return 0.0
    for k in range(1, steps + 1):
        alpha = settle(alpha, [a + k / steps * b for a, b in zip(p, d)])
    return alpha


def feasible(p):
    """S(x)."""
    here = arc(p)
    if here is None:
        return [0.0]
    phi, delta = here
    states = [0.0] if abs(phi) >= delta else []
    states += [phi + delta] if 0 < phi + delta < math.pi else []
    states += [phi - delta] if -math.pi < phi - delta < 0 else []
    return states


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
            reached = convert(alpha, p, [spacing * s for s in step])
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
reached = search() if mode == "reached" else {at: feasible(position(at)) for at in grid}
several = unreachable = 0
for at, states in grid.items():
    right = feasible(position(at))
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
