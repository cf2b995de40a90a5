"""What evdev-test.sh's machine wrote: GOT. The forces that devices got are compared with those of the
sessions, by the units of linux/input.h: levels to 0x7fff, motors to 0xffff, and the direction into which a
force pulls, 0 towards the user, clockwise in 1/0x10000 of a circle. Full is 2 N, the default."""
import itertools
import math
import re
import sys

import machine

FULL = 2.0
parts = machine.parts(sys.argv[1])


def ticks(name):
    """(HIP, force that was sent, levels of the corners) of each tick of a session."""
    rows = machine.ticks(parts[f"{name} session"])
    return [(row[1:4], row[7:10], row[10:18]) for row in rows]


def constant(force):
    level = int(min(math.hypot(force[0], force[1]) / FULL, 1) * 0x7fff)
    turn = math.atan2(-force[0], -force[1]) / (2 * math.pi) * 0x10000
    return (level, math.floor(turn + 0.5) % 0x10000 if level else 0)


def rumble(force):
    return int(min(math.hypot(*force) / FULL, 1) * 0xffff)


def follows(got, wanted, what):
    """Each that a device got is a tick's, in their order."""
    at = 0
    for number, one in enumerate(got):
        while at < len(wanted) and wanted[at] != one:
            at += 1
        assert at < len(wanted), f"{what}: {one}, number {number} of {len(got)}, is no tick's: {got[:number + 1][-5:]}"


def record(name):
    """The lines of a record as lists of words, without the time; and the times, in seconds."""
    found = [line.split() for line in parts[name] if re.match(r"\d+ (upload|erase|play|set) ", line)]
    return [words[1:] for words in found], [int(words[0]) * 1e-6 for words in found]


def ended(name, code, error=""):
    exits = [line for line in parts[name] if line.startswith("exit ")]
    assert exits[-1:] == [f"exit {code}"] and any(error in line for line in parts[name]), (name, parts[name][:12])


# Everybody sees what there is, and who may not open it is told the rule that helps.
lines = parts["list"]
for row in (r"evdev:/dev/input/event\d +rumble  emulated gamepad \(045e:028e\)",
            r"evdev:/dev/input/event\d +force +emulated stick \(1209:0001\)"):
    assert any(re.fullmatch(row, line) for line in lines), (row, lines)
assert lines[-1] == "exit 1" and "TAG+=\"uaccess\"" in lines[-4], lines
assert re.match(r'play: hapgrid-evdev: /dev/input/event\d+: permission denied: put the line KERNEL=="event\*", '
                r'ATTRS{id/vendor}=="1209", ATTRS{id/product}=="0001", TAG', lines[-2]), lines[-2]

# The gamepad steers: to the left, 0.8 units a second, a thousandth of that each tick, when its stick is there.
ended("gamepad", 0)
for said in ("1400 ticks", "missed at 1000 Hz: 0,"):
    assert any(said in line for line in parts["gamepad"]), said
played = ticks("gamepad")
hips = [hip[0] for hip, _, _ in played]
steps = {round((b - a) * 1e9) for a, b in zip(hips, hips[1:])}
assert steps == {0, -800000} or steps == {-800000}, steps
assert abs(hips[0] - 0.175) < 1e-3 and hips[-1] < -0.8, (hips[0], hips[-1])
# The strong motor is the force, and the weak one says the one snap, before the force is gone.
words, times = record("gamepad")
strong = [int(w[3]) for w in words if w[:3] == ["upload", "0", "rumble"]]
follows(strong[1:], [rumble(force) for _, force, _ in played], "strong motor")
assert len(strong) > 80 and max(strong) > 39000, (len(strong), max(strong))
assert words[:4] == [["set", "96", "65535"], "upload 0 rumble 0 0 250".split(), "upload 1 rumble 0 65535 60".split(),
                     ["play", "0", "1"]], words[:4]
