"""Computing and verifying a grid in the folder of a work.Work."""

from __future__ import annotations

import json
import resource
import time
from typing import Any

import numpy as np

from . import files
from .arrays import Array
from .files import Failed
from .work import Work

FINE, BROKEN, NO_ACCURACY = 0, 3, 4  # exit codes of verify


def compute(work: Work, what: str, toml: str, grid: str, threads: int, seconds: float | None = None) -> tuple[str, str] | None:
    """Computes a grid, on which an interrupted run goes on: GRID and GRID.cost. what: it is, for the line of progress;
    seconds: about how long it takes, or None. Returns (why it cannot be done, as expand writes it to the file of --cost,
    the line that expand said), or None where it is done. Errors: Failed, where it is for no reason that expand writes."""
    seeds, cost = f"{grid}.seeds", f"{grid}.cost"
    files.remove(work.path(cost))
    work.run("seed", toml, "-o", seeds)
    begun = work.digest(seeds)
    if work.recall(f"begun-{grid}", begun) is None:  # what is kept is of a definition that was changed since
        files.remove(work.path(f"{grid}.partial"))
        work.remember(f"begun-{grid}", begun, True)
    ran = work.run("expand", "--complete", "-j", threads, seeds, "-o", grid, "--cost", cost, good=(0, 1),
                   watch=lambda gone: work.waiting(what, gone, seconds))
    files.remove(work.path(seeds))
    if ran.code == 0:
        return None
    failed = next((line["failed"] for line in _costs(work, cost) if "failed" in line), None)
    if failed is None:
        raise Failed(ran.fault("expand"))
    return failed, ran.said


def _costs(work: Work, name: str) -> list[Any]:
    try:
        return [json.loads(line) for line in work.read(name).splitlines()]
    except FileNotFoundError:
        return []


def cpu_seconds(work: Work, grid: str) -> float:
    """What a grid took. Errors: Failed"""
    try:
        return sum(float(line["cpu_seconds"]) for line in _costs(work, f"{grid}.cost"))
    except (ValueError, TypeError, KeyError):
        raise Failed(f"{work.path(grid)}.cost: is not what was written: remove it") from None


def records(work: Work, grid: str) -> Array:
    """All that is known of all records of a grid."""
    table = f"{grid if grid[0] == '.' else '.records'}.npy"
    try:
        work.run("stats", grid, "--npy", table)
        return np.load(work.path(table))
    finally:
        files.remove(work.path(table))


def verify(work: Work, what: str, grid: str, threads: int, seconds: float | None = None) -> bool:
    """Verifies a grid, writes verify.txt, and returns whether it has no fault. seconds: as compute() has them."""
    ran = work.run("verify", grid, "-v", "-j", threads, good=(FINE, BROKEN, NO_ACCURACY),
                   watch=lambda gone: work.waiting(what, gone, seconds))
    work.write("verify.txt", ran.out)
    if ran.code == NO_ACCURACY:
        work.say(f"  it is whole, but not all can be proved: see {work.path('verify.txt')}")
    return ran.code != BROKEN


def estimated(work: Work, toml: str, threads: int, steps: int = 300, seconds: float = 3) -> float | None:
    """Seconds that a grid takes on free cores, within a factor of 2 or so: by walking about in it. None where the report has
    a broken check, and so no estimate."""
    def cpu() -> float:
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime
    begun, before = time.monotonic(), cpu()
    report = work.run("check-model", toml, "--steps", steps, "--seconds", seconds, "--format", "json", good=(0, 1, 3)).out
    # check-model times conversions by the clock, which also runs while others have the core.
    share = min((cpu() - before) / (time.monotonic() - begun), 1)
    took = ((json.loads(report) if report else {}).get("grid") or {}).get("cpu_seconds")
    return took and took * share / threads
