"""Which bond a path turns.

Driving one bond can lead to the barrier of another: that of P-OH in methyl phosphate leads to the barrier of its methyl
group. So a path has the name of the bond that was driven only if this turns at least half as far as any other; otherwise
it has the name of that which turns farthest. Where several paths turn one bond the same way, that is kept for which this
bond was driven, or else the lowest.
"""

from dataclasses import dataclass

import numpy as np

from . import torsions as torsions_of


@dataclass
class Candidate:
    """A path that may be taken. job: what was driven, as messages name it; number: of the torsion that was driven; turns:
    how far each torsion turns, radians; height: of its barrier."""
    job: str
    number: int
    turns: np.ndarray
    height: float


def candidate(torsions, torsion, job, way, free):
    """The Candidate of a Way on behind barriers, or from the conformation to one. free: names of torsions that turn freely,
    so that it says nothing how far they do on the way."""
    to_end, extent = torsions_of.turned(torsions, way.nodes)
    number = next(n for n, t in enumerate(torsions) if t.name == torsion.name)
    held = [n == number or t.name not in free for n, t in enumerate(torsions)]
    return Candidate(job, number, np.where(held, extent if way.goes_on else to_end, 0.0), way.barrier)


def names(torsions, candidates, allowed, signed):
    """({key: name of its path} in the order in which they are taken, [(job, why it has no path)]).

    torsions: all bonds that turn; candidates: {key: Candidate}; allowed: the names that are wanted; signed: whether a
    name says in which direction its bond turns.
    """
    farthest = {key: torsions_of.farthest(one.turns, one.number) for key, one in candidates.items()}
    out = {}
    left = [(one.job, "no bond turns on the way to its barrier") for key, one in candidates.items() if farthest[key] is None]

    def order(key):
        """Paths whose driven bond turns come first; where several lead to one barrier, that whose bond turns farther gives
        the name. Of the others the lowest comes first."""
        one, turns = candidates[key], np.abs(candidates[key].turns)
        is_own = farthest[key] == one.number
        return (0, -round(float(turns[one.number] / turns.max()), 1)) if is_own else (1, one.height)
    for key in sorted((key for key, n in farthest.items() if n is not None), key=order):
        one, n = candidates[key], farthest[key]
        name = torsions[n].file_name(np.sign(one.turns[n])) if signed else torsions[n].name
        turns = f"turns {name} instead, by {_degrees(one.turns[n])} degrees against {_degrees(one.turns[one.number])}"
        if name in out.values():
            left.append((one.job, turns if n != one.number else f"turns as {name} does, over another barrier"))
        elif name not in allowed:
            left.append((one.job, turns + ", which is not looked for"))
        else:
            out[key] = name
            if n != one.number:
                left.append((one.job, turns))
    return out, left


def _degrees(turn):
    return f"{abs(np.degrees(turn)):.0f}"