snaps = [i for i, w in enumerate(words) if w == ["play", "1", "1"]]
assert len(snaps) == 1 and any("snapped in 1 tick" in line for line in parts["gamepad"]), snaps
before = int([w for w in words[:snaps[0]] if w[0] == "upload"][-1][3])
assert before > 39000, words[snaps[0] - 3:snaps[0]]
# The slew limit leaves a rest of the force for one tick more, whose turn it can be: much, if little time has passed.
after = [int(w[3]) for w in words[snaps[0] + 1:] if w[:3] == ["upload", "0", "rumble"]]
assert after[0] == 0 or (after[0] < before and after[1] == 0), words[snaps[0]:snaps[0] + 4]
# At most one force in 10 ms, and one that is played goes on.
uploads = [t for t, w in zip(times, words) if w[:2] == ["upload", "0"] and w[3] != "0"]  # no force goes at once
assert min(b - a for a, b in zip(uploads[1:], uploads[2:])) > 0.0099, uploads
# While there is a force, its effect is started anew at least every 0.1 s.
started, pushes = times[0], False
for t, w in zip(times, words):
    if w[:3] == ["upload", "0", "rumble"]:
        started = t if int(w[3]) > 0 and not pushes else started
        pushes = int(w[3]) > 0
    if w == ["play", "0", "1"]:
        started = t
    assert not pushes or t - started < 0.1, (t, w)
# Stopped, then erased by the kernel when the device is closed.
end = ("play 0 0", "play 1 0", "play 0 0", "erase 0", "play 1 0", "erase 1")
assert words[-6:] == [line.split() for line in end], words[-6:]

# The second button, held for 50 ms while the ball is pushed, takes it to its other level there, once: from then on, until the
# other play's ball snaps, the levels differ, and nowhere else but where a snap is a tick later.
ended("next", 0)
pushed = {round(hip[0], 6): levels for hip, _, levels in played}
differs = [levels != pushed[round(hip[0], 6)] for hip, _, levels in ticks("next") if round(hip[0], 6) in pushed]
lengths = [len(list(run)) for is_other, run in itertools.groupby(differs) if is_other]
assert lengths[0] > 60 and sum(lengths[1:]) <= 5 and not differs[0], (lengths, len(differs))

# The stick is held: its place is a position, and it gets each force as level and direction.
ended("stick", 1, "hapgrid-evdev: did not answer within 100 ms")
words, times = record("stick")
assert words[:2] == [["set", "97", "0"], ["set", "96", "65535"]], words[:2]
played = ticks("stick")
got = [tuple(map(int, w[3:5])) for w in words if w[:3] == ["upload", "0", "constant"]]
assert len(got) == 110 and max(level for level, _ in got) > 5000, (len(got), max(got))
follows(got[1:], [constant(force) for _, force, _ in played], "constant force")
# The ball is to the left and below: the force on the hand points to the right, 0xC000.
assert all(abs(direction - 0xc000) < 0x1000 for level, direction in got if level > 1000), got
# From the middle, 19 units a metre, at 0.05 m in 1.2 s.
for hip, _, _ in played:
    assert -0.775 - 1e-9 < hip[0] < 0.175 + 1e-9 and abs(hip[1] + 0.025) < 1e-9, hip

# The guard stops what plays when play stands still; no force comes after that.
ended("stopped", 1, "the program stood still, and its guard sent zero force")
words, _ = record("stopped")
motors = [int(w[3]) for w in words if w[:3] == ["upload", "0", "rumble"]]
assert len(motors) > 10 and max(motors) > 10000, motors
last = max(i for i, w in enumerate(words) if w[0] == "upload")
assert ["play", "0", "0"] in words[last:] and ["play", "0", "1"] not in words[last:], words[last:]

ended("unplugged", 1, "play: device: hapgrid-evdev: /dev/input/event")
print("as many forces as", len(strong), len(got), "reached the gamepad and the stick")
