# examples/xtb, a model process that uses libxtb: answers do not depend on earlier questions, and a small
# grid is the same from one process and in rounds, verifies, and is played without the process.
source "$(dirname "$0")/../lib.sh"
example=$HAPGRID_SOURCE/examples/xtb
toml=$example/disulfane.toml

python3 -c 'import ctypes; ctypes.CDLL("libxtb.so.6")' 2>/dev/null || { missing libxtb6; exit 77; }

# Conversions with GFN2-xTB have the same bits in one order, in another, and alone. Where nothing is
# touched nothing changes, and what is evaluated is what was stored.
(cd "$example" && PYTHONPATH=$HAPGRID_BIN/../python python3 - "$toml") <<'PYTHON'
import json, subprocess, sys, tomllib
with open(sys.argv[1], "rb") as file:
    model = tomllib.load(file)["model"]
with open(model["files"]["molecule"]) as file:
    hello = {"hapgrid": 1, "parameters": {**model["parameters"], "molecule": file.read()}}


def ask(*questions):
    """The answers of a process of its own, without their ids."""
    lines = [hello, *({"id": n, **q} for n, q in enumerate(questions))]
    out = subprocess.run(["python3", "xtb_model.py"], input="".join(json.dumps(q) + "\n" for q in lines),
                         capture_output=True, text=True, check=True).stdout.splitlines()[1:]
    answers = [json.loads(line) for line in out]
    assert [a.pop("id") for a in answers] == list(range(len(questions))), answers
    assert not any("error" in a for a in answers), answers
    return answers


[[rest]] = (a["states"] for a in ask({"op": "known_states", "x": [3.0, 3.0, 3.0]}))
a, b, away = ({"op": "convert", "s": rest, "x": x, "d": d} for x, d in (
    ([0.3, 2.2, 1.8], [-0.3, -0.4, 0.0]), ([-1.75, 1.75, 1.5], [0.5, -0.5, 0.5]),
    ([3.0, 3.0, 3.0], [0.5, 0.5, 0.5])))
one, other, again, once_more = ask(a, b, a, b)
assert one == again == ask(a)[0] and other == once_more == ask(b)[0] and one != other, (one, other)
moved, evaluated = ask(away, {"op": "evaluate", "s": rest, "x": [3.5, 3.5, 3.5]})
assert moved.pop("s") == rest and moved["force"] == [0.0, 0.0, 0.0], moved
assert moved == evaluated and abs(moved["energy"]) < 1e-3, (moved, evaluated)
PYTHON

# A grid, with the force field because it is quick. The S-H group is turned, so that there are two states.
# GFN-FF writes to standard output and leaves files; neither may be seen.
small=(--set 'model.parameters.method="gfnff"' --set 'grid.counts=[3,3,3]' --set grid.spacing=0.9
  --set 'grid.origin=[-1.4,-0.9,1.1]' --set 'seeds.points=[[-1.4,-0.9,2.9]]')
allow="--allow-process $toml"
files=$(ls -A "$example")
seed "$toml" "${small[@]}" --allow-process -o seeds
expand --complete seeds $allow -o grid
rounds seeds round $allow
cmp grid round
[[ $(stats --get records grid) -gt 27 ]] || fail "no point has two levels"
same "files of the example" "$files" "$(ls -A "$example")"
expect 0 '~.*' '~verify: fine: .*' -- verify grid --recompute 10 $allow

# The grid is played without the process: force, energy and shape are stored.
awk 'BEGIN { for (i = 0; i <= 60; ++i) print -1.4 + 0.03 * i, 0.9 - 0.03 * i, 1.6 }' >path
expect 0 '' '~play: .*' -- play grid --device path:path --log log --frames frames
[[ $(grep -vc '^#' log) == 61 && $(head -1 log) == *$'\tenergy\tsnap' ]] || fail "the log: $(head -c 500 log)"
same "the atoms" "$(printf 'S\nS\nH\nH')" "$(view frames --xyz - | sed -n '3,6s/ .*//p')"

# Parameters that are refused.
refuses 'seed: model xtb: parameter method is gfn9, it must be one of gfn2, gfnff' \
  -- seed "$toml" --set 'model.parameters.method="gfn9"' --allow-process
refuses 'seed: model xtb: parameter anchor must have 4 numbers, none negative' \
  -- seed "$toml" --set 'model.parameters.anchor=[1, 2]' --allow-process
