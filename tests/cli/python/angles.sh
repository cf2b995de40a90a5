# Angles and orientations: the helpers of the Python module against closed forms, and a compass whose needle points away
# from the HIP. Each turn around it adds 2 pi to its state.
source "$(dirname "$0")/../lib.sh"
PYTHONPATH=$HAPGRID_BUILD/python /usr/bin/python3 - <<'PYTHON'
import math

from hapgrid import applied, normalised, turned


def near(a, b):
    return all(abs(u - v) < 1e-14 for u, v in zip(a, b, strict=True))  # a few roundings of numbers below 4


c, s = math.cos(0.7), math.sin(0.7)
assert near(normalised([2, 0, 0, 5, 3, 0]), [1, 0, 0, 0, 1, 0])
assert near(turned([1, 0, 0, 0, 1, 0], [0, 0, 0.7]), [c, s, 0, -s, c, 0])
assert near(turned([c, s, 0, -s, c, 0], [0, 0, -0.7]), [1, 0, 0, 0, 1, 0])
assert near(turned([1, 0, 0, 0, 1, 0], [0, 0.7, 0]), [c, 0, -s, 0, 1, 0])
assert near(applied([c, s, 0, -s, c, 0], [1, 2, 3]), [c - 2 * s, s + 2 * c, 3])
assert turned([1, 0, 0, 0, 1, 0], [0, 0, 0]) == [1, 0, 0, 0, 1, 0]
for bad in [0, 0, 0, 0, 1, 0], [1, 2, 3, -2, -4, -6]:
    try:
        normalised(bad)
        raise SystemExit(f"{bad} is taken")
    except ValueError:
        pass
PYTHON

cat >compass.py <<'PYTHON'
import math

import hapgrid


class Compass:
    def __init__(self, period=0.0):
        self.description = {"state_size": 1, "d_max": 3, "tolerance": 0.01, "tolerance_unit": "rad"}
        if period:
            self.description["period"] = [period]

    def known_states(self, x):
        return [[math.atan2(x[1], x[0])]]

    def convert(self, s, x, d):
        return [s[0] + math.remainder(math.atan2(x[1] + d[1], x[0] + d[0]) - s[0], 2 * math.pi)]

    def force(self, s, x):
        return [0.01 * math.cos(s[0]), 0.01 * math.sin(s[0]), 0]


hapgrid.serve(Compass)
PYTHON
grid() { # PERIOD
  cat >compass.toml <<TOML
model = {process = ["/usr/bin/python3", "compass.py"], name = "compass", parameters = {period = $1}}
grid = {origin = [-1.75, -1.75, 0], spacing = 0.5, counts = [8, 8, 2]}
search = {max_levels = 16}
TOML
  seed compass.toml --allow-process | expand --complete --allow-process compass.toml
}
# Without a period each turn is another level, without end.
grid 0.0 >none 2>why && fail 'there is a grid without a period'
grep -q 'level' why || fail "$(cat why)"
grid 6.283185307179586 >with
same 'levels' '[0,128]' "$(stats with --get levels_histogram)"
# Three turns around, at a radius of 1.5: between two points half a spacing apart the angle of an arc is blended, which
# is off by at most h^2/8 times its largest second derivative along a side, 1/r^2 with r > 1, in two directions: 0.07.
/usr/bin/python3 -c 'import math
for k in range(3001): print(1.5 * math.cos(k * math.pi / 500), 1.5 * math.sin(k * math.pi / 500), 0.25)' >round
for traversal in branch paper; do
  play with --device path:round --traversal $traversal --log log >/dev/null
  /usr/bin/python3 - <<'PYTHON'
import math
names = None
for line in open("log", encoding="ascii"):
    if line.startswith("#"):
        names = names or line[1:].split()
        continue
    row = dict(zip(names, map(float, line.split())))
    off = math.remainder(row["s0"] - math.atan2(row["y"], row["x"]), 2 * math.pi)
    assert abs(off) < 0.07, (row, off)
PYTHON
done
