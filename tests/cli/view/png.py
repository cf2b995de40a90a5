"""Looks into PNG files of 8-bit RGB, without any library for pictures.

usage: png.py size FILE            prints "W x H"
       png.py order FILE COLOUR... whether the middles of what has these colours go from left to right
       png.py near FILE OTHER A B  whether the upper part of FILE is OTHER: at most the part A of the
                                   pixels differs by more than a rounding, and B by much
"""
import struct
import sys
import zlib


def decode(name):
    """Width, height, and the rows of pixels as tuples."""
    data = open(name, "rb").read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
    chunks, at = [], 8
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        crc, = struct.unpack(">I", data[at + 8 + size:at + 12 + size])
        assert crc == zlib.crc32(kind + body), "damaged"
        chunks.append((kind, body))
        at += 12 + size
    assert chunks[0][0] == b"IHDR" and chunks[-1] == (b"IEND", b""), "cut off"
    width, height, depth, colours, *_ = struct.unpack(">IIBBBBB", chunks[0][1])
    assert (depth, colours) == (8, 2), "not 8-bit RGB"
    raw = zlib.decompress(b"".join(body for kind, body in chunks if kind == b"IDAT"))
    stride = 3 * width
    assert len(raw) == (1 + stride) * height, "wrong size"
    rows, above = [], bytearray(stride)
    for y in range(height):
        kind, row = raw[y * (1 + stride)], bytearray(raw[y * (1 + stride) + 1:(y + 1) * (1 + stride)])
        for i in range(stride):
            a, b, c = (row[i - 3] if i > 2 else 0), above[i], (above[i - 3] if i > 2 else 0)
            if kind == 4:
                near = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            else:
                near = [0, a, b, (a + b) // 2][kind]
            row[i] = (row[i] + near) & 255
        rows.append([tuple(row[i:i + 3]) for i in range(0, stride, 3)])
        above = row
    return width, height, rows


COLOURS = {
    "red": lambda r, g, b: r > g + 60 and r > b + 60,
    "blue": lambda r, g, b: b > r + 40 and b > g + 20,
    "yellow": lambda r, g, b: r > b + 40 and g > b + 40,
}


def main():
    what, name, *rest = sys.argv[1:]
    width, height, rows = decode(name)
    if what == "size":
        print(width, "x", height)
    elif what == "near":
        other_width, other_height, others = decode(rest[0])
        assert width == other_width and height >= other_height, "sizes"
        # A rounding in each of two steps, and the shading in float. Much is more than 40: a straight
        # edge that 2 x 2 and 3 x 3 rays see covers a third of a pixel more or less at most, and most
        # edges are lines of the box, whose grey is 97 from white.
        counts = {4: 0, 40: 0}
        for row, other in zip(rows, others):
            if row == other:
                continue
            for pixel, wanted in zip(row, other):
                difference = max(abs(a - b) for a, b in zip(pixel, wanted))
                for limit in counts:
                    counts[limit] += difference > limit
        parts = [count / (width * other_height) for count in counts.values()]
        assert all(part <= float(most) for part, most in zip(parts, rest[1:])), (parts, rest)
    else:
        middles = []
        for colour in rest:
            columns = [x for row in rows for x, pixel in enumerate(row) if COLOURS[colour](*pixel)]
            assert len(columns) > 20, f"{name}: hardly any {colour}"
            middles.append(sum(columns) / len(columns))
        assert middles == sorted(middles), (rest, middles)


if __name__ == "__main__":
    main()
