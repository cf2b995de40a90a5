"""Looks into PNG files.

usage: png.py size FILE            prints "W x H"
       png.py order FILE COLOUR... whether the middles of what has these colours go from left to right
       png.py near FILE OTHER A B  whether the upper part of FILE is OTHER: at most the part A of the
                                   pixels differs by more than a rounding, and B by much
"""
import sys

from PIL import Image


def decode(name):
    """Width, height, and the rows of pixels as tuples."""
    with open(name, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and data.endswith(b"IEND\xaeB`\x82"), "no PNG, or cut off"
    image = Image.open(name)
    width, height = image.size
    pixels = list(image.convert("RGB").getdata())  # reads all of it
    return width, height, [pixels[y * width:(y + 1) * width] for y in range(height)]


COLOURS = {
    "magenta": lambda r, g, b: r > g + 60 and b > g + 30,
    "teal": lambda r, g, b: g > r + 25 and b > r + 20,
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
