"""coded.py SHARD: a coded grid as `stats --dump` prints its plain form.

A decoder of its own: written from schemas/CODING.md, on the stock tools and Python's integers and
doubles; nothing of hapgrid's is used.
"""

import os
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import shard

BACK = (12, 10, 4)  # directions -i, -j, -k
MODULUS = 1 << 64


def planes(data, count, width):
    return [sum(data[p * count + r] << 8 * p for p in range(width)) for r in range(count)]


def unzigzag(z):
    return -(z + 1) // 2 if z & 1 else z // 2


def bits_of(value):
    return struct.unpack("<Q", struct.pack("<d", value))[0]


def double_of(bits):
    return struct.unpack("<d", struct.pack("<Q", bits))[0]


def finite(value):
    return value if isinstance(value, int) or abs(value) < float("inf") else 0.0


class Rows:
    """Points, levels, links and generations of a chunk, and the way back from each row."""

    def __init__(self, chunk, box):
        self.count = count = chunk["rows"]
        self.level = chunk["level"]
        self.links = [chunk["links"][26 * r : 26 * r + 26] for r in range(count)]
        self.point = []
        for step in planes(chunk["point"], count, 4):
            self.point.append(step + (self.point[-1] if self.point else 0))
        self.generation = []
        for z in planes(chunk["generation"], count, 4):
            before = self.generation[-1] if self.generation else 0
            self.generation.append((before + unzigzag(z)) % (1 << 32))
        nx, ny, _ = shard.counts(box)
        strides = (1, nx, nx * ny)
        row_of = {}
        self.back = ([], [], [])
        self.depth = ([], [], [])
        self.fallback = []
        for r in range(count):
            near = []
            for a in range(3):
                link = self.links[r][BACK[a]]
                key = (self.point[r] - strides[a], link)
                near.append(row_of.get(key) if link < 254 else None)
            row_of[self.point[r], self.level[r]] = r
            self.fallback.append(next((n for n in near if n is not None), r - 1))
            for a in (2, 1, 0):
                same = near[a] is not None and all(
                    self.depth[b][near[a]] == self.depth[b][r] for b in range(a + 1, 3))
                self.back[a].append(near[a] if same else None)
                self.depth[a].append(min(3, 1 + self.depth[a][near[a]]) if same else 0)

    def extrapolate(self, v, a, order, r):
        m = min(order, self.depth[a][r])
        if m == 0:
            return 0
        at = self.back[a][r]
        v1 = v[at]
        if m == 1:
            return v1
        at = self.back[a][at]
        v2 = v[at]
        if m == 2:
            return 2 * v1 - v2
        return 3 * v1 - (3 * v2 - v[self.back[a][at]])

    def column(self, orders, first, value):
        """`value(r, P)` answers the value of row r as it is predicted with."""
        x, y, z = [], [], []
        for r in range(self.count):
            k = self.extrapolate(x, 2, orders[2], r)
            b = self.extrapolate(y, 1, orders[1], r) + k
            p = finite(b + self.extrapolate(z, 0, orders[0], r))
            if not any(min(orders[a], self.depth[a][r]) for a in range(3)):
                p = first if r == 0 else x[self.fallback[r]]
            x.append(finite(value(r, p)))
            y.append(x[r] - k)
            z.append(x[r] - b)


def decode_column(rows, order, shift, first, residuals, bound):
    orders = (order & 3, order >> 2 & 3, order >> 4)
    out = []
    if shift == 255:
        step = 1.9990234375 * bound

        def integer(r, predicted):
            whole = (int(predicted) + unzigzag(residuals[r])) % MODULUS
            out.append(float(whole - MODULUS if whole >= MODULUS // 2 else whole) * step)
            return whole

        rows.column(orders, first, integer)
        return out
    width = 64 - shift
    half = 1 << width - 1

    def double(r, predicted):
        u = (bits_of(predicted) + (1 << shift >> 1)) % MODULUS >> shift
        place = u + half if u < half else 2 * half - 1 - u
        place = (place + unzigzag(residuals[r])) % (2 * half)
        u = place - half if place >= half else 2 * half - 1 - place
        out.append(double_of(u << shift))
        return out[-1]

    rows.column(orders, double_of(first), double)
    return out


def main(name):
    with open(name, "rb") as file:
        messages = shard.decode(file.read())
    header = messages[0]["header"]
    assert header["version"] == 2
    bounds = header["coding"].get("bounds", [])
    for message in messages[1:-1]:
        chunk = {"level": [], "links": [], **message["coded"]}
        rows = Rows(chunk, header["box"])
        columns = []
        at = 0
        residuals = chunk.get("residuals", [])
        first = struct.unpack("<%dQ" % len(chunk["order"]), bytes(chunk["first"]))
        for c, width in enumerate(chunk["planes"]):
            end = at + width * rows.count
            columns.append(decode_column(rows, chunk["order"][c], chunk["shift"][c], first[c],
                                         planes(residuals[at:end], rows.count, width),
                                         bounds[c] if bounds else 0))
            at = end
        assert at == len(residuals)
        for r in range(rows.count):
            fields = [*shard.coordinates(header["box"], rows.point[r]), rows.level[r]]
            fields += ["%.17g" % column[r] for column in columns[: header["stateSize"]]]
            fields += [{255: "-", 254: "?"}.get(link, link) for link in rows.links[r]]
            print(*fields, sep="\t")


main(sys.argv[1])
