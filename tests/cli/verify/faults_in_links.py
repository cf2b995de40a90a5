"""Faults in the links of a grid."""

from planting import EDGE, LEFT, MIDDLE, VERTEX, X, fault, levels_exchanged, link, move, named, part, points_exchanged, unsettle

part("Links")

for way, q in (("a face", X), ("an edge", EDGE), ("a vertex", VERTEX)):
    fault("a link across %s off by one" % way, "fidelity", "generations")(lambda g, q=q: move(g, g.at(MIDDLE), q))
    fault("a link across %s to a level that is not there" % way, "links", "continuous")(lambda g, q=q: link(g, 2, q))
    fault("a link across %s lost: not settled" % way, "links", "continuous")(lambda g, q=q: link(g, 254, q))
fault("a link off by one where the branch is another one", "fidelity")(lambda g: move(g, g.at(MIDDLE, 1)))
fault("a link off by one, there and back", "fidelity", "generations")(
    lambda g: (move(g, g.target(g.at(MIDDLE), X), LEFT), move(g, g.at(MIDDLE)))[1])
fault("a link to the level limit", "links", "continuous")(lambda g: link(g, 8))
fault("a link to level 253", "links", "continuous")(lambda g: link(g, 253))
fault("a link marked as leaving the box, inside of it", "links", "continuous")(lambda g: link(g, 255))
fault("a link to outside of the box", "links")(lambda g: link(g, 0, LEFT, 0))
fault("a link to outside of the box, not settled", "links")(lambda g: link(g, 254, LEFT, 0))


def exchanged(name, point, *rows):
    @fault(name, *rows)
    def _(g):
        links = g.at(point)["links"]
        links[X], links[LEFT] = links[LEFT], links[X]


exchanged("two links of a record exchanged", 6, "fidelity", "generations")
exchanged("a link inside exchanged with one that leaves the box", 0, "links", "continuous")
fault("the links of two levels exchanged", "fidelity", "generations")(levels_exchanged("links"))
fault("the links of two points exchanged", "fidelity", "generations")(points_exchanged("links"))
fault("a record's links shifted by one direction", "links", "continuous")(
    lambda g: g.at(MIDDLE)["links"].append(g.at(MIDDLE)["links"].pop(0)))
fault("a record's links in the order of the opposite directions", "links", "continuous")(
    lambda g: g.at(MIDDLE)["links"].reverse())


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


fault("all links of a record lost", "links", "continuous")(lambda g: unsettle(g.at(MIDDLE)))
fault("two seeds' links lost", "links", "continuous")(lambda g: (unsettle(g.at(0)), unsettle(g.at(13)))[1])
