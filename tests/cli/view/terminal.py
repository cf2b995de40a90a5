"""Compares what a terminal shows with a PNG of the same frame.

usage: terminal.py cells CAPTURE PNG COLUMNS ROWS   a capture of tmux, with its escape sequences
       terminal.py sixel OUTPUT PNG                 the last image in sixels
"""
import re
import sys

from png import decode


def basic(n):
    """The first 16 colours of xterm."""
    full = 255 if n > 7 else 205
    return (127,) * 3 if n == 8 else (229,) * 3 if n == 7 else tuple(full * (n >> bit & 1) for bit in range(3))


def covered(symbol):
    """The part of a cell that is foreground, of the block elements of Unicode."""
    code = ord(symbol)
    if symbol == " " or code < 128:  # the legend's letters
        return 0
    if 0x2581 <= code <= 0x2588:  # from below
        return (code - 0x2580) / 8
    if 0x2589 <= code <= 0x258f:  # from the left
        return (0x2590 - code) / 8
    parts = {0x2580: 4, 0x2590: 4, 0x2591: 2, 0x2592: 4, 0x2593: 6, 0x2594: 1, 0x2595: 1,
             0x2596: 2, 0x2597: 2, 0x2598: 2, 0x2599: 6, 0x259a: 4, 0x259b: 6, 0x259c: 6,
             0x259d: 2, 0x259e: 4, 0x259f: 6}
    return parts[code] / 8


PLAIN = (229,) * 3, (0,) * 3, False  # front, back, whether the two are exchanged


def cells(line, state):
    """The mean colour of each cell of a line, and the state at its end, which the next one has."""
    result = []
    front, back, turned = state
    for match in re.finditer(r"\x1b\[([0-9;]*)m|([^\x1b])", line):
        if match[2]:
            part = covered(match[2])
            part = 1 - part if turned else part
            result.append(tuple(part * f + (1 - part) * b for f, b in zip(front, back)))
            continue
        codes = [int(c or 0) for c in match[1].split(";")]
        while codes:
            code = codes.pop(0)
            if code == 0:
                front, back, turned = PLAIN
            elif code in (7, 27):
                turned = code == 7
            elif code in (38, 48):  # true colour
                assert codes.pop(0) == 2, codes
                colour = tuple(codes.pop(0) for _ in range(3))
                front, back = (colour, back) if code == 38 else (front, colour)
            elif code not in (1, 22):  # 39, 49: the usual ones
                colour = basic(code % 10 + (8 if code >= 90 else 0)) if code % 10 < 8 else PLAIN[code // 10 - 3]
                front, back = (colour, back) if code // 10 in (3, 9) else (front, colour)
    return result, (front, back, turned)


def block_mean(rows, x0, x1, y0, y1):
    pixels = [pixel for row in rows[y0:y1] for pixel in row[x0:x1]]
    return tuple(sum(p[c] for p in pixels) / len(pixels) for c in range(3))


what, name, png = sys.argv[1:4]
width, height, rows = decode(png)
if what == "cells":
    columns, lines = map(int, sys.argv[4:])
    text = open(name, encoding="utf-8").read().split("\n")[:lines]
    assert len(text) == lines, "rows"
    off, total, coloured, state = 0, 0, 0, PLAIN
    for y, line in enumerate(text):
        line, state = cells(line, state)
        assert len(line) == columns, (y, len(line))
        for x, cell in enumerate(line):
            wanted = block_mean(rows, x * width // columns, (x + 1) * width // columns,
                                y * height // lines, (y + 1) * height // lines)
            far = max(abs(a - b) for a, b in zip(cell, wanted))
            total += far
            # Blocks follow what is in a cell as well as they can.
            off += far > 48
            coloured += max(wanted) - min(wanted) > 60 and far <= 48
    parts = off / (columns * lines), total / (columns * lines)
    assert parts[0] < 0.02 and parts[1] < 8, parts
    assert coloured >= 5, "nothing there"
else:  # its pixels are chafa's work
    data = open(name, "rb").read().decode("latin-1")
    image = re.match(r'[0-9;]*q"1;1;%d;%d([^\x1b]*)\x1b\\' % (width, height), data[data.rindex("\x1bP") + 2:])
    assert len(set(re.findall("#([0-9]+)", image[1]))) > 5, "hardly any colours"
