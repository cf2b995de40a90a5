# A grid and a session as arrays, and a grid as an image for ParaView: numpy reads what the dump and the text log say.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' --set model.parameters.stored=true |
  expand --complete -o grid
dump grid >dump
stats grid --npy grid.npy
stats --npy - <grid | cmp - grid.npy
/usr/bin/python3 - <<'PYTHON'
import numpy as np
with open("dump") as file:
    names = file.readline()[2:].split()
lines = [line.rstrip("\n").split("\t") for line in open("dump")][1:]
grid = np.load("grid.npy")
assert grid.dtype.names == ("point", "level", "generation", "destination", "state", "force", "energy", "shape")
assert grid.flags.c_contiguous and grid.dtype.isnative
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
PYTHON

# A session's ticks.
printf '%s\n' '-0.7 0.1 0' '-0.5 0.1 0.1' '-0.3 0.1 0.1' >path
play grid --device path:path --log a.session --frames a.frames 2>/dev/null
python3 "$here/session.py" text a.session >text
stats a.session --npy ticks.npy
/usr/bin/python3 - <<'PYTHON'
import numpy as np
ticks = np.load("ticks.npy")
text = np.loadtxt("text")
columns = ["t", "hip", "force", "sent", "levels", "flags", "lateness_us", "compute_us"]
assert list(ticks.dtype.names) == columns, ticks.dtype
assert np.array_equal(np.column_stack([ticks[name] for name in columns]), text, equal_nan=True)
PYTHON

see='\(see stats --help\)'
expect 2 "" "~stats: --(get|npy) excludes --(get|npy) $see" -- stats grid --npy a --get records
refuses 'stats: .*No space left on device' -- stats grid --npy /dev/full
head -c 300 grid >cut
refuses 'stats: cut: .*' -- stats cut --npy cut.npy
[[ ! -e cut.npy && ! -e a ]] || fail "a file was left"

# Frames, whose numbers are in tests/python/test_read.py.
stats a.frames --npy frames.npy
stats --npy - <a.frames | cmp - frames.npy
refuses 'stats: a\.frames: are frames, which view shows; --npy makes an array of them' -- stats a.frames

# An image for ParaView: its library reads it.
/usr/bin/python3 -c 'import vtk' 2>/dev/null || { missing python3-vtk9; exit 0; }
PYTHONPATH=$(realpath "$HAPGRID_BIN/../python") /usr/bin/python3 - <<'PYTHON'
import hapgrid
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy
known = np.load("grid.npy")
levels = np.bincount(np.ravel_multi_index(known["point"].T[::-1], (10, 10, 20)), minlength=2000)
for level in 0, 1:
    hapgrid.write_vti("grid", "grid.vti", level)
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName("grid.vti")
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions() == (20, 10, 10) and image.GetSpacing() == (0.1,) * 3
    texts, data = image.GetFieldData(), image.GetPointData()
    assert texts.GetAbstractArray("model").GetValue(0) == hapgrid.read("grid").known["model"]
    assert [data.GetArray("force").GetComponentName(a) for a in range(3)] == ["x", "y", "z"]
    assert (vtk_to_numpy(data.GetArray("levels")) == levels).all()
    here = known["level"] == level
    i, j, k = known["point"][here].T
    for name in "state", "force", "energy":
        values = vtk_to_numpy(data.GetArray(name)).reshape(10, 10, 20, -1)
        assert (values[k, j, i] == known[name][here].reshape(here.sum(), -1)).all(), name
        assert np.isnan(values).any(axis=3).sum() == 2000 - here.sum(), name
PYTHON
