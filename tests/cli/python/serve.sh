# The Python module: serve() answers for a model as the protocol says, whatever the model prints and returns.
source "$(dirname "$0")/../lib.sh"
python=$(realpath "$HAPGRID_BIN/../python")

# A model of functions and arrays of numpy that prints, in Python and beneath it, and starts what reads its input.
cat >chatty.py <<'PYTHON'
import os
import subprocess
import types
import hapgrid
import numpy as np

print("before serve")


def chatty(fault=""):
    def convert(s, x, d):
        print("converting")
        os.write(1, b"from beneath\n")
        assert subprocess.run(["cat"], capture_output=True, check=True).stdout == b""
        if fault == "key" and x[0] > 0:
            {}["gone"]
        if fault == "said" and x[0] > 0:
            raise ValueError("nothing is known\nbeyond 0")
        if fault == "nan" and x[0] > 0:
            return np.array([np.nan, 0])
        return (np.array(x) + d)[:2] / 2

    def known_states(x):
        return [np.array(x[:2]) / 2]

    if fault == "refused":
        raise ValueError("no fault is refused")
    return types.SimpleNamespace(
        description={"state_size": 2, "d_max": 2, "tolerance": 1e-6}, convert=convert, known_states=known_states,
        force=lambda s, x: [-s[0], -s[1], np.float32(0.5)])


hapgrid.serve(chatty)
PYTHON
define() {
  cat <<TOML
model = {process = ["/usr/bin/python3", "chatty.py"], name = "chatty", parameters = {${1-}}}
grid = {origin = [-1, 0, 0], spacing = 1, counts = [3, 2, 2]}
TOML
}
define >chatty.toml
unset PYTHONPATH PYTHONUNBUFFERED
seed chatty.toml --allow-process 2>/dev/null >seeds
expand --complete seeds --allow-process chatty.toml -o grid 2>said
for words in 'before serve' converting 'from beneath'; do grep -qx "$words" said || fail "not said: $words"; done

# With a fault at the questions beyond x = 0, the search ends in its line.
conversion='conversion at point [0-9]+ \([0-9], [0-9], [0-9]\) level 0, direction [0-9]+'
for fault in "said: nothing is known.*beyond 0" "key: KeyError: 'gone' \(chatty\.py, line 16\)" \
  'nan: convert\(\) returned \[nan, 0\.0\]'; do
  define "fault = \"${fault%%: *}\"" >faulty.toml
  expect 1 '' "~(before serve"$'\n'"|converting"$'\n'"|from beneath"$'\n'")*expand: $conversion: ${fault#*: }" -- \
    bash -c 'seed faulty.toml --allow-process -o faulty.seeds 2>/dev/null && exec expand --complete faulty.seeds --allow-process faulty.toml'
done
define 'fault = "refused"' >faulty.toml
expect 1 '' $'before serve\nseed: model chatty: no fault is refused' -- seed faulty.toml --allow-process
define 'falt = 1' >faulty.toml
expect 1 '' $'before serve\nseed: model chatty: unknown parameter falt (known: fault)' -- \
  seed faulty.toml --allow-process
# A module of that name that PYTHONPATH has comes first.
mkdir mine
echo 'raise SystemExit(5)' >mine/hapgrid.py  # a module there hides the package
expect 1 '' '~seed: .*exited with status 5.*' -- env PYTHONPATH="$PWD/mine" "$HAPGRID_BIN/seed" chatty.toml --allow-process

# Lines that hapgrid would not write: serve() ends with one line.
model=$HAPGRID_SOURCE/examples/hung-ball/hung_ball.py
deep=$(head -c 100000 /dev/zero | tr '\0' '[')
hello='{"hapgrid": 1, "parameters": {}}'
for line in "$deep" '{' '[1]' '"x"' '{"x": 1}'; do
  case $line in
    '[['*) why='it is nested too deep' ;;
    '{') why='it is no JSON: .*' ;;
    *) why='it must be an object with .*' ;;
  esac
  refuses "hapgrid: a question is not understood: $why" -- \
    env PYTHONPATH="$python" /usr/bin/python3 "$model" <<<"$line"
  expect 1 '~\{"hapgrid": 1.*\}' "~hapgrid: a question is not understood: $why" -- \
    env PYTHONPATH="$python" /usr/bin/python3 "$model" <<<"$hello"$'\n'"$line"
done

# What a function returned wrongly is named. Each fault is of the model below, at the questions that its definition asks.
cat >wrong.py <<'PYTHON'
import types
import hapgrid
import numpy as np

FAULTS = {
    "scalar": ("convert", lambda s, x, d: 0.5),
    "nothing": ("convert", lambda s, x, d: None),
    "nan": ("energy", lambda s, x: float("nan")),
    "one of three": ("force", lambda s, x: [0.0, np.nan, 1.0]),
    "short": ("shape", lambda s, x: np.zeros((1, 3))),
    "text": ("energy", lambda s, x: "1 eV"),
    "flat": ("known_states", lambda x: [0.0, 0.0]),
    "unset": ("convert", lambda s, x, d: {"state": s}),
}


