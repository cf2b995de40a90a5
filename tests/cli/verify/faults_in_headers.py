"""Faults in what the header says of a grid."""

import copy

from planting import message_fault, part

part("The header")


def header(name, *rows, grid="ball", refused=None, **changes):
    @message_fault(name, *rows, grid=grid, refused=refused)
    def _(messages):
        messages[0]["header"].update(copy.deepcopy(changes))


def box(name, *rows, refused=None, grid="ball", **changes):
    @message_fault(name, *rows, refused=refused, grid=grid)
    def _(messages):
        messages[0]["header"]["box"].update(changes)


def parameter(name, *rows, grid="ball", refused=None, **changes):
    @message_fault(name, *rows, grid=grid, refused=refused)
    def _(messages):
        for p in messages[0]["header"]["parameters"]:
            if p["key"] in changes:
                p["value"] = {"number": changes[p["key"]]}


box("the spacing 1 % larger", "fidelity", "stable", spacing=0.101)
box("the spacing doubled", "fidelity", "stable", spacing=0.2)
box("the origin moved", "fidelity", "stable", originX=-0.6)
box("the origin not finite", refused="box: origin is not finite", originY="NaN")
box("a plane of points more", "coverage", "links", "continuous", countZ=3)
box("a plane of points less", refused="point 42 is outside the box", countZ=1)
box("points in x and y exchanged", "links", "reachable", "generations", "fidelity", "stable", "continuous", countX=3, countY=14)
box("points in y and z exchanged", "links", "fidelity", "stable", "continuous", countY=2, countZ=3)
box("no points", refused="box: a count is 0...", countY=0)
box("more points than can be", refused="box: more than 4294967295 grid points", countX=4294967295)
parameter("another radius of the balls", "fidelity", "stable", radius=0.11)
parameter("another weight", "stored", grid="stored", weight=1.5)
parameter("another bound of the force", "stored", "gradient", grid="stored", max_force=0.2)
parameter("another tolerance of the model", refused="it and the grid differ in tolerance...", tolerance=1e-5)
parameter("a parameter out of its range", refused="radius...", radius=0.6)
header("a parameter that the model does not have", refused="unknown parameter...",
       parameters=[{"key": "colour", "value": {"number": 1}}])
header("a parameter of another kind", refused="parameter radius must be a number...",
       parameters=[{"key": "radius", "value": {"text": "0.1"}}])
header("another tolerance", refused="it and the grid differ in tolerance...", tolerance=1e-5)
header("another unit of the tolerance", refused="it and the grid differ in the units...", toleranceUnit="deg")


@message_fault("another tolerance, of the model too", "distinct")
def _(messages):
    messages[0]["header"]["tolerance"] = 0.9
    for p in messages[0]["header"]["parameters"]:
        if p["key"] == "tolerance":
            p["value"] = {"number": 0.9}


header("another tolerance function", refused="is a process, which is only started with --allow-process...",
       equality={"norm": "max", "weights": []})
header("another model", refused="unknown parameter max_force...", model="spring-c")
header("a model that there is not", refused="no plug-in none.so in...", model="none")
header("a model by its path", refused="a plug-in's name has only letters...", model="../hung-ball")
header("a state of more components", refused="column state does not fit the chunk", stateSize=2)
header("a smaller level limit", refused="level 1 at point 2, the limit is 1", maxLevels=1)
header("no level limit", refused="a level limit of 0; 1 to 254 are possible", maxLevels=0)
header("force that is said not to be stored", refused="column force does not fit the chunk", grid="stored",
       stored={"force": False, "energy": True, "shape": True})
header("force that is said to be stored", refused="column force does not fit the chunk", stored={"force": True})
header("another generation of the header", refused="a record of generation 11", generation=9)
header("content of another kind", refused="holds requests where a grid is needed", content="requests")
header("another format", refused="not a hapgrid shard", magic="1")
header("a version to come", refused="format version 2...", version=2)


@message_fault("a sphere of another size", refused="it and the grid differ in the spheres that show the model...", grid="stored")
def _(messages):
    messages[0]["header"]["spheres"][0]["radius"] = 0.2
