"""The folder of the results. What is there already is not computed again.

A stage makes files from files. It is passed over when what it reads, its options, and the files it
made are as they were. A file that was changed by hand since is kept, and what depends on it is
computed anew.

The folder can be renamed and copied: nothing in it has its name, and it may come from somebody else. So
no file in it can name one outside of it.
"""

import fcntl
import hashlib
import json
import os
import re
import shutil
import sys
import time

from preparation import files, work
from preparation.molecule import BadInput

# What a command that was killed leaves behind, its own and its filters' files.
UNFINISHED = re.compile(r"\.(choice|combined|room|way-|single-|hapgrid\.).*|.*\.new\.\d+")


def digest(path):
    """A hash of a file's bytes, None where there is none."""
    try:
        with open(path, "rb") as file:
            return digest_of(file.read())
    except FileNotFoundError:
        return None


def digest_of(content):
    return hashlib.sha256(content).hexdigest()[:24]


def key_of(value):
    return digest_of(json.dumps(value, sort_keys=True).encode())


class Stages:
    def __init__(self, directory, quiet):
        self.directory = directory
        self.quiet = quiet
        self.started = time.monotonic()
        self.line = False
        self.steps = work.Steps(self.path(".work"))  # the one cache
        self._lock = None
        if os.path.isdir(directory):
            self.enter()

    def enter(self):
        """Makes the folder where there is none, and waits until no other run works in it. What a run that was killed
        has left is removed. A link would let a stranger's folder write outside of it."""
        if self._lock is not None:
            return
        os.makedirs(self.directory, exist_ok=True)
        self._lock = os.open(self.directory, os.O_RDONLY)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.say(f"another run works in {self.directory}: waiting for its end")
            fcntl.flock(self._lock, fcntl.LOCK_EX)
        for directory in (self.directory, self.steps.directory):
            for one in os.scandir(directory) if os.path.isdir(directory) else ():
                if one.is_symlink():
                    raise BadInput(f"{one.path}: is a link, which a folder of results must not have: remove it")
                if UNFINISHED.fullmatch(one.name):
                    shutil.rmtree(one.path) if one.is_dir() else os.remove(one.path)

    def name(self):
        """Of the grid and its definition: that of the folder when it was new, whatever it is called since."""
        kept = self.steps.kept("name")
        if not isinstance(kept, str) or not files.is_plain(kept):
            kept = os.path.basename(os.path.realpath(self.directory))
            kept = kept if files.is_plain(kept) else "molecule"
            self.steps.keep("name", kept)
        return kept

    def digest(self, name):
        return digest(self.path(name))

    def path(self, name):
        return os.path.join(self.directory, name)

    def say(self, text):
        self._clear()
        if not self.quiet:
            print(f"molecule: {time.monotonic() - self.started:5.0f} s  {text}", file=sys.stderr, flush=True)

    def progress(self, what, done, total, began):
        """A line that is written over, where somebody watches."""
        left = ""
        if 0 < done < total:
            left = f", about {duration((time.monotonic() - began) / done * (total - done))} left"
        self._write_over(f"{what}: {done} of {total}{left}")

    def waiting(self, what, gone, expected):
        """The same for one long computation. Seconds; expected: of all of it, or None."""
        left = f", {duration(gone)}"
        if expected:
            left += f", about {duration(expected - gone)} left" if expected > gone else ", longer than expected"
        self._write_over(what + left)

    def counted(self, what, total):
        """tell(n) for what is done in `total` steps."""
        began = time.monotonic()
        self.progress(what, 0, total, began)
        return lambda done: self.progress(what, done, total, began)

    def _write_over(self, text):
        if self.quiet or not sys.stderr.isatty():
            return
        width = os.get_terminal_size(sys.stderr.fileno()).columns or 80
        print(f"\r\033[K{f'molecule: {text}'[:width - 1]}", end="", file=sys.stderr, flush=True)
        self.line = True

    def _clear(self):
        if self.line:
            print("\r\033[K", end="", file=sys.stderr)
        self.line = False

    # What was computed

    def recall(self, name, key):
        """What was remembered for this key, or None."""
        kept = self.steps.kept(name)
        return kept["value"] if isinstance(kept, dict) and kept.get("key") == key and "value" in kept else None

    def remember(self, name, key, value):
        self.steps.keep(name, {"key": key, "value": value})

    def _record(self, stage):
        """(key, {file that was made: its digest})"""
        kept = self.steps.kept("stage-" + stage)
        key, made = (kept.get("key"), kept.get("made")) if isinstance(kept, dict) else (None, None)
        if not isinstance(made, dict) or not all(map(files.is_plain, made)):
            return None, {}
        return key, made

    def changed_by_hand(self, stage, name):
        """Whether a file that a stage made was changed since."""
        made = self._record(stage)[1]
        return name in made and os.path.exists(self.path(name)) and digest(self.path(name)) != made[name]

    def run(self, stage, title, inputs, options, compute):
        """Makes files by compute(), which returns their names, unless they are there. What else compute() returns is
        returned, and nothing is kept. inputs: names of files; options: what else decides the result."""
        key = key_of([{name: digest(self.path(name)) for name in inputs}, options])
        old, made = self._record(stage)
        if old == key and all(os.path.exists(self.path(n)) for n in made):
            return None
        if title:
            self.say(title)
        names = compute()
        if not isinstance(names, list):
            return names
        self.steps.keep("stage-" + stage, {"key": key, "made": {name: digest(self.path(name)) for name in names}})
        return None

    def made(self, stage):
        return list(self._record(stage)[1])


def duration(seconds):
    """As people say it."""
    if seconds < 90:
        return f"{max(seconds, 1):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
