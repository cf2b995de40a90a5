# The Python module: read() gives grids, sessions, logs and frames, and search() makes a grid.
source "$(dirname "$0")/../lib.sh"
python=$(realpath "$HAPGRID_BIN/../python")

cat >half.py <<'PYTHON'
import types
import hapgrid
import numpy as np

hapgrid.serve(lambda: types.SimpleNamespace(
    description={"state_size": 2, "d_max": 2, "tolerance": 1e-6, "force_scale": 1, "spheres": [{"radius": 0.1}] * 2},
    convert=lambda s, x, d: (np.array(x) + d)[:2] / 2, known_states=lambda x: [np.array(x[:2]) / 2],
    force=lambda s, x: [-s[0], -s[1], np.float32(0.5)], energy=lambda s, x: s[0]**2 + s[1]**2 - x[2] / 2,
    shape=lambda s, x: [*s, 0, *x]))
PYTHON
cat >half.toml <<'TOML'
model = {process = ["/usr/bin/python3", "half.py"], name = "half"}
grid = {origin = [-1, 0, 0], spacing = 1, counts = [3, 2, 2]}
TOML
seed half.toml --allow-process | expand --complete --allow-process half.toml -o grid

# What read() gives is what the closed form and the log say. stats/arrays.sh has the arrays of stats.
printf '%s\n' '-0.5 0.5 0.5' '0.5 0.5 0.5' >path
play grid --device path:path --log a.session --frames a.frames 2>/dev/null
play grid --device path:path --log a.log 2>/dev/null
head -c 200 grid >cut
head -c -20 a.session >cut.session
touch empty
(cat a.frames; head -c 100 /dev/zero | tr '\0' '\377') >cut.frames  # no message begins so
sed '2s/\t/\tx/' a.log >bad.log
PYTHONPATH=$python /usr/bin/python3 - <<'PYTHON'
import pathlib
import hapgrid
import numpy as np

grid = hapgrid.read("grid")
assert "12 records with point, level, " in repr(grid), grid
# The state is half of where the HIP is, and the force leads back from it.
assert {tuple(p) for p in grid["point"]} == set(np.ndindex(3, 2, 2)) and (grid["level"] == 0).all()
assert (grid["state"] == (grid["origin"] + grid["spacing"] * grid["point"])[:, :2] / 2).all()
assert (grid["force"] == np.column_stack([-grid["state"], np.full(12, 0.5)])).all()
ticks = hapgrid.read(pathlib.Path("a.session"))["ticks"]
text, log = np.loadtxt("a.log"), hapgrid.read("a.log")["ticks"]
again = hapgrid.read("a.session", grid="grid")["ticks"]
assert len(ticks) == len(text) == 2 and (ticks["t"] == text[:, 0]).all() and (ticks["hip"] == text[:, 1:4]).all()
assert log.dtype.names == ("t", "hip", "force", "sent", "levels", "state", "energy", "snap")
for got in log, again:
    assert (got["t"] == text[:, 0]).all() and (got["hip"] == text[:, 1:4]).all() and (got["force"] == text[:, 4:7]).all()
    assert (got["sent"] == text[:, 7:10]).all() and (got["levels"] == text[:, 10:18]).all()
    assert (got["state"] == text[:, 18:20]).all() and (got["energy"] == text[:, 20]).all()
frames = hapgrid.read("a.frames")["frames"]
assert len(frames) >= 1 and (frames["hip"][-1] == [0.5, 0.5, 0.5]).all() and (frames["position"] == frames["hip"]).all()
last = frames[-1]
assert (last["state"] == log["state"][-1]).all() and last["energy"] == log["energy"][-1] and last["tick"] == len(log) - 1
assert last["shape"].shape == (2, 3) and np.isnan(last["own_energy"]) and np.isnan(last["hand"]).all() and (last["sent"] == log["sent"][-1]).all()
assert np.abs(last["shape"] - [[*last["state"], 0], last["hip"]]).max() < 1e-6  # floats below 1
for name, error, words in (("gone", FileNotFoundError, "gone"), ("cut", ValueError, "cut: stats: "), ("empty", ValueError, "empty: stats: "),
                           ("cut.session", ValueError, "a session without a tick, which ended early"), ("path", ValueError, "path: stats: "),
                           ("cut.frames", ValueError, "cut.frames: damaged frames"), ("bad.log", ValueError, "bad.log: not a log of play")):
    try:
        hapgrid.read(name)
    except error as why:
        assert words in str(why) and "\n" not in str(why), why
    else:
        raise AssertionError(name)
