"""Faults in a grid's numbers: states, and what is stored with them."""

import math

from planting import MIDDLE, TOLERANCE, add, each, fault, levels_exchanged, move, named, part, points_exchanged, put, shard

part("States")

for place, p, level in (("a seed", 0, 0), ("the first level", MIDDLE, 0), ("the second level", MIDDLE, 1)):
    for much in (10, -10, 1.5):
        fault("the state of %s moved by %g tolerances" % (place, much), "fidelity")(add("state", much * TOLERANCE, p, level))
for number in ("nan", "inf", "-inf"):
    fault("a state is %s" % number, "finite")(lambda g, number=number: put(g, g.at(MIDDLE), state=[float(number)]))
fault("a state of the other sign", "fidelity")(lambda g: g.at(MIDDLE).update(state=[-g.at(MIDDLE)["state"][0]]))
fault("a state that was lost: 0", "fidelity")(lambda g: g.at(MIDDLE).update(state=[0.0]))
fault("the states of two levels exchanged", "fidelity")(levels_exchanged("state"))
fault("the states of two points exchanged", "fidelity", "stable")(points_exchanged("state"))
fault("two levels with the same state", "distinct", "fidelity")(
    lambda g: put(g, g.at(MIDDLE), state=list(g.at(MIDDLE, 1)["state"])))
fault("two levels within the tolerance", "distinct", "fidelity")(
    lambda g: put(g, g.at(MIDDLE), state=[g.at(MIDDLE, 1)["state"][0] + 0.5 * TOLERANCE]))
fault("all states scaled", "fidelity", "stable")(each("state", lambda v: 1.001 * v))
fault("all states in degrees", "fidelity", "stable")(each("state", math.degrees))


@fault("the states of all points shifted by one record", "fidelity", "stable")
def _(g):
    states = [row["state"] for row in g.rows]
    for row, state in zip(g.rows, states[1:] + states[:1]):
        row["state"] = state


part("What is stored, and the energy of closed walks")


def scaled(much, point=MIDDLE, level=0):
    """A force."""
    return lambda g: put(g, g.at(point, level), force=[much * f for f in g.at(point, level)["force"]])


fault("a force of the wrong sign", "stored", grid="stored")(scaled(-1))
fault("all forces of the wrong sign", "stored", grid="stored")(each("force", lambda v: -v))
fault("all forces and energies of the wrong sign: snaps lead up", "stored", "passive", grid="fine")(
    lambda g: (each("force", lambda v: -v)(g), each("energy", lambda v: -v)(g))[1])
fault("all forces of the wrong sign", "passive (not proved)", grid="fine", arguments="--recompute none")(
    each("force", lambda v: -v))


@fault("a force that is no gradient", "passive (not proved)", grid="fine", arguments="--recompute none")
def _(g):
    for row in g.rows:
        i, j, _ = shard.coordinates(g.box, row["point"])
        row["force"][0] -= 0.5 * j
        row["force"][1] += 0.5 * i


fault("a link off by one", "generations", arguments="--recompute none")(lambda g: move(g, g.at(MIDDLE)) and None)
for much in (2, 1.00001, 0):
    fault("a force scaled by %g" % much, "stored", grid="stored")(scaled(much, 2, 1))
    fault("all forces scaled by %g" % much, "stored", grid="stored")(each("force", lambda v, much=much: much * v))
fault("the axes of a force exchanged", "stored", grid="stored")(lambda g: g.at(MIDDLE)["force"].reverse())
fault("the forces of two levels exchanged", "stored", grid="stored")(levels_exchanged("force"))
fault("an energy moved by a constant", "stored", grid="stored")(each("energy", lambda v: v + 0.01))
fault("an energy of the wrong sign", "stored", grid="stored")(
    lambda g: put(g, g.at(MIDDLE, 1), energy=[-g.at(MIDDLE, 1)["energy"][0]]))


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
    fault("a number of the %s is nan" % what, "finite", grid="stored")(
        lambda g, what=what: put(g, g.at(MIDDLE), **{what: [float("nan"), *g.at(MIDDLE)[what][1:]]}))
fault("a state moved by ten tolerances", "fidelity", "stored", grid="stored")(add("state", 10 * TOLERANCE))
