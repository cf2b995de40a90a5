"""Tables of energies in the formats of other programs. Each reader gives a Table, and refuses with one line
what does not fit the file's own header."""

from __future__ import annotations

import lzma
import math
import os
import re
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from hapgrid.apps.common import sandbox
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed, read_bytes

from .units import BOHR

MOST_VALUES = 16 << 20
MOST_BYTES = 1 << 30
MOST_LENGTH = 1e30
CAPPED = 1e5  # kcal/mol: AutoGrid writes nothing higher, which is the inside of the receptor
SYMBOLS = """X H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga Ge As Se Br Kr
Rb Sr Y Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe""".split()
# Covalent radii in angstrom (Cordero et al., Dalton Trans. 2008, 2832).
RADII = dict(zip(SYMBOLS[1:], map(float, """.31 .28 1.28 .96 .84 .76 .71 .66 .57 .58 1.66 1.41 1.21 1.11 1.07 1.05 1.02 1.06 2.03 1.76
1.7 1.6 1.53 1.39 1.39 1.32 1.26 1.24 1.32 1.22 1.22 1.2 1.19 1.2 1.2 1.16 2.2 1.95 1.9 1.75 1.64 1.54 1.47 1.46 1.42 1.39
1.45 1.44 1.42 1.39 1.39 1.38 1.39 1.4""".split())))


