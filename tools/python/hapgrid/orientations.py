"""Orientations: six numbers of a state that are the first two columns of a rotation matrix."""
import math
from collections.abc import Sequence


def normalised(columns: Sequence[float]) -> list[float]:
    """Six numbers of a state that are an orientation, the first two columns of a rotation matrix, made orthonormal.

    A description says with "period": [..., -1, -1, -1, -1, -1, -1] that they are one (see PROTOCOL.md). The first
    column keeps its direction. Raises ValueError when the columns are parallel or zero.
    """
    p, q = columns[:3], columns[3:6]
    size = math.hypot(*p)
    along = sum(a * b for a, b in zip(p, q))
    q = [b - a * along / size**2 for a, b in zip(p, q)] if size else q
    other = math.hypot(*q)
    if not size > 0 or not other > 0:
        raise ValueError("the two columns of an orientation are parallel or zero")
    return [*(a / size for a in p), *(b / other for b in q)]


def applied(columns: Sequence[float], point: Sequence[float]) -> list[float]:
    """Where an orientation brings a point of the body: the rotation matrix times (x, y, z)."""
    p, q = columns[:3], columns[3:6]
    r = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
    return [p[k] * point[0] + q[k] * point[1] + r[k] * point[2] for k in range(3)]


def turned(columns: Sequence[float], turn: Sequence[float]) -> list[float]:
    """An orientation after a turn by a rotation vector: around its direction, by its length in radians."""
    angle = math.hypot(*turn)
    if angle == 0:
        return list(columns)
    n, c, s = [t / angle for t in turn], math.cos(angle), math.sin(angle)
    out = []
    for v in columns[:3], columns[3:6]:  # Rodrigues' formula
        along = sum(a * b for a, b in zip(n, v)) * (1 - c)
        across = [n[1] * v[2] - n[2] * v[1], n[2] * v[0] - n[0] * v[2], n[0] * v[1] - n[1] * v[0]]
        out += [c * v[k] + s * across[k] + along * n[k] for k in range(3)]
    return normalised(out)
