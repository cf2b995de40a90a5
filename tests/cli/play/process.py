"""Plays with adapters that lie, stall, die, or are not there (adapter.py): how play ends, what the hand feels last
and how soon, and that no process is left."""
import itertools
import json
import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import system_calls
from patience import Busy, patiently, ramp

ADAPTER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "adapter.py")
SESSION = os.environ["HAPGRID_SOURCE"] + "/tests/cli/stats/session.py"
# Seconds from the fault until nothing pushes the hand: play's patience, and what a busy machine may add.
SILENCE, BUSY = 0.1, 1.0
numbers = itertools.count()


def at_once(case, arguments):
    """Most of a case is waiting."""
    with ThreadPoolExecutor(3) as pool:
        for line in pool.map(lambda argument: case(*argument), arguments):
            print(line)


def running(pid):
    """Not a process that only waits to be buried by whoever inherited it."""
    try:
        return open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


class Play:
    def __init__(self, mode, *words, options=(), grid="stuck.0", command=None, wrapper=(), ramp_ms=50):
        self.mode, self.record = mode, f"record.{next(numbers)}"
        command = command or f"/usr/bin/python3 {ADAPTER} {self.record} {mode} {' '.join(words)}"
        settings, self.first_line = ramp(ramp_ms)
        self.process = subprocess.Popen(
            [*wrapper, "play", grid, "--device", f"process:{command}", "--traversal", "paper",
             *settings, *options], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def events(self, kind):
        """Those of the record: (time, words...). The adapter may be in the middle of its last line."""
        text = open(self.record).read() if os.path.exists(self.record) else ""
        lines = [line.split() for line in text.splitlines(keepends=True) if line.endswith("\n")]
        return [(float(time), *words) for time, what, *words in lines if what == kind]

    def alive(self):
        """Of all processes that the adapter noted."""
        return [pid for _, pid in self.events("pid") if running(pid)]

    def wait(self, what, until):
        deadline = time.monotonic() + 60
        while not until():
            assert time.monotonic() < deadline, (self.mode, "waited in vain", what)
            time.sleep(0.002)

    def await_force(self):
        self.wait("for the force", lambda: self.process.poll() is not None or
                  any(x == "0.5" for _, x, _ in self.events("force")))
        assert self.process.poll() is None, self.process.communicate()[1]

    def end(self, code, line, one_line=False):
        """The exit code, the last line on standard error, and no process: not a moment later."""
        error = self.process.communicate(timeout=30)[1].removeprefix(self.first_line)
        assert self.process.returncode == code, (self.mode, self.process.returncode, error)
        lines = error.splitlines()
        assert re.fullmatch(line, lines[-1]), (self.mode, error)
        assert not one_line or len(lines) == 1, (self.mode, error)
        if code >= 0:
            assert not self.alive(), (self.mode, "left alive", self.alive())
        return error

    def ended(self):
        """The adapter took the last message."""
        return self.events("force")[-1][2] == "1"

    def ended_with_zero(self):
        """The last message says so, or the adapter on SIGTERM, or its --release.
        @return seconds from the fault until the first zero behind the last force"""
        assert self.ended() or self.events("let-go") or self.events("release"), (self.mode, self.events("force")[-3:])
        zeros = [t for t, x, _ in self.events("force") if float(x) == 0] + [
            t for kind in ("let-go", "release") for t, *_ in self.events(kind)]
        last = max([t for t, x, _ in self.events("force") if float(x) != 0], default=0)
        return min(t for t in zeros if t > last) - self.events("fault")[0][0]


RELEASED, NO_RELEASE = "; then --release sent zero force", "; it has no --release: the device may hold its last force"
NAME = r"process '.*adapter\.py \S+ \S+.*'"
with open(os.path.splitext(os.path.abspath(__file__))[0] + ".tsv", encoding="utf-8") as rows:
    TABLE = [row.rstrip("\n").replace("$RELEASED", RELEASED).replace("$NO_RELEASE", NO_RELEASE).split("\t") for row in rows if row[0] != "#"]


def before_the_loop():
    """One line, and nothing else."""
    def case(mode, why, *words):
        Play(mode, *words).end(1, f"play: {NAME}: {why}", one_line=True)
        return f"{mode}: refused"

    at_once(case, [(mode.split()[0], why, *mode.split()[1:]) for mode, told, why in TABLE if told == "greeting"])
    Play("absent", command="/no/such/adapter").end(
        1, "play: process '/no/such/adapter': cannot be started: No such file or directory", one_line=True)
    Play("fast", options=["--rate", "2000"]).end(
        1, "play: --rate: puppet takes at most 1000 forces a second", one_line=True)
    play = Play("mute")
    play.wait("for the adapter", lambda: play.events("pid"))
    time.sleep(0.1)
    play.process.send_signal(signal.SIGINT)
    play.process.communicate(timeout=10)
    assert play.process.returncode == 130 and not play.alive(), (play.process.returncode, play.alive())
    print("before the loop: done")


def in_the_loop():
    """Who is still there is told to let go, and the others are killed."""
    def goes_on(play):
        """A machine that stood still with play hides a pause from it that is little longer than it waits."""
        fault = play.events("fault")[0][0]
        play.wait("for what comes of the fault", lambda: play.process.poll() is not None or not play.alive() or
                  play.events("force")[-1][0] > fault + 1)
        return play.process.poll() is None and bool(play.alive())

    def faulty(mode):
        play = Play(mode)
        play.wait("for its fault", lambda: play.events("fault") or play.process.poll() is not None)
        if play.events("fault") and not (mode == "late" and goes_on(play)):
            return play
        play.process.kill()
        raise Busy(play.process.communicate()[1])  # before its fault

    def case(mode, told, why):
        play = patiently(faulty, mode)
        play.wait("for the end of all", lambda: play.process.poll() is not None or not play.alive())
        error = play.end(1, f"play: device: {NAME}: {why}")
        assert (mode == "unable") == ("play: puppet: its adapter has no --release: " in error), error
        assert any(x == "0.5" for _, x, _ in play.events("force")), (mode, "there was no force")
        assert told == play.ended(), (mode, play.events("force")[-3:])
        took = play.ended_with_zero() if mode != "unable" else play.events("let-go")[0][0] - play.events("fault")[0][0]
        # A family is first made, which takes a busy machine a while.
        assert took < 2 * SILENCE + BUSY or mode == "family", (mode, took)
        assert mode != "family" or len(play.events("pid")) == 3, play.events("pid")
        return f"{mode}: let go after {took * 1000:.1f} ms"

    at_once(case, [(mode, told == "told", why) for mode, told, why in TABLE if told != "greeting"])


def at_the_end():
    def recorded():
        play = Play("good", options=["--duration", "0.3", "--log", "log.session"])
        play.end(0, "play: lateness .*")
        assert play.events("force")[-1][1:] == ("0.0", "1"), play.events("force")[-1]
        assert sum(x == "0.5" for _, x, _ in play.events("force")) > 50
        # The same forces again, without the adapter.
        subprocess.run(["play", "stuck.0", "--device", "replay:log.session", "--log", "again.session"], check=True, stderr=subprocess.DEVNULL)
        texts = [subprocess.run([sys.executable, SESSION, "text", name], check=True, capture_output=True,
                                text=True).stdout for name in ("log.session", "again.session")]
        columns = texts[0].splitlines()[0].split("\t")
        kept = [i for i, name in enumerate(columns) if not name.startswith(("late", "compute"))]
        rows = [[[line.split("\t")[i] for i in kept] for line in text.splitlines()] for text in texts]
        assert rows[0] == rows[1] and len(rows[0]) > 200, (columns, len(rows[0]))
        return "recorded: played again"

    def clutch():
        play = Play("clutch", options=["--duration", "0.6"])
        play.end(0, "play: lateness .*")
        fault = play.events("fault")[0][0]
        after = [float(x) for t, x, _ in play.events("force") if t > fault + 0.02]
        assert 0 in after[:150] and 0.5 in after, after  # with the clutch, and when it is released
        return "clutch: done"

    def silent():
        """A device that steers, and says while it is pushed that it is silent."""
        play = Play("silent", "50", options=["--duration", "0.6", "--log", "silent.session"])
        play.end(0, "play: lateness .*")
        text = subprocess.run([sys.executable, SESSION, "text", "silent.session"], check=True, capture_output=True, text=True)
        x = [line.split("\t")[1] for line in text.stdout.splitlines() if line[0] != "#"]
        assert len(x) > 100 and len(set(x[:50])) > 20 and len(set(x[60:])) == 1, x
        return "silent: at rest"

    def slow():
        """Answers come 3.5 ms after their force, at 1 kHz."""
        play = Play("tardy", "0", options=["--duration", "2", "--report", "slow.json"])
        error = play.end(0, "play: lateness .*")
        assert re.search(r"^play: of 10 answers of the adapter, one came [3-9]\.?\d* ms after its force or later: the force "
                         r"acts late, set safety.delay = [3-9] in the file of --config$", error, re.M), error
        assert json.load(open("slow.json"))["answers"]["delay_ticks"] >= 3
        return "slow: told"

    def deaf():
        Play("deaf", options=["--duration", "0.2"]).end(1, f"play: device: did not take the last zero force: {NAME}: "
                                                        f"did not answer the last message within 100 ms{RELEASED}")
        return "deaf: killed"

    def lingers():
        Play("lingers", options=["--duration", "0.2"]).end(0, "play: lateness .*")
        return "lingers: killed"

    def escape():
        Play("escape", options=["--duration", "0.05"]).end(0, "play: lateness [^\x1b]*")
        return "escape: done"

    at_once(lambda case: case(), [[lingers], [silent], [slow], [deaf], [recorded], [clutch], [escape]])


def play_ends():
    """However play ends, the guard's word is the last, and the adapter's end follows."""
    def case(name, disturb, code, line, mode="good", grid="stuck.0"):
        play = Play(mode, grid=grid)
        if mode == "good":
            play.await_force()
        begin = time.monotonic()
        disturb(play)
        play.end(code, line)
        play.wait("for the adapter's end", lambda: not play.alive())
        came, x, end = play.events("force")[-1]
        assert (float(x), end) == (0, "1"), (name, play.events("force")[-3:])
        return f"{name}: zero force after {(came - begin) * 1000:.1f} ms"

    def stand_still(play):
        play.process.send_signal(signal.SIGSTOP)
        play.wait("for the guard", lambda: play.ended())
        assert play.events("silence")  # a good adapter lets go before
        play.process.send_signal(signal.SIGCONT)

    def orphaned():
        """What happens to the guard happens to play, which says the last word itself."""
        play = Play("good")
        play.await_force()
        (_, adapter), = play.events("pid")
        guard = next(line.split()[1] for line in open(f"/proc/{adapter}/status") if line.startswith("PPid"))
        os.kill(int(guard), signal.SIGKILL)
        play.end(1, f"play: device: {NAME}: its guard process is gone")
        assert play.ended(), play.events("force")[-3:]
        return "its guard killed: done"

    at_once(lambda what, *rest: what() if not rest else case(what, *rest), [
        [orphaned],
        ("hangs", lambda play: None, 1, "play: the haptic loop hangs, .*: zero force was sent", "move"),
        ("interrupted", lambda play: play.process.send_signal(signal.SIGINT), 130, "play: lateness .*"),
        ("hung up", lambda play: play.process.send_signal(signal.SIGHUP), 129, "play: lateness .*"),
        ("Ctrl-Z", lambda play: play.process.send_signal(signal.SIGTSTP), 148, "play: lateness .*"),
        ("killed", lambda play: play.process.kill(), -signal.SIGKILL, "play: puppet at .*"),
        ("crashed", lambda play: None, -signal.SIGABRT, "play: puppet at .*", "move", "stuck.1"),
        ("stopped", stand_still, 1,
         f"play: device: {NAME}: the program stood still, and its guard sent zero force")])


def real_time():
    """The adapter's priority is that of a device's threads; the loop only sends, receives and sleeps."""
    play = Play("good")
    play.await_force()
    (_, adapter), = play.events("pid")
    said = subprocess.run(["chrt", "-p", adapter], check=True, capture_output=True, text=True).stdout
    if subprocess.run(["chrt", "-f", "45", "true"], stderr=subprocess.DEVNULL).returncode == 0:
        assert re.search(r"priority: 45$", said, re.M) and "SCHED_FIFO" in said, said
    play.process.send_signal(signal.SIGINT)
    play.end(130, "play: lateness .*")
    if os.environ.get("HAPGRID_WRAPPER"):
        return
    trace = subprocess.run(
        ["strace", "-f", "-o", "trace", "play", "stuck.0", "--device",
         f"process:/usr/bin/python3 {ADAPTER} record.trace good", "--traversal", "paper",
         "--rate", "200", "--duration", "0.5", "--log", "trace.session"],
        env=dict(os.environ, ASAN_OPTIONS="detect_leaks=0"), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    assert trace.returncode == 0, trace.stderr
    calls = system_calls.check("trace", "recvfrom", "sendto")
    # An answer that is late is waited for by a second call; sixty beats of the guard's are sent in 0.6 s.
    assert calls["recvfrom"] <= 2 * calls["clock_nanosleep"] + 2, calls
    assert calls["sendto"] <= 2 * calls["clock_nanosleep"] + 2, calls
    print("real time: done")


if __name__ == "__main__":
    for part in sys.argv[1:]:
        globals()[part]()
