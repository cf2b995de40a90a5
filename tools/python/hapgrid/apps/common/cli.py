"""The command line of a command that makes a grid."""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Callable, Sequence
from typing import Any, NoReturn, TextIO

from .files import Failed
from .programs import Stopped, catch_signals
from .texts import printable_line, printable_text

# For the help of a command.
EXIT_CODES = """\
Exit codes:
  0  done
  1  could not: input, I/O, a model or another program
  2  the command line is wrong
  3  the grid breaks a rule: see verify.txt"""


class UsageError(Exception):
    pass


class BreaksRule(Failed):
    """Verify found a fault in the grid, for which there is no cure."""


class Parser(argparse.ArgumentParser):
    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        # A word such as -1,0,0 is a value, and no option. argparse knows this of single numbers only.
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def error(self, message: str) -> NoReturn:  # one line, as every other message
        raise UsageError(message + " (see --help)")

    def add_output(self, threads: str) -> None:
        """threads: what -j N is a number of."""
        self.add_argument("-o", "--output", type=folder, metavar="DIR", required=True, help="folder for all files")
        self.add_argument("-j", "--threads", type=number(1, 1024, int), metavar="N", default=1,
                          help=f"number of {threads}, which does not change the result (default: 1)")

    def add_until(self, *steps: str) -> None:
        self.add_argument("--until", choices=steps, help="step after which the command stops")
        self.add_argument("-q", "--quiet", action="store_true", help="print no progress on standard error")


def folder(text: str) -> str:
    if not text or os.path.exists(text) and not os.path.isdir(text):
        raise argparse.ArgumentTypeError(f"'{text}' is no folder")
    return text


class Help(argparse.RawDescriptionHelpFormatter):
    """As the filters have it."""
    def add_usage(self, usage: Any, actions: Any, groups: Any, prefix: str | None = None) -> None:
        super().add_usage(usage, actions, groups, "Usage: ")


def formatter(prog: str) -> argparse.HelpFormatter:
    return Help(prog, width=80)


def number(low: float, high: float, kind: Callable[[str], Any] = float) -> Callable[[str], Any]:
    def read(text: str) -> Any:
        value = kind(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"must be from {low} to {high}")
        return value
    read.__name__ = getattr(kind, "__name__", "")
    return read


def three(low: float, high: float) -> Callable[[str], list[float]]:
    def read(text: str) -> list[float]:
        try:
            values = [float(word) for word in text.split(",")]
        except ValueError:
            values = []
        if len(values) != 3 or not all(low <= v <= high for v in values):
            raise argparse.ArgumentTypeError(f"must be three numbers from {low:g} to {high:g} with commas between")
        return values
    return read


def guarded(command: str, parse: Callable[[Sequence[str]], argparse.Namespace], run: Callable[[argparse.Namespace], str],
            arguments: Sequence[str]) -> int:
    """Runs a command and returns its exit code. parse(arguments) gives options, run(options) the line for standard output."""
    def failed(why: object, code: int) -> int:
        if code > 128 and sys.stderr.isatty():  # behind ^C
            print(file=sys.stderr)
        print(printable_line(f"{command}: {why}"), file=sys.stderr)
        return code
    try:
        catch_signals()
        options = parse(arguments)
        with silenced() as out:
            line = run(options)
            if line:
                print(printable_text(line), file=out)
    except UsageError as why:
        return failed(why, 2)
    except BreaksRule as why:
        return failed(why, 3)
    except Failed as why:
        return failed(why, 1)
    except OSError as why:
        return failed(f"{why.filename}: {why.strerror}" if why.filename else why, 1)
    except MemoryError:
        return failed("there is not enough memory", 1)
    except Stopped as why:
        return failed("stopped; the same command goes on", 128 + why.number)
    return 0


def silenced() -> TextIO:
    """Discards what libraries write to standard output from here on, and returns the real one. GFN-FF prints there, whatever
    its verbosity, some of it only when the process ends."""
    sys.stdout.flush()
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)
    return out
