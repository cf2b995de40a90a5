# A model process that was allowed walks beside the grid. When it fails, the grid alone decides.
source "$(dirname "$0")/../lib.sh"

# Two branches along a line: +1 where x < 0.39, with the force of a slope of -1 N, and -1 where x > -0.39, with 1 N.
# The grid has points at 0.35 and 0.45.
cat >flip.py <<'PYTHON'
import os
import hapgrid


class Flip:
    description = {"state_size": 1, "d_max": 1.0, "tolerance": 1e-4, "length_unit": "lengths",
                   "energy_unit": "N lengths", "force_scale": 1, "stored": ["force", "energy"]}

    def known_states(self, x):
        return [[1.0]] if x[0] < -0.39 else [[-1.0]] if x[0] > 0.39 else []

    def convert(self, s, x, d):
        if os.path.exists("die"):
            os._exit(3)
        there = x[0] + d[0]
        return [1.0] if there < -0.39 else [-1.0] if there > 0.39 else s

    def force(self, s, x):
        return [-s[0], 0, 0]

    def energy(self, s, x):
        return s[0] * x[0] + 2


hapgrid.serve(Flip)
PYTHON
cat >flip.toml <<'TOML'
model = {process = ["python3", "flip.py"], name = "flip"}
grid = {origin = [-0.95, 0, 0], spacing = 0.1, counts = [20, 1, 1]}
TOML
seed flip.toml --allow-process -o seeds
expand --complete seeds --allow-process flip.toml -o grid
python3 -c 'for i in range(1801): print(-0.9 + i / 1000, 0, 0)' >path

snap() { # LOG: where the state changes its sign
  awk -F '\t' '/^#/ { next } $19 * last < 0 { print $2 } { last = $19 }' "$1"
}
played() { # NAME OPTION...
  play grid --device path:path --log "$1.log" --report "$1.json" "${@:2}" 2>"$1.err"
}
near() { # NAME LOW HIGH: the state snaps once, at a place between these
  awk -v at="$(snap "$1.log")" -v low="$2" -v high="$3" 'BEGIN { exit !(at > low && at < high) }' ||
    fail "$1: snaps at $(snap "$1.log")"
}

# The grid alone snaps in the middle of the link, to a tick of 0.001, and the model where its state does. The way is
# straight, so that a model whose answers come late looks ahead to the right place.
played alone
near alone 0.398 0.402
played beside --allow-process flip.toml
near beside 0.3895 0.3915
played late --allow-process flip.toml --beside 5
near late 0.3895 0.3925
played model --allow-process flip.toml --traversal model
near model 0.3895 0.3915
grep -q '"beside": null' alone.json || fail 'a process was asked without permission'

# A process that fails is told of, once.
touch die
played dead --allow-process flip.toml
near dead 0.398 0.402
line="play: the model beside the grid fails: process 'python3 flip.py' exited with status 3.*: from here on the grid alone"
[[ $(grep -c 'beside the grid fails' dead.err) == 1 ]] || fail "$(cat dead.err)"
grep -q "^$line decides$" dead.err || fail "$(cat dead.err)"
# So it is when the system has no room for another process.
if strace -o /dev/null true 2>/dev/null && ! sanitized; then
  strace -f -qq -o trace -e inject=pipe2:error=EMFILE:when=5+ play grid --device path:path --allow-process flip.toml 2>full.err ||
    fail "$(cat full.err)"
  grep -q "process 'python3 flip.py' cannot be started: Too many open files" full.err || fail "$(cat full.err)"
fi
rm die

# What the user asks for must be there.
why='play: model flip: is a process, which is only started with --allow-process MODEL.toml'
expect 1 '' "$why" -- play grid --device path:path --beside on
expect 1 '' "$why" -- play grid --device path:path --traversal model
sed 's/"flip"/"flop"/' flip.toml >flop.toml
expect 1 '' "play: flop.toml: defines the model flop, the grid's is flip" -- \
  play grid --device path:path --allow-process flop.toml
