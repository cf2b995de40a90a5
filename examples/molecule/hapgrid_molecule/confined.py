"""A function in a process of its own, for files from strangers.

Libraries that read a dozen formats crash on some damaged files. The process has limits of memory, time and size of
files, and on Linux for x86-64 and ARM64 it cannot open a connection or start a program. What it returns are texts and
numbers. A container or a user namespace would hide the files of this machine, too, but many machines allow neither.
"""

import ctypes
import json
import multiprocessing
import os
import platform
import resource
import signal
import struct
import threading

from .molecule import BadInput

MEMORY = 4 << 30  # bytes of address space, with the libraries
CPU_SECONDS = 120
WAIT_SECONDS = 600  # with others on the same machine
MOST_ANSWER = 16 << 20  # bytes

# By machine: the kernel's number of the architecture, and of the calls that are refused: socket, execve, execveat,
# io_uring_setup (which could do the same).
_REFUSED = {"x86_64": (0xC000003E, (41, 59, 322, 425)), "aarch64": (0xC00000B7, (198, 221, 281, 425))}
_PR_SET_PDEATHSIG, _PR_SET_NO_NEW_PRIVS, _PR_SET_SECCOMP, _FILTER = 1, 38, 22, 2


def run(function, what):
    """function(), whose result JSON can hold, in a child process. what: the file, as messages name it. Errors: BadInput, also
    where the process crashes or comes to a limit."""
    fork = multiprocessing.get_context("fork")
    ours, its = fork.Pipe(duplex=False)
    child = fork.Process(target=_answer, args=(function, what, its))
    child.start()
    its.close()
    too_long = threading.Timer(WAIT_SECONDS, child.kill)
    too_long.start()
    try:
        answer = json.loads(ours.recv_bytes(MOST_ANSWER))
        child.kill()
    except (EOFError, OSError, ValueError):  # it crashed, or wrote what is no answer
        answer = None
    ours.close()
    child.join()
    too_long.cancel()
    if answer is None:
        raise BadInput(f"{what}: {_ended(child.exitcode)}: the file is damaged or too complicated: give it in another format, or "
                       "--smiles")
    if "refused" in answer:
        raise BadInput(answer["refused"])
    return answer["value"]


def _ended(code):
    if -code in (signal.SIGXCPU, signal.SIGKILL):
        return "reading it takes too long"
    return "its reader crashed" + (f" ({signal.Signals(-code).name})" if code < 0 else "")


def _answer(function, what, pipe):
    try:
        nowhere = os.open(os.devnull, os.O_RDWR)
        for standard in (0, 1, 2):
            os.dup2(nowhere, standard)
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        confine()
        try:
            answer = {"value": function()}
        except BadInput as why:
            answer = {"refused": str(why)}
        except MemoryError:
            answer = {"refused": f"{what}: reading it takes more than {MEMORY >> 30} GiB of memory"}
        except (Exception, RecursionError) as why:  # of a library: whatever it is, nothing was read
            answer = {"refused": f"{what}: not understood: {why}".split("\n", 1)[0]}
        pipe.send_bytes(json.dumps(answer).encode())
    finally:
        os._exit(0)


def confine():
    """From here on this process has the limits."""
    libc = ctypes.CDLL(None, use_errno=True)
    libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    for what, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, CPU_SECONDS), (resource.RLIMIT_FSIZE, 0),
                       (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(what)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        # A second more, or the signal would be SIGKILL, which does not say why.
        resource.setrlimit(what, (most, most + (what == resource.RLIMIT_CPU and most != hard)))
    _refuse_calls(libc)


def _refuse_calls(libc):
    """A seccomp filter: the calls fail with EPERM, on the machines that are known here."""
    if platform.machine() not in _REFUSED:
        return
    architecture, calls = _REFUSED[platform.machine()]
    load, equal, at_least, give = 0x20, 0x15, 0x35, 0x06
    count = len(calls)
    rows = [(load, 0, 0, 4), (equal, 0, count + 3, architecture), (load, 0, 0, 0),
            (at_least, count + 1, 0, 0x40000000)]  # x32 calls have other numbers
    rows += [(equal, count - n, 0, call) for n, call in enumerate(calls)]
    rows += [(give, 0, 0, 0x7FFF0000), (give, 0, 0, 0x00050001)]  # allow; EPERM
    code = b"".join(struct.pack("HBBI", *row) for row in rows)
    program = struct.pack("HxxxxxxP", len(rows), ctypes.addressof(keep := ctypes.create_string_buffer(code)))
    libc.prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
    libc.prctl(_PR_SET_SECCOMP, _FILTER, ctypes.create_string_buffer(program), 0, 0)
    del keep
