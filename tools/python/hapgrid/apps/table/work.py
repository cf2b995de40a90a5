"""A folder with the one grid that follows from a definition, of `hapgrid table` or `hapgrid dock`."""

from __future__ import annotations

import os
import sys
import tomllib
from argparse import Namespace
from collections.abc import Callable, Sequence
from typing import Any

from hapgrid.apps.common import grid as grids
from hapgrid.apps.common.cli import BreaksRule
from hapgrid.apps.common.files import Failed, is_plain
from hapgrid.apps.common.work import Work as Folder

VERIFY_SHARE = 0.6  # about, of what the search took, when that took long


def run_steps(command: str, o: Namespace, given: Sequence[str], define: Callable[[Work, str], Any],
              page: Callable[[Work, str], Any]) -> str:
    """Everything; the line for standard output. o: the options; given: the files that the grid is of, whose names the folder
    keeps; define(work, name) makes the definition, and page(work, name) the page."""
    work, names = Work(command, o.output, o.quiet, given), [os.path.basename(one) for one in given]
    work.require(" in ".join(names), names)
    name = work.name()
    toml, grid = f"{name}.toml", f"{name}.grid"
    if work.changed_by_hand(toml):
        work.say(f"{toml} was changed by hand: it is kept")
    else:
        define(work, name)
    work.name()  # is kept now that there is a folder
    work.belong(" in ".join(names), names)
    if o.until:
        work.say("stopped after the definition: the same command without --until goes on")
        return ""
    broken = None
    try:
        work.compute_grid(toml, grid, o.threads)
    except BreaksRule as why:  # the pictures show where
        broken = why
    work.step("page", "drawing pictures", [grid, "verify.txt"], [], lambda: page(work, name))
    if broken:
        raise broken
    work.say(f"done: {work.in_shell('index.html')} sums up")
    return f"{work.launcher()} feel {work.in_shell(grid)}"


class Work(Folder):
    def compute_grid(self, toml: str, grid: str, threads: int) -> None:
        """Computes and verifies a grid; where a run was interrupted it goes on. Makes GRID, GRID.cost, verify.txt.
        Errors: BreaksRule."""
        title = f"computing {grid}"

        def compute() -> list[str]:
            watched = not self.quiet and sys.stderr.isatty()
            expected = grids.estimated(self, toml, threads, 100, 2) if watched else None
            failed = grids.compute(self, title, toml, grid, threads, expected)
            if failed is not None:
                raise Failed(failed[1])
            return [grid, f"{grid}.cost"]
        self.step("grid", title, [toml, *self.inputs_of(toml)], [], compute)
        title = "checking that the grid is whole and that its states are the model's"

        def verify() -> list[str]:
            took = grids.cpu_seconds(self, grid) / threads
            if not grids.verify(self, title, grid, threads, VERIFY_SHARE * took if took > 5 else None):
                raise BreaksRule(f"{grid} breaks a rule: see {self.path('verify.txt')}")
            return ["verify.txt"]
        self.step("verify", title, [grid], [], verify)

    def inputs_of(self, toml: str) -> list[str]:
        """The files that a definition names, changed by hand or not. Errors: Failed, where one is not beside it."""
        try:
            files = tomllib.loads(self.read(toml))["model"].get("files", {})
        except (tomllib.TOMLDecodeError, KeyError, AttributeError):
            return []  # seed says what is wrong
        names = [name for one in files.values() for name in (one if isinstance(one, list) else [one])]
        strange = next((name for name in names if not is_plain(name)), None)
        if strange is not None:
            raise Failed(f"{self.path(toml)}: names the file '{strange}': only files beside it are used, with plain names")
        return names
