"""Densities of crystallography and electron microscopy (.ccp4, .mrc, and .map of theirs), and arrays of NumPy."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed

from .readers import MOST_VALUES, Table, _count

_MODES = {0: "i1", 1: "i2", 2: "f4", 6: "u2", 12: "f2"}
_HEADER = 1024


def is_ccp4(data: bytes) -> bool:
    return data[208:211] == b"MAP"


def read_ccp4(data: bytes, **_: Any) -> Table:
    """A map of CCP4 or MRC2014 (Cheng et al., J. Struct. Biol. 192 (2015) 146)."""
    if len(data) < _HEADER or not is_ccp4(data):
        raise Failed("no map of CCP4 or MRC: the word MAP is missing in its header")
    order = ">" if data[212:213] == b"\x11" else "<"
    whole = np.frombuffer(data[:_HEADER], order + "i4")
    real = np.frombuffer(data[:_HEADER], order + "f4").astype(float)
    counts, total = _count(whole[:3], "its header")
    mode, begin, cells, crystal = int(whole[3]), whole[4:7], whole[7:10], int(whole[23])
    if mode not in _MODES:
        raise Failed(f"its values are of mode {mode}, which are no plain numbers")
    lengths, angles, columns = real[10:13], np.radians(real[13:16]), whole[16:19] - 1
    if sorted(columns) != [0, 1, 2] or min(cells) < 1 or not (lengths > 0).all() or not 0 <= crystal <= _MOST_SYMMETRY:
        raise Failed("its header has no cell, or its axes are not 1, 2 and 3")
    dtype = np.dtype(order + _MODES[mode])
    body = data[_HEADER + crystal:]
    if len(body) < total * dtype.itemsize:
        raise Failed(f"its header speaks of {total:,} values, and it has {len(body) // dtype.itemsize:,}")
    values = np.frombuffer(body, dtype, total).reshape(counts[::-1]).transpose(2, 1, 0).astype(float)
    # What is stored first, second and third becomes x, y and z.
    inverse = np.argsort(columns)
    values, begin = values.transpose(inverse).copy(), begin[inverse]
    axes = _cell(lengths, angles) / cells[:, None]
    place = real[49:52]  # of MRC2014; CCP4's files begin at their first point instead
    origin = place if place.any() and not begin.any() else begin @ axes
    return Table(values, np.array(origin), axes, has_unit=True, notes=[
        "a map of crystallography or electron microscopy: densities, no energies. --factor -1 makes wells of them"])


_MOST_SYMMETRY = 1 << 20  # bytes between header and values


def _cell(lengths: Array, angles: Array) -> Array:
    """The vectors of a cell as rows: a along x, b in the plane of x and y."""
    a, b, c = lengths
    cos_a, cos_b, cos_c = np.cos(angles)
    sin_c = np.sin(angles[2])
    if not sin_c > 1e-6:
        raise Failed("the angles of its cell are no angles of a cell")
    x, y = cos_b, (cos_a - cos_b * cos_c) / sin_c
    if not 1 - x * x - y * y > 0:
        raise Failed("the angles of its cell are no angles of a cell")
    return np.array([[a, 0, 0], [b * cos_c, b * sin_c, 0], [c * x, c * y, c * np.sqrt(1 - x * x - y * y)]])


def _loaded(data: bytes) -> Any:
    try:
        return np.load(io.BytesIO(data), allow_pickle=False)
    except Exception as why:  # of many kinds
        raise Failed(f"no array of NumPy: {' '.join(str(why).split())[:100]}") from None


def _placed(values: Array, origin: Any, steps: Any, **more: Any) -> Table:
    if values.ndim != 3 or values.dtype.kind not in "fiu":
        raise Failed(f"its array is {'x'.join(map(str, values.shape)) or 'one'} of {values.dtype}: three dimensions of real "
                     "numbers are due")
    if values.size > MOST_VALUES:
        raise Failed(f"{values.size:,} values are too many: at most {MOST_VALUES:,}")
    if origin is None or steps is None:
        raise Failed("an array has no place: numpy.savez(FILE, values=VALUES, origin=[X, Y, Z], spacing=H) gives it one")
    axes = np.array(steps, float)
    if axes.shape not in ((), (1,), (3,), (3, 3)) or np.shape(origin) != (3,):
        raise Failed("its origin must be three numbers, and its spacing one, three, or a row for each axis")
    axes = axes if axes.ndim == 2 else np.diag(np.broadcast_to(axes, 3))
    return Table(values.astype(float), np.array(origin, float), axes, length_unit="", **more)


def read_npz(data: bytes, array: str | None = None) -> Table:
    """An array of three dimensions, indexed [i, j, k] along x, y and z, beside it `origin` and `spacing` (one number, three, or rows of
    axes)."""
    known = _loaded(data)
    if isinstance(known, np.ndarray):
        raise Failed("no .npz: it is one array")
    try:
        found = {name: known[name] for name in known.files}
    except Exception as why:
        raise Failed(f"no arrays of NumPy: {' '.join(str(why).split())[:100]}") from None
    fields = [name for name, one in found.items() if one.ndim == 3]
    if array is not None and array not in fields or not fields:
        raise Failed(f"it has no array {array or ''} of three dimensions, only {', '.join(found)}".replace("  ", " "))
    if array is None and len(fields) > 1:
        raise Failed(f"it has the arrays {', '.join(fields)}: --array says which")
    name = array or fields[0]
    return _placed(found[name], found.get("origin"), found.get("spacing", found.get("delta")), notes=[f"array {name}"])
