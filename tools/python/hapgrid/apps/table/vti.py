"""VTK image data: .vti."""

from __future__ import annotations

import base64
import lzma
import re
import xml.etree.ElementTree as xml
from collections.abc import Callable
from typing import Any

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed

from .readers import Table, _count, _numbers, inflated, unpacked

_TYPES = {"Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4", "UInt32": "u4", "Int64": "i8",
          "UInt64": "u8", "Float32": "f4", "Float64": "f8"}


def read_vti(data: bytes, array: str | None = None, **_: Any) -> Table:
    """Image data of one piece with values at points or in cells: as text, base64 or raw bytes, perhaps compressed."""
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
    values_tag, in_cells, notes = _array_of(pieces[0], array)
    counts, total = _count(extent[1::2] - extent[::2] + (not in_cells), "WholeExtent")
    if values_tag.get("NumberOfComponents", "1") != "1":
        raise Failed(f"its array {values_tag.get('Name')} has vectors: only one number a point can be felt")
    values = _array(root, values_tag, raw, total)
    spacing = _numbers(image.get("Spacing", "1 1 1"), 3, "numbers of its spacing")
    turn = _numbers(image.get("Direction", "1 0 0 0 1 0 0 0 1"), 9, "numbers of its direction").reshape(3, 3)
    axes = (turn * spacing).T  # column a of the direction is axis a
    origin = _numbers(image.get("Origin", "0 0 0"), 3, "numbers of its origin") + (extent[::2] + in_cells / 2) @ axes
    return Table(values.reshape(counts[::-1]).transpose(2, 1, 0).copy(), origin, axes, length_unit="", notes=notes)


def _array_of(piece: xml.Element, wanted: str | None) -> tuple[xml.Element, bool, list[str]]:
    """The array that is wanted, or else its scalars, or the first one; whether its values are in cells; and notes."""
    tags = [tag for tag in (piece.find("PointData"), piece.find("CellData")) if tag is not None]
    known: dict[str, tuple[xml.Element, bool]] = {}
    for tag in reversed(tags):  # of one name, the values at points
        known |= {one.get("Name", ""): (one, tag.tag == "CellData") for one in tag.findall("DataArray")}
    if not known:
        raise Failed("it has no values at points or in cells")
    chosen = wanted or next((tag.get("Scalars") for tag in tags if tag.get("Scalars")), None)
    chosen = chosen or next((name for name in known if not known[name][1]), next(iter(known)))
    if chosen not in known:
        raise Failed(f"it has no array {chosen}, only {', '.join(known)}")
    array, in_cells = known[chosen]
    others = [name for name in known if name != chosen]
    notes = [f"array {chosen}" + (f"; --array takes another one: {', '.join(others)}" if others else "")]
    if in_cells:
        notes.append("its values are in cells: they are taken at the cells' centres")
    return array, in_cells, notes


def _array(root: xml.Element, array: xml.Element, raw: bytes, total: int) -> Array:
    kind, how = array.get("type"), array.get("format", "ascii")
    if kind not in _TYPES:
        raise Failed(f"values of the type {kind} are not known")
    if how == "ascii":
        return _numbers(array.text or "", total)
    order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
    head = np.dtype(order + ("u8" if root.get("header_type") == "UInt64" else "u4"))
    packed = root.get("compressor")
    if packed and packed not in UNPACK:
        raise Failed(f"its compressor {packed} is not known: write it with zlib or without")
    stream: _Raw
    if how == "binary":
        stream = _Base64((array.text or "").encode("ascii", "replace"))
    elif how == "appended":
        offset = array.get("offset", "")
        part = raw[int(offset):] if offset.isdigit() else b""
        tag = root.find("AppendedData")
        stream = _Base64(part) if tag is not None and tag.get("encoding") == "base64" else _Raw(part)
    else:
        raise Failed(f"values in the format {how} are not known")
    dtype = np.dtype(order + _TYPES[kind])
    most = total * dtype.itemsize
    data = _blocks(stream, head, most, UNPACK[packed]) if packed else _plain(stream, head, most)
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


def _blocks(stream: _Raw, head: np.dtype[Any], most: int, unpack: Callable[[bytes, int], bytes]) -> bytes:
    # The header: number of blocks, size of each and of the last one, then the size of each when packed.
    count, size, last = (int(n) for n in np.frombuffer(stream.peek(3 * head.itemsize), head))
    if count > most or count * size > most + size:
        raise Failed("the blocks of its compressed values do not fit its extent")
    sizes = [int(n) for n in np.frombuffer(stream.take((3 + count) * head.itemsize), head)[3:]]
    packed = stream.take(sum(sizes))
    out, at = [], 0
    for length in sizes:
        out.append(unpack(packed[at:at + length], min(size, most) + 1))
        at += length
    return b"".join(out)


def _unpack_lz4(data: bytes, most: int) -> bytes:
    """A block of LZ4: literals, and copies of what came before."""
    out, at = bytearray(), 0

    def length(begin: int) -> int:
        nonlocal at
        more = 255 if begin == 15 else 0
        while more == 255:
            more = data[at]
            begin, at = begin + more, at + 1
        return begin
    try:
        while True:
            token = data[at]
            at += 1
            many = length(token >> 4)
            out += data[at:at + many]
            at += many
            if at >= len(data):
                break
            back = data[at] | data[at + 1] << 8
            at += 2
            many = length(token & 15) + 4
            if not 0 < back <= len(out) or len(out) + many > most:
                raise Failed("its compressed data are damaged")
            piece = bytes(out[-back:])
            out += (piece * (many // back + 1))[:many]
    except IndexError:
        raise Failed("its compressed data are cut off") from None
    if at != len(data) or len(out) > most:
        raise Failed("its compressed data are damaged")
    return bytes(out)


UNPACK: dict[str, Callable[[bytes, int], bytes]] = {
          "vtkZLibDataCompressor": lambda data, most: inflated(data, 15, most),
          "vtkLZMADataCompressor": lambda data, most: unpacked(lzma.LZMADecompressor(memlimit=1 << 28), data, most),
          "vtkLZ4DataCompressor": _unpack_lz4}
