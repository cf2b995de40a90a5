"""An adapter for play --device process:, which records what it hears and misbehaves on command.

    adapter.py RECORD MODE [AT] [--release]   MODE: a name below; AT: the force at which it begins (default 150)

With "daemon-" before MODE it goes to the background. Of "script-" last_word.py makes a script that starts it.

RECORD gets a line for each event, behind the time (CLOCK_MONOTONIC, s): "pid N", "force X END", "fault", "let-go" on
SIGTERM, "release"."""
import os
import select
import signal
import struct
import subprocess
import sys
import time

record = os.open(sys.argv[1], os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
kind, _, mode = sys.argv[2].rpartition("-")
at = int(sys.argv[3]) if sys.argv[3:4] not in ([], ["--release"]) else 150
END, RELEASES, SHARES = 1, 1, 4
forces = struct.Struct("<3d2I")


def note(*words):
    """A line as a whole: a signal may come between two parts of print()."""
    os.write(record, " ".join(map(str, (time.monotonic(), *words, "\n"))).encode())


def greeting(magic=b"hapgrid", version=3, flags=RELEASES | SHARES, low=(-0.08,) * 3, high=(0.08,) * 3, force=3.0, rate=1000.0,
             name=b"puppet"):
    return struct.pack("<8s2I3d3d2d48s", magic, version, flags, *low, *high, force, rate, name)


def state(number, t=None, x=-0.04, buttons=0):
    return struct.pack("<4d2I", time.monotonic() if t is None else t, x, 0, 0, buttons, number)


def forever():
    while True:
        time.sleep(100)


def flood(number):
    try:
        while True:
            os.write(1, state(number))
    except OSError:
        os._exit(0)


def leave_children(number):
    """A child that ignores what can be ignored, and a daemon."""
    script = "import os,signal,sys,time;[signal.signal(s,signal.SIG_IGN) for s in (1,2,15)];" \
             "print(time.monotonic(),'pid',os.getpid(),file=open(sys.argv[1],'a'));time.sleep(100)"
    subprocess.Popen([sys.executable, "-c", script, sys.argv[1]], start_new_session=True)
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            subprocess.Popen([sys.executable, "-c", script, sys.argv[1]])
        os._exit(0)
    deadline = time.monotonic() + 10
    while open(sys.argv[1]).read().count("pid") < 3 and time.monotonic() < deadline:
        if number != 0:
            os.write(1, state(number))  # play waits for no answer longer than it must
        number = forces.unpack(os.read(0, forces.size))[3]
    os._exit(3)


def fork_for_ever(number):
    """Children that leave their group, fork, and end at once."""
    began = time.monotonic()
    if os.fork() == 0:
        while time.monotonic() < began + 60:
            os.setsid()
            if os.fork() != 0:
                os._exit(0)
    os._exit(3)


first = {
    "version": lambda: greeting(version=1),
    "sorry": lambda: b"error: the device is \x1b[31mburning",
    "pointlike": lambda: greeting(low=(0,) * 3, high=(0,) * 3),
    "steers": lambda: greeting(flags=2, low=(-1,) * 3, high=(1, 1, 0.5)),
    "unable": lambda: greeting(flags=0),
    "plain": lambda: greeting(flags=SHARES),
    "silent": lambda: greeting(flags=2, low=(-1,) * 3, high=(1,) * 3),
    "other": lambda: b"x" * 128,
    "short": lambda: greeting()[:100],
    "long": lambda: greeting() * 2,
    "range": lambda: greeting(low=(float("nan"), 0, 0)),
    "turned": lambda: greeting(low=(0.1,) * 3, high=(-0.1,) * 3),
    "strong": lambda: greeting(force=float("inf")),
    "slow": lambda: greeting(rate=1.0),
    "escape": lambda: greeting(name=b"\x1b[31mred"),
}
later = {
    "nan": lambda n: os.write(1, state(n, x=float("nan"))),
    "infinite": lambda n: os.write(1, state(n, x=float("inf"))),
    "timeless": lambda n: os.write(1, state(n, t=float("nan"))),
    "far": lambda n: os.write(1, state(n, x=0.4)),
    "back": lambda n: os.write(1, state(n, t=1.0)),
    "number": lambda n: os.write(1, state(n - 1)),
    "burns": lambda n: (os.write(1, b"error: the motors burn"), sys.exit(1)),
    "late": lambda n: (time.sleep(0.15 if n == at else 0), os.write(1, state(n))),
    "tardy": lambda n: (time.sleep(0.0035), os.write(1, state(n))),
    "unable": lambda n: forever(),
    "forks": fork_for_ever,
    "garbage": lambda n: os.write(1, b"garbage"),
    "huge": lambda n: os.write(1, b"g" * 5000),
    "empty": lambda n: forever(),
    "stall": lambda n: forever(),
    "stopped": lambda n: os.kill(os.getpid(), signal.SIGSTOP),
    "dies": lambda n: os._exit(3),
    "killed": lambda n: os.kill(os.getpid(), signal.SIGKILL),
    "closes": lambda n: (os.close(0), os.close(1), forever()),
    "flood": flood,
    "family": leave_children,
    "move": lambda n: os.write(1, state(n, x=0.06)),
    "silent": lambda n: os.write(1, state(n, x=-0.5, buttons=4)),
    "clutch": lambda n: os.write(1, state(n, buttons=1 if n < at + 200 else 0)),
}

if sys.argv[-1] == "--release":
    note("release")
    sys.exit(0)
if kind == "daemon":
    if os.fork() != 0:
        os._exit(0)
    os.setsid()
note("pid", os.getpid())


def let_go(*_):
    if mode != "deaf":
        note("let-go")
        os._exit(0)


signal.signal(signal.SIGTERM, let_go)
if mode == "early":
    sys.exit(3)
if mode == "mute":
    forever()
os.write(1, first.get(mode, greeting)())
frozen = None
while True:
    if not select.select([0], [], [], 0.1)[0]:
        note("force", 0.0, 0)
        note("silence")
        continue
    try:
        message = os.read(0, forces.size)
    except ConnectionResetError:  # play is gone, and has not read the last state
        message = b""
    if not message:
        note("force", 0.0, 0)
        note("closed")
        break
    x, _, _, number, flags = forces.unpack(message)
    end = flags & END
    note("force", x, end)
    if end and mode == "deaf":
        note("fault")
        forever()
    if number == at:
        note("fault")
        frozen = time.monotonic() if mode == "frozen" else None
    if number >= at and mode in later and not end:
        later[mode](number)
    elif number != 0:
        os.write(1, state(number, t=frozen))
    if end:
        if mode == "lingers":
            forever()
        break
