"""Plays with an adapter that records (adapter.py): whoever of play, guard and adapter is killed, stopped or spins, and
whatever is scarce, the last thing that the device hears is zero force, and nobody is left."""
import ctypes
import os
import platform
import resource
import signal
import subprocess
import sys
import time

from patience import Busy, patiently, ramp, whole
from process import ADAPTER, BUSY, Play, at_once, numbers, running


def parent(pid):
    return int(next(line.split()[1] for line in open(f"/proc/{pid}/status") if line.startswith("PPid")))


def tell(pids, number):
    for pid in pids:
        try:
            os.kill(pid, number)
        except ProcessLookupError:
            pass  # it has ended


REGISTERS = ctypes.c_ulong * 27  # struct user_regs_struct of x86-64
ORIG_RAX, RIP = 15, 16
SEIZE, INTERRUPT, DETACH, GETREGS, SETREGS = 0x4206, 0x4207, 17, 12, 13
WALL = 0x40000000
libc = ctypes.CDLL(None, use_errno=True)
libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]


def endless_loop(pid):
    """The address of a `jmp .` in the process: in the rest of the last page of its program's code, which is unused."""
    for line in open(f"/proc/{pid}/maps"):
        area, rights, *_ = line.split()
        if rights[2] == "x":
            place = int(area.split("-")[1], 16) - 2
            with open(f"/proc/{pid}/mem", "r+b", buffering=0) as memory:
                memory.seek(place)
                memory.write(b"\xeb\xfe")
            return place


def make_go_on(thread, change):
    """Stops a thread, and lets it go on with the registers that change() makes of its own. @return its own"""
    def trace(request, data=None):
        if libc.ptrace(request, thread, None, data) != 0:
            raise ProcessLookupError(thread)  # it has ended
    trace(SEIZE)
    trace(INTERRUPT)
    os.waitpid(thread, WALL)
    own = REGISTERS()
    trace(GETREGS, ctypes.byref(own))
    trace(SETREGS, ctypes.byref(change(own)))
    trace(DETACH)
    return own


def make_spin(pid, thread):
    """@return the registers with which the thread would have gone on"""
    place = endless_loop(pid)

    def in_the_loop(own):
        registers = REGISTERS(*own)
        registers[RIP] = place
        registers[ORIG_RAX] = 2**64 - 1  # or the kernel would begin a system call again
        return registers
    return make_go_on(thread, in_the_loop)


def spin(pids):
    """From now on each thread computes for ever."""
    for pid in pids.values():
        try:
            for thread in os.listdir(f"/proc/{pid}/task"):
                make_spin(pid, int(thread))
        except (FileNotFoundError, ProcessLookupError):
            pass  # it has ended


def compute(pids):
    """An adapter that computes for 0.13 s and goes on."""
    adapter = pids["adapter"]
    own = make_spin(adapter, adapter)
    time.sleep(0.13)
    try:
        make_go_on(adapter, lambda _: own)
    except ProcessLookupError:
        pass  # it has ended, as it must not


NEVER, STAYS = "never", "stays"
REAL_TIME = subprocess.run(["chrt", "-f", "46", "true"], stderr=subprocess.DEVNULL).returncode == 0
# The table of examples/devices/README.md: by who, the seconds until zero force after KILL, TERM, SEGV, STOP, a pause of
# 0.12 and 0.5 s, and spinning. NEVER: only the device itself can take its force away. STAYS: the play goes on.
WHATS = [signal.SIGKILL, signal.SIGTERM, signal.SIGSEGV, signal.SIGSTOP, 0.12, 0.5, spin]
TABLE = {
    "play":               (0.1, 0, 0.1, 0.1, 0.1, 0.1, 0.1),
    "guard":              (0.02, STAYS, STAYS, STAYS, STAYS, STAYS, 0.1),
    "adapter":            (0.05, 0, 0.05, 0.2, 0.12, 0.2, 0.35),
    "play guard":         (0.1, 0, 0.1, 0.1, 0.1, 0.1, 0.15),
    "play adapter":       (0.05, 0, 0.05, 0.2, 0.12, 0.2, 0.35),
    "guard adapter":      (0.05, 0, 0.05, 0.25, 0.12, 0.25, 0.5),
    "play guard adapter": (NEVER, 0, 0.05, NEVER, 0.12, 0.5, NEVER),
}
# The thread sanitizer tells a program of a signal when it next calls the system, which one that spins does not do.
CAN_SPIN = platform.machine() == "x86_64" and "SANITIZE:STRING=thread" not in open(f"{os.environ['HAPGRID_BUILD']}/CMakeCache.txt").read()
if not REAL_TIME:  # the kernel ends nobody who spins; a processor is shared
    TABLE = {who: (*row[:6], STAYS if who == "guard" else NEVER if row[6] == NEVER else 0.5) for who, row in TABLE.items()}


