# Simulated hands (tests/bench/hands.cpp), which play a grid as play does: what their sessions are judged by, against a count
# over the log in Python; the same bytes again; the model in the grid's place; a replay by play.
source "$(dirname "$0")/../lib.sh"
hands=$HAPGRID_BUILD/bench/bench_hands
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
cat >sim.toml <<'TOML'
encoder = 0
delay = 1
truth = true
[random]
seed = 4
sessions = 6
seconds = 4
speed = 0.2
hold = 1.25
TOML

# The box is 1.9 rope lengths long, and 0.1 m reach from end to end: 19 a metre. Without a ramp what is stored is the
# energy of the first tick; with --traversal paper it is the one that the log has.
settings plain.toml 'safety.ramp = 0' 'safety.reserve = inf'
plain=(--traversal paper --config plain.toml)
"$hands" grid sim.toml "${plain[@]}" --log log --report report --sessions table 2>summary
python3 "$here/hands.py" log table report summary
expect 0 '' "~hands: energy returned .*" -- "$hands" grid sim.toml "${plain[@]}" --log a.session --sessions again
cmp again table
# A replay starts anew where the sessions did, by the same rule.
play grid --device replay:a.session --log replayed 2>/dev/null
cmp replayed log
# stats counts the same energy: exactly so when a force is in effect at once, with the encoder's positions.
sed 's/delay = 1/delay = 0/' sim.toml >prompt.toml
"$hands" grid prompt.toml "${plain[@]}" --log prompt.session --sessions prompt 2>/dev/null
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
# The first sessions are the same whatever comes after them.
sed 's/sessions = 6/sessions = 2/' sim.toml >two.toml
"$hands" grid two.toml "${plain[@]}" --sessions - 2>/dev/null | cmp - <(head -3 table)
# Along the recorded positions the model gives the forces that the errors were taken against.
play grid --device replay:a.session --traversal model --log truth 2>/dev/null
python3 "$here/hands.py" error log truth table
# Played itself it is the truth, and the loop closes without energy from mixed branches.
"$hands" grid sim.toml --traversal model --report report 2>/dev/null
python3 - <<'PYTHON'
import json
r = json.load(open("report"))
assert r["ticks_in_contact"] > 100 and r["error_before_safety_N"] == {"mean": 0, "p99": 0}, r
PYTHON

# Along a path: one session, which follows it behind a stiff spring. The time is virtual.
mkdir held
for i in {-60..-20}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >held/path
printf '[hand]\npath = "path"\nstiffness = 1e6\ndamping = 600\n' >held/sim.toml
expect 0 '' "~hands: .*in session 0
hands: largest step of the force in a tick: .*" -- "$hands" grid held/sim.toml --rate 0.5 --log log --frames frames
awk -F '\t' -v h=2.9e-6 'NR > 1 { d = $2 - (-0.6 + (NR - 2) / 100); if (d < 0) d = -d
  if (d > 19 * h + 1e-3 || $1 != (NR - 2) * 2) { bad = 1 } } END { exit bad || NR != 42 }' log || fail "path: $(cat log)"
# Frames tell where the hand is. From the box to metres and back, numbers below 1 are rounded a few times.
PYTHONPATH=$(realpath "$HAPGRID_BIN/../python") /usr/bin/python3 - <<'PYTHON'
import hapgrid
import numpy
frames, way = hapgrid.read("frames")["frames"], numpy.loadtxt("held/path")
assert len(frames) == 41 and abs(frames["hand"] - way[frames["tick"]]).max() < 1e-15, frames["hand"]
PYTHON

# A hand that trembles by 2 mm behind a stiff spring, at rest in free space: 8 Hz on x, 10 on y, 12 on z, one second of
# each. The tremor's frequency is too low by 2e-4 (x) to 5e-4 (z) of itself: 6e-3 of a turn in a second, 7e-5 m.
for i in {1..1000}; do echo '-0.9 0.3 0.3'; done >held/path
printf 'encoder = 0\n[hand]\npath = "path"\nstiffness = 1e6\ndamping = 600\ntremor = 2e-3\n' >held/sim.toml
"$hands" grid held/sim.toml --log log 2>/dev/null
python3 - <<'PYTHON'
import math
rows = [list(map(float, line.split("\t")[:4])) for line in open("log") if line[0] != "#"]
for t, *x in rows[100:]:
    for a, (place, middle) in enumerate(zip(x, (-0.9, 0.3, 0.3))):
        want = 2e-3 * math.sin(2 * math.pi * (8 + 2 * a) * t)
        assert abs((place - middle) / 19 - want) < 1e-4, (t, a, place, want)
PYTHON

# A hand that rests in a contact from the start feels the full force after a second, without a jump: of a model with
# energies and of one without.
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' --set 'search.store=["force"]' | expand --complete -o dull
for i in {1..2000}; do echo 0.05 0.01 0; done >held/path
printf '[hand]\npath = "path"\n' >held/sim.toml
for known in grid dull; do
  "$hands" "$known" held/sim.toml --log log 2>/dev/null
  python3 - <<'PYTHON'
import math
rows = [list(map(float, line.split("\t")[:10])) for line in open("log") if line[0] != "#"]
sent = [row[7:10] for row in rows]
assert max(math.dist(a, b) for a, b in zip([[0, 0, 0]] + sent, sent)) < 0.02
for row in rows[1000:]:
    assert math.hypot(*row[4:7]) > 0.1 and math.dist(row[4:7], row[7:10]) < 1e-3, row
PYTHON
done

# Where the grid has two levels, the hand goes on to the other one each half second: a snap, whose force comes in by the
# ramp. A replay presses where the hand did.
for i in {1..2000}; do echo 0.025 0.025 0.025; done >held/path
printf 'encoder = 0\n[hand]\npath = "path"\nnext = 0.5\nstiffness = 1e6\ndamping = 600\n' >held/sim.toml
"$hands" grid held/sim.toml --log log 2>/dev/null
"$hands" grid held/sim.toml --log next.session 2>/dev/null
play grid --device replay:next.session --log replayed 2>/dev/null
cmp replayed log
python3 - <<'PYTHON'
rows = [dict(zip("t x y z fx fy fz sx sy sz".split(), map(float, line.split("\t"))), snap=line.split()[-1],
             state=float(line.split("\t")[18])) for line in open("log") if line[0] != "#"]
assert [row["t"] for row in rows if row["snap"] == "1"] == [0.5, 1.0, 1.5]
for i, row in enumerate(rows):
    # The body hangs on the one side of the probe or on the other.
    assert (row["state"] < -0.1) == (i // 500 % 2 == 0) and abs(row["state"]) > 0.1, (i, row)
    # The ramp's 500 ms; the ball gives the hand what it holds there, so that nothing else acts behind the first tick.
    assert i < 2 or abs(row["sx"] - row["fx"] * (i % 500 + 1) / 500) < 1e-9, (i, row)
PYTHON

# What is refused.
no() {
  printf "%b" "$1" >bad.toml
  expect 1 '' "bench_hands: bad.toml: $2" -- "$hands" grid bad.toml --log nothing
}
no 'weight = 1\n' 'line 1: unknown key weight (known: mass, damping, encoder, delay, reach, truth, hand, random)'
no 'mass = 0\n' 'line 1: mass must be a number from 0.001 to 1000 kg, not 0'
no 'delay = 0.5\n' 'line 1: delay must be a whole number from 0 to 10000'
no '[random]\nseconds = 1e5\n' 'line 2: random.seconds must be a number from 0.001 to 10000 s, not 1e+05'
[[ ! -e nothing ]] || fail "a log is left"
