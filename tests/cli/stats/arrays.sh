# A grid and a session as arrays: numpy and VTK read what the dump and the text log say.
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
np.savez("levels.npz", levels=np.bincount(np.ravel_multi_index(grid["point"].T[::-1], (10, 10, 20)), minlength=2000),
         state=grid["state"][:, 0], point=grid["point"], level=grid["level"], force=grid["force"])
PYTHON

# ParaView's library reads the image and draws it.
stats grid --vti grid.vti
stats grid --vti one.vti --level 1
# Two branches: a record each at points with two levels, and NaN at the others.
same 'branch 0' '~branch 0 of [0-9]+: [0-9]+ records; the largest: .*' "$(stats grid --vti branch0.vti --branch 0)"
read -r _ _ _ count _ <<<"$(stats grid --vti branch1.vti --branch 1)"
count=${count%:}
refuses "stats: --branch $count: this grid has the branches 0 to $((count - 1))" -- stats grid --vti x.vti --branch "$count"
expect 2 '' '~stats: --branch needs --vti .*' -- stats grid --branch 0
LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a /usr/bin/python3 - <<'PYTHON'
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy
known = np.load("levels.npz")
for name, level in ("grid.vti", 0), ("one.vti", 1):
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions() == (20, 10, 10) and image.GetSpacing() == (0.1,) * 3
    data = image.GetPointData()
    assert (vtk_to_numpy(data.GetArray("levels")) == known["levels"]).all()
    state = vtk_to_numpy(data.GetArray("state")).reshape(10, 10, 20)
    here = known["level"] == level
    i, j, k = known["point"][here].T
    assert (state[k, j, i] == known["state"][here]).all() and np.isnan(state).sum() == 2000 - here.sum()
    force = vtk_to_numpy(data.GetArray("force")).reshape(10, 10, 20, 3)
    assert (force[k, j, i] == known["force"][here]).all()
# A branch is grown from its smallest record over two-way links, a record a point.
grid = np.load("grid.npz")
to, point = grid["destination"], np.ravel_multi_index(grid["point"].T[::-1], (10, 10, 20))
branch, sizes = np.full(len(to), -1), []
for seed in range(len(to)):
    if branch[seed] >= 0:
        continue
    members, points = [seed], {point[seed]}
    branch[seed] = len(sizes)
    for r in members:
        for q, there in enumerate(to[r]):
            if there >= 0 and branch[there] < 0 and point[there] not in points and to[there][25 - q] == r:
                branch[there] = len(sizes)
                points.add(point[there])
                members.append(there)
    sizes.append(len(members))
for n in 0, 1:
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(f"branch{n}.vti")
    reader.Update()
    shown = reader.GetOutput().GetPointData()
    here = branch == n
    assert here.sum() == sizes[n] == len(set(point[here]))
    for name in "state", "force", "energy":
        values = vtk_to_numpy(shown.GetArray(name)).reshape(2000, -1)
        assert (values[point[here]] == grid[name][here].reshape(sizes[n], -1)).all(), name
        assert np.isnan(values).any(axis=1).sum() == 2000 - sizes[n], name
mapper, actor, renderer, window = vtk.vtkDataSetMapper(), vtk.vtkActor(), vtk.vtkRenderer(), vtk.vtkRenderWindow()
mapper.SetInputData(image)
data.SetActiveScalars("levels")
mapper.SetScalarRange(1, 2)
actor.SetMapper(mapper)
renderer.AddActor(actor)
window.SetOffScreenRendering(1)
window.SetSize(200, 150)
window.AddRenderer(renderer)
window.Render()
shot = vtk.vtkWindowToImageFilter()
shot.SetInput(window)
shot.Update()
colours = np.unique(vtk_to_numpy(shot.GetOutput().GetPointData().GetScalars()), axis=0)
assert len(colours) > 10, colours  # one and two levels, and what is between
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
