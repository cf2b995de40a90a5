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


# The device itself. The last of 2,000 reports is 0.3998 s behind the first. A report takes some 20
# microseconds of the machine's time; half a period of lateness is allowed.
lines = parts["device"]
assert lines[:4] == ["1 -2 3 0 0", "100000 -200000 300000 1 0", "-2147483648 2147483647 0 2 0",
                     "-2147483648 2147483647 0 3 0"], lines
events = [line.split(" ", 1) for line in lines[4:]]
assert [event for _, event in events[:-1]] == ["open", "out 1 -2 32767 513", "short 64"], events
(time, end) = events[-1]
assert re.fullmatch(r"end 2000 \S+", end) and 399800 <= float(time) < 401000, events[-1]
assert float(end.split()[2]) < 100, end

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

# What is there.
lines = parts["list"]
assert "/dev/hidraw0\t16c0:0486\t-\tffab:0200\t-\tTeensy RawHID" in lines, lines