# Adapters that compute, that a script has started, or that went to the background: with --release ("good") and without. No
# cell of these is NEVER: each of them can let go.
KINDS = {
    "": {("adapter", compute): 0.15},
    "script-": {("play", signal.SIGKILL): 0.1, ("play", signal.SIGTERM): 0, ("guard", signal.SIGKILL): 0.02,
                ("adapter", signal.SIGSTOP): 0.2, ("adapter", 0.25): 0.2, ("guard adapter", 0.25): 0.25},
    "daemon-": {("play", signal.SIGKILL): 0.1, ("play", signal.SIGTERM): 0, ("guard", signal.SIGKILL): 0.02,
                ("adapter", signal.SIGSTOP): 0.2, ("adapter", 0.25): 0.2},
}


def started(cores, mode="good", options=()):
    """A play that pushes, and the process ids of the three."""
    words = f"record.{next(numbers)} {mode} 1000000000"
    if mode.startswith("script-"):
        whole("start.sh", f'/usr/bin/python3 {ADAPTER} "$@"\nexit $?\n')
    command = f"sh start.sh {words}" if mode.startswith("script-") else f"/usr/bin/python3 {ADAPTER} {words}"
    play = Play(mode, command=command, options=options, ramp_ms=20,
                wrapper=["taskset", "-c", "0"] if cores == 1 else [])
    play.record = words.split()[0]
    try:
        play.await_force()
    except AssertionError as error:
        if "did not answer within 100 ms" in str(error):
            raise Busy from error
        raise
    (_, adapter), = play.events("pid")
    try:
        guard = parent(adapter)
        while open(f"/proc/{guard}/comm").read() != "hapgrid-guard\n":
            guard = parent(guard)
        return play, {"play": play.process.pid, "guard": guard, "adapter": int(adapter)}
    except FileNotFoundError as error:  # play has given it up
        raise Busy from error


def disturb(victims, what):
    """@param victims process ids by name"""
    pids = victims.values()
    if callable(what):
        what(victims)
    elif isinstance(what, float):
        tell(pids, signal.SIGSTOP)
        time.sleep(what)
        tell(pids, signal.SIGCONT)
    else:
        tell(pids, what)


def goes_on(play, cell, begin):
    """Nobody has let go. A machine that stands still for 10 ms takes the force away until play has caught up."""
    def is_there():
        return play.process.poll() is not None or any(
            t > begin + 0.6 and float(x) != 0 for t, x, _ in play.events("force"))

    play.wait("for a force", is_there)
    if play.process.poll() is not None:
        error = play.process.communicate()[1]
        if "did not answer within 100 ms" in error:
            raise Busy
        raise AssertionError((cell, error))
    assert not play.events("let-go") and not play.events("release"), cell


def case(who, what, cores, limit, mode="good"):
    cell = f"{who} {getattr(what, '__name__', what)}, {cores} cores, {mode}"
    play, pids = started(cores, mode)

    def let_go():
        return [t for t, x, *_ in play.events("force") if t > begin and float(x) == 0] + [
            t for kind in ("let-go", "release") for t, *_ in play.events(kind)]

    begin, took = time.monotonic(), None
    try:
        disturb({name: pids[name] for name in who.split()}, what)
        if limit == STAYS:
            goes_on(play, cell, begin)
            begin = time.monotonic()
            play.process.send_signal(signal.SIGINT)
        if limit == NEVER:
            time.sleep(0.5)  # no zero is promised, but one may come: of the three, one is disturbed first
        else:
            play.wait("for zero force", let_go)
            took = min(let_go()) - begin
    finally:
        # Nobody is left, once who still stands is told to go on. Who spins is ended by the kernel.
        for name, pid in pids.items():
            tell([pid], signal.SIGKILL if what is spin and name in who.split() and not REAL_TIME else signal.SIGCONT)
        play.process.send_signal(signal.SIGINT)
    try:
        play.process.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        tell(pids.values(), signal.SIGKILL)
        play.process.communicate(timeout=60)
        raise
    play.wait("for the end of all", lambda: not [p for p in pids.values() if running(p)])
    if not let_go() and limit == NEVER:
        return f"{cell}: never"
    last = max(let_go())
    assert not [t for t, x, *_ in play.events("force") if t > last and float(x) != 0], cell
    if limit == NEVER:
        return f"{cell}: a zero, by luck"
    if took >= (0 if limit == STAYS else limit) + BUSY:
        raise Busy
    return f"{cell}: {'stays' if limit == STAYS else f'{1000 * took:.0f} ms'}"


