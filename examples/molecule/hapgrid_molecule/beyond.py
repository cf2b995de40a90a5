"""The path of a torsion that goes on behind its saddles, from minimum to minimum.

From the conformation the torsion is driven over one saddle after the other in the same direction.
Each leg leads from a minimum up to a saddle and down to the next one. Where a whole turn comes back
to the conformation, the circle is cut at a saddle, whose two sides become the path's ends: the
highest one from which the conformation is reached on both sides before its halves have turned so far
against each other that the alignment jumps. Otherwise the other direction is driven, too.
"""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from . import geometry, optimise, path, torsions
from .xtb import BOHR, HARTREE, XtbError

LEGS = 6  # in one direction, at most
JUMP = 3.0  # times the way that the atoms go: how far an aligned shape moves where the alignment jumps
FIRST_LEG = 10  # segments from the conformation to its first saddle; their length holds for all


@dataclass
class Beyond:
    """A path for a file. nodes: aligned to the conformation, which is the one at `start`, bohr;
    energies: hartree; kinds: as a Way has them; why: each end is where it is."""
    name: str
    torsion: str
    nodes: list
    energies: list
    start: int
    kinds: dict
    why: str
    goes_on: ClassVar = True

    @property
    def barrier(self):
        return max(self.energies)


@dataclass
class Way:
    """What driving a torsion found. nodes, energies (bohr, hartree) from the conformation on; kinds:
    "minimum" or "saddle" by node, without the conformation; why: it ended there. closed: the last node
    is the conformation once more."""
    nodes: list
    energies: list
    kinds: dict = field(default_factory=dict)
    why: str = ""
    closed: bool = False


def _leg(work, torsion, sign, x, energy, hessian, apart):
    """(nodes up to the saddle, energies), (from the saddle down, energies), (x, energy, hessian) of the
    minimum behind it. The saddle is in both lists, and so is the minimum."""
    surface, tree = work.surface, work.tree
    left = work.options.highest / HARTREE - (energy - work.energy)
    guess, tangent = torsions.scan(surface, x, hessian, torsion, sign, highest=left)
    saddle, top, bend, _ = work.climbed(guess, tangent)
    sides = work.sides(saddle, bend)
    near, far = sides if work.same(sides[0][1], x) else sides[::-1]
    if not work.same(near[1], x):
        raise optimise.NoPath(f"the saddle at {work.above(top):.2f} kJ/mol joins other minima")
    if not work.intact(far[1]):
        raise optimise.NoPath("bonds change")
    there = np.round(far[1] * BOHR, 8) / BOHR  # as in the file
    up = path.nodes(surface, tree, saddle, bend, near[0], x, energy,
                    count=FIRST_LEG + 1, apart=apart)
    if apart is None:
        apart = path.length(up[0], surface.masses) / FIRST_LEG
    down = path.nodes(surface, tree, saddle, bend, far[0], there, surface.energy(there), apart=apart)
    return up, (down[0][::-1], down[1][::-1]), (there, down[1][0], far[3]), apart


def drive(work, torsion, sign, apart=None, known=()):
    """(Way, distance of its nodes) of a torsion in one direction. It ends before a saddle to one of the
    known minima."""
    way = Way([work.x], [work.energy])
    x, energy, hessian = work.x, work.energy, work.hessian
    for _ in range(LEGS):
        try:
            up, down, (x, energy, hessian), apart = _leg(work, torsion, sign, x, energy, hessian, apart)
        except (optimise.NoPath, XtbError) as why:
            way.why = str(why)
            return way, apart
        minima = [way.nodes[k] for k, kind in way.kinds.items() if kind == "minimum"]
        way.closed = work.same(x, work.x)
        if not way.closed and any(work.same(x, y) for y in [*minima, *known]):
            way.why = "a minimum that it has already"
            way.nodes += up[0][1:-1]
            way.energies += up[1][1:-1]
            return way, apart
        way.nodes += up[0][1:]
        way.energies += up[1][1:]
        way.kinds[len(way.nodes) - 1] = "saddle"
        way.nodes += down[0][1:]
        way.energies += down[1][1:]
        if way.closed:
            way.why = "back in the conformation"
            return way, apart
        way.kinds[len(way.nodes) - 1] = "minimum"
    way.why = f"{LEGS} saddles are enough"
    return way, apart


def whole(work, torsion):
    """The Beyond of a torsion: both directions as one path. Raises optimise.NoPath where no minimum is behind a
    saddle."""
    plus, apart = drive(work, torsion, 1)
    if plus.closed:
        plus, minus = _cut(work, plus)
    else:
        found = [plus.nodes[k] for k, kind in plus.kinds.items() if kind == "minimum"]
        minus, _ = drive(work, torsion, -1, apart, found)
        if minus.closed:
            raise optimise.NoPath("a whole turn comes back in one direction only")
        plus, minus = _before_jump(work, plus), _before_jump(work, minus)
    if not {"minimum"} & {*plus.kinds.values(), *minus.kinds.values()}:
        raise optimise.NoPath(f"nothing behind its saddles: {plus.why}; {minus.why}")
    start = len(minus.nodes) - 1
    nodes = minus.nodes[:0:-1] + plus.nodes
    nodes = [n if k == start else geometry.aligned(n, work.x, work.surface.masses)
             for k, n in enumerate(nodes)]
    kinds = {start - k: kind for k, kind in minus.kinds.items()}
    kinds.update({start + k: kind for k, kind in plus.kinds.items()})
    return Beyond(torsion.name, torsion.name, nodes, minus.energies[:0:-1] + plus.energies, start,
                  dict(sorted(kinds.items())), f"{plus.why}; {minus.why}")


def _jump(work, nodes):
    """The first node at which the alignment with the conformation jumps; None where it never does."""
    masses = work.surface.masses
    chain = path.aligned_chain(nodes, masses)
    aligned = [geometry.aligned(n, work.x, masses) for n in nodes]
    for k in range(1, len(nodes)):
        if geometry.rms(aligned[k], aligned[k - 1]) > JUMP * geometry.rms(chain[k], chain[k - 1]):
            return k
    return None


def _part(way, count):
    """The first nodes of a way."""
    return Way(way.nodes[:count], way.energies[:count],
               {k: kind for k, kind in way.kinds.items() if k < count}, way.why)


def _before_jump(work, way):
    """A way without what is behind the last saddle before a jump, where there is one."""
    at = _jump(work, way.nodes)
    if at is None:
        return way
    last = max((k for k in way.kinds if k < at), default=at)
    out = _part(way, last if way.kinds.get(last) == "saddle" else at)
    out.why = "the molecule's alignment would jump"
    return out


def _cut(work, circle):
    """The two parts of a circle, each from the conformation to a node before one of its saddles."""
    last = len(circle.nodes) - 1
    back = Way([circle.nodes[0], *circle.nodes[-2::-1]], [circle.energies[0], *circle.energies[-2::-1]],
               {last - k: kind for k, kind in circle.kinds.items()}, circle.why)
    saddles = [k for k, kind in circle.kinds.items() if kind == "saddle"]
    if len(saddles) == 1:  # of the same shape once more
        return circle, _part(back, 1)
    saddles.sort(key=lambda k: -circle.energies[k])
    parts = [(_part(circle, k), _part(back, last - k)) for k in saddles]
    smooth = [both for both in parts if all(_jump(work, part.nodes) is None for part in both)]
    return smooth[0] if smooth else tuple(_before_jump(work, part) for part in parts[0])
