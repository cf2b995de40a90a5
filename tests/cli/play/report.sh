# play --report, against the log and the summary of the same play; and play --selftest.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90} {90..-90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path

play grid --device path:path --max-force 0.05 --log log --report report 2>summary
play grid --device path:path --max-force 0.05 --report - 2>/dev/null >out
head -300 path | play grid --device path:- --rate 1000 --max-force 0.05 --report paced 2>paced.summary
python3 - <<'PYTHON'
import json, math, re


def histogram(h, ticks):
    """Its bins hold all ticks. What they and the percentiles are is in tests/unit/loop."""
    assert h["histogram"]["columns"] == ["from_us", "to_us", "ticks"]
    bins = h["histogram"]["bins"]
    assert sum(n for _, _, n in bins) == ticks, (bins, ticks)
    assert bins[-1][0] <= h["max_us"] < bins[-1][1], (bins[-1], h["max_us"])


def check(report, summary):
    """What both say is the same."""
    numbers = [int(n) for n in re.findall(r"\d+", summary[0])]
    switches = report["switches"]
    assert numbers == [report["ticks"], sum(switches.values()), switches["face"], switches["edge"],
                       switches["vertex"], report["level_changed"]], (summary, report)
    numbers = [int(n) for n in re.findall(r"\d+", summary[1])]
    assert numbers == [report["outside"], report["split"], report["lagging"]], (summary, report)
    acted = dict((name, int(n)) for name, n in re.findall(r"([a-z-]+) (\d+)", summary[2].split(": ")[-1]))
    assert acted == {name: n for name, n in report["safety_ticks"].items() if n}, (summary, report)
    assert report["end"] == "device" and report["exit_code"] == 0 and report["zero_sent"] is True
    histogram(report["lateness"], report["ticks"])
    histogram(report["compute"], report["ticks"])


report = json.load(open("report"))
check(report, open("summary").read().splitlines())
assert report["model"] == "hung-ball" and report["device"] == "path" and report["rate_hz"] == 0
assert report["missed"] == report["overruns"] == 0 and report["lateness"]["max_us"] == 0
log = [list(map(float, line.split("\t"))) for line in open("log") if line[0] != "#"]
assert report["ticks"] == len(log) == 362
assert abs(report["largest_force_sent_N"] - max(math.hypot(*row[7:10]) for row in log)) < 1e-15
assert abs(report["largest_force_of_model_N"] - max(math.hypot(*row[4:7]) for row in log)) < 1e-15
assert 0.049 < report["largest_force_sent_N"] <= 0.05 and report["safety_ticks"]["clamped"] > 0

again = json.load(open("out"))  # what does not depend on the time is the same
for r in (report, again):
    del r["compute"]
assert again == report, (again, report)

paced = json.load(open("paced"))
lines = open("paced.summary").read().splitlines()
assert re.match(r"play: path at 1000 Hz; real time: ", lines[0]), lines
check(paced, lines[1:])
assert paced["rate_hz"] == 1000 and paced["ticks"] == 300 and paced["lateness"]["max_us"] > 0
assert lines[4] == f"play: ticks missed at 1000 Hz: {paced['missed']}, in {paced['overruns']} overrun{'s' * (paced['overruns'] != 1)}", lines
PYTHON

# A quarter of a second each of loop and kernel for each rate; no device, no grid.
play --selftest --duration 0.1 --realtime off >selftest
python3 - <<'PYTHON'
import re

lines = open("selftest").read().splitlines()
assert len(lines) == 2 + 3 * 4, lines
times = r"p50 (\S+), p99 (\S+), p99.9 (\S+), max (\S+) µs"
for i, rate in enumerate((1000, 2000, 5000)):
    title, loop, kernel, compute = lines[2 + 4 * i:6 + 4 * i]
    grade = re.fullmatch(rf"{rate} Hz: (good|fair|poor) \(.+\)", title).group(1)
    loop = re.fullmatch(rf"  the loop's lateness    {times}; missed (\d+) of (\d+)", loop).groups()
    kernel = re.fullmatch(rf"  the kernel's lateness  {times}", kernel).groups()
    compute = re.fullmatch(rf"  the loop's computing   {times}", compute).groups()
    for t in (loop[:4], kernel, compute):
        t = list(map(float, t))
        assert 0 < t[0] <= t[1] <= t[2] <= t[3], lines
    missed, ticks = int(loop[4]), int(loop[5])
    assert ticks == rate / 4, lines
    # The grade by its own words; what is shown has three digits.
    done = lambda k: (float(loop[k]) + float(compute[k])) * rate / 1e6
    near = 1.01
    good = missed == 0 and done(2) <= 0.1
    fair = missed <= ticks / 1000 and done(1) <= 0.25
    if not any(limit / near < d < limit * near for d, limit in ((done(2), 0.1), (done(1), 0.25))):
        assert grade == ("good" if good else "fair" if fair else "poor"), lines
PYTHON
