"""precision.py E N DUMP LOSSY: each of the N components in LOSSY may be off by E of its range in DUMP;
everything else is the same. Prints nothing; by exact fractions, not by doubles."""

import sys
from fractions import Fraction

precision, size = Fraction(sys.argv[1]), int(sys.argv[2])
dump, lossy = ([line.rstrip("\n").split("\t") for line in open(name)] for name in sys.argv[3:])
assert len(dump) == len(lossy)
states = slice(4, 4 + size)
columns = list(zip(*(map(Fraction, row[states]) for row in dump)))
# The bound is computed in doubles: off by a few units in the last place.
bounds = [precision * (max(c) - min(c)) * (1 + Fraction(1, 10**14)) for c in columns]
moved = 0
for a, b in zip(dump, lossy):
    assert a[:4] == b[:4] and a[4 + size :] == b[4 + size :], (a, b)
    for x, y, bound in zip(a[states], b[states], bounds):
        assert abs(Fraction(x) - Fraction(y)) <= bound, (a, b)
        moved += x != y
assert moved > 0
