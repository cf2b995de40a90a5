"""Plays with an adapter that records (adapter.py): whoever of play, guard and adapter is killed, stopped or spins, and
whatever is scarce, the last thing that the device hears is zero force, and nobody is left."""
import os
import resource
import signal
import subprocess
import sys
import time

from process import ADAPTER, BUSY, Play, at_once, numbers, plugins, running


def parent(pid):
    return int(next(line.split()[1] for line in open(f"/proc/{pid}/status") if line.startswith("PPid")))


def tell(pids, number):
    for pid in pids:
        try:
            os.kill(pid, number)
        except ProcessLookupError:
            pass  # it has ended


class Busy(Exception):
    """The machine stood still for 100 ms, so that play gave the adapter up, as it should."""


def last_word():
    """The table of examples/devices/README.md on an adapter that records: who x what, and the seconds until zero
    force. NEVER: only the device itself can take its force away. STAYS: the play goes on, and ends with zero."""
    NEVER, STAYS = "never", "stays"
    # By who: KILL, TERM, SEGV, STOP, a pause of 0.12 and 0.5 s.
    table = {
        "play":               (0.1, 0, 0.1, 0.1, 0.1, 0.1),
        "guard":              (0.02, STAYS, STAYS, STAYS, STAYS, STAYS),
        "adapter":            (0.05, 0, 0.05, 0.2, 0.12, 0.2),
        "play guard":         (0.1, 0, 0.1, 0.1, 0.1, 0.1),
        "play adapter":       (0.05, 0, 0.05, 0.2, 0.12, 0.2),
        "guard adapter":      (0.05, 0, 0.05, 0.25, 0.12, 0.25),
        "play guard adapter": (NEVER, 0, 0.05, NEVER, 0.12, 0.5),
    }
    whats = [signal.SIGKILL, signal.SIGTERM, signal.SIGSEGV, signal.SIGSTOP, 0.12, 0.5]

    def case(who, what, cores, limit):
        play = Play("good", options=["--set", "safety.ramp=20"], wrapper=["taskset", "-c", "0"] if cores == 1 else [])
        try:
            play.await_force()
        except AssertionError as error:
            if "did not answer within 100 ms" in str(error):
                raise Busy from error
            raise
        (_, adapter), = play.events("pid")
        pids = {"play": play.process.pid, "guard": parent(adapter), "adapter": int(adapter)}
        begin = time.monotonic()
        victims = [pids[name] for name in who.split()]
        tell(victims, signal.SIGSTOP if isinstance(what, float) else what)
        if isinstance(what, float):
            time.sleep(what)
            tell(victims, signal.SIGCONT)

        def let_go():
            return [t for t, x, *_ in play.events("force") if t > begin and float(x) == 0] + [
                t for kind in ("let-go", "release") for t, *_ in play.events(kind)]

        cell = f"{who} {what}, {cores} cores"
        if limit == STAYS:
            time.sleep(0.4)
            if play.process.poll() is not None and "did not answer within 100 ms" in play.process.communicate()[1]:
                raise Busy
            assert not let_go() and play.process.poll() is None, (cell, let_go())
            begin, limit = time.monotonic(), 0
            play.process.send_signal(signal.SIGINT)
        elif limit == NEVER:
            time.sleep(0.5)
            assert not let_go(), (cell, let_go())
        if limit != NEVER:
            play.wait("for zero force", let_go)
            took = min(let_go()) - begin
            assert took < limit + BUSY, (cell, took, limit)
        # Nobody is left, once who still stands is told to go on.
        tell(pids.values(), signal.SIGCONT)
        play.process.send_signal(signal.SIGINT)
        play.process.communicate(timeout=30)
        play.wait("for the end of all", lambda: not [p for p in pids.values() if running(p)])
        last = max(let_go(), default=0)
        assert not [t for t, x, *_ in play.events("force") if t > last and float(x) != 0] or limit == NEVER, cell
        return f"{cell}: {limit if limit == NEVER else f'{1000 * took:.0f} ms'}"

    cells = [(who, what, 2, limit) for who, row in table.items() for what, limit in zip(whats, row)]
    spins = signal.SIGUSR1
    cells += [("adapter", spins, 2, 0.2), ("adapter", spins, 1, 0.2)]
    cells += [(who, what, 1, table[who][i]) for who in ("play", "adapter", "play guard") for i, what in enumerate(whats)
              if what in (signal.SIGKILL, signal.SIGSTOP)]

    def patient_case(*cell):
        for attempt in 1, 2, 3, 4, 5:
            try:
                return case(*cell)
            except Busy:
                print(f"attempt {attempt} of 5: the machine stood still")
        raise Busy(cell)

    at_once(patient_case, cells)


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
            [*command, f"process:/usr/bin/python3 {ADAPTER} {record} good", "--model-path", plugins, "--force", "state",
             "--set", "safety.ramp=20", "--duration", "0.2"], env=dict(os.environ, **dict([tag.split("=")])),
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
