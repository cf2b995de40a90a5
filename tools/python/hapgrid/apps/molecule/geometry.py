"""Shapes: superposition, bonds and internal coordinates.

Positions in bohr, arrays (atoms, 3); angles in radians.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from hapgrid.apps.common.arrays import Array, Neighbours
from scipy.linalg import orth
from scipy.spatial.transform import Rotation

from .elements import COVALENT
from .xtb import BOHR

LINEAR = 0.17  # a torsion about a bond with a sine of its angle below this is none
STRAIGHT = 0.35  # the same of an atom between two others: it stands on a line, as those of an alkyne do, which bends in places
LOOSE = 0.3  # of a shape's own tightness(): below this an alignment comes loose
BONDED = 1.25  # times the sum of the covalent radii: nearer atoms are bonded


def shares(numbers: Sequence[int], x: Array) -> Array:
    """Distances (atoms, atoms) of positions in angstrom, by the sum of the covalent radii; of an atom from itself infinite."""
    radius = np.array([COVALENT.get(z, 1.5) for z in numbers])
    out = np.linalg.norm(x[:, None] - x[None], axis=2) / (radius[:, None] + radius[None])
    np.fill_diagonal(out, np.inf)
    return out


def bonds_of(numbers: Sequence[int], x: Array) -> Neighbours:
    """The neighbours of each atom, ascending, by distances in angstrom."""
    return [np.flatnonzero(row).tolist() for row in shares(numbers, x) < BONDED]


def centred(x: Array, masses: Array) -> Array:
    return x - masses @ x / masses.sum()


def on_principal_axes(x: Array, masses: Array) -> Array:
    """x centred, with the molecule's longest axis along x and its shortest along z. An axis points
    to its farthest atom, the first one among those that are equally far."""
    c = centred(x, masses)
    _, axes = np.linalg.eigh((masses[:, None] * c).T @ c)
    axes = axes[:, ::-1].copy()
    for k in (0, 1):
        along = c @ axes[:, k]
        far = np.flatnonzero(np.abs(along) > np.abs(along).max() - 0.001)[0]
        axes[:, k] *= np.sign(along[far])
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])  # no reflection
    return c @ axes


def aligned(x: Array, reference: Array, masses: Array) -> Array:
    """x turned and shifted to the least mass-weighted distance from the reference (Kabsch)."""
    a, b = centred(x, masses), centred(reference, masses)
    u, _, vt = np.linalg.svd(a.T @ (masses[:, None] * b))
    u[:, -1] *= np.sign(np.linalg.det(u @ vt))  # no reflection
    return a @ (u @ vt) + masses @ reference / masses.sum()


def tightness(x: Array, reference: Array, masses: Array) -> float:
    """How stiff the best alignment is against the turn that changes it least: 0 where there are two best ones."""
    a, b = centred(x, masses), centred(reference, masses)
    u, s, vt = np.linalg.svd(a.T @ (masses[:, None] * b))
    return float(s[1] + np.sign(np.linalg.det(u @ vt)) * s[2])


def as_in_file(x: Array) -> Array:
    """Rounded as files have it, to 1e-8 angstrom, since readers compare the nodes of paths with a file."""
    return np.round(x * BOHR, 8) / BOHR


def rms(x: Array, y: Array) -> float:
    """Root mean square displacement of the atoms, without superposition."""
    return np.sqrt(((x - y) ** 2).sum() / len(x))


def rigid_vectors(x: Array, weights: Array) -> Array:
    """Shifts and turns of coordinates times sqrt(weights), as orthonormal columns (3 atoms, 6)."""
    root = np.sqrt(weights)[:, None]
    c = centred(x, weights)
    columns = [(root * column).ravel() for axis in np.eye(3) for column in (axis, np.cross(axis, c))]
    return orth(np.array(columns).T, rcond=1e-6)


def torsion(x: Array, i: int, j: int, k: int, l: int) -> float:
    """Torsion angle, (-pi, pi], IUPAC sign."""
    b1, b2, b3 = x[j] - x[i], x[k] - x[j], x[l] - x[k]
    n1, n2 = np.cross(b1, b2), np.cross(b2, b3)
    return np.arctan2(np.linalg.norm(b2) * (b1 @ n2), n1 @ n2)


def torsion_gradient(x: Array, i: int, j: int, k: int, l: int) -> Array:
    """Derivative (atoms, 3) of the torsion. Source: Blondel and Karplus 1996."""
    f, g, h = x[i] - x[j], x[j] - x[k], x[l] - x[k]
    a, b = np.cross(f, g), np.cross(h, g)
    a2, b2, gn = a @ a, b @ b, np.linalg.norm(g)
    out = np.zeros_like(x)
    out[i] = -gn / a2 * a
    out[l] = gn / b2 * b
    fg, hg = f @ g / (a2 * gn) * a, h @ g / (b2 * gn) * b
    out[j] = gn / a2 * a + fg - hg
    out[k] = -gn / b2 * b - fg + hg
    return out


def angle(x: Array, i: int, j: int, k: int) -> float:
    u, v = x[i] - x[j], x[k] - x[j]
    return np.arctan2(np.linalg.norm(np.cross(u, v)), u @ v)


def wrapped(a: float | Array) -> Any:
    """An angle, or an array of them, in (-pi, pi]."""
    return -((-np.asarray(a) + np.pi) % (2 * np.pi) - np.pi)


def rotated_about(x: Array, j: int, k: int, side: Sequence[int], turn: float) -> Array:
    """x with the atoms of `side` turned by an angle about the bond from j to k."""
    out, axis = x.copy(), (x[k] - x[j]) / np.linalg.norm(x[k] - x[j])
    out[side] = x[k] + Rotation.from_rotvec(turn * axis).apply(x[side] - x[k])
    return out


def side_of(neighbours: Neighbours, j: int, k: int) -> list[int] | None:
    """The atoms on k's side of the bond j-k, without k; None when the bond is in a ring."""
    side = [k]
    for at in side:
        side += [n for n in neighbours[at] if n not in side and (at, n) != (k, j)]
    return None if j in side else sorted(side[1:])


