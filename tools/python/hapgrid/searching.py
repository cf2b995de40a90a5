"""search(): the filters seed and expand, with their progress where a notebook or a terminal can show it."""
from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from typing import Any

from hapgrid.files import program

BAR = 30  # characters
UNITS = {"": 1, " k": 1e3, " M": 1e6, " G": 1e9, " T": 1e12}  # of the filters' numbers


def search(definition: str | os.PathLike[str], output: str | os.PathLike[str] | None = None, *, allow_process: bool = False,
           processors: int | None = None, set: Mapping[str, Any] | None = None) -> str:
    """Searches the grid of a definition, and returns the name of its file, for read().

    output          the file; by default the definition's name with .grid. What is there is replaced when the new grid is
                    complete. After an interruption the same call goes on.
    allow_process   whether the command that the definition names may be started: a model in Python needs it
    processors      how many models work at a time; by default, as many as it may use processors
    set             keys of the definition that have other values than in the file: {"grid.spacing": 0.5}

    Progress goes to the notebook's cell, or to standard error if that is a terminal. Raises RuntimeError with what a
    filter said when it failed.
    """
    definition = os.fspath(definition)
    grid = os.fspath(output) if output is not None else os.path.splitext(definition)[0] + ".grid"
    overrides = [word for key, value in (set or {}).items() for word in ("--set", f"{key}={_toml(value)}")]
    seeds = subprocess.run([program("seed"), definition, *overrides, *["--allow-process"] * allow_process],
                           stdin=subprocess.DEVNULL, capture_output=True, check=False)
    if seeds.returncode != 0:
        hint = "; give search() allow_process=True" if not allow_process and b"--allow-process" in seeds.stderr else ""
        raise RuntimeError(seeds.stderr.decode(errors="replace").strip() + hint)
    command = [program("expand"), "--complete", "-", "-o", grid, "-j", str(processors or 0)]
    if allow_process:
        command += ["--allow-process", definition]
    _watch(command, seeds.stdout)
    return grid


def _watch(command: list[str], seeds: bytes) -> None:
    """Runs expand with a terminal of its own as standard error, because it shows progress often on a terminal alone."""
    show = _display()
    screen, terminal = os.openpty()
    # A terminal's size of 0 is none: no line is cut.
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=terminal) as running:
        os.close(terminal)
        try:
            try:
                with running.stdin or open(os.devnull, "wb") as pipe:
                    pipe.write(seeds)
            except BrokenPipeError:
                pass  # it says why
            said = _show(screen, show)
        except BaseException:
            running.terminate()
            raise
        finally:
            os.close(screen)
            show("")
    if running.returncode == 0:
        show(f"[{'#' * BAR}] done")
    else:
        raise RuntimeError(said[-1] if said else f"expand ended with {running.returncode}")


def _show(screen: int, show: Callable[[str], object]) -> list[str]:
    """Shows the lines of progress until the end. Returns all other lines."""
    said, text = [], b""
    while True:
        try:
            text += os.read(screen, 1 << 16)
        except OSError:  # Linux says so when the other side is closed
            break
        *lines, text = re.split(rb"[\r\n]+", text)
        for line in (line.decode(errors="replace").replace("\x1b[K", "").strip() for line in lines):
            if not line:
                continue
            if part := _part(line):
                show(f"[{'#' * round(BAR * part[0]):{BAR}}] {part[1]}")
            else:
                said.append(line)
    return said


def _part(line: str) -> tuple[float, str] | None:
    """How much of its round a line of progress has behind it, and what it says; None for any other line."""
    number = r"([0-9.]+)( [kMGT])?"
    found = re.search(f"{number} of {number} (conversions|one-way links)", line)
    if not line.startswith("expand: ") or not found:
        return None
    done, all_of_them = (float(found[i]) * UNITS[found[i + 1] or ""] for i in (1, 3))
    return min(1.0, done / all_of_them if all_of_them else 1.0), line.removeprefix("expand: ")


def _display() -> Callable[[str], object]:
    """A function that shows one line in place of the one before. An empty one takes it away, but from a notebook, where
    the last one stays."""
    if "ipykernel" in sys.modules:
        from IPython.display import display

        handle = display({"text/plain": ""}, raw=True, display_id=True)
        return lambda line: line and handle.update({"text/plain": line}, raw=True)
    if not sys.stderr.isatty():
        return lambda line: None
    return lambda line: print("\r\033[K" + line + "\n" * line.endswith("done"), end="", file=sys.stderr, flush=True)


def _toml(value: Any) -> str:
    if hasattr(value, "tolist"):  # NumPy's arrays and numbers
        value = value.tolist()
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return str(value)
