"""What the pictures of plot.sh show, against the files that they show."""
import io
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as tree

import numpy
from PIL import Image

SVG = "{http://www.w3.org/2000/svg}"


def texts(name):
    return [re.sub(r"\s+", " ", "".join(node.itertext()).replace("\u2212", "-")).strip() for node in tree.parse(name).iter(SVG + "text")]


def has(name, *words):
    for word in words:
        assert word in texts(name), (name, word, texts(name))


def curves(name, colour):
    """Points of the lines that have a colour, in the picture's points from the left and from above."""
    found = []
    for node in tree.parse(name).iter(SVG + "path"):
        if f"stroke: {colour}" in node.get("style", "") and "fill: none" in node.get("style", ""):
            found.append(numpy.array(re.findall(r"[ML] (\S+) (\S+)", node.get("d")), float))
    return found


def scale(name, axis):
    """The numbers at an axis as a line from places in the picture: value = a place + b."""
    marks = []
    for group in tree.parse(name).iter(SVG + "g"):
        if re.fullmatch(axis + r"tick_\d+", group.get("id", "")):
            use = next(group.iter(SVG + "use"))
            text = "".join("".join(t.itertext()) for t in group.iter(SVG + "text")).replace("\u2212", "-").strip()
            marks.append((float(use.get("x" if axis == "x" else "y")), float(text)))
    places, values = numpy.array(marks).T
    return numpy.polyfit(places, values, 1)


def colour_share(image, colour):
    return (numpy.abs(image - numpy.array(colour)).max(axis=2) < 8).mean()


log = numpy.loadtxt("a.log")
names = open("a.log").readline()[2:].split()
x, state, snap = (log[:, names.index(name)] for name in ("x", "s0", "snap"))
assert snap.sum() == 2 and (numpy.abs(numpy.diff(state))[snap[1:] == 1] > 0.3).all()  # the ball leaps to where it hangs

# There and back: both curves lie on the axes' scales where the log has them, and are broken where the model snaps.
has("loop.svg", "x of the HIP / rope lengths", "state s0 / rad", "there", "back", "the model snaps")
ax, bx = scale("loop.svg", "x")
ay, by = scale("loop.svg", "y")
there, back = (max(curves("loop.svg", colour), key=len) for colour in ("#0072b2", "#c8500a"))
for curve, ticks in ((there, slice(0, 181)), (back, slice(180, None))):
    drawn_x, drawn_y = ax * curve[:, 0] + bx, ay * curve[:, 1] + by
    assert abs(drawn_x.min() + 0.9) < 0.01 and abs(drawn_x.max() - 0.9) < 0.01, (drawn_x.min(), drawn_x.max())
    assert abs(drawn_y.min() - state[ticks].min()) < 0.01 and abs(drawn_y.max() - state[ticks].max()) < 0.01
    distance = [numpy.hypot(x[ticks] - a, state[ticks] - b).min() for a, b in zip(drawn_x, drawn_y)]
    assert max(distance) < 0.01, max(distance)  # simplified lines keep to the points of the log

has("force.svg", "x of the force / N", "as sent", "of the model", "there", "back")
has("three.svg", "time / s", "x of the force / N", "a.log", "a.session", "a.frames")
assert "back" not in texts("three.svg")
has("words.svg", "a", "b / c")
has("session.svg", "time / s", "force / N", "HIP / rope lengths", "as sent", "of the model", "snap", "ramped", "the model snaps")
has("energies.svg", "energy", "/ N rope lengths")
has("error.svg", "spacing / rope lengths", "error of the force / N", "error of the state / rad", "0.1", "0.2")
for name in ("loop.svg", "force.svg", "three.svg", "session.svg", "energies.svg", "error.svg", "levels.svg"):
    assert not any("e-" in text and re.search(r"\de-", text) for text in texts(name)), texts(name)

# A slice: its numbers are counted by the dump; the shares of the colours are those of the points.
plane = next(text for text in texts("levels.svg") if "levels at y" in text)
j = round((float(re.search("y = ([−0-9.]+)", plane)[1].replace("−", "-")) + 0.475) / 0.1)
here = {}
for line in subprocess.run([sys.executable, os.environ["HAPGRID_SOURCE"] + "/tests/cli/dump.py", "grid"], capture_output=True, text=True, check=True).stdout.splitlines()[1:]:
    at = line.split("\t")[:3]
    if int(at[1]) == j:
        here[at[0], at[2]] = here.get((at[0], at[2]), 0) + 1
has("levels.svg", "x / rope lengths", "z / rope lengths", "1 level", "2 levels")
assert len(here) == 200 and set(here.values()) == {1, 2}
image = numpy.array(Image.open(io.BytesIO(open("levels.png", "rb").read())).convert("RGB"), int)
colours = [re.search(r"fill: (#\w+)", node.get("style", "")) for node in tree.parse("levels.svg").iter(SVG + "path")]
fills = [match[1] for match in colours if match and match[1] not in ("#ffffff", "none")]
one, two = [tuple(bytes.fromhex(fill[1:])) for fill in fills[-2:]]
shares = [colour_share(image, one), colour_share(image, two)]
wanted = sum(value == 2 for value in here.values()) / len(here)
assert abs(shares[1] / sum(shares) - wanted) < 0.02, (shares, wanted)  # the legend has a square of each

# A field: its longest arrow is that of play on the same rows, each walked from the left.
has("field.svg", "x / rope lengths", "z / rope lengths")
said = next(text for text in texts("field.svg") if "longest arrow" in text)
there = -0.975 + 0.1 * numpy.arange(20)
rows = [(x, 0.025, z) for z in -0.475 + 0.1 * numpy.arange(10) for x in [*there, *there[-2:0:-1]]]
log = subprocess.run(["play", "grid", "--beside", "off", "--device", "path:-", "--log", "-"], check=True, capture_output=True, text=True,
                     input="".join(" ".join(map(str, row)) + "\n" for row in rows)).stdout.splitlines()
columns = [log[0].split("\t").index(name) for name in ("force_x", "force_z")]
ticks = numpy.array([line.split("\t") for line in log[1:]], float)[:, columns].reshape(10, 38, 2)[:, :20]
most = numpy.hypot(*ticks.T).max()
assert f"the longest arrow is {most:.2g} N" in said, (said, most)

# Force, energy and snap have one colour each, in plots as in pages.
page = subprocess.run(["view", "a.frames", "--html", "-"], check=True, capture_output=True, text=True).stdout
parts = {name: re.search(f'"{name}_colour":"rgb.([^)]*)"?', page)[1].split() for name in ("force", "energy", "snap")}
colours = {name: "#" + "".join(f"{int(float(x) + 0.5):02x}" for x in rgb) for name, rgb in parts.items()}
sys.path.insert(0, os.environ["HAPGRID_BUILD"] + "/python")
from hapgrid import style  # noqa: E402
assert colours == {"force": style.FORCE, "energy": style.ENERGY, "snap": style.SNAP}, colours
assert curves("field.svg", colours["energy"]) and f"fill: {colours['force']}" in open("field.svg").read()
