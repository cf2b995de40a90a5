"""Starting the filters of hapgrid, and ending them: none of them outlives the command."""

import ctypes
import errno
import os
import shutil
import signal
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_PDEATHSIG = 1  # of prctl


class Failed(Exception):
    """What was asked for is not possible; the message is one line."""


class FilterFailed(Failed):
    """A filter said no; the message is the last line that it wrote."""


class Stopped(BaseException):
    """A signal asks the command to end. number: of the signal."""

    def __init__(self, number):
        super().__init__(number)
        self.number = number


_running = set()  # of all threads
_stopped_by = 0


def catch_signals():
    for number in ENDING:
        if signal.getsignal(number) != signal.SIG_IGN:  # as nohup wants it
            signal.signal(number, _stop)


def _stop(number, _frame):
    global _stopped_by
    _stopped_by = number
    signal.signal(number, signal.SIG_DFL)  # once more: at once
    for process in list(_running):
        process.terminate()
    raise Stopped(number)


def end_with_parent():
    """For a process that was forked from this one: signals have their usual effect, except that Ctrl-C is left to the
    first process; and where that is killed, the system kills this one."""
    for number in ENDING[1:]:
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    ctypes.CDLL(None).prctl(_PDEATHSIG, signal.SIGKILL)


def run_program(words, directory, watch=None):
    """(standard output, standard error, exit code) of a program that ends when this one does. directory: where it runs;
    watch(seconds) is called twice a second while it works.
    Errors: FileNotFoundError"""
    if shutil.which(words[0]) is None:
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), words[0])
    if _stopped_by:
        raise Stopped(_stopped_by)
    # Where this process is killed, the system asks the program to end.
    process = subprocess.Popen(["setpriv", "--pdeathsig", "TERM", "--", *words], cwd=directory, text=True,
                               encoding="utf-8", errors="replace", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
    _running.add(process)
    began = time.monotonic()
    with process:
        try:
            if _stopped_by:
                process.terminate()
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
        finally:
            _running.discard(process)
    if _stopped_by:
        raise Stopped(_stopped_by)
    return out, said, process.returncode


class Filters:
    """The programs of one folder, run in the folder of the results."""

    def __init__(self, directory):
        if "HAPGRID_BIN" not in os.environ:
            raise Failed("start it as `hapgrid molecule`, which knows where the filters are")
        self.directory = os.environ["HAPGRID_BIN"]
        self.work = directory
        self.said = ""  # the last line that a filter wrote to standard error

    def run(self, name, *arguments, good=(0,), watch=None):
        """What a filter writes to standard output, and its exit code. watch: of run_program().
        Errors: FilterFailed, when the exit code is not among the good ones."""
        try:
            out, said, code = run_program([os.path.join(self.directory, name), *map(str, arguments)], self.work, watch)
        except FileNotFoundError:
            raise Failed(f"{name} is not in {self.directory}: build all of hapgrid") from None
        lines = said.strip().splitlines()
        self.said = lines[-1] if lines else f"{name}: exit code {code}"
        if code not in good:
            raise FilterFailed(self.said)
        return out, code

    def run_each(self, commands, threads, tell):
        """Runs several commands (lists of arguments, the filter's name first), so many at a time. tell(n)
        is called when n are done."""
        with ThreadPoolExecutor(threads) as pool:
            for done, _ in enumerate(pool.map(lambda words: self.run(*words), commands), 1):
                tell(done)
