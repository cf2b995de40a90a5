"""Room for a molecule that yields: how far it can be pushed or turned before the probe slips past is
measured, not guessed. Where a grid has a record at a side of its box in which the molecule is not in
its place, the probe holds it there, and what lies behind is cut off. The box is then made a cell wider
on that side, and the grid is computed once more."""

import numpy as np
from preparation import files

WIDENED = 4  # times, at most
RIGID = 6  # the last numbers of a state: shift and rotation


class TooSmall(Exception):
    """sides: of the box at which the molecule is held, low x, y, z and high x, y, z; spacing: angstrom."""

    def __init__(self, sides, spacing):
        super().__init__()
        self.sides, self.spacing = sides, spacing


def check(filters, stages, grid):
    """Raises TooSmall."""
    arrays = stages.path(".room.npz")
    try:
        filters.run("stats", grid, "--npz", ".room.npz")
        with np.load(arrays) as of:
            sides = touched(of["point"], of["state"], of["counts"])
            spacing = float(of["spacing"])
    finally:
        files.remove(arrays)
    if any(sides):
        raise TooSmall(sides, spacing)


def touched(point, state, counts):
    """Whether the molecule is held out of its place anywhere on each of the six sides."""
    held = (state[:, -RIGID:] != 0).any(axis=1)[:, None]
    return [*(held & (point == 0)).any(axis=0).tolist(), *(held & (point == counts - 1)).any(axis=0).tolist()]
