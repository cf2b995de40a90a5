# Simulated hands (tests/bench/hands.cpp), which play a grid as play does: what their sessions are judged by, against a count
# over the log in Python; the same bytes again; a replay by play. How they wander is in unit/device/simulated_test.cpp.
source "$(dirname "$0")/../lib.sh"
hands=$HAPGRID_BUILD/bench/bench_hands
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid

# The box is 1.9 rope lengths long, and 0.1 m reach from end to end: 19 a metre. Without a ramp what is stored is the
# energy of the first tick; with --traversal paper it is the one that the log has.
settings plain.toml 'safety.ramp = 0' 'safety.reserve = inf'
wander=(grid --encoder 0 --seed 4 --seconds 4 --speed 0.2 --hold 1.25 --traversal paper --config plain.toml)
"$hands" "${wander[@]}" --sessions 6 --delay 1 --log log --table table 2>summary
python3 - <<'PYTHON'
import math
import re


def read(name):
    lines = [line.split("\t") for line in open(name).read().splitlines()]
    names = [n.removeprefix("# ") for n in lines[0]]
    return [dict(zip(names, map(float, line))) for line in lines[1:]]


ticks, sessions = read("log"), read("table")
assert len(sessions) == 6 and len(ticks) == 24000
for k, said in enumerate(sessions):
    rows = ticks[4000 * k:4000 * (k + 1)]
    sent = [[0, 0, 0]] + [[t[f"sent_{a}"] for a in "xyz"] for t in rows]  # in effect a tick late
    x = [[t[a] / 19 for a in "xyz"] for t in rows]
    given = highest = 0
    stored = 1000 * rows[0]["energy"] / 19  # 1 N times a rope length
    for force, a, b in zip(sent, x, x[1:]):
        given += 1000 * sum(f * (v - u) for f, u, v in zip(force, a, b))
        highest = max(highest, given - stored)
    for name, counted in (("stored", stored), ("given", given), ("returned", highest)):
        assert abs(said[f"{name}_mJ"] - counted) < 1e-9 * max(1, abs(counted)), (k, name, said, counted)
returned = [s["returned_mJ"] for s in sessions]
assert len({s["given_mJ"] for s in sessions}) == 6, sessions
found = re.search(r"of 6 sessions: mean (\S+) mJ, worst (\S+) mJ in session (\d)\n", open("summary").read())
assert abs(float(found[1]) - sum(returned) / 6) < 0.01 * max(returned) and float(found[2]) > 0, found
assert int(found[3]) == returned.index(max(returned)), found
PYTHON
"$hands" "${wander[@]}" --sessions 6 --delay 1 --log a.session --table again 2>/dev/null
cmp again table
# The first sessions are the same whatever comes after them.
"$hands" "${wander[@]}" --sessions 2 --delay 1 --table - 2>/dev/null | cmp - <(head -3 table)
# A replay starts anew where the sessions did, by the same rule.
play grid --device replay:a.session --log replayed 2>/dev/null
cmp replayed log
# stats counts the same energy: exactly so when a force is in effect at once, with the encoder's positions.
"$hands" "${wander[@]}" --sessions 6 --log prompt.session --table prompt 2>/dev/null
stats prompt.session --format json >energy
python3 - <<'PYTHON'
import json
said = json.load(open("energy"))["energy"]
rows = [list(map(float, line.split("\t"))) for line in open("prompt") if line[0] != "#"]
given, returned = sum(row[2] for row in rows), max(row[1] + row[3] for row in rows if row[3] > 0)
assert said["unit"] == "mJ", said
assert abs(said["given"] - given) < 1e-9 * abs(given), (said, given)
assert abs(said["returned"] - returned) < 1e-9 * returned, (said, returned)
PYTHON

# Along a path: one session, which follows it behind a stiff spring. The time is virtual.
for i in {-60..-20}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
held=(--path path --stiffness 1e6 --damping 600)
expect 0 '' "~hands: .*in session 0" -- "$hands" grid "${held[@]}" --rate 0.5 --log log --frames frames
awk -F '\t' -v h=2.9e-6 'NR > 1 { d = $2 - (-0.6 + (NR - 2) / 100); if (d < 0) d = -d
  if (d > 19 * h + 1e-3 || $1 != (NR - 2) * 2) { bad = 1 } } END { exit bad || NR != 42 }' log || fail "path: $(cat log)"
# Frames tell where the hand is. From the box to metres and back, numbers below 1 are rounded a few times.
PYTHONPATH=$(realpath "$HAPGRID_BIN/../python") /usr/bin/python3 - <<'PYTHON'
import hapgrid
import numpy
frames, way = hapgrid.read("frames")["frames"], numpy.loadtxt("path")
assert len(frames) == 41 and abs(frames["hand"] - way[frames["tick"]]).max() < 1e-15, frames["hand"]
PYTHON

# A hand that rests in a contact from the start feels the full force after a second, without a jump: of a model with
# energies and of one without.
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' --set 'search.store=["force"]' | expand --complete -o dull
for i in {1..2000}; do echo 0.05 0.01 0; done >path
for known in grid dull; do
  "$hands" "$known" --path path --log log 2>/dev/null
  python3 - <<'PYTHON'
import math
rows = [list(map(float, line.split("\t")[:10])) for line in open("log") if line[0] != "#"]
sent = [row[7:10] for row in rows]
assert max(math.dist(a, b) for a, b in zip([[0, 0, 0]] + sent, sent)) < 0.02
for row in rows[1000:]:
    assert math.hypot(*row[4:7]) > 0.1 and math.dist(row[4:7], row[7:10]) < 1e-3, row
PYTHON
done

# Where the grid has two levels, the word next in a path takes the other one: a snap. A replay presses where the path did.
# How the force comes in is in tests/unit/loop.
for i in {0..1999}; do echo 0.025 0.025 0.025 $((i % 500 || i == 0)); done | sed 's/ 1$//; s/ 0$/ next/' >path
play grid --device path:path --log log 2>/dev/null
play grid --device path:path --log next.session 2>/dev/null
play grid --device replay:next.session --log replayed 2>/dev/null
cmp replayed log
same "snaps" $'0.5\n1\n1.5' "$(awk '!/^#/ && $NF == 1 { print $1 }' log)"
# The body hangs on the one side of the probe or on the other.
same "sides" '-1 1 -1 1' "$(awk '!/^#/ && NR % 500 == 2 { print ($19 > 0.1) - ($19 < -0.1) }' log | xargs)"
