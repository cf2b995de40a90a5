"""What the hand holds of a molecule that has paths of its own (--path), and what of it stays."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed

from . import geometry, holding, mending
from .along import kinds
from .definition import FORCE_SCALE
from .holding import Hold, named
from .mending import apart
from .molecule import Molecule
from .results import Result
from .xtb import BOHR, HARTREE

LIGHT = 0.4  # of what a hydrogen atom moves: another atom is held sooner
CLEAR_WAY, LEAST_WAY = 0.3, 0.05  # angstrom between its places in two minima: what is held tells them apart
MOST_PARTS = 3  # that are tried as what stays
RIGID = 0.15  # angstrom that distances in a part change that keeps its shape
MOST_FORCE = 1.2  # newtons


def hold(molecule: Molecule, result: Result, wanted: str | None) -> Hold:
    """What of the molecule the hand holds, and what stays: the atom, or those of --hold, of which all minima of the paths have
    places far from each other, or two atoms, where one does not tell them apart. What stays is a part that keeps its shape; or
    the whole by its mass, unless a path closes, since such a path must come to its place again. Where none of them says on all
    frames how the molecule is turned, all stays but what is held."""
    closes = any(apart(f.nodes[0], f.nodes[-1]) * BOHR <= mending.SAME for f in result.found)
    fixed: list[Sequence[int] | None] = [some for some in [*([()] if not closes else []), *_rigid(result)] if _tight(result, some)]
    fixed = fixed or [None]
    if wanted is not None:
        return _farthest(result, [named(molecule, wanted)], fixed)[0]
    count = range(len(result.numbers))
    one, far = _farthest(result, [(n,) for n in count], fixed)
    if far < CLEAR_WAY:
        two, farther = _farthest(result, list(itertools.combinations(count, 2)), fixed)
        one, far = (two, farther) if farther > 1.5 * far else (one, far)
    if far < LEAST_WAY:
        raise Failed("--path: no atom, nor the centre of two, has another place in each minimum: say what is held by --hold")
    return one


def _farthest(result: Result, candidates: Sequence[Sequence[int]], fixed: Sequence[Sequence[int] | None]) -> tuple[Hold, float]:
    """(the best Hold of some atoms, how far its nearest places in two minima are from each other, angstrom; of one hydrogen less).
    fixed: parts that may stay; None is all but what is held."""
    best, most = Hold(tuple(candidates[0]), (), ()), 0.0
    for part in fixed:
        places = np.array(_places(result, part)) if part is not None else None
        for some in candidates:
            stay = [n for n in range(len(result.numbers)) if n not in some] if part is None else part
            if set(some) & set(stay) or part is None and not _tight(result, stay):
                continue
            at = (np.array(_places(result, stay)) if places is None else places)[:, list(some)].mean(axis=1)
            least = float(np.min([np.linalg.norm(a - b) for k, a in enumerate(at) for b in at[:k]], initial=9.0))
            least *= LIGHT if len(some) == 1 and result.numbers[some[0]] == 1 else 1
            least *= _straight(result, Hold(tuple(some), tuple(stay), ())) if part is None else 1
            if least > most + 0.05:
                best, most = Hold(tuple(some), tuple(stay), ()), least
    return best, most


def _tight(result: Result, fixed: Sequence[int]) -> bool:
    """Whether the best alignment of these atoms, or of all by their mass, is the only one on all paths. A tetrahedron lies on its
    mirror image in several ways, and the molecule would leap between them."""
    weight = holding.weights(result.masses, fixed)
    least = geometry.LOOSE * geometry.tightness(result.x, result.x, weight)
    return all(geometry.tightness(x, result.x, weight) >= least for f in result.found for x in f.nodes)


def _straight(result: Result, hold: Hold) -> float:
    """How far the ends of what is held are from each other, as a share of its way, on the path that bends most."""
    ways = [places for places, _ in holding.ways(result, hold, {f.name for f in result.found}).values()]
    return max(0.1, min(float(np.linalg.norm(p[-1] - p[0]) / np.linalg.norm(np.diff(p, axis=0), axis=1).sum()) for p in ways))


def _places(result: Result, fixed: Sequence[int]) -> list[Array]:
    """Shapes in the minima and at the ends of all paths, as the conformation lies, angstrom; of ends that meet one."""
    weights = holding.weights(result.masses, fixed)
    out = [result.x]
    for f in result.found:
        ends = {0, len(f.nodes) - 1} if apart(f.nodes[0], f.nodes[-1]) * BOHR > mending.SAME else set()
        out += [geometry.aligned(f.nodes[k], result.x, weights)
                for k in sorted(ends | {k for k, kind in kinds([e * HARTREE for e in f.energies], f.start).items()
                                        if kind == "minimum"}) if k != f.start]
    return [x * BOHR for x in out]


def _rigid(result: Result) -> list[tuple[int, ...]]:
    """Parts that keep their shape on all paths and say how the molecule is turned, the heaviest first."""
    nodes = np.array([x for f in result.found for x in f.nodes]) * BOHR
    distance = np.linalg.norm(nodes[:, :, None] - nodes[:, None], axis=3)
    stable = np.ptp(distance, axis=0) < RIGID
    parts = set()
    for first in range(len(result.numbers)):
        part = [first]
        for n in sorted(set(range(len(result.numbers))) - {first}, key=lambda n: (-stable[n].sum(), n)):
            if stable[n, part].all():
                part.append(n)
        spread = np.linalg.svd(geometry.centred(result.x[part], np.ones(len(part))), compute_uv=False)
        if 2 < len(part) < len(result.numbers) and spread[1] > 0.4:
            parts.add(tuple(sorted(part)))
    return sorted(parts, key=lambda part: (-result.masses[list(part)].sum(), part))[:MOST_PARTS]


def force_scale(result: Result, hold: Hold) -> float:
    """Newtons on the device for 1 kJ/(mol angstrom): the steepest rise along the way of what is held is MOST_FORCE at most."""
    steepest = 0.0
    for f in result.found:
        shapes = [geometry.aligned(x, result.x, holding.weights(result.masses, hold.fixed)) for x in f.nodes]
        places = np.array([holding.way(x, hold.atoms) for x in shapes]) * BOHR
        steps = np.maximum(np.linalg.norm(np.diff(places, axis=0), axis=1), 0.01)
        steepest = max(steepest, float((np.abs(np.diff(f.energies)) * HARTREE / steps).max()))
    return float(f"{min(FORCE_SCALE, MOST_FORCE / steepest):.1g}") if steepest else FORCE_SCALE
