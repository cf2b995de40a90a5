"""What the search for structures finds, and how that is kept.

Positions are in bohr, energies in hartree, wave numbers in cm^-1, negative where they are imaginary. Results are kept as
JSON in a folder that may come from somebody else: only what has the form of its type counts.
"""

from dataclasses import dataclass, field, fields, is_dataclass

import numpy as np

SAME_SHAPE = 0.1  # bohr, root mean square: minima closer than this are one


@dataclass
class Dropped:
    """There is no such result. why: in words; free: whether that is because the bond turns freely."""
    why: str
    free: bool = False


@dataclass
class Point:
    """A minimum or a saddle. nu1: its lowest wave number."""
    x: np.ndarray
    energy: float
    hessian: np.ndarray
    nu1: float


@dataclass
class Conformation(Point):
    """bonds_at: the shape off which GFN-FF read its bonds, for the surface on which this is a minimum."""
    bonds_at: np.ndarray


@dataclass
class Ends:
    """A saddle and the minima that it joins. sign: which way along its mode the near one lies."""
    saddle: Point
    sign: int
    near: Point
    far: Point

    def points(self):
        """[(kind, energy, shape)] along the way from the near one to the far one."""
        return [(kind, one.energy, one.x) for kind, one in (("minimum", self.near), ("saddle", self.saddle),
                                                            ("minimum", self.far))]


@dataclass
class Way:
    """Nodes through the conformation, which is the one at `start`. kinds: {node: "minimum" or "saddle"} of the others that
    are stationary, where the way goes on behind its saddles; why: its ends are where they are."""
    nodes: list
    energies: list
    start: int = 0
    kinds: dict = field(default_factory=dict)
    why: str = ""

    goes_on = property(lambda self: bool(self.kinds))
    barrier = property(lambda self: max(self.energies))

    def points(self):
        """The same of a way, without the conformation."""
        return [(kind, self.energies[k], self.nodes[k]) for k, kind in self.kinds.items()]

    def minima(self):
        return [k for k, kind in self.kinds.items() if kind == "minimum"]

    def add(self, nodes, energies, kind):
        """Goes on along nodes of which the last is stationary, and the first is there already."""
        self.nodes += nodes[1:]
        self.energies += energies[1:]
        self.kinds[len(self.nodes) - 1] = kind


@dataclass
class Path(Way):
    """A way for a file. nu1: of its saddle, None where its last node is no saddle of xtb; far: the
    minimum behind that, None where nobody has looked for it."""
    name: str = ""
    nu1: float = None
    far: Point = None


@dataclass
class Result:
    """x, energy, nu1: of the conformation; found: Paths; dropped: [(path, reason)]."""
    numbers: list
    masses: np.ndarray
    method: str
    torsions: list
    x: np.ndarray
    energy: float
    nu1: float
    found: list = field(default_factory=list)
    dropped: list = field(default_factory=list)

    def files(self):
        return ["conformation.xyz", *(one.name + ".xyz" for one in self.found)]


def plain(value):
    """A result as JSON can hold it."""
    if is_dataclass(value):
        return {f.name: plain(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, dict):
        return [list(item) for item in value.items()]
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def restored(types, value, atoms):
    """The result that plain() gave, of one of these types. Errors: ValueError, where it is something else."""
    kind = next((one for one in types if isinstance(value, dict) and {f.name for f in fields(one)} == set(value)), None)
    if kind is None:
        raise ValueError("of another type")
    nodes = len(value["nodes"]) if isinstance(value.get("nodes"), list) else 0
    return kind(**{name: _field(name, one, atoms, nodes) for name, one in value.items()})


def _field(name, value, atoms, nodes):
    shape = {"x": (atoms, 3), "bonds_at": (atoms, 3), "hessian": (3 * atoms, 3 * atoms), "nodes": (nodes, atoms, 3),
             "energies": (nodes,), "energy": (), "nu1": ()}.get(name)
    if shape is not None:
        array = np.array(value)
        if array.shape != shape or array.dtype.kind not in "if" or not np.isfinite(array).all():
            raise ValueError(name)
        return list(array) if name == "nodes" else array if shape and name != "energies" else value
    if name in ("saddle", "near", "far"):
        return restored([Point], value, atoms)
    if name == "kinds" and isinstance(value, list) and all(isinstance(one, list) and len(one) == 2 for one in value):
        if all(type(k) is int and 0 <= k < nodes and kind in ("minimum", "saddle") for k, kind in value):
            return dict(value)
    elif name == "why" and isinstance(value, str) or name == "free" and isinstance(value, bool):
        return value
    elif type(value) is int and (name == "sign" and value in (1, -1) or name == "start" and 0 <= value < nodes):
        return value
    raise ValueError(name)