def straight(neighbours: Neighbours, x: Array) -> list[int]:
    """The atoms that stand on a line between two that have other neighbours, as in an alkyne or in the middle of an allene."""
    return [j for j, near in enumerate(neighbours) if len(near) == 2 and all(len(neighbours[n]) > 1 for n in near)
            and np.sin(angle(x, near[0], j, near[1])) < STRAIGHT]


def line(neighbours: Neighbours, on_line: Collection[int], start: int, first: int) -> list[int]:
    """The atoms from `start` over its neighbour `first` to the end of a line of straight() atoms."""
    out = [start, first]
    while out[-1] in on_line:
        out.append(next(n for n in neighbours[out[-1]] if n != out[-2]))
    return out


class Tree:
    """A tree of internal coordinates: each atom has a bond, an angle and a torsion. Atoms of a line, and the one behind it, refer
    to the atom before it: about a line that bends to either side no torsion is defined.

    The torsions of an atom's second and later children are relative to the first child's, so that
    turning about one bond changes one number. The molecule model interpolates such coordinates;
    here they show whether a spline through the nodes makes sense between them.
    """

    def __init__(self, neighbours: Neighbours, numbers: Sequence[int], on_line: Collection[int] = ()) -> None:
        near = [sorted(some, key=lambda n: (n in on_line, numbers[n] == 1, n)) for some in neighbours]
        heavy = [a for a in range(len(numbers)) if len(near[a]) > 1 and a not in on_line and near[a][0] not in on_line]
        self.root = heavy[0] if heavy else 0
        parent: dict[int, int | None] = {self.root: None}
        order = [self.root]
        for at in order:
            for n in near[at] + [b for n in near[at] if n not in parent for b in line(neighbours, on_line, at, n)[2:]]:
                if n not in parent:
                    parent[n] = at
                    order.append(n)
        # (atom, the three atoms to which its coordinates refer, the first child that its torsion is relative to); None for
        # what the first atoms lack.
        self.order = order
        self.rows: list[tuple[int, int, Any, Any, int | None]] = []
        first: dict[int, int] = {}
        children = [n for n in order if parent[n] == self.root]
        for atom in order[1:]:
            a: Any = parent[atom]
            b: Any = parent[a]
            sibling = atom
            if b is None:  # a child of the root: the first ones have each other
                b, c = [*children[:min(children.index(atom), 2)], None, None][:2]
            else:
                c = next((n for n in children if n != a), None) if parent[b] is None else parent[b]
                sibling = first.setdefault(a, atom)
            self.rows.append((atom, a, b, c, None if sibling == atom else sibling))

    def read(self, x: Array) -> Array:
        """Internal coordinates (3, atoms - 1) of a shape: bonds, angles, torsions."""
        out = np.zeros((3, len(self.rows)))
        for n, (atom, a, b, c, sibling) in enumerate(self.rows):
            out[0, n] = np.linalg.norm(x[atom] - x[a])
            if b is not None:
                out[1, n] = angle(x, atom, a, b)
            if c is not None:
                out[2, n] = torsion(x, atom, a, b, c)
                if sibling is not None:
                    out[2, n] -= torsion(x, sibling, a, b, c)
        out[2] = wrapped(out[2])
        return out

    def build(self, q: Array) -> Array:
        """A shape with these internal coordinates, anywhere in space."""
        x = np.zeros((len(self.order), 3))
        turn: dict[int, float] = {}
        for n, (atom, a, b, c, sibling) in enumerate(self.rows):
            r, theta, tau = q[:, n]
            if b is None:
                x[atom] = x[a] + [r, 0, 0]
            elif c is None:
                x[atom] = x[a] + _placed(r, theta, 0.0, x[b] - x[a], np.array([0.0, 1.0, 0.0]))
            else:
                turn[atom] = tau if sibling is None else tau + turn[sibling]
                x[atom] = x[a] + _placed(r, theta, turn[atom], x[b] - x[a], x[c] - x[b])
        return x

    def change(self, x: Array, y: Array) -> Array:
        """Internal coordinates of y less those of x; torsions turn the short way."""
        change = self.read(y) - self.read(x)
        change[2] = wrapped(change[2])
        return change


def _placed(r: float, theta: float, tau: float, to_b: Array, b_to_c: Array) -> Array:
    """An atom's place relative to its parent: bond r, angle theta to b, torsion tau to c."""
    e1 = to_b / np.linalg.norm(to_b)
    e2 = b_to_c - (b_to_c @ e1) * e1
    e2 /= np.linalg.norm(e2)
    e3 = np.cross(e2, e1)  # IUPAC: clockwise, seen along the bond
    return r * (np.cos(theta) * e1 + np.sin(theta) * (np.cos(tau) * e2 + np.sin(tau) * e3))
