"""What can be wrong with a grid, and what is done about it.

Room is one of these: how far the molecule can be pushed or turned before the probe slips past is measured,
not guessed. Where a grid has a record at a side of its box in which the molecule is not in its place, the
probe holds it there, and what lies behind is cut off. The box is then made a cell wider on that side.
"""

import json
from dataclasses import dataclass, field, replace

import numpy as np
from hapgrid_command import files

from .definition import MAX_LEVELS

WIDENED = 4  # times, at most
RIGID = 6  # the last numbers of a state: shift and rotation
# Why expand cannot compute a grid, by the word that it writes to the file of --cost, and what that means for the
# stiffest path of the grid.
HOPELESS = {"levels": f"with it a point has more than {MAX_LEVELS} states",
            "model": "with it the molecule does not come to rest"}
ROOM, RULE = "room", "rule"


@dataclass(frozen=True)
class Fault:
    """kind: one of HOPELESS, ROOM, RULE; text: for people; sides: how much more room each side of the box needs, low
    x, y, z and high x, y, z, angstrom."""
    kind: str
    text: str
    sides: tuple = ()


@dataclass(frozen=True)
class Remedies:
    """What was learnt from grids that had a fault. unwanted: paths, and why; softer: how many times softer anchors are
    than the rule has them; sides: as in Fault; widened: how often."""
    unwanted: dict = field(default_factory=dict)
    softer: int = 1
    sides: tuple = (0.0,) * 6
    widened: int = 0

    def after(self, fault, stiffest, can_soften):
        """(Remedies that also cure this fault, what is done in words), None where there is no cure. stiffest: the
        stiffest path of the grid, or None."""
        if fault.kind == ROOM:
            more = tuple(a + b for a, b in zip(self.sides, fault.sides))
            return replace(self, sides=more, widened=self.widened + 1), f"{fault.text}, which is made wider"
        if fault.kind == RULE and can_soften:
            # Where the molecule cannot yield, the probe goes through it, and the spacing does not resolve that.
            return replace(self, softer=2 * self.softer), f"{fault.text}: anchors half as stiff are tried"
        if fault.kind in HOPELESS and stiffest is not None:
            why = HOPELESS[fault.kind]
            return Remedies({**self.unwanted, stiffest: why}), f"{stiffest} is left out: {why}"
        return None

    @classmethod
    def of(cls, kept):
        """Those that asdict() gave, or none where `kept` is something else: it may come from a stranger."""
        try:
            sides, unwanted, softer, widened = (kept[k] for k in ("sides", "unwanted", "softer", "widened"))
            sides, unwanted = tuple(map(float, sides)), {str(k): str(why) for k, why in unwanted.items()}
            sound = len(sides) == 6 and all(0 <= v < 100 for v in sides) and 0 < softer < 1 << 20 and 0 <= widened <= WIDENED
        except (TypeError, ValueError, KeyError, AttributeError):
            return cls()
        return cls(unwanted, softer, sides, widened) if sound else cls()


def short_of_room(folder, grid):
    """The Fault of a grid at whose sides the molecule is held, or None."""
    array = ".room.npy"
    try:
        folder.run("stats", grid, "--npy", array)
        records = np.load(folder.path(array))
    finally:
        files.remove(folder.path(array))
    box = json.loads(folder.run("stats", grid, "--get", "box").out)
    # Where the molecule is out of its place something holds it there.
    point = records["point"][(records["state"][:, -RIGID:] != 0).any(axis=1)]
    sides, spacing = np.array([point == 0, point == np.array(box["counts"]) - 1]).any(axis=1).ravel(), box["spacing"]
    if not sides.any():
        return None
    return Fault(ROOM, "the molecule is pushed as far as a side of the box", tuple((spacing * sides).tolist()))
