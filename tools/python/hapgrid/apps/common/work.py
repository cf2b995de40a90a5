"""The folder of the results. What is there already is not computed again.

A step makes files from files. It is passed over when what it reads, its options, the files it made, and hapgrid itself
are as they were. A file that was changed by hand since is kept, and what depends on it is computed anew.

The folder can be renamed and copied: nothing in it has its name, and it may come from somebody else. So
no file in it can name one outside of it, and what is kept in .work counts only if it has the right form.
"""

from __future__ import annotations

import fcntl
import functools
import json
import os
import re
import shlex
import shutil
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

from hapgrid.files import FILTERS, write_whole

from . import files
from .cli import UsageError
from .files import Failed, digest, digest_of
from .programs import Ran, Watch, run_program
from .texts import printable_line

Value = TypeVar("Value")
Answer = TypeVar("Answer")

# What a command that was killed leaves behind, its own and its filters' files.
UNFINISHED = re.compile(r"\.(selection|room|way-|single-|records\.|hapgrid\.).*|.*\.new\.\d+")
MOST_KEPT = 64 << 20  # bytes of a file of .work


class Cache:
    """Results that are kept as JSON files, by their names."""

    def __init__(self, directory: str) -> None:
        self.directory = directory

    def get(self, name: str) -> Any:
        """What was kept under a name, or None."""
        try:
            return json.loads(files.read_bytes(os.path.join(self.directory, name + ".json"), MOST_KEPT))
        except (FileNotFoundError, ValueError, RecursionError):
            return None

    def put(self, name: str, value: Any) -> None:
        os.makedirs(self.directory, exist_ok=True)
        write_whole(os.path.join(self.directory, name + ".json"), json.dumps(value))

    def take(self, key: Any, compute: Callable[[], Any], read: Callable[[Any], Value]) -> Value:
        """read() of the value that was kept under a key, or else of compute(). read: raises ValueError or TypeError where a
        value has another form."""
        name = digest_of(json.dumps(key, sort_keys=True).encode())
        try:
            return read(self.get(name))
        except (ValueError, TypeError):
            value = compute()
            self.put(name, value)
            return read(value)


