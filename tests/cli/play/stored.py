"""Forces, before the safety core, energies and angles of two logs of the hung ball, evaluated and
interpolated.

States and levels must be the same. What was interpolated is compared with the closed form on the
line y = z = 0 (Sect. 2.1): trilinear interpolation is off by at most h²/8 times the sum, over the
axes, of the largest second derivative in the cell. These are taken here from second differences of
the closed form on a lattice through the cells that the place can be in, plus a tenth for what lies
between the lattice's points. Compared are the ticks that push with x from -0.1 to 0.3 in the
direction of the push: before, cells have corners that do not touch, where the force has a kink;
beyond, it bends too much for h = 0.05 to say anything (the tear-off, 0.663, has no bound at all)."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(__file__), ".."))
from closed_form import contact, force_and_energy

H = 0.05
STEP = 2e-3  # of the second differences; the closed form has 1e-16, so they have 1e-10


def read(name):
    lines = open(name).read().splitlines()
    names = lines[0].lstrip("# ").split("\t")
    return [dict(zip(names, map(float, line.split("\t")))) for line in lines[1:]]


def exact(place):
    """Force x, y, z, energy and angle."""
    return [*force_and_energy(place), contact(place)]


def bounds(x):
    """Of the same at (x, 0, 0)."""
    sums = [0.0] * 5
    for axis in range(3):
        worst = [0.0] * 5
        for i in range(-4, 5):
            for j in range(-2, 3):
                for k in range(-2, 3):
                    at = [x + i * H / 4, j * H / 4, k * H / 4]
                    beside = [[c + (a == axis) * s for a, c in enumerate(at)] for s in (-STEP, STEP)]
                    low, mid, high = exact(beside[0]), exact(at), exact(beside[1])
                    worst = [max(w, abs(a - 2 * b + c) / STEP**2)
                             for w, a, b, c in zip(worst, low, mid, high)]
        sums = [s + w for s, w in zip(sums, worst)]
    return [1.1 * H * H / 8 * s for s in sums]


evaluated, stored = read(sys.argv[1]), read(sys.argv[2])
assert len(evaluated) == len(stored) > 3000
for a, b in zip(evaluated, stored):
    assert all(a[k] == b[k] for k in a if k[0] in "txl" or k == "s0"), (a, b)

compared, differences, largest = 0, 0, 0.0
for i in range(10, len(stored), 10):
    tick = stored[i]
    side = 1 if tick["x"] > stored[i - 1]["x"] else -1  # the way back is the mirror image
    x = side * tick["x"]
    if not -0.1 <= x <= 0.3:
        continue
    compared += 1
    differences += tick["force_x"] != evaluated[i]["force_x"]
    found = [side * tick["force_x"], tick["force_y"], tick["force_z"], tick["energy"], side * tick["s0"]]
    for got, want, bound in zip(found, exact((x, 0, 0)), bounds(x)):
        largest = max(largest, abs(got - want) / bound) if bound > 1e-9 else largest
        assert abs(got - want) <= bound + 1e-9, (tick, got, want, bound)
assert compared > 70 and differences > 70, (compared, differences)  # it was not evaluated
print("%d ticks, at most %.2f of the bound" % (compared, largest))
