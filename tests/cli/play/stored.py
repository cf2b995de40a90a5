"""Forces and energies of two logs of the hung ball, evaluated and interpolated: within the bound of
linear interpolation, h²/8 times the second derivative, along the grid's x axis (y = z = 0 lies in
the middle of cells across y and z, where the states are interpolated, too).

With the ball pushed by the HIP, the energy's and the force's second derivatives along x stay below
20 N per rope length² for |x| <= 0.5 (closed form of Sect. 2.1, r = 0.1, differentiated numerically:
14 at most), and h = 0.05; across y and z the same bound applies once each: 3 * 20 * h² / 8 = 0.019.
At the first touch (x = -0.2) the force has a kink: there the bound is h times its slope, 3 N per
rope length at most. Near the tear-off the force is unbounded: the ticks beyond |x| = 0.5 are left
out, and so are those where both logs are not in the same levels."""
import sys


def read(name):
    lines = open(name).read().splitlines()
    names = lines[0].lstrip("# ").split("\t")
    return [dict(zip(names, map(float, line.split("\t")))) for line in lines[1:]]


evaluated, stored = read(sys.argv[1]), read(sys.argv[2])
assert len(evaluated) == len(stored) > 3000
H = 0.05
worst = {"fx": 0.0, "fy": 0.0, "fz": 0.0, "energy": 0.0}
compared = 0
for a, b in zip(evaluated, stored):
    assert all(a[k] == b[k] for k in a if k[0] in "txls"), (a, b)  # same states, same levels
    if abs(a["x"]) > 0.5:
        continue
    compared += 1
    bound = 3 * H if abs(abs(a["x"]) - 0.2) < 2 * H else 3 * 20 * H * H / 8
    for k in worst:
        error = abs(a[k] - b[k])
        worst[k] = max(worst[k], error / bound)
        assert error <= bound, (k, error, bound, a, b)
assert compared > 1500
assert worst["fx"] > 0  # they are not the same computation
print("shares of the bound:", worst)
