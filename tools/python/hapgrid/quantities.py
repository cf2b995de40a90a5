"""What can be drawn of a play: columns of logs, sessions and files of frames by name, and what each is called."""
from __future__ import annotations

import json
import os
import subprocess
from typing import Any

from hapgrid.files import program, read
from hapgrid.style import label, place, plain, sign

AXES = "xyz"
WORDS = {"t": "time", "force": "force", "sent": "force", "energy": "energy", "own_energy": "energy",
         "lateness_us": "lateness", "compute_us": "compute time"}


def report(*arguments: str) -> dict[str, Any]:
    """What stats says as JSON. Raises ValueError with its line."""
    result = subprocess.run([program("stats"), *arguments, "--format", "json"], stdin=subprocess.DEVNULL,
                            capture_output=True, check=False)
    if result.returncode != 0:
        raise ValueError(result.stderr.decode(errors="replace").strip().removeprefix("stats: "))
    return json.loads(result.stdout)


def plane_of(text: str | None, origin: Any, spacing: float, counts: Any) -> tuple[int, int]:
    """The axis and the number of the plane of points."""
    if text is None:
        return 1, int(counts[1]) // 2
    axis, _, value = text.partition("=")
    try:
        at = float(value) if axis in AXES and axis else None
    except ValueError:
        at = None
    if at is None or at - at != 0:
        raise ValueError(f"a plane is like y=0.25, not {plain(text)!r}")
    a = AXES.index(axis)
    step, last = (at - origin[a]) / spacing, int(counts[a]) - 1
    if not -1e-9 <= step <= last + 1e-9:
        ends = f"{origin[a]:g} to {origin[a] + last * spacing:g}"
        raise ValueError(f"the plane {plain(text)} is outside the box: {axis} goes from {ends}")
    return a, min(max(int(-(-(step - 0.5) // 1)), 0), last)  # the lower of two that are equally near


def plane_arrays(grid: str | os.PathLike[str], plane: str | None) -> tuple[dict[str, Any], int, int, int, int]:
    """(the grid's arrays; axis and number of the plane that is nearest to `plane`, as in "y=0"; the axes in it). Errors:
    ValueError."""
    arrays = read(grid)
    if "point" not in arrays:
        raise ValueError(f"{os.fspath(grid)}: not a grid")
    axis, index = plane_of(plane, arrays["origin"], float(arrays["spacing"]), arrays["counts"].astype(int))
    u, v = (a for a in range(3) if a != axis)
    return arrays, axis, index, u, v


def plane_name(axis: int, at: float, spacing: float, unit: str, asked: str | None) -> str:
    """Where a plane of points is, as "z = 0.5 Å", and that it is not where it was asked for."""
    name = f"{AXES[axis]} = {place(at, spacing)} {sign(unit)}".rstrip()
    away = asked is not None and abs(float(asked.partition("=")[2]) - at) > 1e-6 * spacing
    return name + (f", the nearest to {asked}" if away else "")


class Play:
    """A log, session or file of frames. ticks: as read() has them; units: of "length", "energy" and "state", "" where they
    are not known."""

    def __init__(self, path: str | os.PathLike[str], grid: str | os.PathLike[str] | None = None,
                 allow_process: str | os.PathLike[str] | None = None) -> None:
        self.path = os.fspath(path)
        arrays = read(self.path, grid, allow_process)
        self.ticks = arrays.get("ticks", arrays.get("frames"))
        if self.ticks is None:
            raise ValueError(f"{self.path}: a grid, not a session, log or file of frames")
        if not len(self.ticks):
            raise ValueError(f"{self.path}: no tick in it")
        self.report: Any = None
        with open(self.path, "rb") as file:
            if file.read(4) == b"\x28\xb5\x2f\xfd":  # zstd: a session
                self.report = report(self.path)
        self.units = {"length": (self.report or {}).get("length_unit", ""), "energy": "", "state": ""}
        if grid is not None:
            known = report(os.fspath(grid))
            self.units = {"length": known["length_unit"], "energy": known["energy_unit"], "state": known["tolerance_unit"]}

    def column(self, name: str) -> Any:
        """A value a tick. "force" and "sent" are lengths of vectors. Raises ValueError with the names that there are."""
        import numpy

        fields = self.ticks.dtype.names
        kind, _, rest = name.rpartition("_")
        if name in AXES and name:
            return self.ticks["hip"][:, AXES.index(name)]
        if kind in ("force", "sent") and kind in fields and rest in AXES:
            return self.ticks[kind][:, AXES.index(rest)]
        if name in ("force", "sent") and name in fields:
            return numpy.linalg.norm(self.ticks[name], axis=1)
        if name[:1] in ("s", "l") and name[1:].isdigit():
            field = "state" if name[0] == "s" else "levels"
            if field in fields and int(name[1:]) < self.ticks[field].shape[1]:
                return self.ticks[field][:, int(name[1:])]
        elif name in fields and self.ticks.dtype[name].shape == ():
            return self.ticks[name].astype(float)
        hint = "" if "state" in fields else "; a session has states and energies together with its grid"
        raise ValueError(f"{self.path}: no column {name}: there are {', '.join(self.names())}{hint}")

    def names(self) -> list[str]:
        fields = self.ticks.dtype
        states = fields["state"].shape[0] if "state" in fields.names else 0
        vectors = [kind for kind in ("force", "sent") if kind in fields.names]
        several = [f"s0 ... s{states - 1}" if states > 1 else "s0"][:states]
        return ["t", "x", "y", "z", *(f"{kind}{axis}" for kind in vectors for axis in ("", "_x", "_y", "_z")),
                *(["l0 ... l7"] if "levels" in fields.names else []),
                *several, *(name for name in fields.names if name != "t" and fields[name].shape == ())]

    def snaps(self) -> Any:
        """The ticks in which the model snapped."""
        import numpy

        fields = self.ticks.dtype.names
        if "snap" in fields:
            return numpy.flatnonzero(self.ticks["snap"])
        if "jumps" in fields:
            return numpy.flatnonzero(numpy.diff(self.ticks["jumps"].astype(int))) + 1
        bit = list((self.report or {}).get("flags", {"level_changed": 0})).index("level_changed")
        if self.report and "flags" in fields and json.loads(self.report["settings"] or "{}").get("traversal", "branch") == "branch":
            return numpy.flatnonzero(self.ticks["flags"] >> bit & 1)
        return numpy.zeros(0, int)

    def label(self, name: str) -> str:
        """What an axis with this column says."""
        units = self.units
        kind, _, rest = name.rpartition("_")
        if name in AXES:
            return label(f"{name} of the HIP", units["length"])
        if kind in ("force", "sent") and rest in AXES:
            return label(f"{rest} of the force", "N")
        if name[:1] == "s" and name[1:].isdigit():
            return label(f"state {name}", units["state"])
        if name[:1] == "l" and name[1:].isdigit():
            return f"level in corner {name[1:]}"
        unit = {"t": "s", "force": "N", "sent": "N", "energy": units["energy"], "own_energy": units["energy"],
                "lateness_us": "µs", "compute_us": "µs"}.get(name, "")
        return label(WORDS.get(name, name), unit)


def beside(name: str) -> list[tuple[str, str]]:
    """The columns that are drawn when one is asked for, and what each is called. A force is drawn as the model gave it and
    as it was sent, so that what the safety core does is not taken for a property of the model."""
    kind, _, axis = name.rpartition("_")
    for each in ("force", "sent"):
        if name == each or kind == each and axis in AXES:
            end = name[len(each):]
            return [("sent" + end, "as sent"), ("force" + end, "of the model")]
    if name == "energy":
        return [("energy", "with the hand"), ("own_energy", "of the model alone")]
    return [(name, "")]
