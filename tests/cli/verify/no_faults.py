"""Changes that are no faults: verify has to find these grids fine."""

from planting import MIDDLE, TOLERANCE, fault, part

part("No faults: other grids that are as good, or what only people read")


@fault("a state moved by half a tolerance")
def _(g):
    g.at(MIDDLE)["state"][0] += 0.5 * TOLERANCE


@fault("a seed that says it is none, beside another seed")
def _(g):
    g.at(0)["generation"] = 1


@fault("a larger level limit")
def _(g):
    g.header["maxLevels"] = 254


@fault("another weight, of a force that is not stored")
def _(g):
    for p in g.header["parameters"]:
        if p["key"] == "weight":
            p["value"] = {"number": 1.1}


@fault("another unit of length, in words")
def _(g):
    g.header["lengthUnit"] = "furlongs"


@fault("another radius of the HIP's ball, for pictures", grid="ball")
def _(g):
    g.header["hipRadius"] = 0.5


@fault("a force scaled by 1 + 1e-7", grid="stored")
def _(g):
    for row in g.rows:
        row["force"] = [(1 + 1e-7) * f for f in row["force"]]


@fault("a force and an energy that are 0 everywhere", grid="fine", arguments="--recompute none")
def _(g):
    for row in g.rows:
        row["force"] = [0.0, 0.0, 0.0]
        row["energy"] = [0.0]
