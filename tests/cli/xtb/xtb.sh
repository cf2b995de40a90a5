#!/bin/bash
# examples/xtb, a model process on top of libxtb: answers do not depend on what was asked before, a
# small grid is the same in one process and in parts, verifies, and is played without the process.
source "$(dirname "$0")/../lib.sh"
example=$HAPGRID_SOURCE/examples/xtb
toml=$example/disulfane.toml

python3 -c 'import ctypes; ctypes.CDLL("libxtb.so.6")' 2>/dev/null || skip "libxtb.so.6 is missing (Debian package libxtb6)"

# Conversions with GFN2-xTB, in one order, in another, and alone: the same bits.
python3 - "$toml" <<'PYTHON' >first
import json, os, sys, tomllib
definition = tomllib.load(open(sys.argv[1], "rb"))
text = open(os.path.join(os.path.dirname(sys.argv[1]), definition["model"]["files"]["molecule"])).read()
print(json.dumps({"hapgrid": 1, "parameters": {**definition["model"]["parameters"], "molecule": text}}))
PYTHON
ask() { cat first - | (cd "$example" && python3 xtb_model.py); }
rest=$(ask <<<'{"id": 1, "op": "known_states", "x": [3.0, 3.0, 3.0]}' | sed -n '2s/.*\[\(\[.*\]\)\]}/\1/p')
[[ $rest == "["*"]" ]] || fail "no state at rest: $rest"
a='"op": "convert", "s": '$rest', "x": [0.3, 2.2, 1.8], "d": [-0.3, -0.4, 0.0]}'
b='"op": "convert", "s": '$rest', "x": [-1.75, 1.75, 1.5], "d": [0.5, -0.5, 0.5]}'
same_answers() { sed 1d "$1" | sed 's/"id": [0-9]*/"id": 0/' | sort -u; }
{ echo '{"id": 1, '"$a"; echo '{"id": 2, '"$b"; echo '{"id": 3, '"$a"; echo '{"id": 4, '"$b"; } | ask >both
echo '{"id": 5, '"$b" | ask >alone
echo '{"id": 6, '"$a" | ask >>alone.more
sed 1d alone.more >>alone
[[ $(same_answers both | wc -l) == 2 ]] || fail "an answer depends on what was asked before: $(cat both)"
cmp <(same_answers both) <(same_answers alone)
! grep -q error both || fail "$(cat both)"
# Nothing touched, nothing changed; what is evaluated is what was stored.
{
  echo '{"id": 1, "op": "convert", "s": '"$rest"', "x": [3.0, 3.0, 3.0], "d": [0.5, 0.5, 0.5]}'
  echo '{"id": 2, "op": "evaluate", "s": '"$rest"', "x": [3.5, 3.5, 3.5]}'
} | ask >far
python3 - "$rest" <<'PYTHON' <far
import json, sys
_, moved, evaluated = map(json.loads, sys.stdin)
assert moved.pop("s") == json.loads(sys.argv[1]) and moved["force"] == [0.0, 0.0, 0.0], moved
del moved["id"], evaluated["id"]
assert moved == evaluated and abs(moved["energy"]) < 1e-3, (moved, evaluated)
PYTHON

# A grid, with the force field to be quick: the S-H is turned, so that there are two states. GFN-FF
# writes to standard output and leaves files; neither is seen.
small=(--set 'model.parameters.method="gfnff"' --set 'grid.counts=[3,3,3]' --set grid.spacing=0.9
  --set 'grid.origin=[-1.4,-0.9,1.1]' --set 'seeds.points=[[-1.4,-0.9,2.9]]')
allow="--allow-process $toml"
files=$(ls -A "$example")
seed "$toml" "${small[@]}" --allow-process -o seeds
expand --complete seeds $allow -o grid
cp seeds round
while [[ $(stats --get frontier round) -gt 0 ]]; do
  expand round $allow --part 1/2 -o requests.1
  expand round $allow --part 2/2 --in-flight 1 -o requests.2
  merge round requests.2 requests.1 -o next
  mv next round
done
cmp grid round
[[ $(stats --get records grid) -gt 27 ]] || fail "no point has two levels"
same "files of the example" "$files" "$(ls -A "$example")"
expect 0 '~.*' '~verify: fine: .*' -- verify grid --recompute 10 $allow

# Played without the process: force, energy and shape are stored.
awk 'BEGIN { for (i = 0; i <= 60; ++i) print -1.4 + 0.03 * i, 0.9 - 0.03 * i, 1.6 }' >path
expect 0 '' '~play: .*' -- play grid --device path:path --log log --frames frames
[[ $(grep -vc '^#' log) == 61 && $(head -1 log) == *$'\tenergy\t'* ]] || fail "the log: $(head -c 500 log)"
same "the atoms" "$(printf 'S\nS\nH\nH')" "$(view frames --xyz - | sed -n '3,6s/ .*//p')"

# What it refuses.
refuses 'seed: model xtb: parameter method is gfn9, it must be one of gfn2, gfnff' \
  -- seed "$toml" --set 'model.parameters.method="gfn9"' --allow-process
refuses 'seed: model xtb: parameter anchor must have 4 numbers, none negative' \
  -- seed "$toml" --set 'model.parameters.anchor=[1, 2]' --allow-process
