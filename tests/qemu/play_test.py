"""What play-test.sh's machine wrote: GOT, the positions that the device sent. It leaves log.session and there.txt."""
import json
import re
import sys

import machine

got, positions = sys.argv[1:]
parts = machine.parts(got)


def exit_code(lines):
    return [line for line in lines if line.startswith("exit ")]


# 2,500 ticks at 5 kHz. Of a tick's 200 us, play and its adapter take 140 on this slow machine, and what the kernel itself does
# now and then costs some more: one tick in 500 may be missed.
report = json.loads("\n".join(parts["report"]))
del report["lateness"]["histogram"], report["compute"]["histogram"]
assert report["ticks"] + report["missed"] == 2500 and report["missed"] <= 5, report
assert report["device"] == "test device" or "test device" in report["device"], report
assert exit_code(parts["ticks"]) == ["exit 0"], parts["ticks"]
ticks = machine.ticks(parts["session"])
forces = [tuple(map(int, line.split())) for line in parts["record"]]
assert len(forces) > 1250 and forces[-1] == (0, 0, 0), (len(forces), forces[-3:])
strongest = max(abs(f[0]) for f in forces)
assert strongest > 100, ("no contact was felt", strongest)
print(f"2500 ticks: {report['missed']} missed, {len(forces)} reports of force, "
      f"p99 of lateness {report['lateness']['p99_us']:g} us, of computing {report['compute']['p99_us']:g} us")


# Under load no process that a force passes through waits for the desktop, whose turns are 15 ticks and
# more. The device's own process runs above the loop and can cost it some ticks. Together they are fewer than one turn has.
report = json.loads("\n".join(parts["busy report"]))
assert report["missed"] < 15, report
assert exit_code(parts["busy"]) == ["exit 0"], parts["busy"]
tasks = [line for line in parts["busy"] if line.startswith("task ")]
assert tasks == [f"task hapgrid-{name} SCHED_FIFO|SCHED_RESET_ON_FORK {priority} "
                 for name, priority in (("hid", 45), ("guard", 46))], tasks
busy = int(next(line for line in parts["busy"] if line.startswith("forces ")).split()[1])
assert busy > 2 * 0.95 * len(forces), (busy, len(forces))  # it lasts twice as long
print(f"under load: {report['missed']} missed, {busy} reports of force")


# Unplugged in mid-play, while the ball is pushed: one clear line, exit 1. What is written then reaches
# nobody; the attempt is seen with the stand-in (cli/play/adapters.py).
lines = parts["unplugged"]
assert exit_code(lines) == ["exit 1"], lines
assert any(re.match(r"play: device: .*", line) for line in lines), lines
count, most = map(int, next(line for line in lines if line.startswith("felt ")).split()[1:])
assert count > 100 and most > 100, lines

# What went over the wire at 2,500 ticks against the session's text.
hips = [tuple(t[1:4]) for t in ticks]
sent_forces = [tuple(t[7:10]) for t in ticks]

# Positions: 0.2 m of reach fill 1.9 along x, so 9.5 units a metre, from the box's middle, which is at
# (-0.025, -0.025, -0.025). Each HIP is one that the device sent, in their order, none older than the
# third newest (a report a tick, and both at 5 kHz).
sent = [9.5e-6 * float(line.split()[0]) - 0.025 for line in open(positions)]
at = 0
for tick, (x, y, z) in enumerate(hips):
    while at < len(sent) and abs(sent[at] - x) > 1e-9:
        at += 1
    assert at < len(sent), f"tick {tick}: {x} is no position of the device after the one before"
    assert abs(y + 0.025) < 1e-9 and abs(z + 0.025) < 1e-9, (y, z)
assert at > 2450, at

def is_of(force, report):
    """Whether a report has this force in whole millinewtons, rounded towards zero."""
    return all(abs(w) <= abs(1000 * f) + 1e-6 and abs(1000 * f - w) < 1 + 1e-6 for f, w in zip(force, report))


# Forces: each report is what a tick had, in their order; what was replaced before it was written is
# left out, and that are few.
tick = 0
for number, report in enumerate(forces[:-1]):  # the last one is the stop's zero
    while tick < len(sent_forces) and not is_of(sent_forces[tick], report):
        tick += 1
    if tick == len(sent_forces):
        rest = forces[number:]
        assert len(rest) <= 3 and all(w == (0, 0, 0) for w in rest), (number, rest[:5])
        break
assert len(forces) > 2250, len(forces)
print(f"{len(hips)} positions and {len(forces)} forces are the device's and the session's")
