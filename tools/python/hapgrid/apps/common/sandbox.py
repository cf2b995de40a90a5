"""Where files from strangers are read: a function in a process of its own, or a program such as Open Babel, behind walls.

Parsers of a dozen formats crash on some damaged files, and somebody may make a file that does more than that. So such a process
has limits of memory, time and size of files, and two walls, which also hold for root:

Landlock   of the kernel's files it reads installed software alone, and writes none but in the one folder of a program
           that needs one
seccomp    of the kernel's calls it has those of the lists below alone. Among them is none for a connection, a new process, a
           signal to another process, or a name, mode or owner of a file.

Where the kernel lacks Landlock the lists remain, which then refuse to open any file for writing: the process can read
what its user can. A container or a user namespace would do as much, but many machines allow neither.
"""

from __future__ import annotations

import ctypes
import errno
import functools
import glob
import io
import json
import math
import multiprocessing
import os
import resource
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from typing import Any, NoReturn

import numpy as np

from hapgrid.files import FILTERS

from .files import Failed
from .programs import Ran, Watch, end_with_parent, run_program

MEMORY = 4 << 30  # bytes of address space, with the libraries
CPU_SECONDS = 120
WAIT_SECONDS = 600  # with others on the same machine
MOST_TEXT = 16 << 20  # bytes of the answer, beside its arrays
MOST_NUMBERS = 18 << 20  # of its arrays
MOST_FILE = 256 << 20  # bytes that a program can write to each file, its answer among them

# Calls of the kernel that change nothing outside of the process, whatever their arguments.
HARMLESS = """read readv pread64 write writev lseek close close_range dup dup2 dup3 fstat stat lstat newfstatat statx access faccessat
faccessat2 readlink readlinkat getcwd getdents64 fadvise64 poll ppoll select pselect6 mmap munmap mremap mprotect madvise brk
futex futex_waitv set_robust_list set_tid_address rseq membarrier arch_prctl rt_sigaction rt_sigprocmask rt_sigreturn sigaltstack
restart_syscall getrandom clock_gettime clock_getres clock_nanosleep nanosleep gettimeofday time times getrusage getpid gettid
getppid getuid geteuid getgid getegid getrlimit sched_yield sched_getaffinity getcpu uname sysinfo exit exit_group""".split()
_ALLOW, _REFUSE, _EQUAL, _MASKED = 0x7FFF0000, 0x00050000, 4, 7  # of seccomp.h
_CLONE_THREAD = 0x10000
_WRITES = os.O_ACCMODE | os.O_CREAT | os.O_TRUNC | os.O_APPEND | (os.O_TMPFILE & ~os.O_DIRECTORY)
# fcntl() could ask the kernel for signals to others.
_FCNTL = (0, 1, 2, 3, 1030)  # F_DUPFD, F_GETFD, F_SETFD, F_GETFL, F_DUPFD_CLOEXEC

# Of linux/landlock.h. The rights to change anything: those of each version of the kernel's interface, the first one being 1.
_EXECUTE, _WRITE, _READ, _LIST, _MAKE, _TRUNCATE = 1, 2, 4, 8, 1 << 8, 1 << 14
_RIGHTS = [(1 << 13) - 1, (1 << 14) - 1, (1 << 15) - 1, (1 << 15) - 1, (1 << 16) - 1]
_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF, _GET_VERSION, _PATH_BENEATH = 444, 445, 446, 1, 1
_PR_SET_DUMPABLE, _PR_SET_NO_NEW_PRIVS = 4, 38

_libc = ctypes.CDLL(None, use_errno=True)


class _Argument(ctypes.Structure):
    """What an argument of a call must be: scmp_arg_cmp."""
    _fields_ = [("index", ctypes.c_uint), ("how", ctypes.c_int), ("a", ctypes.c_uint64), ("b", ctypes.c_uint64)]


def run(function: Callable[[], Any], what: str, advice: str = "the file is damaged or too complicated") -> Any:
    """function(), whose result is JSON and numpy arrays of doubles, in a child process. what: the file, as messages name it.
    Errors: Failed, also where the process crashes or comes to a limit, when `advice` follows."""
    prepare = _walls(_software(), CPU_SECONDS, 0)
    fork = multiprocessing.get_context("fork")
    ours, its = fork.Pipe(duplex=False)
    child = fork.Process(target=_answer, args=(function, what, its, prepare), daemon=True)
    child.start()
    its.close()
    late = []

    def stop() -> None:
        late.append(True)
        child.kill()
    too_long = threading.Timer(WAIT_SECONDS, stop)
    too_long.start()
    try:
        answer, ended = _received(ours), False
    except EOFError:  # it crashed
        answer, ended = None, True
    except (OSError, ValueError, TypeError, OverflowError, RecursionError):  # it was taken over: what it wrote is no answer
        answer, ended = None, False
    if not ended:
        child.kill()
    ours.close()
    child.join()
    too_long.cancel()
    if answer is None:
        raise Failed(f"{what}: {_why(-(child.exitcode or 0) if ended else 0, bool(late))}: {advice}")
    kind, value = answer
    if kind == "refused":
        raise Failed(str(value)[:2000])
    return value


