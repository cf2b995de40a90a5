"""Tries ways out of each kind of process that reads files from strangers (hapgrid.apps.common.sandbox), with Landlock and
without. It works in the current folder, and prints a table."""

import ctypes
import inspect
import json
import os
import pty
import sys

from hapgrid.apps.common import sandbox
from hapgrid.apps.common.files import Failed

FILES = {"a new file", "an unnamed file", "mmap", "truncate on opening", "a terminal", "the parent's memory"}


def attack(parent, address, terminal, room, other):
    """{what was tried: "done", or why not}. room: a folder with files a, b, c, d; other: a program."""
    import ctypes
    import fcntl
    import mmap
    import os
    import resource
    import socket
    import stat
    libc, names = ctypes.CDLL(None, use_errno=True), ctypes.CDLL("libseccomp.so.2")

    def call(name, *arguments):
        if libc.syscall(names.seccomp_syscall_resolve_name(name.encode()), *arguments) < 0:
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))

    def into(path, flags=0):
        os.write(os.open(path, os.O_WRONLY | os.O_NOCTTY | flags), b"\x1b]0;taken\x07")

    def mapped():
        with mmap.mmap(os.open(f"{room}/a", os.O_RDWR), 0) as memory:
            memory[:5] = b"taken"

    def vector():
        data, pair = ctypes.create_string_buffer(b"taken"), ctypes.c_uint64 * 2
        call("process_vm_writev", parent, pair(ctypes.addressof(data), 6), 1, pair(address, 6), 1, 0)

    def inherited():
        for n in range(3, 256):
            try:
                terminal = stat.S_ISCHR(os.fstat(n).st_mode)
            except OSError:
                continue
            if terminal:
                return
        raise OSError("none")
    def remote():
        memory = os.open(f"/proc/{parent}/mem", os.O_RDWR)
        os.lseek(memory, address, 0)
        os.write(memory, b"taken")

    ways = {
        "an open terminal": inherited,
        "a new file": lambda: into(f"{room}/new", os.O_CREAT),
        "an unnamed file": lambda: os.open(room, os.O_TMPFILE | os.O_RDWR),
        "mmap": mapped,
        "truncate on opening": lambda: os.open(f"{room}/a", os.O_RDONLY | os.O_TRUNC),
        "a terminal": lambda: into(terminal),
        "the parent's memory": remote,
        "unlink": lambda: os.unlink(f"{room}/b"),
        "truncate": lambda: os.truncate(f"{room}/c", 0),
        "rename": lambda: os.rename(f"{room}/d", f"{room}/e"),
        "link": lambda: os.link(f"{room}/a", f"{room}/f"),
        "symlink": lambda: os.symlink("/etc/passwd", f"{room}/g"),
        "mkdir": lambda: os.mkdir(f"{room}/h"),
        "mkfifo": lambda: os.mkfifo(f"{room}/i"),
        "chmod": lambda: os.chmod(f"{room}/a", 0o777),
        "chown": lambda: os.chown(f"{room}/a", os.getuid(), os.getgid()),
        "times": lambda: os.utime(f"{room}/a", (0, 0)),
        "an attribute": lambda: os.setxattr(f"{room}/a", "user.x", b"x"),
        "process_vm_writev": vector,
        "ptrace": lambda: call("ptrace", 16, parent, 0, 0),
        "fork": lambda: os.fork() or os._exit(0),
        "exec": lambda: os.execv(other, ["true"]),
        "kill": lambda: os.kill(parent, 0),
        "tgkill": lambda: call("tgkill", parent, parent, 0),
        "pidfd": lambda: os.pidfd_open(parent),
        "signals of a descriptor": lambda: fcntl.fcntl(0, fcntl.F_SETOWN, parent),
        "the parent's limits": lambda: resource.prlimit(parent, resource.RLIMIT_CORE, (0, 0)),
        "the parent's priority": lambda: os.setpriority(os.PRIO_PROCESS, parent, 19),
        "socket": socket.socket,
        "socketpair": socket.socketpair,
        "io_uring": lambda: call("io_uring_setup", 1, ctypes.create_string_buffer(120)),
        "memfd": lambda: os.memfd_create("x"),
        "reading": lambda: open(f"{room}/a").close(),
    }
    found = {}
    for name, way in ways.items():
        try:
            way()
            found[name] = "done"
        except OSError as why:
            found[name] = why.strerror or str(why)
    return found


def tried(kind, landlock):
    """Fails where more gets through than must."""
    os.makedirs("room", exist_ok=True)
    for name in "abcd":
        open(f"room/{name}", "w").write("precious")
    secret = ctypes.create_string_buffer(b"precious", 16)
    ours, theirs = pty.openpty()
    given = [os.getpid(), ctypes.addressof(secret), os.ttyname(theirs), os.path.realpath("room"),
             "/bin/true" if landlock or kind == "function" else "/gone"]  # else it may start, behind its walls
    sandbox.landlock = VERSION if landlock else lambda: 0
    if kind == "function":
        found = sandbox.run(lambda: attack(*given), "file")
    else:
        text = f"{inspect.getsource(attack)}\nimport json\nprint(json.dumps(attack(*{given})))"
        os.makedirs("own", exist_ok=True)
        ran = sandbox.program(["/usr/bin/python3", "-I", "-"], "file", "python3", text.encode(), os.path.realpath("own") if kind == "folder" else None)
        assert ran.code == 0, ran
        found = json.loads(ran.out)
    through = {name for name, how in found.items() if how == "done"}
    may = set() if landlock else {"reading"} | (FILES if kind == "folder" else set())
    print(f"{kind:9} {'both walls' if landlock else 'seccomp':10} of {len(found)}: {', '.join(sorted(through)) or 'none'}")
    assert through <= may, (kind, landlock, through - may, found)
    if not through:
        assert secret.value == b"precious" and sorted(os.listdir("room")) == list("abcd"), os.listdir("room")
        assert all(open(f"room/{name}").read() == "precious" for name in "abcd")
        os.set_blocking(ours, False)
        try:
            raise AssertionError(os.read(ours, 99))
        except BlockingIOError:
            pass
    for end in (ours, theirs):
        os.close(end)


def own_folder():
    """A program that may write does so in its folder, and sees that of nobody else."""
    here = os.path.realpath("own")
    ran = sandbox.program(["/usr/bin/python3", "-I", "-"], "file", "python3", b"open('made', 'w').write('x' * 9)", here)
    assert ran.code == 0 and open("own/made").read() == 9 * "x", ran
    os.remove("own/made")


VERSION = sandbox.landlock
print(f"Landlock's version: {VERSION()}")
for kind in ("function", "program", "folder"):
    for landlock in (True, False) if VERSION() else (False,):
        tried(kind, landlock)
sandbox.landlock = VERSION
own_folder()
