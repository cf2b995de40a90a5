"""What the search for structures finds, and how that is kept.

Positions are in bohr, energies in hartree, wave numbers in cm^-1, negative where they are imaginary. Results are kept as
JSON in a folder that may come from somebody else: only what has the form of its type counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np
from hapgrid.apps.common.arrays import Array

SAME_SHAPE = 0.1  # bohr, root mean square: minima closer than this are one


@dataclass
class Dropped:
    """There is no such result. why: in words; free: whether that is because the bond turns freely."""
    why: str
    free: bool = False


@dataclass
class Point:
    """A minimum or a saddle. nu1: its lowest wave number."""
    x: Array
    energy: float
    hessian: Array
    nu1: float


@dataclass
class Ends:
    """A saddle and the minima that it joins. up: shapes from the near one to the saddle; down: from there to the far
    one."""
    saddle: Point
    near: Point
    far: Point
    up: list[Array]
    down: list[Array]


@dataclass
class Path:
    """Nodes through the conformation, which is the one at `start`. kinds: {node: "minimum" or "saddle"} of the others that are
    stationary, where the path goes on behind its saddles; otherwise its last node is a saddle. nu1: of that, None where it is
    no saddle of xtb; near, far: the minima that it joins, None where nobody has looked for them. why: there is no path, or
    where it ends. name: of its file."""
    nodes: list[Array]
    energies: list[float]
    start: int = 0
    kinds: dict[int, str] = field(default_factory=dict)
    why: str = ""
    name: str = ""
    nu1: float | None = None
    near: Point | None = None
    far: Point | None = None

    @property
    def goes_on(self) -> bool:
        return bool(self.kinds)

    @property
    def barrier(self) -> float:
        return max(self.energies)

    @property
    def closes(self) -> bool:
        """Whether both ends are one shape."""
        return bool(np.allclose(self.nodes[0], self.nodes[-1], rtol=0, atol=1e-6))

    def points(self) -> list[tuple[str, float, Array]]:
        """[(kind, energy, shape)] of what is stationary on the way behind saddles, each once, without the conformation."""
        last = len(self.nodes) - self.closes
        return [(kind, self.energies[k], self.nodes[k]) for k, kind in self.kinds.items() if k < last]

    def minima(self) -> list[int]:
        return [k for k, kind in self.kinds.items() if kind == "minimum"]

    def add(self, nodes: Sequence[Array], energies: Sequence[float], kind: str) -> None:
        """Goes on along nodes of which the last is stationary, and the first is there already."""
        self.nodes += nodes[1:]
        self.energies += energies[1:]
        self.kinds[len(self.nodes) - 1] = kind


@dataclass
class Result:
    """x, energy, nu1: of the conformation; found: Paths; dropped: [(path, reason)]."""
    numbers: list[int]
    masses: Array
    method: str
    torsions: list[Any]
    x: Array
    energy: float
    nu1: float | None
    found: list[Path] = field(default_factory=list)
    dropped: list[tuple[str, str]] = field(default_factory=list)

    def files(self) -> list[str]:
        return ["conformation.xyz", *(one.name + ".xyz" for one in self.found)]


def plain(value: Any) -> Any:
    """A result as JSON can hold it."""
    if is_dataclass(value):
        return {f.name: plain(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, dict):
        return [list(item) for item in value.items()]
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def restored(types: Sequence[type], value: Any, atoms: int) -> Any:
    """The result that plain() gave, of one of these types. Errors: ValueError or TypeError, where it is something else."""
    kind = next((one for one in types if isinstance(value, dict) and {f.name for f in fields(one)} == set(value)), None)
    if kind is None:
        raise ValueError("of another type")
    nodes = len(value.get("nodes") or ())
    return kind(**{f.name: None if value[f.name] is f.default is None else _field(f.name, value[f.name], atoms, nodes)
                   for f in fields(kind)})


def _field(name: str, value: Any, atoms: int, nodes: int) -> Any:
    shape = {"x": (atoms, 3), "hessian": (3 * atoms, 3 * atoms), "nodes": (nodes, atoms, 3),
             "energies": (nodes,), "energy": (), "nu1": ()}.get(name)
    if shape is not None:
        array = np.array(value)
        sound = array.shape == shape and array.dtype.kind in "if" and np.isfinite(array).all()
        value = value if shape == () else list(array) if name in ("nodes", "energies") else array
    elif name == "kinds":
        sound = isinstance(value, list) and all(0 <= k < nodes and kind in ("minimum", "saddle") for k, kind in value)
        value = dict(value)
    elif name in ("near", "far"):
        return restored([Point], value, atoms)
    elif name == "start":
        sound = type(value) is int and 0 <= value < nodes
    else:
        sound = type(value) is (bool if name == "free" else str)
    if not sound:
        raise ValueError(name)
    return value
