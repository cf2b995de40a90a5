"""Charges that a file does not say. Formats without formal charges leave an ion with valences that no neutral atom has.
"""

from preparation.molecule import BadInput
from rdkit import Chem

from .pieces import signed, symbol

# Sums of bond orders that an atom without a charge has. Nitrogen with five is a nitro group, as many programs write it.
VALENCES = {1: (1,), 5: (3,), 6: (4,), 7: (3, 5), 8: (2,), 9: (1,), 14: (4,), 15: (3, 5), 16: (2, 4, 6), 17: (1, 3, 5, 7),
            34: (2, 4, 6), 35: (1, 3, 5), 53: (1, 3, 5, 7)}
# The charge with which an atom is closed, by element and the sum of its bond orders.
CLOSED = {(5, 4): -1, (7, 4): 1, (7, 2): -1, (8, 1): -1, (8, 3): 1, (9, 0): -1, (15, 4): 1, (15, 2): -1, (15, 6): -1, (16, 1): -1,
          (16, 3): 1, (17, 0): -1, (34, 1): -1, (34, 3): 1, (35, 0): -1, (35, 2): 1, (53, 0): -1, (53, 2): 1}
MOST_NAMED = 6


def open_atoms(mol):
    """[(atom, the charge that would close it or None)] of atoms without a formal charge."""
    found = []
    for atom in mol.GetAtoms():
        z = atom.GetAtomicNum()
        order = int(sum(b.GetBondTypeAsDouble() for b in atom.GetBonds())) + atom.GetTotalNumHs()
        if atom.GetFormalCharge() or order in VALENCES.get(z, (order,)):
            continue
        charge = CLOSED.get((z, order))
        if z == 6 and any(b.GetBondType() == Chem.BondType.TRIPLE for b in atom.GetBonds()) and order == 3:
            charge = -1  # carbon monoxide, isocyanides, cyanide
        found.append((atom.GetIdx(), charge))
    return found


def named(mol, atoms):
    words = [f"{symbol(mol.GetAtomWithIdx(n).GetAtomicNum())}{n + 1}" for n in atoms]
    more = f" and {len(words) - MOST_NAMED} more" if len(words) > MOST_NAMED else ""
    return ", ".join(words[:MOST_NAMED]) + more


def close(mol, what, charge, unpaired):
    """Gives the atoms of a molecule that is whole the formal charges that close them, where their sum is the molecule's
    charge. charge, unpaired: what was said of them, or None. Errors: BadInput where nothing was said and it is needed."""
    found = open_atoms(mol)
    if not found:
        return
    total = Chem.GetFormalCharge(mol) + sum(q or 0 for _, q in found)
    known = all(q is not None for _, q in found)
    if charge is None and unpaired is None and not (known and total == 0):
        one = len(found) == 1
        advice = f"--charge {signed(total)} closes {'it' if one else 'them'}" if known else "--charge, or --uhf for a radical"
        raise BadInput(f"{what}: {named(mol, [n for n, _ in found])} {'has an open valence' if one else 'have open valences'}, "
                       f"and no charge is given: {advice}")
    if known and (charge is None or total == charge):
        for n, q in found:
            mol.GetAtomWithIdx(n).SetFormalCharge(q)
