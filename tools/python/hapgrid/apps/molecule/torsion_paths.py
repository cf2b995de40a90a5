"""The path of a torsion that goes on behind its saddles, from minimum to minimum.

From the conformation the torsion is driven over one saddle after the other in the same direction. Each leg leads from a
minimum up to a saddle and down to the next one. Where a whole turn comes back to the conformation, the circle is cut at a
saddle, whose two sides become the path's ends. Where the hand holds an atom that is the highest saddle, which both ends have:
what is fixed stays, and the model closes the path. Where it pushes, it is the highest saddle from which the conformation is
reached on both sides before its halves have turned so far against each other that the alignment jumps. Otherwise the other
direction is driven, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hapgrid.apps.common.arrays import Array, Shapes

from . import geometry, optimise, path
from .results import Path
from .search import Search
from .torsions import Torsion
from .xtb import XtbError

LEGS = 6  # in one direction, at most
JUMP = 3.0  # times the way that the atoms go: how far an aligned shape moves where the alignment jumps
BACK = "back in the conformation"


def drive(search: Search, torsion: Torsion, sign: int, apart: float | None = None,
          known: Shapes = ()) -> tuple[Path, float | None]:
    """(Path, distance of its nodes) of a torsion in one direction. It ends before a saddle to one of the known minima."""
    way, at = Path([search.x], [search.energy], why=f"{LEGS} saddles are enough"), search.rest
    for _ in range(LEGS):
        try:
            ends = search.driven_over(at, torsion, sign)
            if not search.same(ends.near.x, at.x):
                raise optimise.NoPath(f"the saddle at {search.above(ends.saddle.energy):.2f} kJ/mol joins other minima")
            if not search.intact(ends.far.x):
                raise optimise.NoPath("bonds change")
            if why := search.start.isomer.differs(ends.far.x, axes=False):
                raise optimise.NoPath(why)
            up, down, at, apart = path.over(search.surface, ends, at, apart)
        except (optimise.NoPath, XtbError) as why:
            return replace(way, why=str(why)), apart
        closed = search.same(at.x, search.x)
        if not closed and any(search.same(at.x, y) for y in [*(way.nodes[k] for k in way.minima()), *known]):
            # Up to the saddle, but without it.
            way.nodes += up[0][1:-1]
            way.energies += up[1][1:-1]
            return replace(way, why="a minimum that it has already"), apart
        way.add(*up, "saddle")
        way.add(*down, "minimum")
        if closed:
            del way.kinds[len(way.nodes) - 1]  # it is no other one
            return replace(way, why=BACK), apart
    return way, apart


def whole(search: Search, job: str) -> Path:
    """The Path of a torsion, both directions as one. Errors: optimise.NoPath, where no minimum is behind a saddle."""
    torsion, _ = search.jobs[job]
    plus, apart = drive(search, torsion, 1)
    holds, whole_turn = not search.start.options.push, plus.why == BACK
    if whole_turn:
        plus, minus = _round(plus) if holds else _cut(search, plus)
    else:
        minus, _ = drive(search, torsion, -1, apart, [plus.nodes[k] for k in plus.minima()])
        if minus.why == BACK:  # the other direction only leads to fewer minima
            whole_turn = True
            minus, plus = _round(minus) if holds else _cut(search, minus)
        elif not holds:
            plus, minus = _before_jump(search, plus), _before_jump(search, minus)
    if not plus.minima() + minus.minima() and not (holds and whole_turn):
        raise optimise.NoPath(f"nothing behind its saddles: {plus.why}; {minus.why}")
    start = len(minus.nodes) - 1
    nodes = [n if n is search.x else geometry.aligned(n, search.x, search.surface.masses)
             for n in minus.nodes[:0:-1] + plus.nodes]
    kinds = {start - k: kind for k, kind in minus.kinds.items()} | {start + k: kind for k, kind in plus.kinds.items()}
    return Path(nodes, minus.energies[:0:-1] + plus.energies, start, dict(sorted(kinds.items())))


def _back(circle: Path) -> Path:
    """The same circle in the other direction."""
    last = len(circle.nodes) - 1
    return Path([circle.nodes[0], *circle.nodes[-2::-1]], [circle.energies[0], *circle.energies[-2::-1]], 0,
                {last - k: kind for k, kind in circle.kinds.items()}, circle.why)


def _round(circle: Path) -> tuple[Path, Path]:
    """The two parts of a circle, both to its highest saddle. The model closes such a path, whose ends are one shape."""
    top = max((k for k, kind in circle.kinds.items() if kind == "saddle"), key=lambda k: circle.energies[k])
    return _part(circle, top + 1), _part(_back(circle), len(circle.nodes) - top)


def _jump(search: Search, nodes: Sequence[Array]) -> int | None:
    """The first node at which the alignment with the conformation jumps, or comes loose; None where it never does. Near a shape
    that lies as well on the conformation in two ways, as dichloroethane with both chlorine atoms on one side, a small change of
    shape turns the whole molecule, and the model's minimiser would leap."""
    masses = search.surface.masses
    tight = geometry.tightness(search.x, search.x, masses)
    chain = path.aligned_chain(nodes, masses)
    aligned = [geometry.aligned(n, search.x, masses) for n in nodes]
    return next((k for k in range(1, len(nodes))
                 if geometry.rms(aligned[k], aligned[k - 1]) > JUMP * geometry.rms(chain[k], chain[k - 1])
                 or geometry.tightness(nodes[k], search.x, masses) < geometry.LOOSE * tight), None)


def _part(way: Path, count: int) -> Path:
    return Path(way.nodes[:count], way.energies[:count], 0, {k: kind for k, kind in way.kinds.items() if k < count}, way.why)


def _before_jump(search: Search, way: Path) -> Path:
    """A way without what is behind the last saddle before a jump, where there is one."""
    at = _jump(search, way.nodes)
    if at is None:
        return way
    last = max((k for k in way.kinds if k < at), default=at)
    return replace(_part(way, last if way.kinds.get(last) == "saddle" else at), why="the molecule's alignment would jump")


def _cut(search: Search, circle: Path) -> tuple[Path, Path]:
    """The two parts of a circle, each from the conformation to a node before one of its saddles."""
    last, back = len(circle.nodes) - 1, _back(circle)
    saddles = sorted((k for k, kind in circle.kinds.items() if kind == "saddle"), key=lambda k: -circle.energies[k])
    if len(saddles) == 1:  # of the same shape once more
        return circle, _part(back, 1)
    parts = [(_part(circle, k), _part(back, last - k)) for k in saddles]
    smooth = [both for both in parts if all(_jump(search, part.nodes) is None for part in both)]
    return smooth[0] if smooth else (_before_jump(search, parts[0][0]), _before_jump(search, parts[0][1]))
