"""What play-test.sh's machine wrote: GOT, the positions that the device sent, where to put the session."""
import base64
import json
import re
import sys

got, positions, session = sys.argv[1:]
parts = {}
for line in open(got):
    line = line.rstrip("\r\n")
    if line.startswith("== "):
        part = parts.setdefault(line[3:], [])
    else:
        part.append(line)


def exit_code(lines):
    return [line for line in lines if line.startswith("exit ")]


# 5,000 ticks at 5 kHz, none missed.
report = json.loads("\n".join(parts["report"]))
assert report["ticks"] == 5000 and report["missed"] == 0 and report["overruns"] == 0, report
assert report["device"] == "test device" or "test device" in report["device"], report
assert exit_code(parts["5000 ticks"]) == ["exit 0"], parts["5000 ticks"]
open(session, "wb").write(base64.b64decode("".join(parts["session"])))
forces = [tuple(map(int, line.split())) for line in parts["record"]]
assert len(forces) > 2500 and forces[-1] == (0, 0, 0), (len(forces), forces[-3:])
strongest = max(abs(f[0]) for f in forces)
assert strongest > 100, ("no contact was felt", strongest)
print("5000 ticks: %d reports of force, p99 of lateness %g us, of computing %g us" % (
    len(forces), report["lateness"]["p99_us"], report["compute"]["p99_us"]))


# Under load no thread that a force passes through waits for the desktop, whose turns are 15 ticks and
# more. The device's own process runs above the loop, and can cost it a few ticks.
report = json.loads("\n".join(parts["busy report"]))
assert report["missed"] <= 5, report
assert exit_code(parts["busy"]) == ["exit 0"], parts["busy"]
tasks = [line for line in parts["busy"] if line.startswith("task hid-")]
assert sorted(tasks) == ["task hid-reader SCHED_FIFO 45 ", "task hid-writer SCHED_FIFO 45 "], tasks
busy = int(next(line for line in parts["busy"] if line.startswith("forces ")).split()[1])
assert busy > 0.95 * len(forces), (busy, len(forces))


def felt(lines):
    """The last report, and whether the ball was felt before."""
    count, most = map(int, lines[-2].split())
    assert count > 500 and most > 100, lines
    return lines[-1]


# Unplugged in mid-play, while the ball is pushed: one clear line, exit 1. What is written then reaches
# nobody; the attempt is seen with the stand-in (tests/unit/device).
lines = parts["unplugged"]
assert exit_code(lines) == ["exit 1"], lines
assert any(re.match(r"play: device: .*", line) for line in lines), lines
felt(lines)

# Silent before it was unplugged: let go in time.
lines = parts["silent"]
assert exit_code(lines) == ["exit 1"], lines
assert any("stalled" in line for line in lines), lines
assert felt(lines) == "out 0 0 0", lines

# Interrupted, and killed: zero force is the last report.
for name, code in (("interrupted", "exit 130"), ("killed", "exit 137")):
    lines = parts[name]
    assert exit_code(lines) == [code], lines
    assert felt(lines) == "out 0 0 0", lines

# What is there, and what its descriptor says.
lines = parts["descriptor"]
assert "/dev/hidraw0\t16c0:0486\t-\tffab:0200\t-\tTeensy RawHID" in lines, lines
assert "  input 0: byte 1 bit 0: 64 x 8 bits: ffab:0001: logical 0..255" in lines, lines

# The joystick, by the sequence of the PID class: reset, enable, full gain; an effect an axis, endless
# and constant, at 90 degrees and at 0, started; then magnitudes alone; zeros, stop, blocks freed.
lines = parts["pid"]
assert exit_code(lines) == ["exit 0"], lines
seen = [line for line in lines if re.match(r"(output|set|get) ", line)]
start = """output 0c 08
output 0c 01
output 0d ff
set 11 01 00 00
get 12 01 01 40 00
output 01 01 01 ff ff 00 00 00 00 00 00 ff 00 04 28 23 00 00
output 05 01 00 00
output 0a 01 01 ff
set 11 01 00 00
get 12 02 01 40 00
output 01 02 01 ff ff 00 00 00 00 00 00 ff 00 04 00 00 00 00
output 05 02 00 00
output 0a 02 01 ff""".split("\n")
end = ["output 05 01 00 00", "output 05 02 00 00", "output 0c 04", "output 0b 01", "output 0b 02"]
assert seen[:len(start)] == start, seen[:len(start)]
assert seen[-len(end):] == end, seen[-len(end):]
middle = seen[len(start):-len(end)]
assert len(middle) > 50 and all(re.match(r"output 05 0[12] ", line) for line in middle), middle
