"""What is there already is not computed again.

A stage makes files from files. It is passed over when what it reads, its options, and the files it
made are as they were. A file that was changed by hand since is kept, and what depends on it is
computed anew.
"""

import hashlib
import json
import os
import sys
import time

from preparation import files

VERSION = 1


def digest(path):
    """A hash of a file's bytes, None where there is none."""
    try:
        with open(path, "rb") as file:
            return digest_of(file.read())
    except FileNotFoundError:
        return None


def digest_of(content):
    return hashlib.sha256(content).hexdigest()[:24]


class Stages:
    def __init__(self, directory, quiet):
        self.directory = directory
        self.quiet = quiet
        self.started = time.monotonic()
        self.kept = os.path.join(directory, ".stages.json")
        self.done = {}
        self.line = False
        try:
            with open(self.kept, encoding="utf-8") as file:
                text = json.load(file)
            if text.get("version") == VERSION:
                self.done = text["done"]
        except (FileNotFoundError, ValueError, KeyError, AttributeError, RecursionError):
            pass

    def path(self, name):
        return os.path.join(self.directory, name)

    def say(self, text):
        self._clear()
        if not self.quiet:
            print(f"molecule: {time.monotonic() - self.started:5.0f} s  {text}", file=sys.stderr, flush=True)

    def progress(self, what, done, total, began):
        """A line that is written over, where somebody watches."""
        if self.quiet or not sys.stderr.isatty():
            return
        left = ""
        if 0 < done < total:
            left = f", about {duration((time.monotonic() - began) / done * (total - done))} left"
        print(f"\r\033[Kmolecule: {what}: {done} of {total}{left}", end="", file=sys.stderr, flush=True)
        self.line = True

    def waiting(self, what, gone, expected):
        """The same for one long computation. Seconds; expected: of all of it, or None."""
        if self.quiet or not sys.stderr.isatty():
            return
        left = f", {duration(gone)}"
        if expected:
            left += f", about {duration(expected - gone)} left" if expected > gone else ", longer than expected"
        print(f"\r\033[Kmolecule: {what}{left}", end="", file=sys.stderr, flush=True)
        self.line = True

    def counted(self, what, total):
        """tell(n) for what is done in `total` steps."""
        began = time.monotonic()
        self.progress(what, 0, total, began)
        return lambda done: self.progress(what, done, total, began)

    def _clear(self):
        if self.line:
            print("\r\033[K", end="", file=sys.stderr)
        self.line = False

    def changed_by_hand(self, stage, name):
        """Whether a file that a stage made was changed since."""
        made = self.done.get(stage, {}).get("made", {})
        return name in made and os.path.exists(self.path(name)) and digest(self.path(name)) != made[name]

    def run(self, stage, title, inputs, options, compute):
        """Runs compute(), which returns the names of the files that it made, unless they are there.
        inputs: names of files; options: what else decides the result."""
        key = [{name: digest(self.path(name)) for name in inputs}, options]
        key = hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()[:24]
        old = self.done.get(stage, {})
        if old.get("key") == key and all(os.path.exists(self.path(n)) for n in old["made"]):
            return False
        if title:
            self.say(title)
        self.done.pop(stage, None)
        names = compute()
        self.done[stage] = {"key": key, "made": {name: digest(self.path(name)) for name in names}}
        files.write_whole(self.kept, json.dumps({"version": VERSION, "done": self.done}, indent=1) + "\n")
        return True

    def made(self, stage):
        return list(self.done.get(stage, {}).get("made", {}))


def duration(seconds):
    """As people say it."""
    if seconds < 90:
        return f"{max(seconds, 1):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
