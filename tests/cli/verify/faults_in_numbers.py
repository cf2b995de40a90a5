"""Faults in a grid's numbers: states, and what is stored with them."""

import math

from planting import MIDDLE, TOLERANCE, X, fault, move, named, part, shard

part("States")

for place, p, level in (("a seed", 0, 0), ("the first level", MIDDLE, 0), ("the second level", MIDDLE, 1)):
    for much in (10, -10, 1.5):
        @fault("the state of %s moved by %g tolerances" % (place, much), "fidelity")
        def _(g, p=p, level=level, much=much):
            g.at(p, level)["state"][0] += much * TOLERANCE

for number in ("nan", "inf", "-inf"):
    @fault("a state is %s" % number, "finite")
    def _(g, number=number):
        row = g.at(MIDDLE)
        row["state"] = [float(number)]
        return named(g, row)


@fault("a state of the other sign", "fidelity")
def _(g):
    g.at(MIDDLE)["state"][0] *= -1


@fault("a state that was lost: 0", "fidelity")
def _(g):
    g.at(MIDDLE)["state"] = [0.0]


@fault("the states of two levels exchanged", "fidelity")
def _(g):
    a, b = g.at(MIDDLE), g.at(MIDDLE, 1)
    a["state"], b["state"] = b["state"], a["state"]


@fault("the states of two points exchanged", "fidelity", "stable")
def _(g):
    a, b = g.at(MIDDLE), g.at(MIDDLE + 1)
    a["state"], b["state"] = b["state"], a["state"]


@fault("two levels with the same state", "distinct", "fidelity")
def _(g):
    row = g.at(MIDDLE)
    row["state"] = list(g.at(MIDDLE, 1)["state"])
    return named(g, row)


@fault("two levels within the tolerance", "distinct", "fidelity")
def _(g):
    g.at(MIDDLE)["state"] = [g.at(MIDDLE, 1)["state"][0] + 0.5 * TOLERANCE]


@fault("all states scaled", "fidelity", "stable")
def _(g):
    for row in g.rows:
        row["state"][0] *= 1.001


@fault("all states in degrees", "fidelity", "stable")
def _(g):
    for row in g.rows:
        row["state"][0] = math.degrees(row["state"][0])


@fault("the states of all points shifted by one record", "fidelity", "stable")
def _(g):
    states = [row["state"] for row in g.rows]
    for row, state in zip(g.rows, states[1:] + states[:1]):
        row["state"] = state


part("What is stored, and the energy of closed walks")


@fault("a force of the wrong sign", "stored", grid="stored")
def _(g):
    row = g.at(MIDDLE)
    row["force"] = [-f for f in row["force"]]
    return named(g, row)


@fault("all forces of the wrong sign", "stored", grid="stored")
def _(g):
    for row in g.rows:
        row["force"] = [-f for f in row["force"]]


@fault("all forces and energies of the wrong sign: snaps lead up", "stored", "passive", grid="fine")
def _(g):
    for row in g.rows:
        row["force"] = [-f for f in row["force"]]
        row["energy"] = [-e for e in row["energy"]]


@fault("all forces of the wrong sign", "passive (not proved)", grid="fine", arguments="--recompute none")
def _(g):
    for row in g.rows:
        row["force"] = [-f for f in row["force"]]


@fault("a force that is no gradient", "passive (not proved)", grid="fine", arguments="--recompute none")
def _(g):
    for row in g.rows:
        i, j, _ = shard.coordinates(g.box, row["point"])
        row["force"][0] -= 0.5 * j
        row["force"][1] += 0.5 * i


@fault("a link off by one", "generations", arguments="--recompute none")
def _(g):
    move(g.at(MIDDLE), X)


for much in (2, 1.00001, 0):
    @fault("a force scaled by %g" % much, "stored", grid="stored")
    def _(g, much=much):
        row = g.at(2, 1)
        row["force"] = [much * f for f in row["force"]]
        return named(g, row)

    @fault("all forces scaled by %g" % much, "stored", grid="stored")
    def _(g, much=much):
        for row in g.rows:
            row["force"] = [much * f for f in row["force"]]


@fault("the axes of a force exchanged", "stored", grid="stored")
def _(g):
    g.at(MIDDLE)["force"].reverse()


@fault("the forces of two levels exchanged", "stored", grid="stored")
def _(g):
    a, b = g.at(MIDDLE), g.at(MIDDLE, 1)
    a["force"], b["force"] = b["force"], a["force"]


@fault("an energy moved by a constant", "stored", grid="stored")
def _(g):
    for row in g.rows:
        row["energy"][0] += 0.01


@fault("an energy of the wrong sign", "stored", grid="stored")
def _(g):
    g.at(MIDDLE, 1)["energy"][0] *= -1


@fault("a sphere of a shape moved", "stored", grid="stored")
def _(g):
    row = g.at(MIDDLE)
    row["shape"][4] += 0.01
    return named(g, row)


@fault("two spheres of a shape exchanged", "stored", grid="stored")
def _(g):
    shape = g.at(MIDDLE)["shape"]
    shape[:6] = shape[3:6] + shape[:3]


for what in ("force", "energy", "shape"):
    @fault("a number of the %s is nan" % what, "finite", grid="stored")
    def _(g, what=what):
        row = g.at(MIDDLE)
        row[what][0] = float("nan")
        return named(g, row)


@fault("a state moved by ten tolerances", "fidelity", "stored", grid="stored")
def _(g):
    g.at(MIDDLE)["state"][0] += 10 * TOLERANCE
