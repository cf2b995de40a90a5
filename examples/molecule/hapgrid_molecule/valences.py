"""Bonds and charges that a file does not say. Formats without bonds and formal charges leave atoms with valences that
none has: of an ion, or where Open Babel did not find all double bonds of a molecule that has all its hydrogens.
"""

from rdkit import Chem

from .molecule import BadInput, signed

# Sums of bond orders that an atom without a charge has. Nitrogen with five is a nitro group, as many programs write it.
VALENCES = {1: (1,), 5: (3,), 6: (4,), 7: (3, 5), 8: (2,), 9: (1,), 14: (4,), 15: (3, 5), 16: (2, 4, 6), 17: (1, 3, 5, 7),
            34: (2, 4, 6), 35: (1, 3, 5), 53: (1, 3, 5, 7)}
# The charge with which an atom is closed, by element and the sum of its bond orders.
CLOSED = {(5, 4): -1, (7, 4): 1, (7, 2): -1, (8, 1): -1, (8, 3): 1, (9, 0): -1, (15, 4): 1, (15, 2): -1, (15, 6): -1,
          (16, 1): -1, (16, 3): 1, (17, 0): -1, (34, 1): -1, (34, 3): 1, (35, 0): -1, (35, 2): 1, (53, 0): -1, (53, 2): 1}
NAMED = 6


def _order(atom):
    return int(sum(b.GetBondTypeAsDouble() for b in atom.GetBonds())) + atom.GetTotalNumHs()


def lacking(mol):
    """{atom: how many bonds it lacks} of atoms without a formal charge."""
    out = {}
    for atom in mol.GetAtoms():
        more = [v - _order(atom) for v in VALENCES.get(atom.GetAtomicNum(), ()) if v >= _order(atom)]
        if more and more[0] > 0 and atom.GetFormalCharge() == 0:
            out[atom.GetIdx()] = more[0]
    return out


def pair_up(mol, lack, charge):
    """Makes double bonds between the atoms that lack some: in pairs, along chains in which single and double bonds change
    places. With a positive charge a chain may end at a nitrogen, which takes it. Changes lack, as of lacking()."""
    left = max((charge or 0) - Chem.GetFormalCharge(mol), 0)
    for start in sorted(lack):
        while lack.get(start):
            bases = {a.GetIdx() for a in mol.GetAtoms() if left and a.GetAtomicNum() == 7 and a.GetDegree() == 3
                     and _order(a) == 3 and a.GetFormalCharge() == 0}
            chain = _chain(mol, start, {n for n in lack if lack[n] and n != start}) or _chain(mol, start, bases)
            if chain is None:
                break
            end, bonds = chain
            for n, bond in enumerate(bonds):
                order = int(bond.GetBondTypeAsDouble()) + (-1 if n % 2 else 1)
                bond.SetBondType(Chem.BondType.values[order])
            lack[start] -= 1
            if lack.get(end):
                lack[end] -= 1
            else:
                mol.GetAtomWithIdx(end).SetFormalCharge(1)
                left -= 1


def raise_valences(mol, lack):
    """Makes double bonds from an atom that can have a higher valence, such as the sulphur of a sulphonate, to ends that still
    lack some behind pair_up()."""
    for atom in mol.GetAtoms():
        bonds = [(bond, end.GetIdx()) for bond in atom.GetBonds()
                 for end in [bond.GetOtherAtom(atom)] if lack.get(end.GetIdx()) and end.GetDegree() == 1]
        most, order = sum(lack[end] for _, end in bonds), _order(atom)
        room = max((v - order for v in VALENCES.get(atom.GetAtomicNum(), ())[1:] if 0 < v - order <= most), default=0)
        for bond, end in bonds:
            more = min(lack[end], room)
            bond.SetBondType(Chem.BondType.values[int(bond.GetBondTypeAsDouble()) + more])
            lack[end] -= more
            room -= more


def _chain(mol, start, ends):
    """(the end, the bonds to it): the shortest chain from start to one of ends whose bonds can be raised and lowered in turn,
    or None."""
    seen, queue = {start}, [(start, [])]
    for at, bonds in queue:
        for bond in mol.GetAtomWithIdx(at).GetBonds():
            to = bond.GetOtherAtomIdx(at)
            if mol.GetAtomWithIdx(to).GetAtomicNum() == 1 or bond.GetBondTypeAsDouble() > 2 or bond in bonds:
                continue
            if to in ends:
                return to, [*bonds, bond]
            if bond.GetBondTypeAsDouble() > 1:
                continue
            for second in mol.GetAtomWithIdx(to).GetBonds():
                beyond = second.GetOtherAtomIdx(to)
                if second.GetBondTypeAsDouble() > 1 and beyond not in seen:
                    seen.add(beyond)
                    queue.append((beyond, [*bonds, bond, second]))
    return None


def close(mol, what, charge, unpaired):
    """Gives the atoms of a molecule that is whole the formal charges that close them, where their sum is the molecule's
    charge. charge, unpaired: what was said of them, or None. Errors: BadInput where nothing was said and it is needed."""
    found = []  # (atom, the charge that would close it or None)
    for atom in mol.GetAtoms():
        z = atom.GetAtomicNum()
        order = _order(atom)
        if atom.GetFormalCharge() or order in VALENCES.get(z, (order,)):
            continue
        closing = CLOSED.get((z, order))
        if z == 6 and any(b.GetBondType() == Chem.BondType.TRIPLE for b in atom.GetBonds()) and order == 3:
            closing = -1  # carbon monoxide, isocyanides, cyanide
        found.append((atom.GetIdx(), closing))
    if not found:
        return
    total = Chem.GetFormalCharge(mol) + sum(q or 0 for _, q in found)
    known = all(q is not None for _, q in found)
    if charge is None and unpaired is None and not (known and total == 0):
        one = len(found) == 1
        advice = f"--charge {signed(total)} closes {'it' if one else 'them'}" if known else "--charge, or --uhf for a radical"
        have = "has an open valence" if one else "have open valences"
        raise BadInput(f"{what}: {named(mol, [n for n, _ in found])} {have}, and no charge is given: {advice}")
    if known and (charge is None or total == charge):
        for n, q in found:
            mol.GetAtomWithIdx(n).SetFormalCharge(q)


def named(mol, atoms):
    words = [f"{mol.GetAtomWithIdx(n).GetSymbol()}{n + 1}" for n in atoms]
    return ", ".join(words[:NAMED]) + (f" and {len(words) - NAMED} more" if len(words) > NAMED else "")
