# A grid as an image for ParaView: its library reads it.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' --set model.parameters.stored=true |
  expand --complete -o grid
stats grid --npz grid.npz

stats grid --vti grid.vti
stats grid --vti one.vti --level 1
# Two branches: a record each at points with two levels, and NaN at the others.
same 'branch 0' '~branch 0 of [0-9]+: [0-9]+ records; the largest: .*' "$(stats grid --vti branch0.vti --branch 0)"
read -r _ _ _ count _ <<<"$(stats grid --vti branch1.vti --branch 1)"
count=${count%:}
refuses "stats: --branch $count: this grid has the branches 0 to $((count - 1))" -- stats grid --vti x.vti --branch "$count"
expect 2 '' '~stats: --branch needs --vti .*' -- stats grid --branch 0
needs_python vtk python3-vtk9
/usr/bin/python3 - <<'PYTHON'
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy
known = np.load("grid.npz")
levels = np.bincount(np.ravel_multi_index(known["point"].T[::-1], (10, 10, 20)), minlength=2000)
for name, level in ("grid.vti", 0), ("one.vti", 1):
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions() == (20, 10, 10) and image.GetSpacing() == (0.1,) * 3
    data = image.GetPointData()
    assert (vtk_to_numpy(data.GetArray("levels")) == levels).all()
    state = vtk_to_numpy(data.GetArray("state")).reshape(10, 10, 20)
    here = known["level"] == level
    i, j, k = known["point"][here].T
    assert (state[k, j, i] == known["state"][here][:, 0]).all() and np.isnan(state).sum() == 2000 - here.sum()
    force = vtk_to_numpy(data.GetArray("force")).reshape(10, 10, 20, 3)
    assert (force[k, j, i] == known["force"][here]).all()
# A branch is grown from its smallest record over two-way links, a record a point.
grid = known
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
PYTHON
