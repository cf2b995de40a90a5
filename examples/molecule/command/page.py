"""Plots, pictures, and the page that sums up."""

import html
import urllib.parse

import numpy as np
from preparation import files

from . import curves
from .pushing import read_log

STYLE = """body { font: 16px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; color: #222 }
table { border-collapse: collapse } td, th { padding: 0.2em 0.8em; border-bottom: 1px solid #ccc; text-align: left }
img { max-width: 48% } iframe { width: 100%; height: 34em; border: 1px solid #ccc } code { background: #eee }"""

STAYS = 0.05  # of a t: less is not behind a saddle


class Page:
    def __init__(self, filters, stages, name, way, molecule, torsions, threads):
        self.filters, self.stages, self.name, self.way, self.molecule = filters, stages, name, way, molecule
        self.torsions, self.threads = torsions, threads
        self.grid = f"{name}.grid"

    def write(self):
        run = self.filters.run
        run("play", self.grid, "--device", f"path:{self.way}", "--log", "played.log", "--frames", "played.frames",
            watch=lambda gone: self.stages.waiting("playing the way", gone, None))
        run("view", "played.frames", "--xyz", "played.xyz", "--pdb", "played.pdb")
        names, rows = read_log(self.stages.path("played.log"))
        shapes = files.frames(self.stages.path("played.xyz"))
        drawn = curves.draw(self.stages, (names, rows), np.array([x for _, _, x in shapes]), self.torsions,
                            [float(words["time"]) for words, _, _ in shapes])
        at = {name: rows[:, n] for n, name in enumerate(names)}
        pictures = {**self._plots(at), **self._pictures(at)}
        self.filters.run_each(pictures.values(), self.threads, self.stages.counted("drawing pictures", len(pictures)))
        made = [*drawn, *pictures]
        page = self._html([n for n in made if n.endswith(".png")])
        files.write_whole(self.stages.path("index.html"), page)
        return ["played.log", "played.frames", "played.xyz", "played.pdb", *made, "index.html"]

    @staticmethod
    def _plots(at):
        """{file: the command that draws it}; at: columns of the log by their names."""
        axis = max("xyz", key=lambda a: np.ptp(at[a]))

        def plot(picture, y, label):
            return ["stats", "--log", "played.log", "--plot", f"{axis},{y}", "--labels",
                    f"{axis} of the probe / Å,{label}", "--png", picture]
        return {"force.png": plot("force.png", f"force_{axis}", f"{axis} of the force / N"),
                "energy.png": plot("energy.png", "energy", "energy / (kJ/mol)")}

    @staticmethod
    def _moments(at):
        """{picture: time} of what is worth a look."""
        paths = sum(n[0] == "s" and n[1:].isdigit() for n in at) - 6
        turns = [float(np.abs(at[f"s{k}"]).max()) for k in range(paths)]
        when = {"before.png": 0.0}
        if not turns:
            return {**when, "pushed.png": float(at["t"][len(at["t"]) // 2])}
        farthest = np.abs(at[f"s{int(np.argmax(turns))}"])
        when["turned.png"] = float(at["t"][int(farthest.argmax())])
        # Behind a saddle the molecule stays when nothing pushes it.
        free = np.hypot(np.hypot(at["force_x"], at["force_y"]), at["force_z"]) == 0
        stays = np.flatnonzero(free & (farthest > STAYS))
        if stays.size:
            when["behind.png"] = float(at["t"][stays[stays.size // 2]])
            when["after.png"] = float(at["t"][-1])
        return when

    def _pictures(self, at):
        """{file: the command that draws it}. The probe comes from the left."""
        way = [at[a][len(at[a]) // 2] - at[a][0] for a in "xyz"]
        view = ["--azimuth", f"{np.degrees(np.arctan2(way[1], way[0])):.0f}", "--elevation", "10"]
        out = {}
        for picture, t in self._moments(at).items():
            one = ["view", "played.frames", "--at", f"{t:.3f}", *view, "--png"]
            sticks = picture.replace(".png", "-sticks.png")
            out[picture] = [*one, picture]
            out[sticks] = [*one, sticks, "--style", "sticks"]
        out["played.html"] = ["view", "played.frames", *view, "--html", "played.html"]
        return out

    def _html(self, pictures):
        def read(name):
            with open(self.stages.path(name), encoding="utf-8") as file:
                return file.read()
        rows = [line.split("\t") for line in read("rotors.tsv").splitlines()]
        heads = ["path", "atoms", "barrier / (kJ/mol)", "taken", "why not"]
        table = "".join(f"<th>{h}" for h in heads) + "".join(
            "<tr>" + "".join(f"<td>{html.escape(v)}" for v in row) for row in rows[1:])
        said = read(self.way).splitlines()[0].lstrip("# ")
        name = html.escape(self.name)
        images = "\n".join(f'<img src="{p}" alt="{p[:-4]}">' for p in pictures)
        return f"""<!DOCTYPE html>
<meta charset="utf-8">
<title>{name}</title>
<style>
{STYLE}
</style>
<h1>{name}</h1>
<p>{self.molecule.formula}, {len(self.molecule.numbers)} atoms. {html.escape(said)}</p>
<iframe src="played.html" title="the molecule as it is pushed"></iframe>
<p>To feel it, in the folder that has this one:
<p><code>hapgrid play {name}/{html.escape(self.grid)} --device path:{name}/{html.escape(self.way)} --rate 1000 --frames - |
hapgrid view --window</code>
<p>Another device, or the mouse, goes behind <code>--device</code>: see <code>hapgrid play --help</code>.
<h2>How it feels on this way, there and back</h2>
{images}
<h2>What turns</h2>
<table><tr>{table}</table>
<h2>The grid</h2>
<pre>{html.escape(read("verify.txt"))}</pre>
<p>The definition is <a href="{urllib.parse.quote(self.name)}.toml">{name}.toml</a>: change it, and the same command computes the grid anew.
"""