PYTHON

# search() leaves the bytes of the filters, shows progress on a terminal alone, and says what a filter said.
PYTHONPATH=$python /usr/bin/python3 - >said 2>&1 <<'PYTHON'
import hapgrid

assert hapgrid.search("half.toml", allow_process=True) == "half.grid"
assert len(hapgrid.read(hapgrid.search("half.toml", "finer.grid", allow_process=True, processors=2,
                                       set={"grid.spacing": 0.5, "grid.counts": [5, 3, 3]}))["level"]) == 45
for arguments, words in (({}, "give search() allow_process=True"), ({"allow_process": True, "set": {"search.max_levels": 0}}, "max_levels"),
                         ({"allow_process": True, "output": "/dev/null/x"}, "/dev/null/x")):
    try:
        hapgrid.search("half.toml", **arguments)
    except RuntimeError as why:
        assert words in str(why), why
    else:
        raise AssertionError(arguments)
PYTHON
same 'what search() shows' '' "$(cat said)"
cmp grid half.grid
# A notebook's cell shows one line, which is replaced; in place of Jupyter's kernel stands what search() calls of it.
PYTHONPATH=$python /usr/bin/python3 - <<'PYTHON'
import re
import sys
import types
import hapgrid

shown = []
handle = types.SimpleNamespace(update=lambda data, raw: shown.append(data["text/plain"]))
sys.modules["ipykernel"] = types.ModuleType("ipykernel")
sys.modules["IPython"] = types.ModuleType("IPython")
sys.modules["IPython.display"] = types.SimpleNamespace(display=lambda data, raw, display_id: handle)
hapgrid.search("half.toml", "cell.grid", allow_process=True)
bar = r"\[(#* *)\] .*[0-9] of [0-9].*(conversions|one-way links).*"
assert shown[-1] == f"[{'#' * 30}] done" and all(len(re.fullmatch(bar, line)[1]) == 30 for line in shown[:-1]), shown
seen = len(shown)
try:
    hapgrid.search("half.toml", "/dev/null/x", allow_process=True)
except RuntimeError:
    pass
assert not any("done" in line for line in shown[seen:]), shown[seen:]
PYTHON
cmp grid cell.grid

# A plug-in of one's own is found in the folder that HAPGRID_MODEL_PATH names, and nowhere else.
mkdir -p own/plugins
cp "$HAPGRID_BIN/../models/hung-ball.so" own/plugins/own.so
sed 's/"hung-ball"/"own"/; s/^spacing = .*/spacing = 0.1/; s/^counts = .*/counts = [20, 10, 10]/' "$ball" >own/own.toml
PYTHONPATH=$python /usr/bin/python3 - <<'PYTHON'
import os

import hapgrid
try:
    hapgrid.search("own/own.toml")
    raise SystemExit("it was found")
except RuntimeError as why:
    assert "no plug-in own.so" in str(why), why
os.environ["HAPGRID_MODEL_PATH"] = "own/plugins"
hapgrid.search("own/own.toml")
PYTHON
echo '0.1 0 0' | HAPGRID_MODEL_PATH=own/plugins play own/own.grid --device path:- --log own/a.session 2>said
if /usr/bin/python3 -c 'import matplotlib' 2>/dev/null; then
  expect 1 '' '~plot: own/a.session: play: model own: no plug-in own.so .*' -- plot session own/a.session --grid own/own.grid -o own/a.png
  HAPGRID_MODEL_PATH=own/plugins expect 0 '' '' -- plot session own/a.session --grid own/own.grid -o own/a.png
else
  missing python3-matplotlib
fi
