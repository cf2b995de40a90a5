"""XYZ texts of several frames, and the energies that their titles give.

One rule holds here and in the model (examples/molecule/input.cpp). A frame's energy above the conformation is `dE=` in
kJ/mol, or else the difference between its `E=` (hartree; xtb writes `energy:`) and that in the conformation's title.
Where a title gives both ways, they must agree to DIFFER: whoever changes one of them easily forgets the other.
"""

import re

import numpy as np
from hapgrid_command.files import read_text

from .molecule import BadInput
from .xtb import HARTREE

DIFFER = 0.06  # kJ/mol; dE may be rounded to one decimal


def words(title):
    """What a title gives as KEY=VALUE, texts by their keys; xtb's `energy: VALUE` has the key E."""
    out = dict(re.findall(r"(?:^|[ \t,;(])energy(:)[ \t]*([^\s,;)]+)", title))
    out = {"E": out[":"]} if out else {}
    out.update(re.findall(r"(?:^|[ \t,;(])([^\s=,;(]+)=[ \t]*([^\s,;)]+)", title))
    return out


def parsed(text, where):
    """[(words of the title, symbols, positions (atoms, 3) in angstrom)]. where: what the text is called in errors."""
    lines, out = text.rstrip().splitlines(), []
    while lines:
        try:
            count = int(lines[0])
            rows = [line.split() for line in lines[2:2 + count]]
            x = np.array([[float(v) for v in row[1:4]] for row in rows])
            if count < 1 or x.shape != (count, 3) or not np.isfinite(x).all():
                raise ValueError
        except ValueError:
            raise BadInput(f"{where} frame {len(out) + 1}: not understood as XYZ") from None
        out.append((words(lines[1]), [row[0] for row in rows], x))
        lines = lines[2 + count:]
    return out


def frames(path):
    """parsed() of a file."""
    out = parsed(read_text(path), path)
    if not out:
        raise BadInput(f"{path}: is empty")
    return out


def number(given, key, where):
    """A number among the words of a title, None where there is none. Errors: BadInput, where it is no finite number."""
    try:
        value = float(given.get(key, 0))
        if not np.isfinite(value):
            raise ValueError
    except ValueError:
        raise BadInput(f"{where}: {key}={given[key]} is no number") from None
    return value if key in given else None


def above(given, conformation, where):
    """kJ/mol above the conformation, by the words of both titles. Errors: BadInput, where there is no energy, or two that
    differ."""
    rise, own, base = number(given, "dE", where), number(given, "E", where), number(conformation, "E", "conformation")
    if own is None or base is None:
        if rise is None:
            raise BadInput(f"{where}: no energy: its title needs dE= (kJ/mol above the conformation), or E= (hartree) as "
                           "the conformation's title has it")
        return rise
    difference = (own - base) * HARTREE
    if rise is None:
        return difference
    if abs(rise - difference) > DIFFER:
        raise BadInput(f"{where}: dE= gives {rise:.6g} kJ/mol above the conformation, E= gives {difference:.6g}: remove one")
    return rise