def wrong(fault, atoms: int, names=("a", "b"), sizes=(1.0, 2.0), **more):
    assert isinstance(atoms, int) and isinstance(sizes[0], float) and more == {"probe.radius": 2, "many": [1, 2]}, (atoms, sizes, more)
    model = types.SimpleNamespace(
        description={"state_size": 2, "d_max": 2, "tolerance": 1e-6, "force_scale": 1,
                     "spheres": [{"radius": 1}, {"radius": 1}]},
        convert=lambda s, x, d: list(s), known_states=lambda x: [[0, 0]], force=lambda s, x: [0, 0, 0],
        energy=lambda s, x: np.zeros(1), shape=lambda s, x: np.zeros((2, 3)))
    if fault in FAULTS:
        setattr(model, *FAULTS[fault])
    if fault == "lost":
        del model.convert
    if fault == "stored":
        model.description["stored"] = ["force", "energy", "shape"]
        del model.energy
    return model


hapgrid.serve(wrong)
PYTHON
define_wrong() {
  cat >wrong.toml <<TOML
model.process = ["/usr/bin/python3", "wrong.py"]
model.name = "wrong"
model.parameters = {fault = "$1", ${2-atoms = 3,} sizes = [1, 2], many = [1, 2], probe.radius = 2}
grid = {origin = [0, 0, 0], spacing = 1, counts = [2, 2, 2]}
TOML
}
while IFS=: read -r fault words; do
  define_wrong "$fault"
  (seed wrong.toml --allow-process | expand --complete --allow-process wrong.toml) >/dev/null 2>said && fail "$fault is taken"
  grep -qF ": $words" said || fail "$fault: $(cat said)"
done <<'FAULTS'
scalar:convert() must return 2 numbers, it returned 0.5
nothing:convert() must return 2 numbers, it returned None
nan:energy() returned nan
one of three:force() returned [0.0, nan, 1.0]
short:shape() must return 6 numbers, it returned [[0.0, 0.0, 0.0]]
text:energy() must return 1 number, it returned '1 eV'
flat:known_states() must return states of 2 numbers, it returned 0.0
unset:convert() returned a dict without "s"
lost:the model has no function convert(s, x, d)
stored:"stored" names 'energy', but the model has no function energy(s, x)
FAULTS
define_wrong none
seed wrong.toml --allow-process | expand --complete --allow-process wrong.toml -o right.grid
define_wrong none ''
refuses 'seed: model wrong: the definition lacks the parameter atoms' -- seed wrong.toml --allow-process

# convert_many(): the same bytes as one question at a time, and 26 questions in a call.
cat >many.py <<'PYTHON'
import sys
import hapgrid
import numpy as np


class Many:
    description = {"state_size": 3, "d_max": 3, "tolerance": 1e-9}

    def __init__(self, at_once=0):
        self.largest = 0
        if at_once:
            self.convert_many = self.rows
        else:
            self.convert = lambda s, x, d: self.rows(*(np.array([a]) for a in (s, x, d)))["s"][0]
            self.force = lambda s, x: -np.array(s)

    def rows(self, s, x, d):
        assert s.shape == x.shape == d.shape and s.shape[1] == 3
        if len(s) > self.largest:
            self.largest = len(s)
            print("rows", len(s), file=sys.stderr)
        reached = np.tanh(x + d)
        return {"s": reached, "force": -reached}

    def force(self, s, x):
        return -np.array(s)

    def known_states(self, x):
        return [np.tanh(x)]


hapgrid.serve(Many)
PYTHON
for at_once in 0 1; do
  cat >many.toml <<TOML
model = {process = ["/usr/bin/python3", "many.py"], name = "many", parameters = {at_once = $at_once}}
grid = {origin = [-1, -1, -1], spacing = 0.5, counts = [5, 5, 5]}
TOML
  seed many.toml --allow-process | expand --complete --allow-process many.toml -o many.grid 2>said
  dump many.grid >"dump.$at_once"
done
cmp dump.0 dump.1
same 'rows of a call' 'rows 32' "$(grep rows said)"

# A matrix product rounds a row otherwise when there are more or fewer beside it; the grid is the same in all ways.
cat >product.py <<'PYTHON'
import hapgrid
import numpy as np


class Product:
    description = {"state_size": 40, "d_max": 2, "tolerance": 1e-6}
    a, b = (np.random.default_rng(1).normal(size=shape) for shape in ((40, 40), (3, 40)))
    a = a @ a.T / 40 + np.eye(40)

    def rest(self, s, x):
        for _ in range(50):
            s = s - 0.2 * (s @ self.a - x @ self.b)
        return s

    def convert_many(self, s, x, d):
        return self.rest(0 * s, x + d)

    def known_states(self, x):
        return [self.rest(np.zeros((1, 40)), np.array([x]))[0]]


hapgrid.serve(Product)
PYTHON
sed 's/many/product/g; s/, parameters = {.*}}/}/; s/5, 5, 5/3, 3, 3/' many.toml >product.toml
seed product.toml --allow-process -o product.seeds
expand --complete product.seeds --allow-process product.toml -o product.grid
for threads in 2 4; do expand --complete product.seeds --allow-process product.toml -j $threads | cmp - product.grid; done
for in_flight in 1 7; do
  sed -i -E "s/\"state_size\": 40/&, \"in_flight\": $in_flight/" product.py
  expand --complete product.seeds --allow-process product.toml | cmp - product.grid
done
