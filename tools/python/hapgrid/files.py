"""hapgrid's files as arrays of NumPy, and a grid as an image for ParaView and VTK."""
from __future__ import annotations

import io
import json
import os
import subprocess
import warnings
from pathlib import Path
from typing import IO, Any

COLUMNS = 10  # of a text log before the levels: t, the HIP, the model's force and the one that was sent
FILTERS = str(Path(__file__).resolve().parents[2] / "bin")  # their folder lies beside that of this package


def program(name: str) -> str:
    """The path of a filter."""
    return os.path.join(FILTERS, name)


def write_whole(path: str, content: str | bytes) -> None:
    """Writes a file so that it is there in full, or as it was before."""
    beside = f"{path}.new.{os.getpid()}"
    try:
        with open(beside, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)
    except BaseException as why:
        if os.path.exists(beside):
            os.remove(beside)
        if isinstance(why, OSError):
            why.filename, why.filename2 = path, None
        raise


class Grid(dict[str, Any]):
    """The arrays of a grid by name. known: what stats says of it as JSON, such as "model", "length_unit" and "energy_unit"."""

    def __init__(self, arrays: dict[str, Any], known: dict[str, Any]) -> None:
        super().__init__(arrays)
        self.known = known

    def __repr__(self) -> str:
        box, unit = self.known["box"], self.known["length_unit"] or "of the model's unit"
        points = f"{' x '.join(map(str, box['counts']))} points, {box['spacing']:g} {unit} apart"
        columns = ", ".join(name for name in self if name not in box)
        return f"<Grid of {self.known['model']}: {points}, {len(self['level'])} records with {columns}>"


def read(path: str | os.PathLike[str], grid: str | os.PathLike[str] | None = None,
         allow_process: str | os.PathLike[str] | None = None) -> dict[str, Any]:
    """The arrays of a grid, a session, a text log or a file of frames, as a dict from their names to arrays of NumPy.

    hapgrid-stats(1) lists those of a grid and of a session. A grid's have a row for each record: "point" (n x 3),
    "level", "state" (n x m), "force" (n x 3, where it is stored) and more; "origin", "spacing" and "counts" are those of
    the box. It is a Grid, whose `known` has the model's name, the units and more. What play wrote is one array
    with fields, a row for each tick or frame:

        "ticks"    of a session: t, hip, force (the model's), sent, levels, flags, lateness_us, compute_us; of a text log:
                   t, hip, force, sent, levels, state and, where the model has them, energy and own_energy
        "frames"   t, tick, hip, position (in the box), sent, energy, state, shape, jumps, own_energy,
                   hand (that pulls the HIP by a spring; NaN without one)

    A session has neither states nor energies. With `grid`, the file of the grid that was played, play replays the
    session there, and its ticks get those of the replay: state, energy, own_energy and snap. A warning says where the
    replay's force is another one. `allow_process` is the definition whose command may be run as the model, as in play, and
    os.environ["HAPGRID_MODEL_PATH"] names the folder of the grid's plug-in, where it is one of your own.

    Raises OSError when the file cannot be read, and ValueError when it is none of these or damaged.
    """
    path = os.fspath(path)
    with open(path, "rb") as file:
        if file.read(4) == b"# t\t":
            return {"ticks": _text_log(path, file)}
    arrays = _arrays(path)
    if grid is not None and "ticks" in arrays:
        return {"ticks": _replayed(path, arrays["ticks"], os.fspath(grid), allow_process)}
    return arrays


def write_vti(grid: str | os.PathLike[str], path: str | os.PathLike[str], level: int = 0) -> None:
    """Writes an image of a grid that ParaView and VTK open: "levels", how many a point has, and the state, the force and
    the energy of the records at `level`, where the grid stores them; not a number where a point has no such record. The
    names of the model and of its units are texts of the image's field data."""
    import numpy

    arrays = read(grid)
    if not isinstance(arrays, Grid):
        raise ValueError(f"{os.fspath(grid)}: not a grid")
    points = arrays["point"] @ numpy.cumprod([1, *arrays["counts"][:2]])  # x is the fastest
    here, size = arrays["level"] == level, int(numpy.prod(arrays["counts"]))
    if not here.any():
        raise ValueError(f"{os.fspath(grid)}: no point has level {level}")
    data = {"levels": numpy.bincount(points, minlength=size).astype("<u2")}
    for name in [name for name in ("state", "force", "energy") if name in arrays]:
        data[name] = numpy.full((size, arrays[name][0].size), numpy.nan)
        data[name][points[here]] = arrays[name][here].reshape(here.sum(), -1)
    extent = " ".join(f"0 {n - 1}" for n in arrays["counts"])
    names, offset, axes = "", 0, "".join(f' ComponentName{a}="{axis}"' for a, axis in enumerate("xyz"))
    texts = ""
    for name in "model", "length_unit", "energy_unit":
        letters = " ".join(map(str, [*arrays.known[name].encode(), 0]))
        texts += f'<Array type="String" Name="{name}" NumberOfTuples="1" format="ascii">{letters}</Array>'
    for name, values in data.items():
        names += (f'<DataArray type="{"UInt16" if name == "levels" else "Float64"}" Name="{name}"{axes if name == "force" else ""} '
                  f'NumberOfComponents="{values.size // size}" format="appended" offset="{offset}"/>')
        offset += 8 + values.nbytes
    with open(path, "wb") as file:
        file.write(f'<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64"><ImageData '
                   f'WholeExtent="{extent}" Origin="{" ".join(map(repr, arrays["origin"].tolist()))}" '
                   f'Spacing="{" ".join([repr(float(arrays["spacing"]))] * 3)}"><FieldData>{texts}</FieldData>'
                   f'<Piece Extent="{extent}"><PointData '
                   f'Scalars="levels">{names}</PointData></Piece></ImageData><AppendedData encoding="raw">_'.encode())
        for values in data.values():
            file.write(values.nbytes.to_bytes(8, "little") + values.tobytes())
        file.write(b"</AppendedData></VTKFile>")


