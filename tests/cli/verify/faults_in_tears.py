"""Faults in the tear fractions, which only the grid torn has."""

from planting import fault, named, part

part("Tear fractions")


def link(g, tears):
    """The first direction of a record with such a tear byte, as (record, q)."""
    return next((row, q) for row in g.rows for q in range(26) if row["tears"][q] in tears)


def moved(g, by):
    row, q = link(g, range(2, 29))
    row["tears"][q] += by
    return row, q


@fault("a tear fraction lost", "fractions", grid="torn")
def _(g):
    row, q = link(g, range(32))
    row["tears"][q] = 255
    return named(g, row)


@fault("a tear fraction of a link there and back", "fractions", grid="torn")
def _(g):
    row, q = next((row, q) for row in g.rows for q in range(26) if row["links"][q] < 254 and row["tears"][q] == 255)
    row["tears"][q] = 0
    return named(g, row)


@fault("a tear fraction of a direction that leaves the box", "fractions", grid="torn")
def _(g):
    row = g.rows[0]
    row["tears"][0] = 0
    return named(g, row)


@fault("a tear fraction two intervals off", "tears", grid="torn")
def _(g):
    return named(g, moved(g, 2)[0])


@fault("all tear fractions the middle", "tears", grid="torn")
def _(g):
    for row in g.rows:
        row["tears"] = [255 if t == 255 else 16 for t in row["tears"]]


@fault("a tear fraction one interval off, as of another machine", grid="torn")
def _(g):
    moved(g, 1)


@fault("a tear fraction beyond the link", refused="a tear fraction of 32", grid="torn")
def _(g):
    row, q = link(g, range(32))
    row["tears"][q] = 32


@fault("a column of tear fractions too short", refused="column tears does not fit the chunk", grid="torn")
def _(g):
    g.rows[-1]["tears"].pop()


@fault("no column of tear fractions", refused="column tears does not fit the chunk", grid="torn")
def _(g):
    for row in g.rows:
        row["tears"] = []


@fault("tear fractions that the header does not tell of", refused="column tears does not fit the chunk", grid="torn")
def _(g):
    g.header["tears"] = "wanted"


@fault("tear fractions in a grid with a frontier", refused="tear fractions in a grid that has a frontier", grid="torn")
def _(g):
    g.header["generation"] -= 1
