"""What play tells a viewer in each frame, as an array of NumPy.

Frames are messages of Cap'n Proto in standard framing (capnproto.org/encoding.html). Where each field lies is what
`capnp compile -ocapnp schemas/frame.capnp` prints.
"""
from __future__ import annotations

from typing import Any, TypeAlias

Struct: TypeAlias = tuple[int, int, int, int]  # segment, first byte, bytes of data and number of pointers
MAGIC = 0x6861706772696466.to_bytes(8, "little")  # "hapgridf"
NAN = 0x7FF8000000000000  # own_energy is coded as its difference to this default
MOST_SEGMENTS = 512  # of a message, as Cap'n Proto has it
BYTES = {4: "<f4", 5: "<f8"}  # the kinds of lists that frames have


def read_frames(path: str, data: bytes) -> Any:
    """All whole frames: play may have been stopped in the middle of one. Raises ValueError for damaged frames."""
    import numpy

    frames, at = [], 0
    try:
        while message := _Message.at(data, at):
            root = message.struct(0, 0)
            if message.number(root, 0, 2) == 1:
                frames.append(_frame(message, message.struct(*message.pointer_of(root, 0))))
            at = message.end
    except (LookupError, ValueError, TypeError, RecursionError):
        raise ValueError(f"{path}: damaged frames, in frame {len(frames)}") from None
    states, centres = (len(frames[0][name]) if frames else 0 for name in ("state", "shape"))
    array = numpy.zeros(len(frames), [
        ("t", float), ("tick", "u8"), ("hip", float, 3), ("position", float, 3), ("sent", float, 3),
        ("energy", float), ("state", float, (states,)), ("shape", "f4", (centres // 3, 3)),
        ("jumps", "u8"), ("own_energy", float), ("hand", float, 3)])
    for row, frame in zip(array, frames):
        for name in array.dtype.names or ():
            row[name] = frame[name].reshape(-1, 3) if name == "shape" else frame[name]
    return array


def read_spheres(path: str, data: bytes) -> Any:
    """Radius, red, green and blue of each sphere that shows the model. Raises ValueError for damaged frames."""
    import numpy

    try:
        message = _Message.at(data, 0)
        if message is None:
            return numpy.zeros((0, 4))
        scene = message.struct(*message.pointer_of(message.struct(0, 0), 0))
        segment, start, pointer = message.follow(*message.pointer_of(scene, 4))
        count, words = (message.word(segment, start) >> 2, 3) if pointer else (0, 3)  # each has 16 bytes and a pointer
        if pointer and pointer & 7 << 32 != 7 << 32 or count & 0x3FFFFFFF > 1 << 20:
            raise ValueError
        rows = numpy.frombuffer(message.segments[segment], "<f4", 2 * words * (count & 0x3FFFFFFF), start + 8)
        return rows.reshape(-1, 2 * words)[:, :4]
    except (LookupError, ValueError, TypeError, RecursionError):
        raise ValueError(f"{path}: damaged frames, in the scene") from None


def _frame(message: _Message, at: Struct) -> dict[str, Any]:
    import numpy

    def vector(pointer: int) -> Any:
        place = message.pointer_of(at, pointer)
        if message.word(*place) == 0:
            return numpy.full(3, numpy.nan)
        segment, start, _, _ = message.struct(*place)
        return numpy.frombuffer(message.segments[segment], "<f8", 3, start)

    def double(offset: int, default: int = 0) -> Any:
        return numpy.uint64(message.number(at, offset, 8) ^ default).view(float)

    return {"t": double(0), "tick": message.number(at, 8, 8), "hip": vector(0), "position": vector(1), "sent": vector(2),
            "energy": double(16), "state": message.list(*message.pointer_of(at, 3)),
            "shape": message.list(*message.pointer_of(at, 4)),
            "jumps": message.number(at, 24, 8), "own_energy": double(32, NAN), "hand": vector(5)}


class _Message:
    """One message. A place in it is the number of a segment and a byte there."""

    def __init__(self, segments: list[bytes], end: int) -> None:
        self.segments, self.end = segments, end

    @classmethod
    def at(cls, data: bytes, at: int) -> _Message | None:
        """The message that begins at a byte of `data`; None where no whole one does."""
        count = int.from_bytes(data[at:at + 4], "little") + 1
        if count > MOST_SEGMENTS:
            raise ValueError
        table = 4 * (count + 1) + 4 * (count % 2 == 0)
        if at + table > len(data):
            return None
        sizes = [8 * int.from_bytes(data[at + 4 * i:at + 4 * i + 4], "little") for i in range(1, count + 1)]
        if at + table + sum(sizes) > len(data):
            return None
        at, segments = at + table, []
        for size in sizes:
            segments.append(data[at:at + size])
            at += size
        return cls(segments, at)

    def word(self, segment: int, at: int) -> int:
        if at < 0:
            raise IndexError
        return int.from_bytes(self.segments[segment][at:at + 8], "little")

    def number(self, at: Struct, offset: int, size: int) -> int:
        """A number in the data of a struct; 0 behind its end."""
        segment, start, data, _ = at
        if offset + size > data:
            return 0
        return int.from_bytes(self.segments[segment][start + offset:start + offset + size], "little")

    def pointer_of(self, at: Struct, index: int) -> tuple[int, int]:
        segment, start, data, pointers = at
        if index >= pointers:
            raise IndexError
        return segment, start + data + 8 * index

    def follow(self, segment: int, at: int) -> tuple[int, int, int]:
        """Where a pointer leads, and the pointer itself."""
        pointer = self.word(segment, at)
        if pointer & 3 != 2:
            offset = pointer >> 2 & 0x3FFFFFFF
            return segment, at + 8 + 8 * (offset - (offset >> 29 << 30)), pointer
        there, pad = pointer >> 32, 8 * (pointer >> 3 & 0x1FFFFFFF)  # into another segment
        if not pointer & 4:
            return self.follow(there, pad)
        content = self.word(there, pad)
        return content >> 32, 8 * (content >> 3 & 0x1FFFFFFF), self.word(there, pad + 8)

    def struct(self, segment: int, at: int) -> Struct:
        """Segment, first byte, bytes of data and number of pointers."""
        segment, start, pointer = self.follow(segment, at)
        return segment, start, 8 * (pointer >> 32 & 0xFFFF), pointer >> 48

    def list(self, segment: int, at: int) -> Any:
        import numpy

        segment, start, pointer = self.follow(segment, at)
        if pointer == 0:
            return numpy.zeros(0)
        return numpy.frombuffer(self.segments[segment], BYTES[pointer >> 32 & 7], pointer >> 35, start)
