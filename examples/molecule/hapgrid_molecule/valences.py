"""Bonds and charges that a file does not say.

Formats without orders of bonds or without formal charges leave them open. Of all ways to give each atom a valence that it can
have, so that the charges add up to the molecule's, the cheapest is taken: a small integer program, whose answer is exact
where rules that go from atom to atom miss nitrile oxides or the charge of an enolate.
"""

import numpy as np
from rdkit import Chem
from scipy import optimize

from . import geometry
from .molecule import BadInput, numbers_of, places_of, signed

# {element: {charge: sums of bond orders that an atom with it has}}
VALENCES = {
    1: {0: (1,)}, 5: {0: (3,), -1: (4,)}, 6: {0: (4,), -1: (3,), 1: (3,)}, 7: {0: (3, 5), 1: (4,), -1: (2,)},
    8: {0: (2,), -1: (1,), 1: (3,)}, 9: {0: (1,), -1: (0,)}, 14: {0: (4,), -1: (5,), -2: (6,)},
    15: {0: (3, 5), 1: (4,), -1: (2, 6)}, 16: {0: (2, 4, 6), -1: (1,), 1: (3, 5)}, 17: {0: (1, 3, 5, 7), -1: (0,)},
    33: {0: (3, 5), 1: (4,), -1: (2, 6)}, 34: {0: (2, 4, 6), -1: (1,), 1: (3, 5)}, 35: {0: (1, 3, 5), -1: (0, 2), 1: (2,)},
    52: {0: (2, 4, 6), -1: (1,), 1: (3,)}, 53: {0: (1, 3, 5, 7), -1: (0, 2), 1: (2,)}}
# What a charge costs where that is not 1: less where the element holds it easily, more on carbon.
ON = {(6, -1): 2.5, (6, 1): 2.5, (7, -1): 1.2, (5, -1): 0.5, (15, 1): 0.8, (15, -1): 2.5, (16, 1): 0.8}
HIGHER = 0.3  # each valence above the first one
FIVE = 3.0  # nitrogen's, as many programs write a nitro group; RDKit writes it with charges
UNPAIRED = 4.0
UNCLEAR = 1.0  # two charges whose costs differ by less are both named
HYDROGEN = 0.005  # so that a bond is a double one where its length tells nothing
# An atom with three neighbours and a hydrogen is half an angstrom above their plane, one without lies in it.
HEIGHT, LIFTED = 0.22, 5.0  # half of that, and what it costs to be off by an angstrom
WIDER = 0.035  # a degree by which the angle at a pyrrole's nitrogen is less than 106, as it is without a hydrogen
OXIDE = 2.0  # a hydrogen on an oxygen whose bond to nitrogen is that of an N-oxide
MORE = 0.3  # a hydrogen that Open Babel does not see, on carbon or oxygen
# Lengths in units of the sum of the covalent radii, and what it costs to be off by one.
LENGTHS, OFF = np.array([1.0, 0.87, 0.78]), 2.0
STRAIGHT = np.radians(150)
ACID = Chem.MolFromSmarts("[OD1]~[#7,#15,#16,$([#6](~[OD1])~[OD1])]")
PYRROLE = Chem.MolFromSmarts("[#7D2]1~[#6]~[#6,#7]~[#6,#7]~[#6]1")  # as in porphine, whose bonds tell nothing
SECONDS = 20
NAMED = 6


def _order(atom):
    return int(sum(b.GetBondTypeAsDouble() for b in atom.GetBonds())) + atom.GetTotalNumHs()


def _states(atom, radicals):
    """[(sum of bond orders, charge, unpaired electrons, cost)] that an atom can have; the one that it has, where nothing is
    known of its element. A charge that the file gives stays."""
    z, given = atom.GetAtomicNum(), atom.GetFormalCharge()
    if z not in VALENCES:
        return [(_order(atom), given, 0, 0.0)]
    out = [(v, charge, 0, abs(charge) * ON.get((z, charge), 1.0) + (FIVE if (z, v) == (7, 5) else HIGHER * n))
           for charge, valences in VALENCES[z].items() for n, v in enumerate(valences) if given in (0, charge)]
    if radicals:
        first = VALENCES[z][0][0]
        out += [(first - 1, 0, 1, UNPAIRED), (first - 2, 0, 2, 2 * UNPAIRED)] if given == 0 else []
        out += [(first, 1, 1, 1 + UNPAIRED)] if z in (7, 8, 16) and given in (0, 1) else []  # without an electron of its pair
    return out


