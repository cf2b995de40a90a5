# A grid and a session as arrays: numpy reads what the dump and the text log say.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' --set model.parameters.stored=true |
  expand --complete -o grid
stats grid --dump >dump
stats grid --npz grid.npz
stats --npz - <grid | cmp - grid.npz
/usr/bin/python3 - <<'PYTHON'
import numpy as np
with open("dump") as file:
    names = file.readline()[2:].split()
lines = [line.rstrip("\n").split("\t") for line in open("dump")][1:]
grid = np.load("grid.npz")
assert sorted(grid) == sorted(["point", "level", "generation", "state", "destination", "force", "energy", "shape",
                               "tear", "origin", "spacing", "counts"]), sorted(grid)
n = len(lines)
assert names[:5] == ["i", "j", "k", "level", "s0"] and len(names) == len(lines[0]) == 31, names
assert (grid["point"] == [[int(c) for c in line[:3]] for line in lines]).all()
assert (grid["level"] == [int(line[3]) for line in lines]).all()
assert (grid["state"] == [[float(line[4])] for line in lines]).all()
# A destination is the record at that point with that level.
record = {(*map(int, line[:4]),): r for r, line in enumerate(lines)}
steps = [(x, y, z) for z in (-1, 0, 1) for y in (-1, 0, 1) for x in (-1, 0, 1) if (x, y, z) != (0, 0, 0)]
for line, to in zip(lines, grid["destination"]):
    i, j, k = map(int, line[:3])
    for (dx, dy, dz), level, r in zip(steps, line[5:], to):
        assert r == (-1 if level == "-" else record[i + dx, j + dy, k + dz, int(level)]), (line, r)
assert grid["force"].shape == (n, 3) and grid["energy"].shape == (n,) and grid["shape"].shape[::2] == (n, 3)
assert grid["spacing"] == 0.1 and list(grid["counts"]) == [20, 10, 10]
assert (grid["tear"] < 32).any() and grid["tear"].max() == 255
PYTHON

# A session's ticks.
printf '%s\n' '-0.7 0.1 0' '-0.5 0.1 0.1' '-0.3 0.1 0.1' >path
play grid --device path:path --log a.session 2>/dev/null
stats --log a.session --export text
stats --log a.session --npz ticks.npz
/usr/bin/python3 - <<'PYTHON'
import numpy as np
ticks = np.load("ticks.npz")["ticks"]
text = np.loadtxt("text")
columns = ["t", "hip", "force", "sent", "levels", "flags", "lateness_us", "compute_us"]
assert list(ticks.dtype.names) == columns, ticks.dtype
assert np.array_equal(np.column_stack([ticks[name] for name in columns]), text, equal_nan=True)
PYTHON

see='\(see stats --help\)'
expect 2 '' "~stats: --get, --dump, .* exclude each other $see" -- stats grid --npz a --vti b
expect 2 '' "~stats: --level: .*" -- stats grid --vti a --level 255
refuses 'stats: .*No space left on device' -- stats grid --npz /dev/full
refuses 'stats: .*No space left on device' -- stats grid --vti /dev/full
head -c 300 grid >cut
refuses 'stats: cut: .*' -- stats cut --npz cut.npz
[[ ! -e cut.npz && ! -e a && ! -e b ]] || fail "a file was left"
