"""Starting the filters of hapgrid."""

import os
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor


class Failed(Exception):
    """What was asked for is not possible; the message is one line."""


class FilterFailed(Failed):
    """A filter said no; the message is the last line that it wrote."""


class Filters:
    """The programs of one folder, run in the folder of the results."""

    def __init__(self, directory):
        if "HAPGRID_BIN" not in os.environ:
            raise Failed("start it as `hapgrid molecule`, which knows where the filters are")
        self.directory = os.environ["HAPGRID_BIN"]
        self.work = directory
        self.said = ""  # the last line that a filter wrote to standard error

    def run(self, name, *arguments, good=(0,), watch=None):
        """What a filter writes to standard output, and its exit code. watch(seconds) is called twice
        a second while it works.
        Errors: FilterFailed, when the exit code is not among the good ones."""
        command = [os.path.join(self.directory, name), *map(str, arguments)]
        try:
            process = subprocess.Popen(command, cwd=self.work, text=True, encoding="utf-8",
                                       stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        except FileNotFoundError:
            raise Failed(f"{name} is not in {self.directory}: build all of hapgrid") from None
        began = time.monotonic()
        with process:
            try:
                while True:
                    try:
                        out, said = process.communicate(timeout=0.5)
                        break
                    except subprocess.TimeoutExpired:
                        if watch:
                            watch(time.monotonic() - began)
            except BaseException:
                process.terminate()
                raise
        lines = said.strip().splitlines()
        self.said = lines[-1] if lines else f"{name}: exit code {process.returncode}"
        if process.returncode not in good:
            raise FilterFailed(self.said)
        return out, process.returncode

    def run_each(self, commands, threads, tell):
        """Runs several commands (lists of arguments, the filter's name first), so many at a time. tell(n)
        is called when n are done."""
        with ThreadPoolExecutor(threads) as pool:
            for done, _ in enumerate(pool.map(lambda words: self.run(*words), commands), 1):
                tell(done)
