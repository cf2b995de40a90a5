# The frames of play: which ticks they are, what is in them, and viewers of all kinds.
source "$(dirname "$0")/../lib.sh"
frames=$HAPGRID_SOURCE/schemas/frame.capnp
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid

# 362 ticks there and back: frames at 0, 40, ..., 360, and the last one, 361.
for i in {-90..90} {90..-90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
settings bare.toml "safety.ramp = 0"
bare=(--config bare.toml)  # what is sent is what was computed
expect 0 '' "~play: bare.toml sets safety.ramp = 0
play: 362 ticks, .*
play: ticks outside the box 0, .*
play: largest force .*
play: frames written 11, dropped 0" -- play grid --device path:path --frames x.frames --log log "${bare[@]}"
capnp convert binary:json --short "$frames" Message <x.frames >json
same "messages" 12 "$(wc -l <json)"
python3 - <<'PYTHON'
import json, math
scene, *frames = [json.loads(line) for line in open("json")]
scene, frames = scene["scene"], [f["frame"] for f in frames]
assert scene["model"] == "hung-ball" and scene["lengthUnit"] == "rope lengths", scene
assert scene["box"]["countX"] == 20 and scene["stateSize"] == 1 and scene["hipRadius"] == 0.1
assert len(scene["spheres"]) == 49 and abs(scene["spheres"][0]["radius"] - 0.1) < 1e-8
assert [int(f["tick"]) for f in frames] == [*range(0, 361, 40), 361], frames
log = [line.rstrip("\n").split("\t") for line in open("log")]
names = {name: i for i, name in enumerate(["t", *log[0][1:]])}
touched = 0
for f in frames:
    row = log[1 + int(f["tick"])]
    at = lambda name: float(row[names[name]])
    triple = lambda v: [f[v][a] for a in "xyz"]
    assert f["time"] == at("t")
    assert triple("hip") == triple("position") == [at("x"), at("y"), at("z")]
    assert triple("force") == [at(f"sent_{a}") for a in "xyz"]
    assert f["state"] == [at("s0")] and f["energy"] == at("energy")
    assert len(f["centres"]) == 3 * 49
    assert abs(f["centres"][0] - math.sin(at("s0"))) < 1e-7
    assert abs(f["energy"] - (1 - math.cos(at("s0")))) < 1e-15
    touched += f["energy"] > 0
assert 2 < touched < 9
PYTHON
capnp decode "$frames" Message <x.frames | grep 'tick = 361' >/dev/null || fail "capnp decode"

# The same bytes again, through a pipe, and with the log elsewhere.
play grid --device path:path --frames - "${bare[@]}" 2>/dev/null | cmp - x.frames
play grid --device path:path --frames again --log - "${bare[@]}" 2>/dev/null | cmp - log
cmp again x.frames
# Frames go into a pipe only when they are asked for: all that play says goes into a log.
play grid --device path:path 2>&1 | cat >said
same "lines in a log" 3 "$(grep -c '^play: [[:print:]]*$' said)"
same "other lines" 0 "$(LC_ALL=C grep -acv '^play: [[:print:]]*$' said)"
# A single tick is one frame, held in the box; a force is there as it was sent.
echo '-9 0 0' >one
play grid --device path:one --frames one.frames 2>/dev/null
capnp decode --short "$frames" Message <one.frames | tail -1 >text
grep -q 'tick = 0, hip = (x = -9, y = 0, z = 0), position = (x = -0.975, y = 0, z = 0)' text ||
  fail "$(cat text)"

# A session's own rate counts: at 5 kHz the first tick from 0, 200, 400, ... on, and the last one.
for _ in 1 2; do cat path; done | play grid --device path:- --rate 5000 --log five.session 2>/dev/null
play grid --device replay:five.session --frames five.frames --log five.log 2>/dev/null
capnp convert binary:json --short "$frames" Message <five.frames >json
python3 - <<'PYTHON'
import json
frames = [json.loads(line)["frame"] for line in list(open("json"))[1:]]
ticks = [round(5000 * float(line.split("\t")[0])) for line in list(open("five.log"))[1:]]
wanted = []
for tick in ticks:
    if not wanted or tick // 200 > wanted[-1] // 200:
        wanted.append(tick)
if wanted[-1] != ticks[-1]:
    wanted.append(ticks[-1])
assert [int(f["tick"]) for f in frames] == wanted, (frames, wanted)
assert all(f["time"] == int(f["tick"]) / 5000 for f in frames)
PYTHON

# Paced: the newest tick 60 times a second, and the last one; a viewer that reads misses nothing
# that can be asserted on a machine which may stall, but it gets whole frames in their order.
head -301 path | tail -300 >short
play grid --device path:short --rate 1000 --frames - --log paced.log 2>err |
  capnp convert binary:json --short "$frames" Message >json
python3 - <<'PYTHON'
import json
times = [json.loads(line)["frame"]["time"] for line in list(open("json"))[1:]]
last = open("paced.log").readlines()[-1].split("\t")
assert times[-1] == float(last[0]), (times, last[0])
# At 0, 17, ..., at the latest with the last tick, and that one itself.
assert 1 <= len(times) <= times[-1] * 60 + 3, times
PYTHON
same "paced frames" "$(grep -c '^{"frame"' json)" \
  "$(sed -nE 's/play: frames written ([0-9]+), dropped [0-9]+/\1/p' err)"

# A viewer that dies takes nothing away from play; others, and with a pace, are in unit/play/publisher_test.cpp.
for _ in {1..100}; do cat path; done >long
(set +o pipefail; play grid --device path:long --frames - 2>err | head -c 8000 >part)
grep -q '^play: 36200 ticks, ' err || fail "$(cat err)"
same "last line" "~play: frames written [1-9][0-9]*, dropped [0-9]+; the viewer closed its end before the last one" "$(tail -n 1 err)"

# Refused.
help='(see play --help)'
expect 2 '' "play: --log and --frames cannot both be - $help" \
  -- play grid --device path:path --frames - --log -
expect 2 '' "play: --log and --frames cannot both be both $help" \
  -- play grid --device path:path --frames both --log both
for rate in '' '--rate 1000'; do
  # shellcheck disable=SC2086  # two words or none
  expect 1 '' '~(play: path at 1000 Hz; .*
)?play: /dev/full: No space left on device' -- \
    play grid --device path:one --frames /dev/full $rate
done
refuses 'play: standard output: Bad file descriptor' -- \
  bash -c 'exec play grid --device path:path --frames - >&-'
if command -v script >/dev/null; then
  same "a terminal" "play: standard output is a terminal: redirect it, or name a file after --frames" \
    "$(script -qec 'play grid --device path:path --frames -' /dev/null </dev/null | tr -d '\r')"
fi
