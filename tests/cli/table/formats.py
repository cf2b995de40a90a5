"""What a grid of `hapgrid table` stores, against readers and splines that are not ours.

formats.py images            writes plain.vti, packed.vti, text.vti, raw.vti (by VTK) and sheared.dx
formats.py compare FILE DIR  compares DIR/DIR.grid, which stores energy and force, with FILE
"""

import os
import sys
import tomllib

import numpy as np

sys.path.insert(0, os.path.join(os.environ["HAPGRID_BIN"], "..", "python"))
import hapgrid  # noqa: E402


def images():
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter
    image = vtkImageData()
    image.SetExtent(2, 12, 0, 9, -3, 5)
    image.SetOrigin(-1, 0.5, 2)
    image.SetSpacing(0.2, 0.3, 0.25)
    rows = np.array([image.GetPoint(n) for n in range(image.GetNumberOfPoints())])
    energy = numpy_to_vtk(np.cos(rows[:, 0]) + rows[:, 1] * rows[:, 2] ** 2, deep=True)
    energy.SetName("energy")
    other = numpy_to_vtk(rows[:, 0].copy(), deep=True)
    other.SetName("other")
    image.GetPointData().AddArray(other)
    image.GetPointData().SetScalars(energy)
    for name in ("plain", "packed", "text", "raw"):
        writer = vtkXMLImageDataWriter()
        writer.SetFileName(f"{name}.vti")
        writer.SetInputData(image)
        if name == "plain":
            writer.SetDataModeToBinary()
            writer.SetCompressorTypeToNone()
        elif name == "packed":
            writer.SetDataModeToAppended()
            writer.SetCompressorTypeToZLib()
            writer.SetBlockSize(1024)
        elif name == "text":
            writer.SetDataModeToAscii()
        else:
            writer.SetDataModeToAppended()
            writer.EncodeAppendedDataOff()
            writer.SetHeaderTypeToUInt64()
            writer.SetCompressorTypeToNone()
        writer.Write()
    from gridData import Grid
    x, y, z = np.meshgrid(*(np.arange(n) for n in (9, 8, 7)), indexing="ij")
    Grid(np.sin(x / 4) * y + z**2 / 10, origin=[1, 2, 3], delta=[1, 1, 1]).export("sheared.dx", type="double")
    with open("sheared.dx", encoding="ascii") as file:
        text = file.read()
    rows = [line for line in text.splitlines() if line.startswith("delta")]
    for row, axis in zip(rows, SHEARED):
        text = text.replace(row, "delta " + " ".join(map(str, axis)), 1)
    with open("sheared.dx", "w", encoding="ascii") as file:
        file.write(text)


SHEARED = [[0.6, 0.1, 0], [0, 0.7, 0.2], [0.15, 0, 0.5]]


def read(path):
    """(values, origin, axes) as others read a file, lengths in angstrom."""
    if path.endswith(".map"):
        with open(path, encoding="ascii") as file:
            head = dict(line.split(None, 1) for line in [next(file) for _ in range(6)])
        values = np.loadtxt(path, skiprows=6)
        counts = np.array(head["NELEMENTS"].split(), int) + 1
        spacing = float(head["SPACING"])
        # AutoGrid's own corners of the box, which the .fld names.
        with open("host.maps.xyz", encoding="ascii") as file:
            places = np.array(file.read().split(), float)
        return values.reshape(counts[::-1]).transpose(2, 1, 0), places[::2], np.eye(3) * spacing
    if path.endswith("sheared.dx"):
        from gridData import OpenDX
        dx = OpenDX.field("0")
        dx.read(path)
        return dx.components["data"].array.reshape(9, 8, 7), np.array([1, 2, 3.0]), np.array(SHEARED)
    if path.endswith(".dx"):
        from gridData import Grid
        grid = Grid(path)
        return grid.grid, np.array(grid.origin), np.diag(grid.delta)
    if path.endswith(".cube"):
        from ase.io.cube import read_cube
        with open(path, encoding="ascii") as file:
            cube = read_cube(file)
        return cube["data"], cube["origin"], cube["atoms"].cell / np.array(cube["data"].shape)[:, None]
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader
    reader = vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    values = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1]).transpose(2, 1, 0)
    return values, np.array(image.GetBounds()[::2]), np.diag(image.GetSpacing())


def compare(path, name):
    from scipy.interpolate import BSpline, make_interp_spline
    values, origin, axes = read(path)
    with open(f"{name}/{name}.toml", "rb") as file:
        definition = tomllib.load(file)
    parameters = definition["model"]["parameters"]
    values = values * parameters["factor"]
    if "wall" in parameters:
        begin = (values.min() + parameters["wall"]) / 2
        room = parameters["wall"] - begin
        over = np.maximum(values - begin, 0)
        values = np.where(values > begin, begin + room * (1 - np.exp(-over / room)), values)
    grid = hapgrid.read(f"{name}/{name}.grid")
    spline = values  # SciPy's not-a-knot splines along one axis after the other
    knots = []
    for axis in range(3):
        one = make_interp_spline(np.arange(values.shape[axis]), spline, k=3, axis=axis)
        spline, knots = np.moveaxis(one.c, 0, axis), [*knots, one.t]
    x = np.array(definition["grid"]["origin"]) + definition["grid"]["spacing"] * grid["point"]
    u = (x - origin) @ np.linalg.inv(axes)
    inside = ((u > -1e-6) & (u < np.array(values.shape) - 1 + 1e-6)).all(axis=1)
    pick = np.random.default_rng(1).choice(np.flatnonzero(inside), min(300, inside.sum()), replace=False)
    assert len(pick) > 100, len(pick)
    steepest = 0
    for n in pick:
        rows, slopes = [], []
        for axis in range(3):
            t, at = knots[axis], float(np.clip(u[n, axis], 0, values.shape[axis] - 1))
            every = BSpline(t, np.eye(values.shape[axis]), 3)
            rows.append(every(at))
            slopes.append(every.derivative()(at))
        energy = np.einsum("ijk,i,j,k", spline, *rows)
        by_lattice = [np.einsum("ijk,i,j,k", spline, *(slopes[a] if a == b else rows[a] for a in range(3)))
                      for b in range(3)]
        gradient = np.linalg.inv(axes) @ by_lattice
        # The table's text has 8 digits, which the spline of the wall's height can use up.
        size = np.abs(values).max()
        assert abs(grid["energy"][n] - energy) < 1e-6 * size, (x[n], grid["energy"][n], energy)
        force = grid["force"][n]
        scale = np.linalg.norm(force) / max(np.linalg.norm(gradient), 1e-300)
        steepest = max(steepest, np.linalg.norm(force))
        if np.linalg.norm(force) > 0.05:
            assert np.linalg.norm(force + scale * gradient) < 1e-4 * np.linalg.norm(force), (x[n], force, gradient)
    assert steepest < parameters["largest_force"] * 1.02, steepest
    print(f"{name}: {len(pick)} places, steepest of them {steepest:.3f} N")


if sys.argv[1] == "images":
    images()
else:
    compare(sys.argv[2], sys.argv[3])
