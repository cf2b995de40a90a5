"""Angles and orientations: the helpers of the module against closed forms, and a compass."""
import math
import pathlib

import pytest
from hapgrid import applied, normalised, turned


def near(a, b):
    return all(abs(u - v) < 1e-14 for u, v in zip(a, b, strict=True))  # a few roundings of numbers below 4


def test_closed_forms():
    c, s = math.cos(0.7), math.sin(0.7)
    assert near(normalised([2, 0, 0, 5, 3, 0]), [1, 0, 0, 0, 1, 0])
    assert near(turned([1, 0, 0, 0, 1, 0], [0, 0, 0.7]), [c, s, 0, -s, c, 0])
    assert near(turned([c, s, 0, -s, c, 0], [0, 0, -0.7]), [1, 0, 0, 0, 1, 0])
    assert near(turned([1, 0, 0, 0, 1, 0], [0, 0.7, 0]), [c, 0, -s, 0, 1, 0])
    assert near(applied([c, s, 0, -s, c, 0], [1, 2, 3]), [c - 2 * s, s + 2 * c, 3])
    assert turned([1, 0, 0, 0, 1, 0], [0, 0, 0]) == [1, 0, 0, 0, 1, 0]


@pytest.mark.parametrize("bad", [[0, 0, 0, 0, 1, 0], [1, 2, 3, -2, -4, -6]])
def test_what_is_no_orientation(bad):
    with pytest.raises(ValueError):
        normalised(bad)


def test_without_a_period_each_turn_is_another_level(define, search):
    define("compass", "origin = [-1.75, -1.75, 0], spacing = 0.5, counts = [8, 8, 2]", "period = 0.0")
    assert "level" in search("compass", code=1)


def test_a_period_makes_turns_one_level(define, search, run):
    define("compass", "origin = [-1.75, -1.75, 0], spacing = 0.5, counts = [8, 8, 2]", f"period = {2 * math.pi!r}")
    search("compass")
    assert run("stats", "compass.grid", "--get", "levels_histogram")[0] == "[0,128]\n"
    # Three turns around, at a radius of 1.5: between two points half a spacing apart the angle of an arc is blended, which
    # is off by at most h^2/8 times its largest second derivative along a side, 1/r^2 with r > 1, in two directions: 0.07.
    turns = (k * math.pi / 500 for k in range(3001))
    pathlib.Path("round").write_text("".join(f"{1.5 * math.cos(a)} {1.5 * math.sin(a)} 0.25\n" for a in turns))
    for traversal in "branch", "paper":
        run("play", "compass.grid", "--device", "path:round", "--traversal", traversal, "--log", "log")
        names, *rows = (line.lstrip("#").split() for line in open("log", encoding="ascii") if line[0] != "#" or "s0" in line)
        assert len(rows) == 3001
        for row in (dict(zip(names, map(float, row))) for row in rows):
            assert abs(math.remainder(row["s0"] - math.atan2(row["y"], row["x"]), 2 * math.pi)) < 0.07, row