def _why(number: int, late: bool) -> str:
    """Why there is no answer. number: of the signal that ended the process."""
    if late or number == signal.SIGXCPU:
        return "reading it takes too long"
    if number == signal.SIGKILL:
        return "its reader was killed, perhaps for want of memory"
    return "its reader crashed" + (f" ({signal.Signals(number).name})" if number > 0 else "")


def _received(pipe: Connection) -> tuple[str, Any]:
    """("value" or "refused", what it is)"""
    left = MOST_NUMBERS

    def array(found: dict[str, Any]) -> Any:
        nonlocal left
        if set(found) != {"array"}:
            return found
        shape = [int(n) for n in found["array"]]
        left -= math.prod(shape)
        if min(shape, default=0) < 0 or left < 0:
            raise ValueError(shape)
        return np.frombuffer(pipe.recv_bytes(8 * math.prod(shape) or 1)).reshape(shape).copy()
    answer = json.loads(pipe.recv_bytes(MOST_TEXT), object_hook=array)
    (kind, value), = answer.items() if isinstance(answer, dict) else [("", None)]
    if kind not in ("value", "refused"):
        raise ValueError(kind)
    return kind, value


def _answer(function: Callable[[], Any], what: str, pipe: Connection, prepare: Callable[[], None]) -> NoReturn:
    try:
        nowhere = os.open(os.devnull, os.O_RDWR)
        for standard in (0, 1, 2):
            os.dup2(nowhere, standard)
        prepare()
        os.closerange(3, pipe.fileno())  # among them may be the terminal, and the folder with its lock
        os.closerange(pipe.fileno() + 1, os.sysconf("SC_OPEN_MAX"))
        arrays = []

        def array(value: Any) -> dict[str, Any]:
            arrays.append(np.asarray(value, float).tobytes())
            return {"array": value.shape}
        try:
            answer = {"value": function()}
        except Failed as why:
            answer = {"refused": str(why)}
        except MemoryError:
            answer = {"refused": f"{what}: reading it takes more than {MEMORY >> 30} GiB of memory"}
        except (Exception, RecursionError) as why:  # of a library: whatever it is, nothing was read
            answer = {"refused": f"{what}: not understood: {why}".split("\n", 1)[0]}
        pipe.send_bytes(json.dumps(answer, default=array).encode())
        for one in arrays:
            pipe.send_bytes(one)
    finally:
        os._exit(0)


def program(words: list[str], what: str, package: str, given: bytes = b"", folder: str | None = None,
            cpu_seconds: int = CPU_SECONDS, watch: Watch | None = None) -> Ran:
    """The Ran of a program of a Debian package. given: its standard input; folder: where it runs and can make files, if any;
    watch: of run_program(). Errors: Failed, where it is not there, and where it comes to a limit."""
    path = shutil.which(words[0])
    if path is None:
        raise Failed(f"{words[0]} is not there: install the Debian package {package}")
    path = os.path.realpath(path)
    prefix = os.path.dirname(os.path.dirname(path))
    rules = {one: _READ | _LIST for one in ("/usr", "/lib", "/lib64", "/etc/ld.so.cache", f"{prefix}/lib", f"{prefix}/share")}
    rules.update((os.path.realpath(one), _READ | _EXECUTE) for one in (path, *glob.glob("/lib*/ld-*.so*")))
    if folder is not None:
        rules[folder] = _READ | _LIST | _WRITE | _MAKE | _TRUNCATE
    prepare = _walls(rules, cpu_seconds, MOST_FILE, folder is not None, ("execve",))

    def watched(seconds: float) -> None:
        if seconds > 5 * cpu_seconds:
            raise Failed(f"{what}: {_why(0, True)}")
        if watch:
            watch(seconds)
    with tempfile.TemporaryFile() as stdin, tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as said:
        stdin.write(given)
        stdin.seek(0)
        code = run_program(words, folder or "/", watched, executable=path, stdin=stdin, stdout=out, stderr=said, preexec_fn=prepare).code
        texts = [os.pread(file.fileno(), MOST_FILE, 0).decode("utf-8", "replace") for file in (out, said)]
    if -code in (signal.SIGXCPU, signal.SIGKILL):
        raise Failed(f"{what}: {_why(-code, False)}")
    return Ran(texts[0], code, (texts[1].strip().splitlines() or [""])[-1])


def _software() -> dict[str, int]:
    """{path: rights}: this Python, its modules, and the libraries that it loads."""
    paths = ["/usr", "/lib", "/lib64", "/etc/ld.so.cache", sys.prefix, sys.base_prefix, *sys.path]
    return {os.path.realpath(path): _READ | _LIST for path in paths if path}


