"""Faults in which records there are: levels, generations, the frontier."""

from planting import MIDDLE, fault, move, named, part, shard

part("Records and levels")


@fault("a record doubled", refused="rows out of order at point 5")
def _(g):
    g.rows.insert(g.rows.index(g.at(MIDDLE)), g.at(MIDDLE))


@fault("two records out of order", refused="rows out of order at point 0")
def _(g):
    g.rows[0], g.rows[1] = g.rows[1], g.rows[0]


@fault("two levels out of order", refused="rows out of order at point 5")
def _(g):
    r = g.rows.index(g.at(MIDDLE))
    g.rows[r], g.rows[r + 1] = g.rows[r + 1], g.rows[r]


@fault("a point's last level lost", "links", "continuous")
def _(g):
    g.rows.remove(g.at(MIDDLE, 1))


@fault("a point's first level lost", refused="level 1 where level 0 of at most 8 was expected")
def _(g):
    g.rows.remove(g.at(MIDDLE))


@fault("a point's first level lost, the second in its place", "links", "generations", "fidelity", "continuous")
def _(g):
    g.rows.remove(g.at(MIDDLE))
    g.at(MIDDLE, 1)["level"] = 0


@fault("a point's only level lost", "coverage", "links", "continuous")
def _(g):
    g.rows.remove(g.at(1))
    return "point 1 (1, 0, 0)"


@fault("a plane of points lost", "coverage", "links", "continuous", "reachable")
def _(g):
    g.rows = [r for r in g.rows if shard.coordinates(g.box, r["point"])[0] != 3]


@fault("all records lost but the seeds", "coverage", "links", "generations", "continuous")
def _(g):
    g.rows = [r for r in g.rows if r["generation"] == 0]


@fault("a level whose number skips one", refused="level 2 where level 1 of at most 8 was expected")
def _(g):
    g.at(MIDDLE, 1)["level"] = 2


def another_level(g, **changes):
    row = dict(g.at(MIDDLE, 1), level=2, **changes)
    row["links"] = list(row["links"])
    g.rows.insert(g.rows.index(g.at(MIDDLE, 1)) + 1, row)
    return row


@fault("a level too many, the copy of another", "reachable", "distinct")
def _(g):
    return named(g, another_level(g))


@fault("a level too many, that nothing leads to", "reachable", "fidelity")
def _(g):
    return named(g, another_level(g, state=[0.7]))


@fault("a level too many, that says it is a seed", "generations", "fidelity")
def _(g):
    another_level(g, state=[0.7], generation=0)


@fault("two levels exchanged, and all links to them", "generations")
def _(g):
    a, b = g.at(MIDDLE), g.at(MIDDLE, 1)
    into = list(g.into(MIDDLE))
    for row, q in into:
        move(row, q)
    r = g.rows.index(a)
    g.rows[r : r + 2] = [dict(b, level=0), dict(a, level=1)]


part("Generations and the frontier")


@fault("a generation one too large", "generations")
def _(g):
    row = g.at(4)
    row["generation"] += 1
    return named(g, row)


@fault("a generation one too small", "generations")
def _(g):
    row = g.at(4, 1)
    row["generation"] -= 1
    return named(g, row)


@fault("all generations one too large", "reachable", "complete", "links")
def _(g):
    for row in g.rows:
        row["generation"] += 1


@fault("a seed that says it was found late", "generations")
def _(g):
    g.at(0)["generation"] = 2
    return named(g, g.at(0))


@fault("no seeds", "reachable")
def _(g):
    for row in g.rows:
        row["generation"] = max(1, row["generation"])


@fault("a record in the middle that says it is a seed", "generations")
def _(g):
    g.at(MIDDLE)["generation"] = 0


@fault("the generations of two levels exchanged", "generations")
def _(g):
    a, b = g.at(MIDDLE), g.at(MIDDLE, 1)
    a["generation"], b["generation"] = b["generation"], a["generation"]


@fault("a generation from the future", refused="a record of generation 15")
def _(g):
    g.at(MIDDLE, 1)["generation"] = 15


@fault("a grid that says it is a round older", "generations")
def _(g):
    g.header["generation"] += 1


@fault("a frontier left over: the last round not expanded", "complete")
def _(g):
    g.header["generation"] -= 1
    young = [row for row in g.rows if row["generation"] == g.header["generation"]]
    for row in young:
        row["links"] = [254 if v < 254 else v for v in row["links"]]
    return named(g, young[0])


@fault("a frontier left over, with links", "complete", "links")
def _(g):
    g.header["generation"] -= 1


@fault("a frontier of which one record has links", "links", "complete", "coverage", grid="middle")
def _(g):
    row = next(r for r in g.rows if r["generation"] == 1)
    row["links"] = [0 if v < 255 else v for v in row["links"]]
    return named(g, row)
