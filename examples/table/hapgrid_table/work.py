"""What a command that makes a grid needs: steps that are not done twice, the filters, files that are whole,
and lines of progress. `hapgrid table` and `hapgrid dock` share it."""

import hashlib
import json
import os
import subprocess
import sys
import time
import unicodedata


class Failed(Exception):
    """What was asked for is not possible; the message is one line."""


class BreaksRule(Failed):
    """Verify found a fault in the grid."""


def write_whole(path, content):
    """Writes a file so that it is there in full, or as it was before. content: text or bytes."""
    beside = f"{path}.new.{os.getpid()}"
    try:
        with open(beside, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)
    except BaseException:
        if os.path.exists(beside):
            os.remove(beside)
        raise


def remove(path):
    if os.path.exists(path):
        os.remove(path)


def digest(path):
    """A hash of a file's bytes, None where there is none."""
    try:
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()[:24]
    except FileNotFoundError:
        return None


def printable(text):
    """A text from outside as one line: a control character is a space, what cannot be seen a question mark."""
    unseen = ("Cc", "Cf", "Cs", "Zl", "Zp")
    return "".join(" " if c < " " or c == "\x7f" else "?" if unicodedata.category(c) in unseen else c for c in text)


def duration(seconds):
    """As people say it."""
    if seconds < 90:
        return f"{max(seconds, 1):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


class Work:
    """The folder of the results, and what is in it already.

    A step makes files from files. It is passed over when what it reads, its options, and the files that it
    made are as they were. A file that was changed by hand since is kept, and what depends on it is made anew."""

    def __init__(self, command, directory, quiet):
        self.command, self.directory, self.quiet = command, directory, quiet
        if "HAPGRID_BIN" not in os.environ:
            raise Failed(f"start it as `hapgrid {command}`, which knows where the filters are")
        self.filters = os.environ["HAPGRID_BIN"]
        self.started = time.monotonic()
        self.kept = os.path.join(directory, ".steps.json")
        self.done, self.line = {}, False
        try:
            with open(self.kept, encoding="utf-8") as file:
                known = json.load(file)
            if all(isinstance(one["made"], dict) and isinstance(one["key"], str) for one in known.values()):
                self.done = known
        except (FileNotFoundError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            pass

    def path(self, name):
        return os.path.join(self.directory, name)

    def read(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def write(self, name, content):
        write_whole(self.path(name), content)

    def say(self, text):
        self._clear()
        if not self.quiet:
            print(printable(f"{self.command}: {time.monotonic() - self.started:5.0f} s  {text}"), file=sys.stderr,
                  flush=True)

    def waiting(self, what, gone, expected):
        """A line that is written over, where somebody watches. Seconds; expected: of all of it, or None."""
        if self.quiet or not sys.stderr.isatty():
            return
        left = f", {duration(gone)}"
        if expected:
            left += f", about {duration(expected - gone)} left" if expected > gone else ", longer than expected"
        print("\r\033[K" + printable(f"{self.command}: {what}{left}"), end="", file=sys.stderr, flush=True)
        self.line = True

    def _clear(self):
        if self.line:
            print("\r\033[K", end="", file=sys.stderr)
        self.line = False

    def changed_by_hand(self, name):
        """Whether a file that a step made was changed since."""
        for one in self.done.values():
            if name in one["made"] and os.path.exists(self.path(name)):
                return digest(self.path(name)) != one["made"][name]
        return False

    def step(self, name, title, inputs, options, compute):
        """Runs compute(), which returns the names of the files that it made, unless they are there.
        inputs: names of files; options: what else decides the result."""
        key = json.dumps([{one: digest(self.path(one)) for one in inputs}, options], sort_keys=True)
        key = hashlib.sha256(key.encode()).hexdigest()[:24]
        old = self.done.get(name)
        if old and old["key"] == key and all(os.path.exists(self.path(one)) for one in old["made"]):
            return
        if title:
            self.say(title)
        self.done.pop(name, None)
        made = compute()
        self.done[name] = {"key": key, "made": {one: digest(self.path(one)) for one in made}}
        self.write(".steps.json", json.dumps(self.done, indent=1) + "\n")

    def run(self, program, *arguments, good=(0,), watch=None):
        """What a program writes to standard output, and its exit code. A filter is given by its plain name, any
        other program as a list of one. watch(seconds) is called twice a second.
        Errors: Failed with the last line that it wrote, when the exit code is not among the good ones."""
        file = program[0] if isinstance(program, list) else os.path.join(self.filters, program)
        try:
            process = subprocess.Popen([file, *map(str, arguments)], cwd=self.directory, text=True, encoding="utf-8",
                                       errors="replace", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE)
        except FileNotFoundError:
            raise Failed(f"the program {file} is not there") from None
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
        if process.returncode not in good:
            lines = said.strip().splitlines() or out.strip().splitlines()
            raise Failed(lines[-1] if lines else f"{os.path.basename(file)}: exit code {process.returncode}")
        return out, process.returncode

    # What every grid goes through

    def compute_grid(self, toml, grid, threads):
        """Computes and verifies a grid; where a run was interrupted it goes on. Makes GRID, GRID.cost, verify.txt.
        Errors: BreaksRule."""
        title = f"computing {grid}"

        def compute():
            expected = self._estimated(toml, threads)
            seeds, cost = f"{grid}.seeds", f"{grid}.cost"
            remove(self.path(cost))
            self.run("seed", toml, "-o", seeds)

            def expand():
                self.run("expand", "--complete", "-j", threads, seeds, "-o", grid, "--cost", cost,
                         watch=lambda gone: self.waiting(title, gone, expected))
            try:
                expand()
            except Failed as why:
                if "remove it to begin anew" not in str(why):
                    raise
                remove(self.path(f"{grid}.partial"))  # of a definition that was changed since
                expand()
            remove(self.path(seeds))
            return [grid, cost]
        self.step("grid", title, [toml, *self.inputs_of(toml)], [], compute)
        title = "checking that the grid is whole and that its states are the model's"

        def verify():
            out, code = self.run("verify", grid, "-v", "-j", threads, good=(0, 3, 4),
                                 watch=lambda gone: self.waiting(title, gone, None))
            self.write("verify.txt", out)
            if code == 3:
                raise BreaksRule(f"{grid} breaks a rule: see {self.path('verify.txt')}")
            return ["verify.txt"]
        self.step("verify", title, [grid], [], verify)

    def inputs_of(self, toml):
        """The files that a definition names, changed by hand or not."""
        import tomllib
        try:
            files = tomllib.loads(self.read(toml))["model"].get("files", {})
        except (tomllib.TOMLDecodeError, KeyError, AttributeError):
            return []  # seed says what is wrong
        names = [name for one in files.values() for name in (one if isinstance(one, list) else [one])]
        return [name for name in names if isinstance(name, str)]

    def _estimated(self, toml, threads):
        """Seconds that a grid takes, within a factor of 2 or so; None where it is done before that is known."""
        if self.quiet or not sys.stderr.isatty():
            return None
        report = self.run("check-model", toml, "--steps", 100, "--seconds", 2, "--format", "json", good=(0, 1, 3))[0]
        seconds = ((json.loads(report) if report else {}).get("grid") or {}).get("cpu_seconds")
        return seconds and seconds / threads