def table_on(cores):
    cells = [(who, what, cores, limit) for who, row in TABLE.items() for what, limit in zip(WHATS, row)]
    cells += [(*cell, cores, limit, kind + mode) for kind, row in KINDS.items() for cell, limit in row.items()
              for mode in ("good", "plain")]
    at_once(patiently, [(case, *cell) for cell in cells if not callable(cell[1])])
    # Who spins at a real-time priority disturbs all others, but not who watches.
    if REAL_TIME:
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(48))
    for cell in cells:
        if callable(cell[1]) and CAN_SPIN:
            print(patiently(case, *cell))


def two_cores():
    table_on(2)


def one_core():
    table_on(1)


def processor():
    """At a real-time priority, the loop and an adapter that can share a processor have one, and the guard has the others;
    else, and for all other threads, nothing changes."""
    allowed = os.sched_getaffinity(0)

    def case(mode, realtime):
        play, pids = started(2, mode, ["--realtime", realtime])
        loop = pids["play"]
        try:
            got = [os.sched_getaffinity(pids[who]) for who in ("play", "adapter", "guard")]
            others = [os.sched_getaffinity(int(thread)) for thread in os.listdir(f"/proc/{loop}/task") if int(thread) != loop]
        except (FileNotFoundError, ProcessLookupError):
            got = others = []
        finally:
            play.process.send_signal(signal.SIGINT)
            play.process.communicate(timeout=60)
        if play.process.returncode != 130:  # it gave the adapter up
            raise Busy
        shares = mode == "good" and realtime == "try" and REAL_TIME and len(allowed) > 1
        assert len(got[0]) == 1 or not shares, (mode, got)
        assert got == ([got[0], got[0], allowed - got[0]] if shares else [allowed] * 3), (mode, realtime, got, allowed)
        assert others and all(one == allowed for one in others), (mode, realtime, others, allowed)
        return f"{mode}, real time {realtime}: loop, adapter and guard on {got}"

    at_once(patiently, [(case, "good", "try"), (case, "good", "off"), (case, "unable", "try")])


def left(tag):
    """Processes with this word in their environment."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            if tag in open(f"/proc/{pid}/environ", "rb").read() and running(pid):
                found.append((pid, open(f"/proc/{pid}/comm").read()))
        except OSError:
            pass
    return found


def scarce():
    """Few descriptors, little memory, a full process table: a play, or one line, and nobody is left."""
    def case(name, limit, value):
        tag = f"HAPGRID_SCARCE={name}.{value}.{os.getpid()}"
        user = ["setpriv", "--reuid", str(64000 + value), "--clear-groups"] if limit == resource.RLIMIT_NPROC else []
        record = f"record.{next(numbers)}"
        open(record, "w").close()
        os.chmod(record, 0o666)
        command = f"prlimit --{name}={value} {' '.join(user)} play stuck.0 --device".split()
        ended = subprocess.run(
            [*command, f"process:/usr/bin/python3 {ADAPTER} {record} good", "--traversal", "paper",
             *ramp(20)[0], "--duration", "0.2"], env=dict(os.environ, **dict([tag.split("=")])),
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=60)
        forces = [line.split()[2] for line in open(record) if " force " in line]
        assert not forces or float(forces[-1]) == 0, (name, value, forces[-3:])
        deadline = time.monotonic() + 10
        while left(tag.encode()):
            assert time.monotonic() < deadline, (name, value, left(tag.encode()), ended.stderr)
            time.sleep(0.05)
        ours = [line for line in ended.stderr.splitlines() if line.startswith("play: ")]
        assert ended.returncode in (0, 1, 127) or ended.returncode < 0, (name, value, ended.returncode, ended.stderr)
        assert ended.returncode != 1 or ours, (name, value, ended.stderr)
        return f"{name} {value}: exit {ended.returncode}: {ours[-1][:90] if ended.returncode else 'played'}"

    os.chmod(".", 0o777)
    os.chmod("..", 0o755)
    cells = [("nofile", resource.RLIMIT_NOFILE, value) for value in range(4, 15)]
    cells += [("as", resource.RLIMIT_AS, value << 20) for value in (8, 16, 24, 32, 48, 64, 96, 128)]
    if os.getuid() == 0:
        cells += [("nproc", resource.RLIMIT_NPROC, value) for value in range(1, 7)]
    at_once(case, cells)


for part in sys.argv[1:]:
    globals()[part]()