def _walls(rules: dict[str, int], cpu_seconds: int, most_file: int, writes: bool = False,
           more: Sequence[str] = ()) -> Callable[[], None]:
    """A function that puts the process that calls it behind the walls, for ever. What can fail here fails at once.
    rules: {path: rights of Landlock}; writes: whether it opens files for writing, in folders that the rules name;
    more: calls of the kernel that it has besides."""
    library = _seccomp()
    ruleset = _ruleset(rules)

    def put() -> None:
        end_with_parent()
        for limit, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, cpu_seconds), (resource.RLIMIT_FSIZE, most_file),
                            (resource.RLIMIT_CORE, 0)):
            hard = resource.getrlimit(limit)[1]
            most = most if hard == resource.RLIM_INFINITY else min(most, hard)
            # A second more, or the signal would be SIGKILL, which does not say why.
            resource.setrlimit(limit, (most, most + (limit == resource.RLIMIT_CPU and most != hard)))
        _done(_libc.prctl(_PR_SET_DUMPABLE, 0, 0, 0, 0))
        _done(_libc.prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0))
        if ruleset is not None:
            _done(_libc.syscall(_RESTRICT_SELF, ruleset.fileno(), 0))
        _allow_alone(library, writes, more)
    return put


def _done(result: int) -> None:
    if result < 0:
        raise OSError(ctypes.get_errno(), "the walls for a file from outside cannot be put up")


def landlock() -> int:
    """The version of the kernel's interface; 0 where there is none."""
    return max(_libc.syscall(_CREATE_RULESET, None, ctypes.c_size_t(0), _GET_VERSION), 0)


def _ruleset(rules: dict[str, int]) -> io.FileIO | None:
    """The file of rules that allow nothing else; None without Landlock."""
    version = landlock()
    if version == 0:
        return None
    rights = _RIGHTS[min(version, len(_RIGHTS)) - 1]
    # Then network (both calls of TCP), then signals and abstract sockets outside of the walls.
    handled = (ctypes.c_uint64 * 3)(rights, 3 if version >= 4 else 0, 3 if version >= 6 else 0)
    ruleset = _libc.syscall(_CREATE_RULESET, handled, ctypes.c_size_t(ctypes.sizeof(handled)), 0)
    _done(ruleset)
    ruleset = io.FileIO(ruleset)  # is closed with the last who knows it
    for path, allowed in rules.items():
        try:
            file = os.open(path, os.O_PATH | os.O_CLOEXEC)
        except OSError:
            continue  # not on this machine
        try:
            if not os.path.isdir(path):
                allowed &= _READ | _EXECUTE
            rule = (allowed & rights).to_bytes(8, sys.byteorder) + file.to_bytes(4, sys.byteorder)
            _done(_libc.syscall(_ADD_RULE, ruleset.fileno(), _PATH_BENEATH, rule, 0))
        finally:
            os.close(file)
    return ruleset


@functools.cache
def _seccomp() -> ctypes.CDLL:
    try:
        own = os.path.join(FILTERS, "../libs/libseccomp.so.2")  # of a wheel
        library = ctypes.CDLL(own if os.path.exists(own) else "libseccomp.so.2")
    except OSError:
        raise Failed("libseccomp.so.2 is not there: install the Debian package libseccomp2") from None
    library.seccomp_init.restype = ctypes.c_void_p
    library.seccomp_rule_add_array.argtypes = [ctypes.c_void_p, ctypes.c_uint32, ctypes.c_int, ctypes.c_uint, ctypes.c_void_p]
    library.seccomp_load.argtypes = [ctypes.c_void_p]
    return library


def _allow_alone(library: ctypes.CDLL, writes: bool, more: Sequence[str]) -> None:
    """Other calls fail with EPERM from here on."""
    rules = ctypes.c_void_p(library.seccomp_init(_REFUSE | errno.EPERM))

    def add(name: str, *arguments: _Argument, action: int = _ALLOW) -> None:
        call = library.seccomp_syscall_resolve_name(name.encode())
        if call == -1:  # this library is older than the call
            return
        wanted = (_Argument * max(len(arguments), 1))(*arguments)
        if library.seccomp_rule_add_array(rules, action, call, len(arguments), ctypes.byref(wanted)) < 0:
            raise OSError(errno.EINVAL, f"seccomp: no rule for {name}")
    for name in (*HARMLESS, *more):
        add(name)
    for name, index in (("open", 1), ("openat", 2)):
        add(name, *([] if writes else [_Argument(index, _MASKED, _WRITES, 0)]))
    for command in _FCNTL:
        add("fcntl", _Argument(1, _EQUAL, command, 0))
    add("prlimit64", _Argument(0, _EQUAL, 0, 0))  # its own
    add("tgkill", _Argument(0, _EQUAL, os.getpid(), 0))  # abort()
    add("clone", _Argument(0, _MASKED, _CLONE_THREAD, _CLONE_THREAD))
    add("clone3", action=_REFUSE | errno.ENOSYS)  # its flags are in memory: clone is called then
    if library.seccomp_load(rules) < 0:
        raise OSError(errno.EINVAL, "seccomp: the rules are not taken")
