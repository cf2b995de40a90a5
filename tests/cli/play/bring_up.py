"""Brings up emulated devices. The adapter is this file, too: a mass on the spring of a hand, a tick of 1 ms for each force. What
the person does and feels is in a file that both map: three targets, three places, three forces, in the person's axes."""
import collections
import math
import mmap
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import time

AXES = "right", "away", "up"


def adapter(shared, record, turn, step, delay):
    """turn: for each axis of the device, the person's (0, 1, 2), its sign, and that of the force."""
    log = os.open(record, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
    both = mmap.mmap(os.open(shared, os.O_RDWR), 72)
    reach = [-0.08] * 3 + [0.08] * 3
    signal.signal(signal.SIGTERM, lambda *_: (os.write(log, b"0.0\n"), os._exit(0)))
    if sys.argv[-1] == "--release":
        os.write(log, b"0.0\n")
        return
    os.write(1, struct.pack("<8s2I6d2d48s", b"hapgrid", 3, 1, *reach, 2.0, 1000.0, b"emulated"))
    ticks, place, speed, hand, under_way = 0, [0.0] * 3, [0.0] * 3, [0.0] * 3, collections.deque([(0.0,) * 3] * (delay + 1), delay + 1)
    while True:
        try:
            message = select.select([0], [], [], 0.1)[0] and os.read(0, 32)
        except ConnectionResetError:
            message = b""
        *force, number, flags = struct.unpack("<3d2I", message or struct.pack("<3d2I", 0, 0, 0, 0, message == b""))
        if number or not message:
            os.write(log, f"{max(map(abs, force))}\n".encode())
        if number:
            seen = [sign * round(place[axis] / step) * step for axis, sign, _ in turn]
            os.write(1, struct.pack("<4d2I", time.monotonic(), *seen, 0, number))
        if flags & 1:
            return
        under_way.append(tuple(force))
        ticks += 1
        felt = [0.0] * 3
        for (axis, sign, push), one in zip(turn, under_way[0]):
            felt[axis] = sign * push * one
        for a, target in enumerate(struct.unpack("<3d", both[:24])):
            hand[a] += max(-1e-4, min(1e-4, target - hand[a]))
            tremor = 1e-4 * math.sin((0.05 + 0.004 * a) * ticks)
            for _ in range(4):
                speed[a] += 0.25e-3 / 0.1 * (felt[a] + 100 * (hand[a] + tremor - place[a]) - 1.5 * speed[a])
                place[a] += 0.25e-3 * speed[a]
        both[24:72] = struct.pack("<6d", *place, *felt)


class Person:
    """Talks with play."""

    def __init__(self, name, turn, step=5e-5, delay=0, more=()):
        self.name = name
        open(f"{name}.shared", "wb").write(bytes(72))
        self.both = mmap.mmap(os.open(f"{name}.shared", os.O_RDWR), 72)
        device = f"process:python3 {__file__} adapter {name}.shared {name}.record {step} {delay} " + " ".join(
            f"{axis},{sign},{push}" for axis, sign, push in turn)
        self.terminal, theirs = pty.openpty()
        self.device, self.said = device, ""
        self.play = subprocess.Popen(["play", "--device", device, *more], stdin=theirs, stderr=theirs, stdout=open(f"{name}.toml", "w"),
                                     start_new_session=True, preexec_fn=lambda: __import__("fcntl").ioctl(0, 0x540E, 0))  # TIOCSCTTY
        os.close(theirs)

    def listen(self):
        """What play says within 0.1 s; false where it is gone."""
        try:
            if select.select([self.terminal], [], [], 0.1)[0]:
                self.said += os.read(self.terminal, 4096).decode()
            return True
        except OSError:
            return False

    def goes_on(self, deadline):
        if time.monotonic() > deadline or not self.listen() or self.play.poll() is not None:
            open(sys.argv[1], "a").write(self.said)
            self.play.kill()
            raise AssertionError((self.name, self.said, self.play.wait(), self.feels()))

    def hear(self, words):
        deadline = time.monotonic() + 60
        while not re.search(words, self.said):
            self.goes_on(deadline)
        self.said = re.split(words, self.said, 1)[1]

    def feels(self):
        return struct.unpack("<6d", self.both[24:72])

    def until(self, good):
        deadline = time.monotonic() + 60
        while not good(*self.feels()):
            self.goes_on(deadline)

    def type(self, text):
        os.write(self.terminal, text.encode() + b"\n")

    def move(self, allows="yes"):
        self.hear("Hold the handle still")
        self.type("")
        goal = [0.0] * 3
        for axis, words in enumerate(("to the right", "away from you", "move it up")):
            self.hear(words)
            goal[axis] = 0.03
            self.both[:24] = struct.pack("<3d", *goal)
            self.until(lambda *now: abs(now[axis] - 0.03) < 1e-3)
            self.type("")
        self.hear("May it push")
        self.both[:24] = bytes(24)
        self.until(lambda *now: max(map(abs, now[:3])) < 1e-3)
        self.type(allows)

    def push(self):
        self.hear("It pushes now")
        for there in (False, True):  # the force before it may act for a while yet
            self.until(lambda *now: (max(map(abs, now[3:])) > 0.05) == there)
        force = self.feels()[3:]
        axis = max(range(3), key=lambda a: abs(force[a]))
        return ("rau" if force[axis] > 0 else "ltd")[axis]

    def end(self):
        """(exit code, what play said last, the table)"""
        deadline = time.monotonic() + 60
        while self.listen():
            assert time.monotonic() < deadline, (self.name, self.said)
        open(sys.argv[1], "a").write(self.said)
        last = lambda: open(f"{self.name}.record").read().split()[-1]
        while float(last()) != 0 and time.monotonic() < deadline:  # --release may come a moment later
            time.sleep(0.02)
        assert float(last()) == 0, (self.name, last())
        most = max(map(float, open(f"{self.name}.record").read().split()))
        assert most <= 0.1, most
        return self.play.wait(), self.said, open(f"{self.name}.toml").read()


def whole(*words, **more):
    person = Person(*words, **more)
    person.move()
    for _ in AXES:
        person.type(person.push())
    code, said, table = person.end()
    assert code == 0, (code, said)
    return person, said, table


if sys.argv[1] == "adapter":
    shared, record, step, delay, *turn = [word for word in sys.argv[2:] if word != "--release"]
    adapter(shared, record, [tuple(map(int, word.split(","))) for word in turn], float(step), int(delay))
    sys.exit(0)

# Its x is down, its y to the right, its z towards the person; steps of 0.2 mm, and a force acts 3 ticks late.
TURNED = (2, -1, 1), (0, 1, 1), (1, -1, 1)
person, said, table = whole("turned", TURNED, step=2e-4, delay=3)
print(table)
assert re.search(r'^\[play\]\naxes = "y,-z,-x"\nmax-force = 2\n\[play.safety\]\nencoder = 0.0002 .*\ndelay = 3 ', table, re.M), table
# Play takes the file as it is.
played = subprocess.run(["play", "stuck.0", "--device", person.device, "--config", "turned.toml", "--duration", "0.2",
                         "--traversal", "paper"],
                        capture_output=True, text=True)
assert played.returncode == 0 and "turned.toml sets max-force = 2, safety.delay = 3, safety.encoder = 2e-04, axes = y,-z,-x" in played.stderr, played
open(sys.argv[1], "w").close()

# It pushes the wrong way along one axis.
_, said, table = whole("wrong", ((0, 1, 1), (1, 1, -1), (2, 1, 1)))
print(table)
assert re.search(r'axes = "x,y,z"\nmax-force = 0  # it pushes the wrong way along y, or .* mapping\.push = \[1,-1,1\] in place of max-force', table), table
assert "delay = 0 " in table, table

# Who allows no force gets none.
person = Person("untried", TURNED)
person.move("")
assert "max-force = 0  # no force was tried" in person.end()[2]

# Every way out, with a force on the hand.
for name, leave, code in (("killed", lambda p: p.play.kill(), -signal.SIGKILL), ("ended", lambda p: p.play.terminate(), 143),
                          ("interrupted", lambda p: os.write(p.terminal, b"\x03"), 130), ("closed", lambda p: os.write(p.terminal, b"\x04"), 1)):
    person = Person(name, TURNED)
    person.move()
    person.push()
    leave(person)
    got, said, table = person.end()
    assert (got, table) == (code, ""), (name, got, said, table)
    print(name, "at", max(float(word) for word in open(f"{name}.record").read().split()), "N")
