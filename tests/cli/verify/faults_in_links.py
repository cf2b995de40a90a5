"""Faults in the links of a grid."""

from planting import EDGE, MIDDLE, VERTEX, X, direction, fault, move, named, part

part("Links")

for way, q in (("a face", X), ("an edge", EDGE), ("a vertex", VERTEX)):
    @fault("a link across %s off by one" % way, "fidelity", "generations")
    def _(g, q=q):
        row = g.at(MIDDLE)
        move(row, q)
        return named(g, row, q)

    @fault("a link across %s to a level that is not there" % way, "links", "continuous")
    def _(g, q=q):
        row = g.at(MIDDLE)
        row["links"][q] = 2
        return named(g, row, q)

    @fault("a link across %s lost: not settled" % way, "links", "continuous")
    def _(g, q=q):
        row = g.at(MIDDLE)
        row["links"][q] = 254
        return named(g, row, q)


@fault("a link off by one where the branch is another one", "fidelity")
def _(g):
    row = g.at(MIDDLE, 1)
    move(row, X)
    return named(g, row, X)


@fault("a link off by one, there and back", "fidelity", "generations")
def _(g):
    row = g.at(MIDDLE)
    move(g.target(row, X), direction((-1, 0, 0)))
    move(row, X)
    return named(g, row, X)


@fault("a link to the level limit", "links", "continuous")
def _(g):
    g.at(MIDDLE)["links"][X] = 8


@fault("a link to level 253", "links", "continuous")
def _(g):
    g.at(MIDDLE)["links"][X] = 253


@fault("a link marked as leaving the box, inside of it", "links", "continuous")
def _(g):
    row = g.at(MIDDLE)
    row["links"][X] = 255
    return named(g, row, X)


@fault("a link to outside of the box", "links")
def _(g):
    row, q = g.at(0), direction((-1, 0, 0))
    row["links"][q] = 0
    return named(g, row, q)


@fault("a link to outside of the box, not settled", "links")
def _(g):
    g.at(0)["links"][direction((-1, 0, 0))] = 254


@fault("two links of a record exchanged", "fidelity", "generations")
def _(g):
    links = g.at(6)["links"]
    q = direction((-1, 0, 0))
    assert links[X] != links[q]
    links[X], links[q] = links[q], links[X]


@fault("a link inside exchanged with one that leaves the box", "links", "continuous")
def _(g):
    links = g.at(0)["links"]
    q = direction((-1, 0, 0))
    links[X], links[q] = links[q], links[X]


@fault("the links of two levels exchanged", "fidelity", "generations")
def _(g):
    a, b = g.at(MIDDLE), g.at(MIDDLE, 1)
    a["links"], b["links"] = b["links"], a["links"]


@fault("the links of two points exchanged", "fidelity", "generations")
def _(g):
    a, b = g.at(MIDDLE), g.at(MIDDLE + 1)
    a["links"], b["links"] = b["links"], a["links"]


@fault("a record's links shifted by one direction", "links", "continuous")
def _(g):
    links = g.at(MIDDLE)["links"]
    links.append(links.pop(0))


@fault("a record's links in the order of the opposite directions", "links", "continuous")
def _(g):
    g.at(MIDDLE)["links"].reverse()


@fault("all links to level 0", "reachable", "fidelity")
def _(g):
    for row in g.rows:
        row["links"] = [level and (255 if level == 255 else 0) for level in row["links"]]


@fault("a level that no link reaches", "reachable", "fidelity")
def _(g):
    for row, q in list(g.into(2, 1)):
        row["links"][q] = 0
    return named(g, g.at(2, 1))


@fault("a branch that no link reaches", "reachable", "fidelity")
def _(g):
    for row in g.rows:
        if row["level"] == 0:
            row["links"] = [min(v, 0) if v < 254 else v for v in row["links"]]


@fault("all links of a record lost", "links", "continuous")
def _(g):
    row = g.at(MIDDLE)
    row["links"] = [254 if v < 254 else v for v in row["links"]]


@fault("two seeds' links lost", "links", "continuous")
def _(g):
    for p in (0, 13):
        g.at(p)["links"] = [254 if v < 254 else v for v in g.at(p)["links"]]