def array_of(path: str, **given: Any) -> Any:
    """The array that stats makes of what it reads. given: its standard input, as subprocess.run has it. Errors: ValueError."""
    import numpy

    result = subprocess.run([program("stats"), "--npy", "-"], capture_output=True, check=False, **given)
    if result.returncode != 0:
        raise ValueError(f"{path}: {result.stderr.decode(errors='replace').strip()}")
    return numpy.load(io.BytesIO(result.stdout))


def _arrays(path: str) -> dict[str, Any]:
    import numpy
    from numpy.lib.recfunctions import drop_fields

    with open(path, "rb") as file:
        rows = array_of(path, stdin=file)
    if "tick" in rows.dtype.names:
        return {"frames": drop_fields(rows, "radius")}
    if "t" in rows.dtype.names:
        return {"ticks": rows}
    words = [program("stats"), os.path.abspath(path), "--format", "json"]
    known = json.loads(subprocess.run(words, capture_output=True, check=True).stdout)
    box = {name: numpy.array(value) for name, value in known["box"].items()}
    return Grid({name: rows[name] for name in rows.dtype.names} | box, known)


def _replayed(path: str, played: Any, grid: str, allow_process: str | os.PathLike[str] | None) -> Any:
    """The ticks that were played, with what a replay of the session in `grid` has besides."""
    import numpy

    command = [program("play"), grid, "--device", f"replay:{path}", "--log", "-"]
    if allow_process is not None:
        command += ["--allow-process", os.fspath(allow_process)]
    result = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    if result.returncode != 0:
        raise ValueError(f"{path}: {result.stderr.decode(errors='replace').strip()}")
    again = _text_log(path, io.BytesIO(result.stdout))
    if len(again) != len(played):
        raise ValueError(f"{path}: it has {len(played)} ticks, and its replay in {grid} {len(again)}: is this the grid that was played?")
    apart, largest = (numpy.abs(force).max() for force in (again["force"] - played["force"], played["force"]))
    if apart > 0.01 * largest:
        warnings.warn(f"{path}: states and energies are those of a replay in {grid}, whose force differs by up to {apart:.2g} N from that "
                      f"which was played ({largest:.2g} N at most). Where a process was the model, --allow-process MODEL.toml asks it "
                      "again (in Python: allow_process)", stacklevel=3)
    more = [name for name in ("state", "energy", "own_energy", "snap") if name in again.dtype.names]
    ticks = numpy.zeros(len(played), played.dtype.descr + [(name, again.dtype[name]) for name in more])
    for source, names in ((played, played.dtype.names), (again, more)):
        for name in names:
            ticks[name] = source[name]
    return ticks


def _text_log(path: str, file: IO[bytes]) -> Any:
    import numpy

    file.seek(0)
    names = file.readline().decode("utf-8", "replace").lstrip("# ").split()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a log without a tick
            numbers = numpy.loadtxt(file, ndmin=2).reshape(-1, len(names))
    except ValueError as error:
        raise ValueError(f"{path}: not a log of play: {error}") from None
    states = sum(name[0] == "s" and name[1:].isdigit() for name in names)
    fields = [("t", float), ("hip", float, 3), ("force", float, 3), ("sent", float, 3), ("levels", "u1", 8),
              ("state", float, (states,))]
    fields += [(name, float) for name in names[COLUMNS + 8 + states:]]
    ticks, at = numpy.zeros(len(numbers), fields), 0
    for name in ticks.dtype.names or ():
        shape = ticks.dtype[name].shape
        width = shape[0] if shape else 1
        ticks[name] = numbers[:, at:at + width] if shape else numbers[:, at]
        at += width
    return ticks
