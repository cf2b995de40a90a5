"""Moves a hand through the grid of the hung ball by way of the named pipe: the closed loop of a real play."""
import atexit
import os
import signal
import subprocess
import sys
import time

SPRING = 3 / (1.9 / 3)  # N a unit: 3 N take the HIP a third of the longest side away from the hand


def play(*more):
    """A play in real time whose pipe nobody writes yet."""
    process = subprocess.Popen(["play", "grid", "--device", "path:hand", "--rate", "1000", *more],
                               stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    atexit.register(process.kill)
    line = process.stderr.readline()
    assert line.startswith("play: hand at 1000 Hz"), line
    return process


def end(process, code):
    error = process.communicate(timeout=60)[1]
    assert process.returncode == code, (process.returncode, error)


class Hand:
    def __init__(self):
        self.pipe = open("hand", "w", buffering=1)
        self.x = None

    def go(self, x, speed=0.5):
        """To x along y = 0.01 in steps of 8 ms, as a mouse would."""
        start, begin = (x if self.x is None else self.x), time.monotonic()
        while self.x != x:
            way = (time.monotonic() - begin) * speed
            self.x = min(x, start + way) if x > start else max(x, start - way)
            print(self.x, 0.01, 0, file=self.pipe)
            time.sleep(0.008)

    def rest(self, seconds):
        time.sleep(seconds)


def rows(text):
    """A text log, in which each tick has names for its numbers."""
    with open(text) as lines:
        names = next(lines)[1:].split()
        return [dict(zip(names, map(float, line.split()))) for line in lines]


os.mkfifo("hand")

# Nobody comes: the HIP waits in the middle of the box, until a signal. A hand that only comes and goes ends the play.
waiting = play()
waiting.send_signal(signal.SIGTERM)
end(waiting, 143)
coming = play()
open("hand", "w").close()
end(coming, 0)

# From the left into the ball, a rest in contact, on until it snaps, a rest, and away.
# The model is asked by no thread, or the replay could not be the same.
running = play("--log", "hand.session", "--beside", "off")
time.sleep(0.7)  # the ramp
hand = Hand()
marks = {}
for name, x, seconds in (("left", -0.6, 0.8), ("contact", 0.1, 0.8), ("snapped", 0.9, 0.8)):
    hand.go(x)
    if name == "left":  # where there is no other level
        print("next", file=hand.pipe)
    hand.rest(seconds)
    marks[name] = time.monotonic()
hand.pipe.close()
end(running, 0)
# The same again without the hand. Its log has the ball's angle, too.
subprocess.run(["play", "grid", "--device", "replay:hand.session", "--log", "again"], check=True,
               stderr=subprocess.DEVNULL)
with open("felt", "w") as file:
    subprocess.run([sys.executable, os.environ["HAPGRID_SOURCE"] + "/tests/cli/stats/session.py", "text", "hand.session"], check=True, stdout=file)
said = subprocess.run(["stats", "--log", "hand.session"], check=True, capture_output=True, text=True).stdout
assert "flag next            1 " in said, said
log = rows("again")
same = ["t", "x", "y", "z", "sent_x", "sent_y", "sent_z", *(f"l{i}" for i in range(8))]
assert [[row[n] for n in same] for row in log] == [[row[n] for n in same] for row in rows("felt")]
for row in log:
    row["t"] += marks["snapped"] - log[-1]["t"]  # the last tick is at the last mark, but for some ms


def at_rest(name):
    return [row for row in log if marks[name] - 0.25 < row["t"] < marks[name] - 0.1]


# The first tick is in the middle of the box.
assert all(abs(log[0][a] - m) < 1e-9 for a, m in (("x", -0.025), ("y", -0.025), ("z", -0.025))), log[0]
for name, hand_x in (("left", -0.6), ("contact", 0.1), ("snapped", 0.9)):
    rest = at_rest(name)
    assert len(rest) > 60, (name, len(rest))
    for axis, h in (("x", hand_x), ("y", 0.01), ("z", 0)):
        # The HIP hangs on the hand by the spring, and does not swing: 0.55 s are 18 time constants, so that 1e-7 of
        # a way of 0.7 are left.
        places = [row[axis] for row in rest]
        assert max(places) - min(places) < 1e-5, (name, axis, max(places) - min(places))
        wanted = [h + row["sent_" + axis] / SPRING for row in rest]
        assert all(abs(a - b) < 2e-5 for a, b in zip(places, wanted)), (name, axis, places[-1], wanted[-1])
contact = at_rest("contact")[-1]
assert contact["s0"] > 0.2 and 0.02 < 0.1 - contact["x"] < 0.1, contact
assert abs(at_rest("left")[-1]["s0"]) < 1e-9 and abs(at_rest("snapped")[-1]["s0"]) < 1e-9

# The HIP is pressed down below the hand's z = 0, until the ball slips over it and falls back, in one tick. How the HIP
# then goes to the hand is in unit/device/hand_test.cpp.
snaps = [i for i in range(1, len(log)) if log[i - 1]["s0"] - log[i]["s0"] > 0.1]
assert len(snaps) == 1 and log[snaps[0]]["z"] < -0.1, snaps