def assigned(mol, charge, unpaired, free, loose=False):
    """(a copy of RDKit's molecule with orders of bonds and formal charges for its total charge and number of unpaired
    electrons, what it costs), or (None, inf) where there are none. charge, unpaired: None for whatever costs least; free:
    whether orders of bonds may change, by their lengths; loose: whether numbers of hydrogens may change for that, too."""
    atoms, bonds = list(mol.GetAtoms()), list(mol.GetBonds())
    share = geometry.shares(numbers_of(mol), places_of(mol)) if free else None
    shape = [_shape(atom, places_of(mol)) if loose else "" for atom in atoms]
    acids, pyrroles = ({match[0] for match in mol.GetSubstructMatches(one)} for one in (ACID, PYRROLE))
    hydrogen = [_hydrogen_cost(atom, places_of(mol), pyrroles) if loose else HYDROGEN for atom in atoms]
    # Each choice is a state of an atom or an order of a bond: (its column of the equations, its cost, what is done with it).
    # Rows: each atom and each bond has one choice; bonds of an atom add up to its valence; charges; unpaired electrons; and where
    # hydrogens are open, carbon and nitrogen have one bond at most that is not single, unless they lie on a line.
    other = charge != Chem.GetFormalCharge(mol)

    def fits(n, z, order, q, hydrogens):
        """Where hydrogens are open an atom on a line has none. Charges that the file does not give are without hydrogens on
        nitrogen, on an acid's oxygen, or on or beside atoms on a line; another total charge is on any nitrogen or oxygen."""
        near = any(shape[at] == "straight" for at in (n, *(one.GetIdx() for one in atoms[n].GetNeighbors())))
        return (shape[n] != "straight" or (order, hydrogens) == (4, 0)) and (z, order) != (7, 5) and (
            q == atoms[n].GetFormalCharge() or other and z in (7, 8) or hydrogens == 0 and (z == 7 or n in acids or near))
    choices, valence, total = [], len(atoms) + len(bonds), 2 * len(atoms) + len(bonds)
    for n, atom in enumerate(atoms):
        most, z = atom.GetTotalNumHs(), atom.GetAtomicNum()
        more = loose and (z in (6, 7) or z == 8 and all(near.GetAtomicNum() == 6 for near in atom.GetNeighbors()))
        for order, q, spins, cost in _states(atom, unpaired != 0):
            for hydrogens in range(0 if loose else most, most + 1 + more):
                if not loose or fits(n, z, order, q, hydrogens):
                    cost_of_hydrogens = hydrogen[n] * hydrogens + MORE * (hydrogens > most and z != 7)
                    choices.append(({n: 1, valence + n: hydrogens - order, total: q, total + 1: spins}, cost + cost_of_hydrogens,
                                    lambda to, n=n, some=(q, spins, hydrogens): _set(to.GetAtomWithIdx(n), *some)))
    for n, bond in enumerate(bonds):
        a, b, order = bond.GetBeginAtomIdx(), bond.GetEndAtomIdx(), int(bond.GetBondTypeAsDouble())
        for taken in (1, 2, 3) if free and 1 not in (atoms[a].GetAtomicNum(), atoms[b].GetAtomicNum()) else (order,):
            # The last bonds are single where nothing else tells.
            cost = OFF * abs(share[a, b] - LENGTHS[taken - 1]) + 1e-6 * n * taken if free else 0.0
            several = {total + 2 + a: 1, total + 2 + b: 1} if taken > 1 else {}
            choices.append(({len(atoms) + n: 1, valence + a: taken, valence + b: taken, **several}, cost,
                            lambda to, n=n, taken=taken: to.GetBondWithIdx(n).SetBondType(Chem.BondType.values[taken])))
    matrix = np.zeros((total + 2 + len(atoms), len(choices)))
    for k, (column, _, _) in enumerate(choices):
        matrix[list(column), k] = list(column.values())
    one = [1] * valence + [0] * len(atoms)
    low, high = ([*one, *(end if last is None else last for last in (charge, unpaired))] for end in (-np.inf, np.inf))
    low += [0] * len(atoms)
    high += [1 if one == "bent" else np.inf for one in shape]
    found = optimize.milp([cost for _, cost, _ in choices], integrality=np.ones(len(choices)), bounds=optimize.Bounds(0, 1),
                          constraints=optimize.LinearConstraint(matrix, low, high), options={"time_limit": SECONDS})
    if found.x is None:
        return None, np.inf
    out = Chem.RWMol(mol)
    for k in np.flatnonzero(found.x > 0.5):
        choices[k][2](out)
    out.UpdatePropertyCache(strict=False)
    return out.GetMol(), found.fun


