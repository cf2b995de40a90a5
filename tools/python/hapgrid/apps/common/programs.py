"""Starting programs, and ending them: none of them outlives the command."""

from __future__ import annotations

import ctypes
import errno
import multiprocessing.context
import multiprocessing.popen_fork
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from multiprocessing.pool import Pool
from types import FrameType
from typing import Any, NamedTuple, NoReturn, TypeAlias

Watch: TypeAlias = Callable[[float], None]  # is told how many seconds have gone
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_PDEATHSIG = 1  # of prctl


class Stopped(BaseException):
    """A signal asks the command to end. number: of the signal."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


class Ran(NamedTuple):
    """What a program wrote to standard output, its exit code (negative: the signal that ended it), and the last line that
    it wrote to standard error, or else to standard output."""
    out: str
    code: int
    said: str

    def fault(self, name: str) -> str:
        """Why a program of this name failed, as one line. A crash has no message of ours."""
        if self.code < 0:
            return f"{name}: ended by {signal.Signals(-self.code).name}" + (f": {self.said}" if self.said else "")
        return self.said or f"{name}: exit code {self.code}"


_running: set[subprocess.Popen[str]] = set()  # of all threads
_stopped_by = 0


def catch_signals() -> None:
    for number in ENDING:
        if signal.getsignal(number) != signal.SIG_IGN:  # as nohup wants it
            signal.signal(number, _stop)
    # Nothing can stop what Python calls after a fork: see raise_if_stopped().
    sys.unraisablehook = lambda what: isinstance(what.exc_value, Stopped) or sys.__unraisablehook__(what)


def _stop(number: int, _frame: FrameType | None) -> NoReturn:
    global _stopped_by
    _stopped_by = number
    signal.signal(number, signal.SIG_DFL)  # once more: at once
    for process in list(_running):
        process.terminate()
    raise Stopped(number)


def raise_if_stopped() -> None:
    """For what has forked a process: a signal that came meanwhile is lost in what Python calls after that."""
    if _stopped_by:
        raise Stopped(_stopped_by)


def end_with_parent() -> None:
    """For a process that was forked from this one: signals have their usual effect, except that Ctrl-C is left to the
    first process; and where that is killed, the system kills this one."""
    for number in ENDING[1:]:
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    ctypes.CDLL(None).prctl(_PDEATHSIG, signal.SIGKILL)


class _Popen(multiprocessing.popen_fork.Popen):
    terminate = multiprocessing.popen_fork.Popen.kill  # which Python asks at its end, where a pool was not finished


class _Worker(multiprocessing.context.ForkProcess):
    terminate = multiprocessing.context.ForkProcess.kill
    _Popen = staticmethod(_Popen)


class _Workers(multiprocessing.context.ForkContext):
    Process = _Worker


def workers(count: int) -> Pool:
    """A multiprocessing.Pool of forked processes, which leave signals to this one. If a signal to all of them, as timeout
    and batch systems send it, ended one while it waits for work, the lock that it holds would keep the pool from ending."""
    return _Workers().Pool(count, _leave_signals)


def _leave_signals() -> None:
    end_with_parent()
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)


def run_program(words: Sequence[str], directory: str | None, watch: Watch | None = None, **given: Any) -> Ran:
    """The Ran of a program that ends when this one does. directory: where it runs; watch(seconds) is called twice a second
    while it works; given: of Popen. Its preexec_fn, if any, calls end_with_parent(), and is for a program that may
    not end when it is asked. Errors: FileNotFoundError"""
    if shutil.which(words[0]) is None:
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), words[0])
    raise_if_stopped()
    # Where this process is killed, the system asks the program to end.
    words = words if "preexec_fn" in given else ["setpriv", "--pdeathsig", "TERM", "--", *words]
    options: dict[str, Any] = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **given}
    process = subprocess.Popen(words, cwd=directory, text=True, encoding="utf-8", errors="replace", **options)
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
            process.kill() if "preexec_fn" in given else process.terminate()
            raise
        finally:
            _running.discard(process)
    raise_if_stopped()
    out, said = out or "", said or ""
    lines = said.strip().splitlines() or out.strip().splitlines() or [""]
    return Ran(out, process.returncode, lines[-1])
