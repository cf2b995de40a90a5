"""What faults.py plants with: grids as rows that can be changed, and back to the bytes of a shard."""

import copy
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import shard


class Grid:
    """A plain grid; its shard is sealed with one chunk. `rows` are dictionaries with point, level, generation, links (26),
    state and, where they are stored, force, energy and shape, each a list."""

    NUMBERS = ("state", "force", "energy", "shape")

    def __init__(self, data):
        messages = shard.decode(data)
        self.header = messages[0]["header"]
        self.footer = messages[-1]["footer"]
        self.rows = [row for message in messages[1:-1] for row in self.rows_of(message["records"])]

    def rows_of(self, columns):
        n = len(columns["point"])
        for r in range(n):
            row = {name: columns[name][r] for name in ("point", "level", "generation")}
            row["links"] = columns["links"][26 * r : 26 * r + 26]
            for name in self.NUMBERS:
                row[name] = [float(v) for v in columns.get(name, [])[r::n]]
            yield row

    @property
    def box(self):
        return self.header["box"]

    def at(self, point, level=0):
        return next(r for r in self.rows if (r["point"], r["level"]) == (point, level))

    def levels(self, point):
        return sum(r["point"] == point for r in self.rows)

    def target(self, row, q):
        """The record where a link leads."""
        return self.at(shard.neighbour(self.box, row["point"], q), row["links"][q])

    def into(self, point, level=None):
        """All (record, q) whose link leads to a point, or to one level of it."""
        for row in self.rows:
            for q in range(26):
                if shard.neighbour(self.box, row["point"], q) == point and level in (None, row["links"][q]):
                    yield row, q

    def messages(self):
        columns = {}
        for name in ("point", "level", "generation"):
            columns[name] = [row[name] for row in self.rows]
        columns["links"] = [byte for row in self.rows for byte in row["links"]]
        for name in self.NUMBERS:
            columns[name] = [v if v == v and abs(v) != float("inf") else
                             {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}[str(v)]
                             for column in zip(*(row[name] for row in self.rows)) for v in column]
        return [{"header": self.header}, {"records": columns}, {"footer": self.footer}]

    def seal(self, **options):
        return shard.seal(self.messages(), **options)

    def part(self, keep):
        """The same with the rows that keep(row) has."""
        other = copy.deepcopy(self)
        other.rows = [row for row in other.rows if keep(row)]
        return other


def read(name):
    with open(name, "rb") as file:
        return file.read()


FAULTS = []
current = None  # part of the table


class Fault:
    def __init__(self, part, name, make, rows=(), refused=None, arguments=(), grid="ball"):
        self.part, self.name, self.make = part, name, make
        self.rows, self.refused, self.arguments, self.grid = rows, refused, arguments, grid

    def is_refusal(self, line):
        """Whether the line ends with the text, in which ... stands for anything."""
        text = re.escape(self.refused).replace(r"\.\.\.", ".*")
        return re.fullmatch("verify: .*%s\n" % text, line) is not None

    def found_by(self):
        if self.refused:
            return "*" + self.refused + "*"
        return ", ".join(self.rows) or "nothing"


def part(title):
    """The faults that follow belong to it."""
    global current
    current = title


def fault(name, *rows, refused=None, arguments="", grid="ball"):
    """Of a plain grid, changed as rows."""
    def plant(change):
        def make():
            g = Grid(read(grid))
            where = change(g)
            return g.seal(), where
        FAULTS.append(Fault(current, name, make, rows, refused, arguments.split(), grid))
    return plant


def message_fault(name, *rows, refused=None, arguments="", grid="ball", **options):
    """Of any shard, changed as messages."""
    def plant(change):
        def make():
            messages = shard.decode(read(grid))
            where = change(messages)
            return shard.seal(messages, **options), where
        FAULTS.append(Fault(current, name, make, rows, refused, arguments.split(), grid))
    return plant


def byte_fault(name, *rows, refused=None, arguments="", grid="ball"):
    """Of the bytes of a shard; the change answers the new ones."""
    def plant(change):
        FAULTS.append(Fault(current, name, lambda: (change(read(grid)), None), rows, refused,
                            arguments.split(), grid))
    return plant


def named(g, row, q=None):
    """The place as verify names it."""
    x = "(%d, %d, %d)" % shard.coordinates(g.box, row["point"])
    text = "point %d %s level %d" % (row["point"], x, row["level"])
    return text if q is None else text + " direction %d " % q


X, LEFT, EDGE, VERTEX = map(shard.STEPS.index, ((1, 0, 0), (-1, 0, 0), (1, 1, 0), (1, 1, 1)))
MIDDLE = 5  # a point with two levels: the ball pushed away a little, and a lot
TOLERANCE = 1e-6


# Changes of a plain grid. Those that answer a place say which one was changed.


def put(g, row, **changes):
    row.update(changes)
    return named(g, row)


def link(g, level, q=X, point=MIDDLE):
    g.at(point)["links"][q] = level
    return named(g, g.at(point), q)


def move(g, row, q=X):
    """The link to the other one of two levels."""
    row["links"][q] = 1 - row["links"][q]
    return named(g, row, q)


def unsettle(row):
    row["links"] = [254 if v < 254 else v for v in row["links"]]


def exchange(a, b, name):
    a[name], b[name] = b[name], a[name]


def levels_exchanged(name, point=MIDDLE):
    return lambda g: exchange(g.at(point), g.at(point, 1), name)


def points_exchanged(name):
    return lambda g: exchange(g.at(MIDDLE), g.at(MIDDLE + 1), name)


def each(name, change):
    """Of all records."""
    def plant(g):
        for row in g.rows:
            row[name] = [change(v) for v in row[name]]
    return plant


def add(name, much, point=MIDDLE, level=0):
    def plant(g):
        g.at(point, level)[name][0] += much
    return plant
