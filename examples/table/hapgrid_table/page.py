"""A way through the table, pictures, and the page that sums up."""

import html
import itertools
import json
import tomllib
import urllib.parse

import numpy as np

from .work import remove

STYLE = """body { font: 16px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; color: #222 }
table { border-collapse: collapse } td, th { padding: 0.2em 0.8em; border-bottom: 1px solid #ccc; text-align: left }
img { max-width: 100% } iframe { width: 100%; height: 34em; border: 1px solid #ccc } code { background: #eee }"""

SLICES = """\
set terminal pngcairo noenhanced size 1300,440 font 'DejaVu Sans,11'
set output 'slices.png'
set multiplot layout 1,3 title 'energy{unit} in three planes through the lowest point'
set palette defined (0 '#08306b', 0.35 '#6baed6', 0.6 '#f7f7f7', 1 '#b2182b')
set cbrange [{low}:{high}]
"""


class Values:
    """The energies at the points of the table, as the plug-in has them (field.hpp)."""

    def __init__(self, work, name):
        definition = tomllib.loads(work.read(f"{name}.toml"))["model"]
        parameters = definition["parameters"]
        head, _, body = work.read(definition["files"]["table"]).partition("values\n")
        rows = [line.split() for line in head.splitlines()]
        counts = next([int(n) for n in row[1:]] for row in rows if row[0] == "counts")
        self.origin = next(np.array(row[1:], float) for row in rows if row[0] == "origin")
        self.axes = np.array([row[1:] for row in rows if row[0] == "axis"], float)
        self.atoms = sum(row[0] == "atom" for row in rows)
        energy = np.array(body.split(), float).reshape(counts[::-1]).transpose(2, 1, 0)
        energy = energy * parameters.get("factor", 1.0)
        self.wall = parameters.get("wall")
        if self.wall is not None:
            begin = (np.nanmin(energy) + self.wall) / 2
            room = self.wall - begin
            energy = np.where(np.isnan(energy), np.inf, energy)
            pressed = begin - room * np.expm1(-np.maximum(energy - begin, 0) / room)
            energy = np.where(energy > begin, pressed, energy)
        self.energy = energy
        self.unit = parameters.get("energy_unit", "")
        self.length_unit = parameters.get("length_unit", "")
        self.force = parameters.get("largest_force", 3)

    def lowest(self):
        """Indices of the lowest point, inside rather than at the edge."""
        inside = self.energy[1:-1, 1:-1, 1:-1]
        return tuple(int(n) + 1 for n in np.unravel_index(int(inside.argmin()), inside.shape))

    def place(self, index):
        return self.origin + np.asarray(index, float) @ self.axes


def way(values):
    """(start, end): a line through the lowest point along an axis or a diagonal of the table, that which climbs
    least; it ends at the table's edge."""
    lowest = np.array(values.lowest())
    last = np.array(values.energy.shape) - 1

    def ray(step):
        count = min(int((last[a] - lowest[a]) if step[a] > 0 else lowest[a]) for a in range(3) if step[a])
        return [lowest + n * step for n in range(count + 1)]

    def climbs(step):
        both = ray(step) + ray(-step)
        return max(values.energy[tuple(p)] for p in both)
    steps = [np.array(s) for s in itertools.product((-1, 0, 1), repeat=3) if s > (0, 0, 0)]
    best = min(steps, key=climbs)
    return values.place(ray(-best)[-1]), values.place(ray(best)[-1])


def way_text(ends, unit, ticks):
    """A path for play: there and back."""
    start, end = ends
    there = [start + (end - start) * k / ticks for k in range(ticks + 1)]
    rows = [" ".join(f"{v:.8g}" for v in p) for p in there + there[-2::-1]]
    return "\n".join([f"# x y z of the HIP{', ' + unit if unit else ''}, a line a tick: through the lowest point and back",
                      *rows]) + "\n"


def gnuplot(work, script):
    name = ".gnuplot"
    work.write(name, script)
    try:
        work.run(["gnuplot"], name, package="gnuplot-nox")
    finally:
        remove(work.path(name))


