"""XYZ texts of several frames, and the energies that their titles give.

One rule holds here and in the model (tools/apps/molecule/input.cpp). A frame's energy above the conformation is `dE=` in
kJ/mol, or else the difference between its `E=` (hartree; xtb writes `energy:`) and that in the conformation's title.
Where a title gives both ways, they must agree to DIFFER: whoever changes one of them easily forgets the other.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import read_text

from . import geometry
from .elements import COVALENT, NUMBERS, SYMBOLS
from .molecule import BadInput
from .xtb import BOHR, HARTREE

NOBLE = {2, 10, 18, 36, 54, 86}  # they have no bonds whose lengths tell the unit
DIFFER = 0.06  # kJ/mol; dE may be rounded to one decimal


def words(title: str) -> dict[str, str]:
    """What a title gives as KEY=VALUE, texts by their keys; xtb's `energy: VALUE` has the key E."""
    out = dict(re.findall(r"(?:^|[ \t,;(])energy(:)[ \t]*([^\s,;)]+)", title))
    out = {"E": out[":"]} if out else {}
    out.update(re.findall(r"(?:^|[ \t,;(])([^\s=,;(]+)=[ \t]*([^\s,;)]+)", title))
    return out


@dataclass
class Frame:
    """x: positions (atoms, 3) in angstrom."""
    title: str
    numbers: list[int]
    x: Array

    @property
    def words(self) -> dict[str, str]:
        return words(self.title)


def frames_of(text: str, what: str, say: Callable[[str], object] = lambda _: None) -> list[Frame]:
    """The Frames of a text, of whichever program. what: it is called in errors; say(line): tells what was put right. Errors:
    BadInput."""
    lines, at = text.rstrip().split("\n"), 0
    out: list[Frame] = []
    atoms = {n: _atom(line, say) for n, line in enumerate(lines)}
    while at < len(lines):
        at = _frame(lines, atoms, at, what, say, out) if lines[at].strip(" \t>") else at + 1
    return out


def _frame(lines: list[str], atoms: Mapping[int, Any], at: int, what: str, say: Callable[[str], object],
           out: list[Frame]) -> int:
    """Adds the Frame that begins in line `at`, and returns the line after it. atoms: of each line that is one."""
    if re.fullmatch(r"\s*\d{1,9}\s*", lines[at]):
        count, first = int(lines[at]), at + 2
        title = lines[at + 1] if at + 1 < len(lines) else ""
        if atoms.get(at + 1) and not atoms.get(at + 1 + count):
            say("the line of the title is missing: the atoms are taken from the line after their number on")
            first, title = at + 1, ""
    else:
        title = "" if atoms[at] else lines[at]
        first = at + bool(title)
        count = next((n for n in range(first, len(lines)) if not atoms[n]), len(lines)) - first
        if count:
            say("the line with the number of atoms is missing: all lines of atoms are taken")
    if count == 0:
        raise BadInput(f"{what}: line {at + 1} has no atoms: not understood as XYZ")
    last = first + count
    other = next((n for n in range(first, last) if not atoms.get(n)), None)
    if other is not None:
        wrong = f"line {other + 1} is no atom" if other < len(lines) else f"the file ends after line {len(lines)}"
        raise BadInput(f"{what}: {wrong}, but line {at + 1} says that {count} follow")
    if (first > at + 1 or title == "") and atoms.get(last):
        raise BadInput(f"{what}: line {at + 1} says that {count} atoms follow, but there are more")
    numbers, x = [atoms[n][0] for n in range(first, last)], np.array([atoms[n][1:] for n in range(first, last)])
    nearest = geometry.shares(numbers, x).min(axis=1)
    if nearest.min() > 1.5 and nearest.max() < 2.2 and not NOBLE & {*numbers}:  # as if bohr had been written for angstrom
        say("the atoms are 1.9 times too far apart: the coordinates are taken to be in bohr")
        x = x * BOHR
    if cell := re.search(r"\bLattice\s*=\s*\"([^\"]*)\"", title, re.I):
        x = _whole(numbers, x, cell[1], title, what, say)
    out.append(Frame(title, numbers, x))
    return last


