"""Changes that are no faults: verify has to find these grids fine."""

from planting import TOLERANCE, add, each, fault, part

part("No faults: other grids that are as good, or what only people read")


def header(name, **changes):
    fault(name)(lambda g: g.header.update(changes))


fault("a state moved by half a tolerance")(add("state", 0.5 * TOLERANCE))
fault("a seed that says it is none, beside another seed")(lambda g: g.at(0).update(generation=1))
header("a larger level limit", maxLevels=254)


@fault("another weight, of a force that is not stored")
def _(g):
    for p in g.header["parameters"]:
        if p["key"] == "weight":
            p["value"] = {"number": 1.1}


header("another unit of length, in words", lengthUnit="furlongs")
header("another radius of the HIP's ball, for pictures", hipRadius=0.5)
fault("a force scaled by 1 + 1e-7", grid="stored")(each("force", lambda v: (1 + 1e-7) * v))
fault("a force and an energy that are 0 everywhere", grid="fine", arguments="--recompute none")(
    lambda g: (each("force", lambda v: 0.0)(g), each("energy", lambda v: 0.0)(g))[1])