def _shape(atom, x):
    """Whether a carbon or nitrogen is "bent" or "straight" between its neighbours."""
    near = [n.GetIdx() for n in atom.GetNeighbors()]
    if atom.GetAtomicNum() not in (6, 7) or len(near) < 2:
        return ""
    return "straight" if len(near) == 2 and geometry.angle(x, near[0], atom.GetIdx(), near[1]) > STRAIGHT else "bent"


def _hydrogen_cost(atom, x, pyrroles):
    """What a hydrogen costs on an atom that the file has without, by the places of its neighbours. pyrroles: see PYRROLE."""
    z, near = atom.GetAtomicNum(), [x[n.GetIdx()] - x[atom.GetIdx()] for n in atom.GetNeighbors()]
    if z in (6, 7) and len(near) == 3:
        a, b, c = near
        return LIFTED * (HEIGHT - min(abs(a @ np.cross(b, c)) / np.linalg.norm(np.cross(b - a, c - a)), 2 * HEIGHT))
    if atom.GetIdx() in pyrroles:
        return WIDER * (106 - np.degrees(geometry.angle([near[0], np.zeros(3), near[1]], 0, 1, 2)))
    short = [n.GetAtomicNum() for n in atom.GetNeighbors()] == [7] and np.linalg.norm(near[0]) < 1.34
    return OXIDE if z == 8 and short else HYDROGEN


def _set(atom, charge, radicals, hydrogens):
    atom.SetFormalCharge(charge)
    atom.SetNumRadicalElectrons(radicals)
    atom.SetNumExplicitHs(hydrogens)
    atom.SetNoImplicit(True)


def closed(mol, what, charge, unpaired, free):
    """The molecule with bonds and charges that fit what was said of it. charge, unpaired: that, or None; free: as assigned()
    has it. Where both were said and nothing fits, it stays as it is. Errors: BadInput, which says which charge fits."""
    total = Chem.GetFormalCharge(mol) if charge is None else charge
    electrons = sum(a.GetAtomicNum() + a.GetTotalNumHs() for a in mol.GetAtoms()) - total
    is_odd = (electrons - (unpaired or 0)) % 2 == 1
    if is_odd and (charge is not None or unpaired is not None):
        return mol  # reading.read() refuses it
    one = None if is_odd else assigned(mol, total, unpaired or 0, free)[0]
    if one is not None or charge is not None and unpaired is not None:
        return one or mol
    best, cost = assigned(mol, None, unpaired or 0, free)
    if best is None:
        full = next((a for a in mol.GetAtoms() if _order(a) > max(v for v, *_ in _states(a, False))), None)
        why = "no orders of its bonds fit its valences" if full is None else f"{named(mol, [full.GetIdx()])} has {_order(full)} bonds"
        raise BadInput(f"{what}: {why}: correct its atoms or bonds, or give both --charge and --uhf to compute it as it is")
    fits = Chem.GetFormalCharge(best)
    if charge is not None:
        raise BadInput(f"{what}: its bonds fit --charge {signed(fits)}, and not {signed(charge)}: correct it, or give --uhf "
                       f"{unpaired or 0} as well, with which it is computed all the same")
    advice = f"--charge {signed(fits)}"
    if assigned(mol, 2 * total - fits, unpaired or 0, free)[1] < cost + UNCLEAR:
        advice += f" or {signed(2 * total - fits)}"
    atoms = opened(mol, best)
    have, them = ("has an open valence", "it") if len(atoms) == 1 else ("have open valences", "them")
    raise BadInput(f"{what}: {named(mol, atoms)} {have}, and no charge is given: {advice} closes {them}"
                   + ("; a radical needs --uhf 1" if is_odd else ""))


def opened(mol, best):
    """The atoms that have a charge only in `best`, without those whose neighbour makes up for it, if others are left."""
    before, after = ([a.GetFormalCharge() for a in one.GetAtoms()] for one in (mol, best))
    atoms = [a for a in best.GetAtoms() if after[a.GetIdx()] != before[a.GetIdx()]]
    alone = [a for a in atoms if all(after[a.GetIdx()] * after[n.GetIdx()] >= 0 for n in a.GetNeighbors())]
    return [a.GetIdx() for a in alone or atoms]


def named(mol, atoms):
    words = [f"{mol.GetAtomWithIdx(n).GetSymbol()}{n + 1}" for n in atoms]
    return ", ".join(words[:NAMED]) + (f" and {len(words) - NAMED} more" if len(words) > NAMED else "")