@dataclass
class Table:
    """values: indexed [i, j, k] along the three axes, NaN where there is none. origin: of [0, 0, 0];
    axes: rows, from a point to the next one along each axis. atoms: (symbol, position)."""
    values: Array
    origin: Array
    axes: Array
    length_unit: str = "angstrom"
    energy_unit: str = ""
    has_unit: bool = False  # whether the file's format says that lengths are in angstrom
    atoms: list[tuple[str, Array]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # what a user may want to know of the file


def read(path: str, array: str | None = None) -> Table:
    """array: name or number of the one that is wanted, where a file has several."""
    name = os.path.basename(path).lower()
    packed = name.endswith(".gz")
    kind = os.path.splitext(name[:-3] if packed else name)[1]
    if kind not in READERS:
        raise Failed(f"{path}: only {', '.join([*READERS][:-1])} and {[*READERS][-1]} are known, and each with .gz behind it")
    data = read_bytes(path, MOST_BYTES)

    def parsed() -> Table:
        content = inflated(data, 31) if packed else data
        if kind == ".map" and not volumes.is_ccp4(content):
            return _checked(read_map(_text(content)))
        return _checked(READERS[kind](content, array=array))
    return behind_walls(path, parsed)


def behind_walls(path: str, parsed: Callable[[], Table]) -> Table:
    """The Table that parsed() makes of a file."""
    def plain() -> dict[str, Any]:
        try:
            table = parsed()
        except Failed as why:
            raise Failed(f"{path}: {why}") from None
        return {**vars(table), "atoms": [[symbol for symbol, _ in table.atoms], np.array([x for _, x in table.atoms]).reshape(-1, 3)]}
    table = Table(**sandbox.run(plain, path))
    table.atoms = [(symbol, x) for symbol, x in zip(*table.atoms)]
    return table


def _text(data: bytes) -> str:
    if b"\0" in data:
        raise Failed("it is no text file")
    return data.decode("utf-8", "replace")


def inflated(data: bytes, wbits: int, most: int = MOST_BYTES) -> bytes:
    return unpacked(zlib.decompressobj(wbits), data, most)


def unpacked(unpacker: Any, data: bytes, most: int) -> bytes:
    """What an unpacker of zlib's or lzma's makes of data."""
    try:
        out = unpacker.decompress(data, most)
    except (zlib.error, lzma.LZMAError):
        raise Failed("its compressed data are damaged") from None
    if not unpacker.eof:
        raise Failed("its compressed data are cut off or too long")
    return out


def _checked(table: Table) -> Table:
    if min(table.values.shape) < 4:
        raise Failed(f"{' x '.join(map(str, table.values.shape))} values: at least 4 are needed along each axis")
    if not (np.abs([table.origin, *table.axes]) < MOST_LENGTH).all():
        raise Failed(f"its origin or spacing is no number below {MOST_LENGTH:g}")
    size = np.prod(np.linalg.norm(table.axes, axis=1))
    if not abs(np.linalg.det(table.axes)) > 1e-6 * size:
        raise Failed("its axes lie in one plane")
    table.values[~np.isfinite(table.values)] = np.nan
    if np.isnan(table.values).all():
        raise Failed("it has no value that is a number")
    return table


def _numbers(text: str, count: int, what: str = "values") -> Array:
    """All numbers of a text, which must be `count`."""
    words = text.split()
    if len(words) != count:
        raise Failed(f"its header speaks of {count:,} {what}, and it has {len(words):,}")
    try:
        return np.array(words, dtype=float)
    except ValueError:
        pass
    try:
        return np.array([_fortran(word) for word in words], dtype=float)
    except ValueError:
        wrong = next(w for w in words if not is_number(w))
        raise Failed(f"'{wrong[:20]}' among the {what} is no number") from None


def _fortran(word: str) -> str:
    """1.2D-02, and 0.33-101, in which there was no place for the letter."""
    return re.sub("(?<=[0-9.])(?:[dDqQ](?=[+-]?[0-9])|(?=[+-][0-9]{3}$))", "e", word)


def is_number(word: str) -> bool:
    try:
        float(_fortran(word))
        return True
    except ValueError:
        return False


def _count(words: Sequence[Any] | Array, what: str) -> tuple[list[int], int]:
    """Whole numbers of points, and their product."""
    try:
        counts = [int(w) for w in words]
    except ValueError:
        raise Failed(f"{what}: the counts are no whole numbers") from None
    if len(counts) != 3 or min(counts) < 1:
        raise Failed(f"{what}: three counts above zero are due")
    if math.prod(counts) > MOST_VALUES:
        raise Failed(f"{_many(math.prod(counts))} values are too many: at most {MOST_VALUES:,}")
    return counts, math.prod(counts)


def _many(n: int) -> str:
    return f"{n:,}" if n < 10**15 else "over 10^15"


# AutoGrid


def read_map(text: str) -> Table:
    """Six lines of header, then a value a line, x fastest. NELEMENTS counts cells, not points."""
    lines = text.split("\n", 6)
    if len(lines) < 7:
        raise Failed("it ends before the 6 lines of an AutoGrid map's header")
    head = {words[0]: words[1:] for words in (line.split() for line in lines[:6]) if words}
    for key, count in (("SPACING", 1), ("NELEMENTS", 3), ("CENTER", 3)):
        if len(head.get(key, ())) != count:
            raise Failed(f"no AutoGrid map: {key} is missing among its first 6 lines, or has not {count} numbers")
    spacing, = _numbers(head["SPACING"][0], 1, "numbers of SPACING")
    centre = _numbers(" ".join(head["CENTER"]), 3, "numbers of CENTER")
    cells = _numbers(" ".join(head["NELEMENTS"]), 3, "numbers of NELEMENTS")
    if not all(0 < c < MOST_VALUES and c == int(c) for c in cells) or not spacing > 0:
        raise Failed("NELEMENTS or SPACING is not positive")
    counts, total = _count([int(c) + 1 for c in cells], "NELEMENTS")
    values = _numbers(lines[6], total).reshape(counts[::-1]).transpose(2, 1, 0)
    return Table(np.where(values >= CAPPED, np.nan, values), centre - spacing * cells / 2, spacing * np.eye(3),
                 energy_unit="kcal/mol", has_unit=True)


# OpenDX


def read_dx(text: str) -> Table:
    """As APBS writes it: regular positions, then one array of numbers, z fastest."""
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    counts, origin, deltas, total = None, None, [], None
    for number, line in enumerate(lines):
        words = line.replace('"', " ").split()
        if "gridpositions" in words and "counts" in words:
            counts, expected = _count(words[words.index("counts") + 1:], "gridpositions")
        elif words[:1] == ["origin"]:
            origin = _numbers(" ".join(words[1:]), 3, "numbers of the origin")
        elif words[:1] == ["delta"]:
            deltas.append(_numbers(" ".join(words[1:]), 3, "numbers of a delta"))
        elif "array" in words and "follows" in words:
            if "rank" in words and words[words.index("rank") + 1:][:1] != ["0"]:
                raise Failed("its array has vectors: only one number a point can be felt")
            begin = number + 1
            total = words[words.index("items") + 1:][:1] if "items" in words else []
            break
    if counts is None or origin is None or len(deltas) != 3 or total is None:
        raise Failed("no OpenDX table: counts, origin, three deltas or 'data follows' is missing")
    if total != [str(expected)]:
        raise Failed(f"its positions are {expected:,}, and its array has {' '.join(total) or 'no'} items")
    rest = "\n".join(lines[begin:])
    end = re.search(r"^[ \t]*(attribute|object|component)\b", rest, re.MULTILINE)
    values = _numbers(rest[:end.start()] if end else rest, expected)
    return Table(values.reshape(counts), origin, np.array(deltas))


# Gaussian cube

# What a title calls values that are energies of a charge, and others.
_ENERGIES = re.compile(r"potential|electrostatic|\besp\b|energy|hartree", re.IGNORECASE)
_UNITS = re.compile(r"\b(kj/mol|kcal/mol|ev|hartree)\b", re.IGNORECASE)
_OTHERS = re.compile(r"densit|\bdens\b|\brho\b|\bdt\b|orbital|wave ?function|\bpsi|\bmo\b|homo|lumo|spin|\belf\b|\brdg\b|laplac|"
                     r"gradient|\bldos\b|\bstm\b|e/(a0|bohr|ang)", re.IGNORECASE)
_NO_CELL = 1.2  # angstrom: steps that are longer may be a whole box
_BOND = 0.65  # of the sum of two radii: no atoms are nearer to each other


def read_cube(data: bytes, array: str | None = None, **_: Any) -> Table:
    """Two titles, atoms, values with z fastest. Lengths are in bohr; counts below zero say angstrom, and so do atoms that
    would else lie within each other."""
    lines = _text(data).split("\n", 6)
    if len(lines) < 7:
        raise Failed("it ends before the 6 lines of a cube's header")
    try:
        head = [[float(_fortran(w)) for w in line.split()] for line in lines[2:6]]
    except ValueError:
        raise Failed("no cube: a word among the numbers in lines 3 to 6") from None
    if not 4 <= len(head[0]) <= 5 or any(len(row) != 4 for row in head[1:]) or not all(
            math.isfinite(v) for row in head for v in row) or any(row[0] != int(row[0]) for row in head):
        raise Failed("no cube: lines 3 to 6 need a whole number and 3 others each")
    atoms, is_orbital = abs(int(head[0][0])), head[0][0] < 0
    each = int(head[0][4]) if len(head[0]) == 5 else 1
    counts, total = _count([abs(int(row[0])) for row in head[1:]], "lines 4 to 6")
    if atoms > 200_000:
        raise Failed(f"{atoms:,} atoms are too many")
    rest = lines[6].split("\n", atoms)
    if len(rest) <= atoms:
        raise Failed(f"it ends before its {atoms} atoms")
    rows = [_numbers(line, 5, "numbers of an atom") for line in rest[:atoms]]
    known = [(SYMBOLS[int(row[0])] if 0 <= row[0] < len(SYMBOLS) else "X", row[2:]) for row in rows]
    numbers: list[str] = []
    body = rest[atoms]
    if is_orbital:  # a line, perhaps more, with how many orbitals there are, and their numbers
        words = body.split(None, 1)
        each = int(words[0]) if words and re.fullmatch("[0-9]{1,4}", words[0]) else 0
        words = body.split(None, each + 1)
        if each < 1 or len(words) < each + 2:
            raise Failed("the list of its orbitals is not understood")
        body, numbers = words[-1], words[1:-1]
    if not 1 <= each <= 1000 or each * total > MOST_VALUES:
        raise Failed(f"{_many(each)} values a point are too many")
    notes = [f"title: {' / '.join(' '.join(line.split()) for line in lines[:2])[:120]}"]
    at = _wanted(array, numbers, each, notes)
    values = np.array(_numbers(body, total * each).reshape([*counts, each])[..., at])
    origin, axes = np.array(head[0][1:4]), np.array([row[1:] for row in head[1:]])
    unit = _cube_unit(head[1][0] < 0, known, notes)
    known = [(symbol, place * unit) for symbol, place in known]
    _refuse_whole_box(origin * unit, axes * unit, counts, known)
    return Table(values, origin * unit, axes * unit, energy_unit=_cube_energy(" ".join(lines[:2]), is_orbital, values, notes),
                 has_unit=True, atoms=known, notes=notes)


def _wanted(array: str | None, numbers: list[str], each: int, notes: list[str]) -> int:
    """Which of the values of a point is wanted: by its number, which an orbital has in the file."""
    names = numbers or [str(n + 1) for n in range(each)]
    if array is not None and array not in names:
        raise Failed(f"--array {array}: it has {'orbital' if numbers else 'value'}{'s' * (each > 1)} {', '.join(names[:20])}")
    at = names.index(array) if array is not None else 0
    if numbers or each > 1:
        notes.append(f"{'orbital' if numbers else 'value'} {names[at]}" + (
            f" of {', '.join(names[:20])}: --array takes another one" if each > 1 else ""))
    return at


def _cube_unit(says_angstrom: bool, atoms: list[tuple[str, Array]], notes: list[str]) -> float:
    """Angstrom for one unit of length."""
    if says_angstrom:
        return 1
    nearest: tuple[float, str, str, float] | None = None
    places = np.array([place for _, place in atoms]).reshape(-1, 3)
    for n, (symbol, place) in enumerate(atoms[:2000]):
        away = np.linalg.norm(places[n + 1:] - place, axis=1)
        for m in np.flatnonzero(away * BOHR < 2.5):
            other = atoms[n + 1 + m][0]
            part = away[m] * BOHR / (RADII.get(symbol, 1.4) + RADII.get(other, 1.4)) if "X" not in (symbol, other) else 1
            if 0.05 < part < min(_BOND, nearest[0] if nearest else _BOND):
                nearest = part, symbol, other, away[m]
    if nearest is None:
        return BOHR
    _, one, other, away = nearest
    notes.append(f"{one} and {other} would be only {away * BOHR:.2f} angstrom apart if its lengths were in bohr: they are taken "
                 "as angstrom")
    return 1


def _refuse_whole_box(origin: Array, axes: Array, counts: list[int], atoms: list[tuple[str, Array]]) -> None:
    """Some programs write the vectors of the whole box where a cube has the steps."""
    steps = np.linalg.norm(axes, axis=1)
    if not (steps > _NO_CELL).all() or not abs(np.linalg.det(axes)) > 0:
        return
    within = [(place - origin) @ np.linalg.inv(axes) for _, place in atoms]
    if all((abs(place - 0.5) <= 1).all() for place in within) if atoms else (steps > 3).all():
        raise Failed(f"its steps are {', '.join(f'{s:.3g}' for s in steps)} angstrom long, as if whole box vectors stood in place of "
                     f"steps: divide them by {', '.join(map(str, counts))}, or by one less, as the program that wrote it counts")


def _cube_energy(title: str, is_orbital: bool, values: Array, notes: list[str]) -> str:
    """The unit, as far as one may say so: that of an electrostatic potential, for a charge of 1."""
    named = _UNITS.search(title)
    if not is_orbital and named:
        return next(one for one in ("kJ/mol", "kcal/mol", "eV", "hartree") if one.lower() == named[0].lower())
    if not is_orbital and _ENERGIES.search(title):
        return "hartree"
    if is_orbital or _OTHERS.search(title):
        notes.append("these are no energies: their unit is not known, --unit names it")
        return ""
    if values.min() >= 0 and values.min() < 1e-3 * values.max():
        notes.append("no value is below zero, as of a density: their unit is not known, --unit names it")
        return ""
    notes.append("its title does not say what its values are: are they energies in hartree? Then give --unit hartree, or "
                 "--unit hartree:kJ/mol")
    return ""


from . import volumes, vti  # noqa: E402  # they use what stands above

READERS: dict[str, Callable[..., Table]] = {
    ".map": volumes.read_ccp4, ".dx": lambda data, **_: read_dx(_text(data)), ".cube": read_cube, ".cub": read_cube, ".vti": vti.read_vti,
    ".npz": volumes.read_npz, ".ccp4": volumes.read_ccp4, ".mrc": volumes.read_ccp4}
