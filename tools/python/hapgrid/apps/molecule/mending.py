"""The frames of a path as a path needs them: one molecule, numbered alike, none mirrored, each once, in their order.

Programs write frames that begin anew in the middle, restarts write some twice, and collections have no order. What has one
meaning is put right, and said; what has none is refused. Distances are root mean squares over the atoms after superposition.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from hapgrid.apps.common.arrays import Array
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from . import geometry
from .elements import SYMBOLS
from .molecule import BadInput, listed

MOST, LEAST = 400, 4  # frames
SAME = 2e-3  # angstrom: frames that are nearer are one
FAR = 5.0  # times the usual step: a frame that is farther from all others is no neighbour of theirs
ROUNDING = 0.05  # angstrom, of such a distance
SHORTER = 0.8  # of the way in the order of the file: an order with a shorter one is right
ROUND = 8  # frames that lead round, at least
GAP, LEAST_GAP = 8.0, 0.4  # times the usual step, and angstrom: frames are missing between
TURNS = [np.diag(v) for v in ([1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1])]


@dataclass(frozen=True)
class Shape:
    """number: of its frame, from 1; x: angstrom; energy: kJ/mol, or None."""
    number: int
    numbers: tuple[int, ...]
    x: Array
    energy: float | None = None


def formula(numbers: Sequence[int]) -> str:
    return "".join(f"{SYMBOLS[z]}{n if n > 1 else ''}" for z, n in sorted(Counter(numbers).items(), key=lambda i: SYMBOLS[i[0]]))


def apart(a: Array, b: Array) -> float:
    """The least root mean square distance of two shapes; a mirror image is another shape."""
    p, q = a - a.mean(axis=0), b - b.mean(axis=0)
    u, s, vt = np.linalg.svd(p.T @ q)
    s[2] *= np.sign(np.linalg.det(u @ vt))
    return float(np.sqrt(max((p**2).sum() + (q**2).sum() - 2 * s.sum(), 0) / len(a)))


def mended(shapes: Sequence[Shape], what: str, say: Callable[[str], object]) -> list[Shape]:
    """The Shapes of a path in their order. The last is the first once more where the path closes. Errors: BadInput."""
    first = shapes[0]
    for one in shapes:
        if sorted(one.numbers) != sorted(first.numbers):
            raise BadInput(f"{what}: frame {one.number} has {formula(one.numbers)}, the first one has {formula(first.numbers)}: "
                           "they are no path of one molecule")
    if not LEAST <= len(shapes) <= MOST:
        raise BadInput(f"{what}: {len(shapes)} frames: a path needs {LEAST} to {MOST}")
    out, closes = _once(_alike(list(shapes), what, say), what, say)
    out = _in_order(out, say)
    steps = [apart(a.x, b.x) for a, b in zip(out, out[1:])]
    usual, k = float(np.median(steps)), int(np.argmax(steps))
    if not closes and len(out) >= ROUND and apart(out[0].x, out[-1].x) < 1.5 * usual:
        say("the last frame leads on to the first: the path closes")
        closes = True
    out += out[:1] * closes
    if steps[k] > max(GAP * usual, LEAST_GAP):
        raise _gap(what, out[k], out[k + 1], usual)
    return out


def _gap(what: str, a: Shape, b: Shape, usual: float) -> BadInput:
    return BadInput(f"{what}: frames {a.number} and {b.number} are {apart(a.x, b.x):.2f} angstrom apart, most others {usual:.2f}: "
                    "frames are missing between them")


def _distances(shapes: Sequence[Shape]) -> Array:
    """Between all; infinite where atoms are numbered otherwise, and on the diagonal."""
    out = np.full((len(shapes), len(shapes)), np.inf)
    for j, a in enumerate(shapes):
        for k, b in enumerate(shapes[:j]):
            if a.numbers == b.numbers:
                out[j, k] = out[k, j] = apart(a.x, b.x)
    return out


def _alike(shapes: list[Shape], what: str, say: Callable[[str], object]) -> list[Shape]:
    """Those that are mirrored, or numbered otherwise, as their neighbours are."""
    distances = _distances(shapes)
    nearest = distances.min(axis=1)
    steps = nearest[np.isfinite(nearest) & (nearest > SAME)]
    limit = FAR * float(np.median(steps)) + ROUNDING if len(steps) else ROUNDING
    joined = _joined(distances < limit)
    turned: dict[str, list[int]] = {}
    while len(joined) < len(shapes):
        left = set(range(len(shapes))) - joined
        k = min(left, key=lambda k: (min(abs(j - k) for j in joined), k))
        beside = sorted(joined, key=lambda j: (abs(j - k), j))  # the frames beside it in the file are likely its neighbours
        near, one, how = _best(shapes[k], [shapes[j] for j in beside[:2]])
        if near > limit:
            near, one, how = _best(shapes[k], [shapes[j] for j in beside[::max(1, len(beside) // 12)]])
        if near > limit:
            k, j = min(((k, j) for k in left for j in joined), key=lambda pair: distances[pair])
            if not np.isfinite(distances[k, j]):
                raise BadInput(f"{what}: the atoms of frame {shapes[k].number} are numbered otherwise than those of all others, and "
                               "it is like none of them")
            raise _gap(what, shapes[min(j, k)], shapes[max(j, k)], float(np.median(steps)))
        shapes[k] = one
        turned.setdefault(how, []).append(one.number)
        joined.add(k)
        for j, other in enumerate(shapes):
            far = apart(other.x, one.x) if j != k and other.numbers == one.numbers else np.inf
            distances[j, k] = distances[k, j] = far
        joined |= _joined(distances < limit, k)
    for how, numbers in turned.items():
        say(f"frame{'s' * (len(numbers) > 1)} {listed([str(n) for n in sorted(numbers)])}: {how}")
    return shapes


def _joined(near: Array, first: int | None = None) -> set[int]:
    """What is connected with one, or the largest part."""
    left, parts = set(range(len(near))), []
    while left:
        part = [first if first in left else min(left)]
        for at in part:
            part += [int(k) for k in np.flatnonzero(near[at]) if k not in part]
        left -= set(part)
        parts.append(set(part))
        if first is not None:
            break
    # The numbers of the first frame are what people know, unless it is one of few.
    return max(parts, key=lambda part: (0 in part and 4 * len(part) >= len(near), len(part), -min(part)))


def _best(one: Shape, others: Sequence[Shape]) -> tuple[float, Shape, str]:
    """(how far it is from the nearest of the others, the shape mirrored or numbered as they are, which of these)"""
    found = []
    mirrored = replace(one, x=one.x * [1, 1, -1])
    for other in others:
        if one.numbers == other.numbers:
            found.append((apart(mirrored.x, other.x), mirrored, "a mirror image of its neighbours, turned back"))
        for shape, also in ((one, ""), (mirrored, ", and it is a mirror image")):
            alike, far = _renumbered(shape, other)
            found.append((far, alike, f"its atoms are numbered otherwise{also}: put right"))
    return min(found, key=lambda f: round(f[0], 6))


def _renumbered(one: Shape, other: Shape) -> tuple[Shape, float]:
    """(the shape with its atoms in the order of another's, how far it then is from that)."""
    even = np.ones(len(one.x))
    y = geometry.centred(other.x, even)
    c = geometry.centred(one.x, even)
    axes, other_axes = (np.linalg.svd(v, full_matrices=False)[2] for v in (c, y))
    axes[2] *= np.linalg.det(axes) * np.linalg.det(other_axes)
    wrong = 1e6 * (np.array(one.numbers)[:, None] != np.array(other.numbers)[None])
    best, least = one, np.inf
    for x in [c, *(c @ axes.T @ turn @ other_axes for turn in TURNS)]:
        order = np.arange(len(x))
        for _ in range(8):
            order_before = order
            _, order = linear_sum_assignment((cdist(x, y)**2 + wrong).T)
            if (order == order_before).all():
                break
            x = geometry.aligned(c, _spread(y, order), even)
        off = apart(one.x[order], other.x)
        if off < least:
            best, least = replace(one, numbers=other.numbers, x=one.x[order]), off
    return best, least


def _spread(y: Array, order: Array) -> Array:
    """The places of another shape's atoms, in this one's order."""
    out = np.empty_like(y)
    out[order] = y
    return out


def _once(shapes: list[Shape], what: str, say: Callable[[str], object]) -> tuple[list[Shape], bool]:
    """(each frame once, whether the file ends with the first one again)."""
    distances = _distances(shapes)
    again = [k for k in range(1, len(shapes)) if distances[k, :k].min() < SAME]
    out = [one for k, one in enumerate(shapes) if k not in again]
    tail = [k for k in again if k > shapes.index(out[-1]) and distances[k, 0] < SAME]
    closes = bool(tail) and 4 * (len(again) - len(tail)) < len(out)
    doubled = [k for k in again if not closes or k != tail[0]]
    if doubled:
        say(f"frame{'s' * (len(doubled) > 1)} {listed([str(shapes[k].number) for k in doubled])}: there already, left out")
    if len(out) < LEAST:
        raise BadInput(f"{what}: {len(out)} different frames: a path needs {LEAST}")
    return out, closes


def _in_order(shapes: list[Shape], say: Callable[[str], object]) -> list[Shape]:
    """By the shortest way through all, where that of the file is longer by much."""
    distances = _distances(shapes)

    def length(order: Sequence[int]) -> float:
        return float(distances[list(order[:-1]), list(order[1:])].sum())
    orders = [list(range(len(shapes)))]
    for first in range(len(shapes)):
        order, left = [first], set(range(len(shapes))) - {first}
        while left:
            order.append(min(left, key=lambda k: distances[order[-1], k]))
            left.remove(order[-1])
        orders.append(order)
    best = min(orders, key=length)
    if length(best) > SHORTER * length(orders[0]):
        return shapes
    best = _shortened(best, distances)
    best = best if best.index(0) <= best.index(len(best) - 1) else best[::-1]
    say("the frames are out of order: taken as " + " ".join(str(shapes[k].number) for k in best[:12]) + " …" * (len(best) > 12))
    return [shapes[k] for k in best]


def _shortened(order: list[int], distances: Array) -> list[int]:
    """Parts turned round while that makes the way shorter."""
    padded = np.pad(np.where(np.isfinite(distances), distances, 0), (0, 1))  # the ends are free
    better, n = True, len(order)
    while better:
        better = False
        for j in range(n - 1):
            for k in range(j + 1, n):
                a, b = order[j - 1] if j else -1, order[k + 1] if k + 1 < n else -1
                if padded[a, order[k]] + padded[order[j], b] < padded[a, order[j]] + padded[order[k], b] - 1e-9:
                    order[j:k + 1] = order[j:k + 1][::-1]
                    better = True
    return order
