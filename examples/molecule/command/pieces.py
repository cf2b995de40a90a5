"""Which of several molecules is felt. One rule holds for the records of a file, for the pieces of a
record, and for SMILES with dots: that with the most atoms beside hydrogen, then with the most atoms,
then the first. What is left out is named, with its charge."""

from collections import Counter

from preparation.molecule import BadInput
from preparation.xtb import SYMBOLS

METALS = {3, 4, 11, 12, 13, *range(19, 32), *range(37, 51), *range(55, 85), *range(87, 104)}
MOST_PIECES = 8  # of a record in which no piece is half of it: more are no molecules, but noise
NAMED = 4


def signed(charge):
    return f"{charge:+d}" if charge else "0"


def symbol(z):
    return SYMBOLS[z] if z < len(SYMBOLS) else f"element {z}, atom "


def largest(given, say):
    """Open Babel's molecule of all that there are in `given`, a reading.Input."""
    parts = []
    for ob in given.records:
        some = list(ob.Separate())
        if len(some) > MOST_PIECES and 2 * max(p.NumAtoms() for p in some) < ob.NumAtoms():
            raise BadInput(f"{given.what}: {len(some)} pieces that are not bonded: no coordinates of one molecule")
        if len(some) == 1 and given.charge is not None:
            ob.SetTotalCharge(given.charge)
        parts += some if len(some) > 1 else [ob]
    one = max(parts, key=lambda p: (p.NumHvyAtoms(), _size(p)))  # the first of equal ones
    others = [p for p in parts if p is not one]
    if _size(one) == 1 and others:
        raise BadInput(f"{given.what}: only single atoms or ions, {_named(parts)}: none has a shape to feel: "
                       "give a molecule with bonds")
    if others:
        metals = sorted({symbol(a.GetAtomicNum()) for p in others for a in _atoms(p) if a.GetAtomicNum() in METALS})
        say(f"{given.what}: {len(parts)} molecules or shapes: the largest is taken, {one.GetFormula()} with charge "
            f"{signed(one.GetTotalCharge())}; left out: {_named(others)}"
            + ("".join(f"; {m} is a metal and is not felt" for m in metals))
            + ("" if given.charge is None or any(one is ob for ob in given.records)
               else "; the file's charge is of all pieces: --charge gives that of the one"))
    return one


def _atoms(ob):
    return [ob.GetAtom(n + 1) for n in range(ob.NumAtoms())]


def _size(ob):
    """Atoms, with the hydrogens that are not written."""
    return sum(1 + a.GetImplicitHCount() for a in _atoms(ob))


def _named(parts):
    """C2H6O, 2 of Na+ with charge +1"""
    counts = Counter((p.GetFormula(), p.GetTotalCharge()) for p in parts)
    words = [(f"{n} of " if n > 1 else "") + formula + (f" with charge {charge:+d}" if charge else "")
             for (formula, charge), n in counts.items()]
    return ", ".join(words[:NAMED]) + (f" and {len(words) - NAMED} more" if len(words) > NAMED else "")
