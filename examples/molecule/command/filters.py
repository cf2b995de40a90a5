"""Starting the filters of hapgrid."""

import os
import subprocess
import sys


class Failed(Exception):
    """What was asked for is not possible; the message is one line."""


class FilterFailed(Failed):
    """A filter said no; the message is the last line that it wrote."""


class Filters:
    """The programs of one folder, run in the folder of the results."""

    def __init__(self, directory):
        self.directory = os.environ["HAPGRID_BIN"]
        self.work = directory
        self.said = ""  # the last line that a filter wrote to standard error

    def run(self, name, *arguments, good=(0,), progress=False):
        """What a filter writes to standard output, and its exit code. With progress its line of
        progress goes to the terminal.
        Errors: FilterFailed, when the exit code is not among the good ones."""
        command = [os.path.join(self.directory, name), *map(str, arguments)]
        show = progress and sys.stderr.isatty()
        try:
            done = subprocess.run(command, cwd=self.work, text=True, encoding="utf-8",
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=None if show else subprocess.PIPE, check=False)
        except FileNotFoundError:
            raise Failed(f"{name} is not in {self.directory}: build all of hapgrid") from None
        lines = (done.stderr or "").strip().splitlines()
        self.said = lines[-1] if lines else f"{name}: exit code {done.returncode}"
        if done.returncode not in good:
            raise FilterFailed(self.said)
        return done.stdout, done.returncode