class Work:
    """command: as messages begin; given: files that are read, which must not lie where files are written."""

    def __init__(self, command: str, directory: str, quiet: bool, given: Sequence[str] = ()) -> None:
        self.command, self.directory, self.quiet = command, directory, quiet
        self.filters = os.environ.get("HAPGRID_BIN") or FILTERS
        self.started = time.monotonic()
        self.line = False
        self.cache = Cache(self.path(".work"))  # the one cache
        self._lock: int | None = None
        if os.path.isdir(directory):
            if os.listdir(directory) and not os.path.lexists(self.cache.directory):
                raise UsageError(f"{directory}: has files that are none of hapgrid {command}: give a new folder")
            inside = next((one for one in given if os.path.realpath(os.path.dirname(one)) == os.path.realpath(directory)), None)
            if inside is not None:
                raise UsageError(f"{inside}: lies in the folder of the results, {directory}: copy it, or give another folder")
            self.enter()

    def require(self, words: str, of: Any) -> None:
        """Refuses a folder that belong() has given to something else. words: what the folder is of, for people; of: what tells
        it from others, as JSON keeps it."""
        kept = self.cache.get("of")
        if isinstance(kept, dict) and "words" in kept and "of" in kept and kept["of"] != [self.command, of]:
            raise UsageError(f"{self.directory}: has other results, of {kept['words']}, not of {words}: give another folder, or "
                             "remove this one")

    def belong(self, words: str, of: Any) -> None:
        """From here on the folder is of this alone."""
        self.require(words, of)
        self.cache.put("of", {"of": [self.command, of], "words": words})

    def enter(self) -> None:
        """Makes the folder where there is none, and waits until no other run works in it. What a run that was killed
        has left is removed. A link would let a stranger's folder write outside of it."""
        if self._lock is not None:
            return
        os.makedirs(self.cache.directory if not os.path.isdir(self.directory) else self.directory, exist_ok=True)
        self._lock = os.open(self.directory, os.O_RDONLY)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.say(f"another run works in {self.directory}: waiting for its end")
            fcntl.flock(self._lock, fcntl.LOCK_EX)
        except OSError as e:  # a file system without locks
            self.say(f"{self.directory} cannot be locked ({e.strerror}): let one run at a time work there")
        for directory in (self.directory, self.cache.directory):
            for one in os.scandir(directory) if os.path.isdir(directory) else ():
                if one.is_symlink():
                    raise Failed(f"{one.path}: is a link, which a folder of results must not have: remove it")
                if UNFINISHED.fullmatch(one.name):
                    shutil.rmtree(one.path) if one.is_dir() else os.remove(one.path)

    def name(self) -> str:
        """Of the grid and its definition: that of the folder when it was new, whatever it is called since."""
        kept = self.cache.get("name")
        if not files.is_plain(kept):
            kept = os.path.basename(os.path.realpath(self.directory))
            kept = kept if files.is_plain(kept) else self.command
            if os.path.isdir(self.directory):
                self.cache.put("name", kept)
        return kept

    # Files

    def path(self, name: str) -> str:
        return os.path.join(self.directory, name)

    def in_shell(self, name: str) -> str:
        """The path of a file for a shell's command line, never an option."""
        path = self.path(name)
        return shlex.quote(f"./{path}" if path.startswith("-") else path)

    def launcher(self) -> str:
        """The program hapgrid as a shell finds it: by its plain name, or by its path. It says where it is, since an
        installation has it in another folder than the filters."""
        mine = os.environ.get("HAPGRID_LAUNCHER") or os.path.join(self.filters, "hapgrid")
        found = shutil.which("hapgrid")
        if not os.path.exists(mine) or found and os.path.samefile(found, mine):
            return "hapgrid"
        here, whole = os.path.relpath(mine), os.path.abspath(mine)
        return shlex.quote(here if len(here) < len(whole) else whole)

    def read(self, name: str) -> str:
        return files.read_text(self.path(name))

    def write(self, name: str, content: str | bytes) -> None:
        write_whole(self.path(name), content)

    def digest(self, name: str) -> str | None:
        return digest(self.path(name))

    # What is said

    def say(self, text: str) -> None:
        self._clear()
        if not self.quiet:
            print(printable_line(f"{self.command}: {time.monotonic() - self.started:5.0f} s  {text}"), file=sys.stderr,
                  flush=True)

    def counted(self, what: str, total: int) -> Callable[[int], None]:
        """tell(n) for what is done in `total` parts."""
        began = time.monotonic()

        def tell(done: int) -> None:
            gone = time.monotonic() - began
            self.waiting(f"{what}: {done} of {total}", gone, gone / done * total if 0 < done < total else None)
        tell(0)
        return tell

    def waiting(self, what: str, gone: float, expected: float | None) -> None:
        """The same for one long computation. Seconds; expected: of all of it, or None."""
        left = f"for {duration(gone)}"
        if expected:
            left = (f"{100 * gone / expected:.0f} %, about {duration(expected - gone)} left" if expected > gone
                    else f"{left}, longer than expected")
        self._write_over(f"{left}, {what}")

    def _write_over(self, text: str) -> None:
        """A line that is written over, where somebody watches."""
        if self.quiet or not sys.stderr.isatty():
            return
        width = os.get_terminal_size(sys.stderr.fileno()).columns or 80
        line = printable_line(f"{self.command}: {text}")[:width - 1]
        print(f"\r\033[K{line}", end="", file=sys.stderr, flush=True)
        self.line = True

    def _clear(self) -> None:
        if self.line:
            print("\r\033[K", end="", file=sys.stderr)
        self.line = False

    # What was computed

    @functools.cached_property
    def version(self) -> list[str]:
        """Of hapgrid: that of the filters, and the sources of this command. Another one computes anew."""
        packages = [m for name, m in sys.modules.items() if name.startswith("hapgrid.apps") and hasattr(m, "__path__")]
        names = [os.path.join(package.__path__[0], name) for package in packages for name in os.listdir(package.__path__[0])]
        sources = sorted(digest(name) or "" for name in names if os.path.isfile(name))
        return [self.run("seed", "--version").out, digest_of(json.dumps(sources).encode())]

    def recall(self, name: str, key: Any) -> Any:
        """What was remembered for this key, or None."""
        kept = self.cache.get(name)
        sound = isinstance(kept, dict) and kept.get("key") == [self.version, key] and "value" in kept
        return kept["value"] if sound else None

    def remember(self, name: str, key: Any, value: Any) -> None:
        self.cache.put(name, {"key": [self.version, key], "value": value})

    def _record(self, step: str) -> tuple[str | None, dict[str, Any]]:
        """(key, {file that was made: its digest})"""
        kept = self.cache.get("stage-" + step)
        key, made = (kept.get("key"), kept.get("made")) if isinstance(kept, dict) else (None, None)
        if not isinstance(made, dict) or not all(map(files.is_plain, made)):
            return None, {}
        return key, made

    def changed_by_hand(self, name: str, step: str = "definition") -> bool:
        """Whether a file that a step made was changed since."""
        made = self._record(step)[1]
        return name in made and os.path.exists(self.path(name)) and self.digest(name) != made[name]

    def step(self, step: str, title: str, inputs: Iterable[str], options: Any, compute: Callable[[], Any]) -> Any:
        """Makes files by compute(), which returns their names, unless they are there. What else compute() returns is
        returned, and nothing is kept. inputs: names of files; options: what else decides the result."""
        read = {name: self.digest(name) for name in inputs}
        key = digest_of(json.dumps([self.version, read, options], sort_keys=True).encode())
        old, made = self._record(step)
        if old == key and all(os.path.exists(self.path(n)) for n in made):
            return None
        if title:
            self.say(title)
        names = compute()
        if not isinstance(names, list):
            return names
        self.cache.put("stage-" + step, {"key": key, "made": {name: self.digest(name) for name in names}})
        return None

    def made(self, step: str) -> list[str]:
        return list(self._record(step)[1])

    # Programs

    def run(self, program: str | list[str], *arguments: object, good: Sequence[int] = (0,), watch: Watch | None = None,
            package: str = "") -> Ran:
        """The Ran of a filter, which is given by its plain name, or of another program of a Debian package, as a list of its
        first words. It runs in the folder. watch: of run_program(). Errors: Failed, when the exit code is not among the
        good ones."""
        words = program if isinstance(program, list) else [os.path.join(self.filters, program)]
        try:
            there = self.directory if os.path.isdir(self.directory) else None  # --version needs no folder
            ran = run_program([*words, *map(str, arguments)], there, watch)
        except FileNotFoundError:
            other = f"there: install the Debian package {package or words[0]}"
            where = other if words is program else f"in {self.filters}: build all of hapgrid"
            raise Failed(f"{os.path.basename(words[0])} is not {where}") from None
        if ran.code not in good:
            raise Failed(ran.fault(os.path.basename(words[0])))
        return ran

    def feel_page(self, grid: str) -> list[str]:
        """Makes feel.html, which plays a grid by itself. [its name], or [] where there can be none, since it would be too
        large for instance, and that is said."""
        if os.path.lexists(self.path("feel.html")):
            os.remove(self.path("feel.html"))
        ran = self.run("view", grid, "--html", "feel.html", good=(0, 1))
        if ran.code:
            self.say(f"no feel.html: {ran.fault('view')}")
        return [] if ran.code else ["feel.html"]

    def each(self, what: str, compute: Callable[[Value], Answer], values: Sequence[Value], threads: int) -> list[Answer]:
        """[compute(value)] of several values, so many at a time. what: they are, for the line of progress."""
        tell, out = self.counted(what, len(values)), []
        with ThreadPoolExecutor(threads) as pool:
            for one in pool.map(compute, values):
                out.append(one)
                tell(len(out))
        return out


def about(seconds: float, cores: int) -> str:
    """What a computation of so many seconds takes, in words; also, where others use the cores, if they go on doing so."""
    began, used = time.monotonic(), time.process_time()
    while time.process_time() - used < 0.1:
        pass
    slower = (time.monotonic() - began) / 0.1
    free = f"about {duration(seconds)} on " + ("a free core" if cores == 1 else f"{cores} free cores")
    return free if slower < 1.5 else f"about {duration(slower * seconds)} at the present load, and {free}"


def duration(seconds: float) -> str:
    """As people say it."""
    if seconds < 90:
        return f"{max(seconds, 1):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
