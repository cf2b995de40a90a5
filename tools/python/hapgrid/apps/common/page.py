"""A play along a path, and the page that sums up. One template, common/page.html, has what all pages have, and each command's
page.html fills its blocks. Names and texts in a page may come from anybody: jinja2 escapes all that it fills in."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from .arrays import Array
from .work import Work

_templates = Environment(loader=FileSystemLoader(Path(__file__).parents[1]), autoescape=True, undefined=StrictUndefined,
                         trim_blocks=True, lstrip_blocks=True)


def path_text(ends: Sequence[Array], unit: str, ticks: int) -> str:
    """A path for play: there and back."""
    start, end = ends
    there = [start + (end - start) * k / ticks for k in range(ticks + 1)]
    rows = [" ".join(f"{v:.10g}" for v in p) for p in there + there[-2::-1]]
    return "\n".join([f"# x y z of the HIP{', ' + unit if unit else ''}, a line a tick: there and back",
                      *rows]) + "\n"


def play(work: Work, grid: str) -> list[str]:
    """Plays path.txt: a page shows it, with force and energy. [the files]"""
    work.run("play", grid, "--device", "path:path.txt", "--log", "played.log", "--frames", "played.frames")
    work.run("view", "played.frames", "--html", "played.html")
    return ["played.html", "played.log", "played.frames"]


def write(work: Work, template: str, **values: Any) -> list[str]:
    """index.html by a template, as "table/page.html", and feel.html. [their names]. values: what the template names besides the
    grid's name; a title is that name, where none is given."""
    felt = work.feel_page(f"{work.name()}.grid")
    known = {"title": work.name(), "name": work.name(), "can_feel": bool(felt), "verified": work.read("verify.txt")}
    work.write("index.html", _templates.get_template(template).render(known, **values))
    return [*felt, "index.html"]
