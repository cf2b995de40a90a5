"""A function in a process of its own, for files from strangers.

Libraries that read a dozen formats crash on some damaged files. The process has limits of memory, time and size of
files, and it cannot open a connection or start a program. What it returns are texts and numbers. A container or a user
namespace would hide the files of this machine, too, but many machines allow neither.
"""

import errno
import json
import multiprocessing
import os
import resource
import signal
import threading

import seccomp
from hapgrid_command.programs import end_with_parent

from .molecule import BadInput

MEMORY = 4 << 30  # bytes of address space, with the libraries
CPU_SECONDS = 120
WAIT_SECONDS = 600  # with others on the same machine
MOST_ANSWER = 16 << 20  # bytes


def run(function, what):
    """function(), whose result JSON can hold, in a child process. what: the file, as messages name it. Errors: BadInput, also
    where the process crashes or comes to a limit."""
    fork = multiprocessing.get_context("fork")
    ours, its = fork.Pipe(duplex=False)
    child = fork.Process(target=_answer, args=(function, what, its), daemon=True)
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
        why = "its reader crashed" + (f" ({signal.Signals(-child.exitcode).name})" if child.exitcode else "")
        if -child.exitcode in (signal.SIGXCPU, signal.SIGKILL):
            why = "reading it takes too long"
        raise BadInput(f"{what}: {why}: the file is damaged or too complicated: give it in another format, or --smiles")
    if "refused" in answer:
        raise BadInput(answer["refused"])
    return answer["value"]


def _answer(function, what, pipe):
    try:
        nowhere = os.open(os.devnull, os.O_RDWR)
        for standard in (0, 1, 2):
            os.dup2(nowhere, standard)
        end_with_parent()
        _confine()
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


def _confine():
    for what, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, CPU_SECONDS), (resource.RLIMIT_FSIZE, 0),
                       (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(what)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        # A second more, or the signal would be SIGKILL, which does not say why.
        resource.setrlimit(what, (most, most + (what == resource.RLIMIT_CPU and most != hard)))
    rules = seccomp.SyscallFilter(seccomp.ALLOW)
    for call in ("socket", "execve", "execveat", "io_uring_setup"):  # the last could do what the others do
        rules.add_rule(seccomp.ERRNO(errno.EPERM), call)
    rules.load()
