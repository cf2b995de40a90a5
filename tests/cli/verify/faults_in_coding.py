"""Faults in how a finished grid is coded, and against the grid that it was made from."""

from planting import MIDDLE, fault, message_fault, named, part

part("The coding of finished grids")


def coded(name, *rows, grid="coded", refused=None, arguments="", **changes):
    @message_fault(name, *rows, grid=grid, refused=refused, arguments=arguments)
    def _(messages):
        chunk = messages[1]["coded"]
        for column, change in changes.items():
            change(chunk[column])


def coding(name, *rows, grid="lossy", refused=None, arguments="", change=None):
    @message_fault(name, *rows, grid=grid, refused=refused, arguments=arguments)
    def _(messages):
        change(messages[0]["header"])


def put(at, value):
    def change(values):
        assert values[at] != value
        values[at] = value
    return change


def increase(at):
    return lambda values: put(at, values[at] + 1)(values)


def scale_bounds(header, factor):
    header["coding"]["bounds"] = [factor * b for b in header["coding"]["bounds"]]


coding("a plain grid that says it is coded", refused="a coded chunk was expected", grid="ball",
       change=lambda h: h.update(version=2, coding={}))
coding("a coded grid that says it is plain", refused="a coding where there can be none...", grid="coded",
       change=lambda h: h.update(version=1))
coding("a coded grid without its coding", refused="a coding where there can be none...", grid="coded",
       change=lambda h: h.pop("coding"))
coding("a precision where nothing is lost", refused="bounds of 0 columns", grid="coded",
       change=lambda h: h["coding"].update(precision=0.001))
coding("a better precision than that of the bounds", "precision", change=lambda h: h["coding"].update(precision=0.0005))
coding("a precision that cannot be", refused="an impossible precision", change=lambda h: h["coding"].update(precision=0.5))
coding("bounds ten times as large, and the numbers", "fidelity", change=lambda h: scale_bounds(h, 10))
coding("bounds 1 % larger, and the numbers", "precision", "fidelity", arguments="--against stored", change=lambda h: scale_bounds(h, 1.01))
coding("bounds half as large, and the numbers", "precision", "fidelity", arguments="--against stored",
       change=lambda h: scale_bounds(h, 0.5))
coding("bounds exchanged", "precision", "fidelity", change=lambda h: h["coding"]["bounds"].reverse())
coding("a bound that cannot be", refused="an impossible bound of a column", change=lambda h: put(0, -1.0)(h["coding"]["bounds"]))
coding("a bound lost", refused="bounds of 34 columns", change=lambda h: h["coding"]["bounds"].pop())
coded("a coded state that starts elsewhere", "fidelity", first=increase(6))
coded("a coded residual off by one", "fidelity", residuals=increase(-1))
coded("another prediction", "fidelity", "finite", order=increase(0))
coded("a coded level off by one", refused="level 1 where level 0 of at most 8 was expected", level=increase(0))
coded("a coded generation off by one", refused="a record of generation 4294967294", generation=increase(1))
coded("a coded link to a level that is not there", "links", "paths", links=put(13, 7))
coded("a coded point moved", refused="point 84 is outside the box", point=increase(3))
coded("a number off by a step", "precision", grid="lossy", arguments="--against stored --recompute none",
      residuals=increase(-1))
coded("a column's steps taken for its bits", "fidelity", "precision", grid="lossy", shift=put(0, 0))


@fault("a number that is not the original's", "precision", grid="stored", arguments="--against stored --recompute none")
def _(g):
    row = g.at(MIDDLE)
    row["force"][1] *= 1 + 1e-15
    return named(g, row)


@fault("a generation that is not the original's", "precision", grid="stored", arguments="--against stored --recompute none")
def _(g):
    # Of a seed beside another one: as good a grid, but another one.
    g.at(0)["generation"] = 1


@fault("a record that the original does not have", grid="stored", arguments="--against stored --recompute none",
       refused="the original has 158 records in generation 14, not 157 in generation 14")
def _(g):
    g.rows.remove(g.at(MIDDLE, 1))