def slices(work, values):
    """slices.png: the three planes of the table through its lowest point."""
    at = values.lowest()
    unit = f" / ({values.unit})" if values.unit else ""
    script = [SLICES.format(unit=unit, low=f"{values.energy.min():.6g}", high=f"{values.energy.max():.6g}")]
    steps = np.linalg.norm(values.axes, axis=1)
    # A sheared table has no places along x, y and z: its pictures begin at 0.
    begin = values.origin if np.allclose(values.axes, np.diag(steps)) else np.zeros(3)
    length = f" / {values.length_unit}" if values.length_unit else ""
    for a, b, across in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
        plane = np.take(values.energy, at[across], axis=across)
        script.append(f"$plane{across} << EOD")
        script += [" ".join(f"{v:.5g}" for v in column) for column in plane.T]
        script += ["EOD", f"set xlabel '{'xyz'[a]}{length}'", f"set ylabel '{'xyz'[b]}{length}'",
                   *(f"set {name}range [{begin[n]:.6g}:{begin[n] + (plane.shape[k] - 1) * steps[n]:.6g}]"
                     for k, (name, n) in enumerate((("x", a), ("y", b)))),
                   f"plot $plane{across} matrix using ({begin[a]:.8g}+$1*{steps[a]:.8g}):"
                   f"({begin[b]:.8g}+$2*{steps[b]:.8g}):3 with image notitle"]
    gnuplot(work, "\n".join(script) + "\n")
    return "slices.png"


def along(work, grid, unit, length_unit, prefix=""):
    """Plays the way; pictures of force and energy along it, and the play in a page."""
    work.run("play", grid, "--device", f"path:{prefix}path.txt", "--log", f"{prefix}played.log", "--frames",
             f"{prefix}played.frames")
    with open(work.path(f"{prefix}path.txt"), encoding="utf-8") as file:
        points = np.loadtxt(file)
    axis = "xyz"[int(np.argmax(np.ptp(points, axis=0)))]
    where = f"{axis} of the HIP" + (f" / {length_unit}" if length_unit else "")
    for picture, column, label in ((f"{prefix}force.png", f"force_{axis}", f"{axis} of the force / N"),
                                   (f"{prefix}energy.png", "energy", "energy" + (f" / ({unit})" if unit else ""))):
        work.run("stats", "--log", f"{prefix}played.log", "--plot", f"{axis},{column}", "--labels",
                 f"{where},{label}", "--png", picture)
    work.run("view", f"{prefix}played.frames", "--html", f"{prefix}played.html")
    return [f"{prefix}{n}" for n in ("force.png", "energy.png", "played.html", "played.log", "played.frames")]


def frame(name, body):
    """A whole page."""
    return f"""<!DOCTYPE html>
<meta charset="utf-8">
<title>{html.escape(name)}</title>
<style>
{STYLE}
</style>
<h1>{html.escape(name)}</h1>
{body}"""


def write(work, name, values):
    grid = f"{name}.grid"
    made = ["path.txt", slices(work, values), *along(work, grid, values.unit, values.length_unit)]
    scale = json.loads(work.run("stats", grid, "--format", "json")[0]).get("force_scale")
    e = values.energy
    unit, length = html.escape(values.unit or "units of energy"), html.escape(values.length_unit or "units of length")
    rows = [("values", " × ".join(map(str, e.shape))), ("lowest, highest energy", f"{e.min():.4g}, {e.max():.4g} {unit}"),
            ("wall", "none" if values.wall is None else f"{values.wall:g} {unit}"),
            ("lowest point", ", ".join(f"{v:.4g}" for v in values.place(values.lowest())) + f" {length}"),
            ("largest force", f"{values.force:g} N")]
    if scale:
        rows.append(("force on the device", f"{scale:.4g} N for 1 {unit} in 1 {length}"))
    table = "".join(f"<tr><td>{a}<td>{b}" for a, b in rows)
    quoted = urllib.parse.quote(name)
    work.write("index.html", frame(name, f"""
<p>To feel it, in the folder that has this one:
<p><code>hapgrid feel {name}/{grid}</code>
<p>Another device goes behind <code>hapgrid play {name}/{grid} --device</code>: see <code>hapgrid play --help</code>.
<table>{table}</table>
<h2>The energy</h2>
<img src="slices.png" alt="three planes">
<h2>A way through the lowest point and back</h2>
<p>Blue balls are the deepest minima.
<iframe src="played.html" title="the way"></iframe>
<img src="energy.png" alt="energy on the way"> <img src="force.png" alt="force on the way">
<h2>The grid</h2>
<pre>{html.escape(work.read("verify.txt"))}</pre>
<p>The definition is <a href="{quoted}.toml">{name}.toml</a>: change it, and the same command computes the grid anew.
"""))
    return [*made, "index.html"]
