"""Tables of energies in the formats of other programs. Each reader gives a Table, and refuses with one line
what does not fit the file's own header."""

from __future__ import annotations

import base64
import math
import os
import re
import xml.etree.ElementTree as xml
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from hapgrid.apps.common import sandbox
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed, read_bytes

BOHR = 0.529177210903  # angstrom, CODATA 2018
MOST_VALUES = 16 << 20
MOST_BYTES = 1 << 30
MOST_LENGTH = 1e30
CAPPED = 1e5  # kcal/mol: AutoGrid writes nothing higher, which is the inside of the receptor
SYMBOLS = """X H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga Ge As Se Br Kr
Rb Sr Y Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe""".split()


@dataclass
class Table:
    """values: indexed [i, j, k] along the three axes, NaN where there is none. origin: of [0, 0, 0];
    axes: rows, from a point to the next one along each axis. atoms: (symbol, position)."""
    values: Array
    origin: Array
    axes: Array
    length_unit: str = "angstrom"
    energy_unit: str = ""
    atoms: list[tuple[str, Array]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # what a user may want to know of the file


def read(path: str, array: str | None = None) -> Table:
    """array: name of the one that is wanted, of a .vti with several."""
    name = os.path.basename(path).lower()
    packed = name.endswith(".gz")
    kind = os.path.splitext(name[:-3] if packed else name)[1]
    if kind not in (*READERS, ".vti"):
        raise Failed(f"{path}: only .map, .dx, .cube and .vti are known, and each with .gz behind it")
    data = read_bytes(path, MOST_BYTES)

    def parsed() -> Table:
        content = inflated(data, 31) if packed else data
        return _checked(read_vti(content, array) if kind == ".vti" else READERS[kind](_text(content)))
    return behind_walls(path, parsed)


def behind_walls(path: str, parsed: Callable[[], Table]) -> Table:
    """The Table that parsed() makes of a file."""
    def plain() -> dict[str, Any]:
        try:
            table = parsed()
        except Failed as why:
            raise Failed(f"{path}: {why}") from None
        return {**vars(table), "atoms": [[symbol for symbol, _ in table.atoms], np.array([x for _, x in table.atoms]).reshape(-1, 3)]}
    table = Table(**sandbox.run(plain, path))
    table.atoms = [(symbol, x) for symbol, x in zip(*table.atoms)]
    return table


def _text(data: bytes) -> str:
    if b"\0" in data:
        raise Failed("it is no text file")
    return data.decode("utf-8", "replace")


def inflated(data: bytes, wbits: int, most: int = MOST_BYTES) -> bytes:
    try:
        unpacker = zlib.decompressobj(wbits)
        out = unpacker.decompress(data, most)
        if unpacker.unconsumed_tail or not unpacker.eof:
            raise Failed("its compressed data are cut off or too long")
        return out
    except zlib.error:
        raise Failed("its compressed data are damaged") from None


def _checked(table: Table) -> Table:
    if min(table.values.shape) < 4:
        raise Failed(f"{' x '.join(map(str, table.values.shape))} values: at least 4 are needed along each axis")
    if not (np.abs([table.origin, *table.axes]) < MOST_LENGTH).all():
        raise Failed(f"its origin or spacing is no number below {MOST_LENGTH:g}")
    size = np.prod(np.linalg.norm(table.axes, axis=1))
    if not abs(np.linalg.det(table.axes)) > 1e-6 * size:
        raise Failed("its axes lie in one plane")
    table.values[~np.isfinite(table.values)] = np.nan
    if np.isnan(table.values).all():
        raise Failed("it has no value that is a number")
    return table


def _numbers(text: str, count: int, what: str = "values") -> Array:
    """All numbers of a text, which must be `count`."""
    words = text.split()
    if len(words) != count:
        raise Failed(f"its header speaks of {count:,} {what}, and it has {len(words):,}")
    try:
        return np.array(words, dtype=float)
    except ValueError:
        wrong = next(w for w in words if not _is_number(w))
        raise Failed(f"'{wrong[:20]}' among the {what} is no number") from None


def _is_number(word: str) -> bool:
    try:
        float(word)
        return True
    except ValueError:
        return False


def _count(words: Sequence[Any] | Array, what: str) -> tuple[list[int], int]:
    """Whole numbers of points, and their product."""
    try:
        counts = [int(w) for w in words]
    except ValueError:
        raise Failed(f"{what}: the counts are no whole numbers") from None
    if len(counts) != 3 or min(counts) < 1:
        raise Failed(f"{what}: three counts above zero are due")
    if math.prod(counts) > MOST_VALUES:
        raise Failed(f"{_many(math.prod(counts))} values are too many: at most {MOST_VALUES:,}")
    return counts, math.prod(counts)


def _many(n: int) -> str:
    return f"{n:,}" if n < 10**15 else "over 10^15"


# AutoGrid


def read_map(text: str) -> Table:
    """Six lines of header, then a value a line, x fastest. NELEMENTS counts cells, not points."""
    lines = text.split("\n", 6)
    if len(lines) < 7:
        raise Failed("it ends before the 6 lines of an AutoGrid map's header")
    head = {words[0]: words[1:] for words in (line.split() for line in lines[:6]) if words}
    for key, count in (("SPACING", 1), ("NELEMENTS", 3), ("CENTER", 3)):
        if len(head.get(key, ())) != count:
            raise Failed(f"no AutoGrid map: {key} is missing among its first 6 lines, or has not {count} numbers")
    spacing, = _numbers(head["SPACING"][0], 1, "numbers of SPACING")
    centre = _numbers(" ".join(head["CENTER"]), 3, "numbers of CENTER")
    cells = _numbers(" ".join(head["NELEMENTS"]), 3, "numbers of NELEMENTS")
    if not all(0 < c < MOST_VALUES and c == int(c) for c in cells) or not spacing > 0:
        raise Failed("NELEMENTS or SPACING is not positive")
    counts, total = _count([int(c) + 1 for c in cells], "NELEMENTS")
    values = _numbers(lines[6], total).reshape(counts[::-1]).transpose(2, 1, 0)
    return Table(np.where(values >= CAPPED, np.nan, values), centre - spacing * cells / 2, spacing * np.eye(3),
                 energy_unit="kcal/mol")


# OpenDX


def read_dx(text: str) -> Table:
    """As APBS writes it: regular positions, then one array of numbers, z fastest."""
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    counts, origin, deltas, total = None, None, [], None
    for number, line in enumerate(lines):
        words = line.replace('"', " ").split()
        if "gridpositions" in words and "counts" in words:
            counts, expected = _count(words[words.index("counts") + 1:], "gridpositions")
        elif words[:1] == ["origin"]:
            origin = _numbers(" ".join(words[1:]), 3, "numbers of the origin")
        elif words[:1] == ["delta"]:
            deltas.append(_numbers(" ".join(words[1:]), 3, "numbers of a delta"))
        elif "array" in words and "follows" in words:
            if "rank" in words and words[words.index("rank") + 1:][:1] != ["0"]:
                raise Failed("its array has vectors: only one number a point can be felt")
            begin = number + 1
            total = words[words.index("items") + 1:][:1] if "items" in words else []
            break
    if counts is None or origin is None or len(deltas) != 3 or total is None:
        raise Failed("no OpenDX table: counts, origin, three deltas or 'data follows' is missing")
    if total != [str(expected)]:
        raise Failed(f"its positions are {expected:,}, and its array has {' '.join(total) or 'no'} items")
    rest = "\n".join(lines[begin:])
    end = re.search(r"^[ \t]*(attribute|object|component)\b", rest, re.MULTILINE)
    values = _numbers(rest[:end.start()] if end else rest, expected)
    return Table(values.reshape(counts), origin, np.array(deltas))


# Gaussian cube


def read_cube(text: str) -> Table:
    """Two titles, atoms, values with z fastest. Lengths are in bohr; counts below zero say angstrom."""
    lines = text.split("\n", 6)
    if len(lines) < 7:
        raise Failed("it ends before the 6 lines of a cube's header")
    try:
        head = [[float(w) for w in line.split()] for line in lines[2:6]]
    except ValueError:
        raise Failed("no cube: a word among the numbers in lines 3 to 6") from None
    if not 4 <= len(head[0]) <= 5 or any(len(row) != 4 for row in head[1:]) or not all(
            math.isfinite(v) for row in head for v in row) or any(row[0] != int(row[0]) for row in head):
        raise Failed("no cube: lines 3 to 6 need a whole number and 3 others each")
    atoms, orbital = abs(int(head[0][0])), head[0][0] < 0
    each = int(head[0][4]) if len(head[0]) == 5 else 1
    unit = 1 if head[1][0] < 0 else BOHR
    counts, total = _count([abs(int(row[0])) for row in head[1:]], "lines 4 to 6")
    if atoms > 200_000:
        raise Failed(f"{atoms:,} atoms are too many")
    rest = lines[6].split("\n", atoms)
    if len(rest) <= atoms:
        raise Failed(f"it ends before its {atoms} atoms")
    known = []
    for line in rest[:atoms]:
        row = _numbers(line, 5, "numbers of an atom")
        z = int(row[0]) if 0 <= row[0] < len(SYMBOLS) else 0
        known.append((SYMBOLS[z], row[2:] * unit))
    body = rest[atoms]
    if orbital:  # a line, perhaps more, with how many orbitals there are, and their numbers
        words = body.split(None, 1)
        each = int(words[0]) if words and re.fullmatch("[0-9]{1,4}", words[0]) else 0
        words = body.split(None, each + 1)
        if each < 1 or len(words) < each + 2:
            raise Failed("the list of its orbitals is not understood")
        body = words[-1]
    if not 1 <= each <= 1000 or each * total > MOST_VALUES:
        raise Failed(f"{_many(each)} values a point are too many")
    values = _numbers(body, total * each).reshape([*counts, each])[..., 0]
    notes = [f"it has {each} values a point: the first is taken"] if each > 1 else []
    return Table(np.array(values), np.array(head[0][1:4]) * unit, np.array([row[1:] for row in head[1:]]) * unit,
                 energy_unit="hartree", atoms=known, notes=notes)


# VTK image data

_TYPES = {"Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8",
          "UInt64": "u8", "Float32": "f4", "Float64": "f8"}


def read_vti(data: bytes, wanted: str | None = None) -> Table:
    """Image data of one piece with values at points: as text, base64 or raw bytes, perhaps with zlib."""
    tag = data.find(b"<AppendedData")
    appended, raw = re.compile(rb"\s*_").match(data, data.find(b">", tag) + 1) if tag > 0 else None, b""
    if appended:  # raw bytes are no XML: they end with the last </AppendedData>
        end = data.rfind(b"</AppendedData>")
        raw = data[appended.end():end if end > 0 else len(data)]
        data = data[:appended.end() - 1] + b"</AppendedData></VTKFile>"
    encoding = re.match(rb"\s*<\?xml[^>]{0,99}encoding\s*=\s*.([\w.-]*)", data)
    if b"\0" in data or encoding and encoding[1].lower() not in (b"utf-8", b"us-ascii", b"ascii", b"iso-8859-1"):
        raise Failed("no VTK image: it is not written in UTF-8")
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise Failed("no VTK image: it defines entities of XML")
    try:
        root = xml.fromstring(data)
    except (xml.ParseError, ValueError) as why:
        raise Failed(f"no VTK image: {why}") from None
    image = root.find("ImageData")
    if root.get("type") != "ImageData" or image is None:
        raise Failed("no VTK image: the file's type is not ImageData")
    pieces = image.findall("Piece")
    if len(pieces) != 1 or pieces[0].get("Extent", image.get("WholeExtent")) != image.get("WholeExtent"):
        raise Failed("only an image of one piece can be read")
    extent = _numbers(image.get("WholeExtent", ""), 6, "numbers of its extent").astype(int)
    counts, total = _count(extent[1::2] - extent[::2] + 1, "WholeExtent")
    array = _array_of(pieces[0].find("PointData"), wanted)
    if array.get("NumberOfComponents", "1") != "1":
        raise Failed(f"its array {array.get('Name')} has vectors: only one number a point can be felt")
    values = _array(root, array, raw, total)
    spacing = _numbers(image.get("Spacing", "1 1 1"), 3, "numbers of its spacing")
    turn = _numbers(image.get("Direction", "1 0 0 0 1 0 0 0 1"), 9, "numbers of its direction").reshape(3, 3)
    axes = (turn * spacing).T  # column a of the direction is axis a
    origin = _numbers(image.get("Origin", "0 0 0"), 3, "numbers of its origin") + extent[::2] @ axes
    return Table(values.reshape(counts[::-1]).transpose(2, 1, 0).copy(), origin, axes, length_unit="",
                 notes=[f"array {array.get('Name')}"])


def _array_of(points: xml.Element | None, wanted: str | None) -> xml.Element:
    arrays = [] if points is None else points.findall("DataArray")
    names = [a.get("Name", "") for a in arrays]
    wanted = wanted or (points.get("Scalars") if points is not None else None) or (names[0] if names else None)
    if wanted not in names:
        raise Failed(f"it has no array {wanted} at points, only {', '.join(names)}" if names
                     else "it has no values at points")
    return arrays[names.index(wanted)]


def _array(root: xml.Element, array: xml.Element, raw: bytes, total: int) -> Array:
    kind, how = array.get("type"), array.get("format", "ascii")
    if kind not in _TYPES:
        raise Failed(f"values of the type {kind} are not known")
    if how == "ascii":
        return _numbers(array.text or "", total)
    order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
    head = np.dtype(order + ("u8" if root.get("header_type") == "UInt64" else "u4"))
    packed = root.get("compressor")
    if packed not in (None, "vtkZLibDataCompressor"):
        raise Failed(f"its compressor {packed} is not known: write it with zlib or without")
    if how == "binary":
        stream: _Raw = _Base64((array.text or "").encode("ascii", "replace"))
    elif how == "appended":
        offset = array.get("offset", "")
        part = raw[int(offset):] if offset.isdigit() else b""
        tag = root.find("AppendedData")
        stream = _Base64(part) if tag is not None and tag.get("encoding") == "base64" else _Raw(part)
    else:
        raise Failed(f"values in the format {how} are not known")
    dtype = np.dtype(order + _TYPES[kind])
    data = (_blocks if packed else _plain)(stream, head, total * dtype.itemsize)
    if len(data) != total * dtype.itemsize:
        raise Failed(f"its extent speaks of {total:,} values, and it has {len(data) // dtype.itemsize:,}")
    return np.frombuffer(data, dtype).astype(float)


class _Raw:
    """A part of the file, read in pieces."""

    def __init__(self, data: bytes) -> None:
        self.data = data

    def take(self, size: int) -> bytes:
        out, self.data = self.data[:size], self.data[size:]
        if len(out) < size:
            raise Failed("it ends in the middle of its values")
        return out

    def peek(self, size: int) -> bytes:
        return type(self)(self.data).take(size)


class _Base64(_Raw):
    """The same in base64. Each of VTK's pieces is encoded by itself."""

    def take(self, size: int) -> bytes:
        text = self.data.lstrip()
        length = (size + 2) // 3 * 4
        self.data = text[length:]
        try:
            out = base64.b64decode(text[:length])
        except ValueError:
            out = b""
        if len(out) < size:
            raise Failed("its values in base64 are damaged or end in the middle")
        return out[:size]


def _plain(stream: _Raw, head: np.dtype[Any], most: int) -> bytes:
    # In base64 the header and the values are one piece.
    size = int(np.frombuffer(stream.peek(head.itemsize), head)[0])
    if size > most:
        return b"\0" * min(size, 2 * most)
    return stream.take(head.itemsize + size)[head.itemsize:]


def _blocks(stream: _Raw, head: np.dtype[Any], most: int) -> bytes:
    # The header: number of blocks, size of each and of the last one, then the size of each when packed.
    count, size, last = (int(n) for n in np.frombuffer(stream.peek(3 * head.itemsize), head))
    if count > most or count * size > most + size:
        raise Failed("the blocks of its compressed values do not fit its extent")
    sizes = [int(n) for n in np.frombuffer(stream.take((3 + count) * head.itemsize), head)[3:]]
    packed = stream.take(sum(sizes))
    out, at = [], 0
    for length in sizes:
        out.append(inflated(packed[at:at + length], 15, min(size, most) + 1))
        at += length
    return b"".join(out)


READERS: dict[str, Callable[[str], Table]] = {".map": read_map, ".dx": read_dx, ".cube": read_cube}
