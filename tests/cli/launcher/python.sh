# The Python module: serve() answers for a model as the protocol says, whatever the model prints, and read() has what
# the dump and the text of a session say.
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
  'nan: Out of range float values are not JSON compliant'; do
  define "fault = \"${fault%%: *}\"" >faulty.toml
  expect 1 '' "~(before serve"$'\n'"|converting"$'\n'"|from beneath"$'\n'")*expand: $conversion: ${fault#*: }" -- \
    bash -c 'seed faulty.toml --allow-process -o faulty.seeds 2>/dev/null && exec expand --complete faulty.seeds --allow-process faulty.toml'
done
define 'fault = "refused"' >faulty.toml
expect 1 '' $'before serve\nseed: model chatty: no fault is refused' -- seed faulty.toml --allow-process
define 'falt = 1' >faulty.toml
expect 1 '' "~before serve"$'\n'"seed: model chatty: TypeError: .*unexpected keyword argument 'falt' .*" -- \
  seed faulty.toml --allow-process
# A module of that name that PYTHONPATH has comes first.
mkdir mine
echo 'raise SystemExit(5)' >mine/hapgrid.py
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
  refuses "hapgrid\.py: a question is not understood: $why" -- \
    env PYTHONPATH="$python" /usr/bin/python3 "$model" <<<"$line"
  expect 1 '~\{"hapgrid": 1.*\}' "~hapgrid\.py: a question is not understood: $why" -- \
    env PYTHONPATH="$python" /usr/bin/python3 "$model" <<<"$hello"$'\n'"$line"
done

# What read() gives is what the dump and the text of a session say.
stats grid --dump >dump
printf '%s\n' '-0.5 0.5 0.5' '0.5 0.5 0.5' >path
play grid --device path:path --log a.session 2>/dev/null
stats --log a.session --export text
head -c 200 grid >cut
head -c -20 a.session >cut.session
touch empty
PYTHONPATH=$python /usr/bin/python3 - <<'PYTHON'
import pathlib
import hapgrid
import numpy as np

grid = hapgrid.read("grid")
dump = np.array([line.split("\t")[:6] for line in open("dump") if line[0] != "#"], float)
assert len(dump) >= 12
assert (grid["point"] == dump[:, :3]).all() and (grid["level"] == dump[:, 3]).all()
assert (grid["state"] == dump[:, 4:]).all()
# In closed form: the state is half of where the HIP is, and the force leads back from it.
assert (grid["state"] == (grid["origin"] + grid["spacing"] * grid["point"])[:, :2] / 2).all()
assert (grid["force"] == np.column_stack([-grid["state"], np.full(len(dump), 0.5)])).all()
ticks, text = hapgrid.read(pathlib.Path("a.session"))["ticks"], np.loadtxt("text")
assert len(ticks) == len(text) == 2 and (ticks["t"] == text[:, 0]).all() and (ticks["hip"] == text[:, 1:4]).all()
for name, error, words in (("gone", FileNotFoundError, "gone"), ("cut", ValueError, "cut: stats: "), ("empty", ValueError, "empty: stats: "),
                           ("cut.session", ValueError, "a session without a tick, which ended early"), ("dump", ValueError, "dump: stats: ")):
    try:
        hapgrid.read(name)
    except error as why:
        assert words in str(why) and "\n" not in str(why), why
    else:
        raise AssertionError(name)
PYTHON
