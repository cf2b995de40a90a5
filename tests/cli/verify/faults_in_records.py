"""Faults in which records there are: levels, generations, the frontier."""

from planting import MIDDLE, fault, levels_exchanged, move, named, part, put, shard, unsettle

part("Records and levels")


def neighbours_exchanged(point):
    """A record and the one behind it."""
    def plant(g):
        r = g.rows.index(g.at(point))
        g.rows[r], g.rows[r + 1] = g.rows[r + 1], g.rows[r]
    return plant


def lost(point, level=0):
    return lambda g: g.rows.remove(g.at(point, level))


def keep(which):
    def plant(g):
        g.rows = [row for row in g.rows if which(g, row)]
    return plant


fault("a record doubled", refused="rows out of order at point 5")(
    lambda g: g.rows.insert(g.rows.index(g.at(MIDDLE)), g.at(MIDDLE)))
fault("two records out of order", refused="rows out of order at point 0")(neighbours_exchanged(0))
fault("two levels out of order", refused="rows out of order at point 5")(neighbours_exchanged(MIDDLE))
fault("a point's last level lost", "links", "continuous")(lost(MIDDLE, 1))
fault("a point's first level lost", refused="level 1 where level 0 of at most 8 was expected")(lost(MIDDLE))
fault("a point's first level lost, the second in its place", "links", "generations", "fidelity", "continuous")(
    lambda g: (lost(MIDDLE)(g), g.at(MIDDLE, 1).update(level=0))[1])
fault("a point's only level lost", "coverage", "links", "continuous")(lambda g: lost(1)(g) or "point 1 (1, 0, 0)")
fault("a plane of points lost", "coverage", "links", "continuous", "reachable")(
    keep(lambda g, row: shard.coordinates(g.box, row["point"])[0] != 3))
fault("all records lost but the seeds", "coverage", "links", "generations", "continuous")(
    keep(lambda g, row: row["generation"] == 0))
fault("a level whose number skips one", refused="level 2 where level 1 of at most 8 was expected")(
    lambda g: g.at(MIDDLE, 1).update(level=2))


def another_level(**changes):
    def plant(g):
        row = dict(g.at(MIDDLE, 1), level=2, **changes)
        row["links"] = list(row["links"])
        g.rows.insert(g.rows.index(g.at(MIDDLE, 1)) + 1, row)
        return named(g, row)
    return plant


fault("a level too many, the copy of another", "reachable", "distinct")(another_level())
fault("a level too many, that nothing leads to", "reachable", "fidelity")(another_level(state=[0.7]))
fault("a level too many, that says it is a seed", "generations", "fidelity")(another_level(state=[0.7], generation=0))


@fault("two levels exchanged, and all links to them", "generations")
def _(g):
    a, b = g.at(MIDDLE), g.at(MIDDLE, 1)
    into = list(g.into(MIDDLE))
    for row, q in into:
        move(g, row, q)
    r = g.rows.index(a)
    g.rows[r : r + 2] = [dict(b, level=0), dict(a, level=1)]


part("Generations and the frontier")


def older(much, point, level=0):
    return lambda g: put(g, g.at(point, level), generation=g.at(point, level)["generation"] + much)


def generations(change):
    """Of all records."""
    def plant(g):
        for row in g.rows:
            row["generation"] = change(row["generation"])
    return plant


fault("a generation one too large", "generations")(older(1, 4))
fault("a generation one too small", "generations")(older(-1, 4, 1))
fault("all generations one too large", "reachable", "complete", "links")(generations(lambda v: v + 1))
fault("a seed that says it was found late", "generations")(lambda g: put(g, g.at(0), generation=2))
fault("no seeds", "reachable")(generations(lambda v: max(1, v)))
fault("a record in the middle that says it is a seed", "generations")(lambda g: g.at(MIDDLE).update(generation=0))
fault("the generations of two levels exchanged", "generations")(levels_exchanged("generation"))
fault("a generation from the future", refused="a record of generation 15")(lambda g: put(g, g.at(MIDDLE, 1), generation=15))


def frontier(g):
    """Its last round not made: the records that it found."""
    g.header["generation"] -= 1
    return [row for row in g.rows if row["generation"] == g.header["generation"]]


fault("a grid that says it is a round older", "generations")(lambda g: g.header.update(generation=g.header["generation"] + 1))


@fault("a frontier left over: the last round not expanded", "complete")
def _(g):
    young = frontier(g)
    for row in young:
        unsettle(row)
    return named(g, young[0])


fault("a frontier left over, with links", "complete", "links")(lambda g: named(g, frontier(g)[0]))


@fault("a frontier of which one record has links", "links", "complete", "coverage", grid="middle")
def _(g):
    row = next(r for r in g.rows if r["generation"] == 1)
    row["links"] = [0 if v < 255 else v for v in row["links"]]
    return named(g, row)