def _whole(numbers: list[int], x: Array, cell: str, title: str, what: str, say: Callable[[str], object]) -> Array:
    """x with each molecule in one piece, in extended XYZ whose atoms were put back into a cell. cell: its three vectors."""
    try:
        vectors = np.array([finite(word) for word in cell.split()]).reshape(3, 3)
        inverse = np.linalg.inv(vectors)
    except (ValueError, np.linalg.LinAlgError):
        raise BadInput(f"{what}: Lattice=\"{cell}\" is no cell of three vectors") from None
    found = re.search(r"\bpbc\s*=\s*\"?([TF01]\w*)\s+([TF01]\w*)\s+([TF01]\w*)", title, re.I)
    repeats = np.array([word[0] in "Tt1" for word in found.groups()] if found else [True] * 3)
    radius = np.array([COVALENT.get(z, 1.5) for z in numbers])
    out, placed = x.copy(), np.zeros(len(x), bool)
    for first in range(len(x)):
        row = [] if placed[first] else [first]
        placed[first] = True
        for at in row:
            away = x - x[at]
            away -= np.where(repeats, np.round(away @ inverse), 0) @ vectors
            share = np.linalg.norm(away, axis=1) / (radius + radius[at])
            for n in np.flatnonzero(share < geometry.BONDED):
                place = out[at] + away[n]
                if not placed[n]:
                    out[n], placed[n] = place, True
                    row.append(int(n))
                elif np.linalg.norm(out[n] - place) > 0.1:
                    raise BadInput(f"{what}: its bonds go on from cell to cell, which is a crystal: cut out a molecule")
    if np.abs(out - x).max() > 0.1:
        say("molecules that the walls of the cell cut are put together")
    return out


def _atom(line: str, say: Callable[[str], object]) -> tuple[float, ...] | None:
    """(atomic number, 0 for no known element, x, y, z) of a line, or None."""
    words = line.split()
    if any(re.fullmatch(r"[+-]?\d+,\d+", w) for w in words[1:4]):
        say("decimal commas are read as points")
        words = [w.replace(",", ".") for w in words]
    elif "," in line:
        words = line.replace(",", " ").split()
    try:
        x = [finite(re.sub("[dD]", "e", w)) for w in words[1:4]]
    except ValueError:
        return None
    symbol = re.fullmatch(r"([A-Za-z]{1,2})\d*|(\d{1,3})", words[0]) if len(x) == 3 else None
    if symbol is None:
        return None
    number = int(symbol[2]) if symbol[2] else NUMBERS.get(symbol[1].upper(), 0)
    return (number if number < len(SYMBOLS) else 0, *x)


def frames(path: str) -> list[Frame]:
    out = frames_of(read_text(path), path)
    if not out:
        raise BadInput(f"{path}: is empty")
    return out


def finite(text: object) -> float:
    """The number of a text, or of what was read from JSON. Errors: ValueError, where it is no finite number."""
    value = float(str(text))  # of an integer of 400 digits it is infinite
    if not np.isfinite(value):
        raise ValueError(text)
    return value


def above(given: Mapping[str, str], conformation: Mapping[str, str], where: str) -> float:
    """kJ/mol above the conformation, by the words of both titles. Errors: BadInput, where there is no energy, or two that
    differ."""
    def number(given: Mapping[str, str], key: str, where: str) -> float | None:
        try:
            return finite(given[key]) if key in given else None
        except ValueError:
            raise BadInput(f"{where}: {key}={given[key]} is no number") from None
    rise, own, base = number(given, "dE", where), number(given, "E", where), number(conformation, "E", "conformation")
    difference = None if own is None or base is None else (own - base) * HARTREE
    energy = difference if rise is None else rise
    if energy is None:
        raise BadInput(f"{where}: no energy: its title needs dE= (kJ/mol above the conformation), or E= (hartree) as "
                       "the conformation's title has it")
    if rise is not None and difference is not None and abs(rise - difference) > DIFFER:
        raise BadInput(f"{where}: dE= gives {rise:.6g} kJ/mol above the conformation, E= gives {difference:.6g}: remove one")
    return energy
