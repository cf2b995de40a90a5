"""Bonds, charges and hydrogens that a file does not say.

Formats without orders of bonds, formal charges or hydrogens leave them open. Of all ways to give each atom a valence that it
can have, so that the charges add up to the molecule's, the cheapest is taken: a small integer program, whose answer is exact
where rules that go from atom to atom miss nitrile oxides or the charge of an enolate.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from typing import Any

import numpy as np
from hapgrid.apps.common.arrays import Array
from rdkit import Chem
from scipy import optimize

from . import geometry
from .molecule import BadInput, listed, numbers_of, places_of, signed

# {element: {charge: sums of bond orders that an atom with it has}}
VALENCES: dict[int, dict[int, tuple[int, ...]]] = {
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
HYDROGEN = 0.005  # so that a bond is a double one where its length tells nothing
UNCLEAR = 1.0  # two charges whose costs differ by less are both named
EVEN = 1e-4  # by the square of an atom's number of hydrogens: no NH3+ where two NH2 are as good, as in guanidinium
# An atom with three neighbours and a hydrogen is half an angstrom above their plane, one without lies in it.
HEIGHT, LIFTED = 0.22, 5.0  # half of that, and what it costs to be off by an angstrom
WIDER = 0.035  # a degree by which the angle at a pyrrole's nitrogen is less than 106, as it is without a hydrogen
OXIDE = 2.0  # a hydrogen on an oxygen whose bond to nitrogen is that of an N-oxide
# Lengths in units of the sum of the covalent radii, and what it costs to be off by one.
LENGTHS, OFF = np.array([1.0, 0.87, 0.78]), 2.0
STRAIGHT = np.radians(150)
PYRROLE = Chem.MolFromSmarts("[#7D2]~1~[#6]~[#6,#7]~[#6,#7]~[#6]~1")  # as in porphine, whose bonds tell nothing
PARTIAL = "_TriposPartialCharge"  # where RDKit keeps the partial charges of MOL2
SECONDS = 20


def _order(atom: Chem.Atom) -> int:
    """The sum of the orders of its bonds, with its hydrogens; a bond whose order is open counts once."""
    return int(sum(max(1, b.GetBondTypeAsDouble()) for b in atom.GetBonds())) + atom.GetTotalNumHs()


def _states(atom: Chem.Atom, radicals: bool) -> list[tuple[int, int, int, float]]:
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


def assigned(mol: Chem.Mol, charge: int | None, unpaired: int | None) -> Chem.Mol | None:
    """A copy of RDKit's molecule with orders of bonds, formal charges and hydrogens for its total charge and number of unpaired
    electrons, with its property "cost", or None where there are none. charge, unpaired: None for whatever costs least.

    Bonds that are UNSPECIFIED or AROMATIC get an order by their lengths. Atoms that may have implicit hydrogens get these by
    the places of their neighbours.
    """
    x, atoms, bonds = places_of(mol), list(mol.GetAtoms()), list(mol.GetBonds())
    share = geometry.shares(numbers_of(mol), x)
    pyrroles = {match[0] for match in mol.GetSubstructMatches(PYRROLE)}
    straight = {atom.GetIdx() for atom in atoms if _is_straight(atom, x)}
    beside = straight | {near.GetIdx() for n in straight for near in atoms[n].GetNeighbors()}
    bent = {n for n, a in enumerate(atoms) if not a.GetNoImplicit() and a.GetAtomicNum() in (6, 7)} - straight
    # The equations: each atom and each bond has one choice; the bonds of an atom add up to its valence; so do charges and
    # unpaired electrons; and where hydrogens are open, a bent carbon or nitrogen has one bond at most that is not single.
    bounds: dict[Any, tuple[float, float]] = {
        name: (-np.inf, np.inf) if number is None else (number, number)
        for name, number in (("charge", charge), ("unpaired", unpaired))}
    for n in range(len(atoms)):
        bounds.update({("state", n): (1, 1), ("valence", n): (0, 0), ("double", n): (0, 1)})
    bounds.update({("order", n): (1, 1) for n in range(len(bonds))})
    # There, too, an atom on a line has no hydrogen, carbon has a charge only on or beside a line, and nitrogen no five bonds.
    choices: list[tuple[int, Any, float, dict[Any, int]]] = []  # (atom or bond, what is chosen for it, cost, {equation: what it adds})
    for n, atom in enumerate(atoms):
        z, is_open = atom.GetAtomicNum(), not atom.GetNoImplicit()
        each = _hydrogen_cost(atom, x, pyrroles) if is_open else 0.0
        for order, q, spins, cost in _states(atom, unpaired != 0):
            for hydrogens in range(max(0, order - atom.GetDegree()) + 1) if is_open else [atom.GetTotalNumHs()]:
                if is_open and (n in straight and (order, hydrogens) != (4, 0) or z == 6 and q and n not in beside or
                                (z, order) == (7, 5)):
                    continue
                choices.append((n, (q, spins, hydrogens), cost + each * hydrogens + EVEN * hydrogens**2, {
                    ("state", n): 1, ("valence", n): hydrogens - order, "charge": q, "unpaired": spins}))
    for n, bond in enumerate(bonds):
        ends = bond.GetBeginAtomIdx(), bond.GetEndAtomIdx()
        for order in _orders(bond):
            # The last bonds are single where nothing else tells.
            choices.append((n, order, OFF * abs(share[ends] - LENGTHS[order - 1]) + 1e-6 * n * order, {
                ("order", n): 1, **{("valence", at): order for at in ends},
                **{("double", at): 1 for at in ends if order > 1 and at in bent}}))
    rows = {name: k for k, name in enumerate(bounds)}
    matrix = np.zeros((len(bounds), len(choices)))
    for k, (*_, column) in enumerate(choices):
        for name, number in column.items():
            matrix[rows[name], k] = number
    # With its presolve the solver of Debian 12 gives answers that break the equations.
    found = optimize.milp([cost for *_, cost, _ in choices], integrality=np.ones(len(choices)), bounds=optimize.Bounds(0, 1),
                          constraints=optimize.LinearConstraint(matrix, *zip(*bounds.values())),
                          options={"time_limit": SECONDS, "presolve": False})
    if found.x is None:
        return None
    out = Chem.RWMol(mol)
    for k in np.flatnonzero(found.x > 0.5):
        n, value, *_ = choices[k]
        one = out.GetAtomWithIdx(n) if isinstance(value, tuple) else out.GetBondWithIdx(n)
        one.SetIsAromatic(False)
        if isinstance(value, tuple):
            charge, radicals, hydrogens = value
            one.SetFormalCharge(charge)
            one.SetNumRadicalElectrons(radicals)
            one.SetNumExplicitHs(hydrogens)
            one.SetNoImplicit(True)
        else:
            one.SetBondType(Chem.BondType.values[value])
    out.UpdatePropertyCache(strict=False)
    out.SetDoubleProp("cost", found.fun)
    return out.GetMol()


def _orders(bond: Chem.Bond) -> list[int]:
    """Those that it may have."""
    if bond.GetBondType() == Chem.BondType.AROMATIC:
        return [1, 2]
    if bond.GetBondType() != Chem.BondType.UNSPECIFIED:
        return [int(bond.GetBondTypeAsDouble())]
    return [1] if 1 in (bond.GetBeginAtom().GetAtomicNum(), bond.GetEndAtom().GetAtomicNum()) else [1, 2, 3]


def _is_straight(atom: Chem.Atom, x: Array) -> bool:
    """Whether it is a carbon or nitrogen on a line with two neighbours."""
    near = [n.GetIdx() for n in atom.GetNeighbors()]
    return atom.GetAtomicNum() in (6, 7) and len(near) == 2 and geometry.angle(x, near[0], atom.GetIdx(), near[1]) > STRAIGHT


def _hydrogen_cost(atom: Chem.Atom, x: Array, pyrroles: Collection[int]) -> float:
    """What a hydrogen costs on an atom that the file has without, by the places of its neighbours. pyrroles: see PYRROLE."""
    z, near = atom.GetAtomicNum(), [x[n.GetIdx()] - x[atom.GetIdx()] for n in atom.GetNeighbors()]
    if z in (6, 7) and len(near) == 3:
        a, b, c = near
        return LIFTED * (HEIGHT - min(abs(a @ np.cross(b, c)) / np.linalg.norm(np.cross(b - a, c - a)), 2 * HEIGHT))
    if atom.GetIdx() in pyrroles:
        return WIDER * (106 - np.degrees(geometry.angle(np.array([near[0], np.zeros(3), near[1]]), 0, 1, 2)))
    short = [n.GetAtomicNum() for n in atom.GetNeighbors()] == [7] and np.linalg.norm(near[0]) < 1.34
    return OXIDE if z == 8 and short else HYDROGEN


def closed(mol: Chem.Mol, what: str, charge: int | None, unpaired: int | None, filled: Chem.Mol | None = None) -> Chem.Mol:
    """The molecule with bonds and charges that fit what was said of it. charge, unpaired: that, or None; filled: the same with
    hydrogens added, which is taken where the molecule fits no ion whose charges are on nitrogen, oxygen and sulphur. Where
    charge and unpaired were both said and nothing fits, it stays as it is. Errors: BadInput, which says which charge fits."""
    total = Chem.GetFormalCharge(mol) if charge is None else charge
    electrons = sum(a.GetAtomicNum() + a.GetTotalNumHs() for a in mol.GetAtoms()) - total
    is_odd = (electrons - (unpaired or 0)) % 2 == 1
    one = None if is_odd else assigned(mol, total, unpaired or 0)
    if one is not None:
        return one
    best = assigned(mol, None, unpaired or 0)
    atoms = opened(mol, best) if best else []
    if filled and (charge is not None or not atoms or any(mol.GetAtomWithIdx(n).GetAtomicNum() not in (7, 8, 16) for n in atoms)):
        return closed(filled, what, charge, unpaired)
    if None not in (charge, unpaired) or is_odd and (charge, unpaired) != (None, None):
        return mol  # reading.read() refuses a wrong number of electrons
    if best is None:
        full = next((a for a in mol.GetAtoms() if _order(a) > max(v for v, *_ in _states(a, False))), None)
        why = "no orders of its bonds fit its valences" if full is None else f"{named(mol, [full.GetIdx()])} has {_order(full)} bonds"
        raise BadInput(f"{what}: {why}: correct its atoms or bonds, or give both --charge and --uhf to compute it as it is")
    fits = Chem.GetFormalCharge(best)
    if charge is not None:
        raise BadInput(f"{what}: its bonds fit --charge {signed(fits)}, and not {signed(charge)}: correct it, or give --uhf "
                       f"{unpaired or 0} as well, with which it is computed all the same")
    partial = [float(a.GetProp(PARTIAL)) for a in mol.GetAtoms() if a.HasProp(PARTIAL)]
    if any(partial) and fits == round(sum(partial)):
        return best
    opposite = assigned(mol, 2 * total - fits, unpaired or 0)
    is_unclear = opposite and opposite.GetDoubleProp("cost") < best.GetDoubleProp("cost") + UNCLEAR
    fit = f"{signed(fits)} or {signed(2 * total - fits)}" if is_unclear else signed(fits)
    have, them = ("has an open valence", "it") if len(atoms) == 1 else ("have open valences", "them")
    raise BadInput(f"{what}: {named(mol, atoms)} {have}, and no charge is given: --charge {fit} closes {them}"
                   + ("; a radical needs --uhf 1" if is_odd else "")
                   + ("; without any hydrogens in the file, all are added" if filled else ""))


def hydrogens_set(mol: Chem.Mol, count: Callable[[Chem.Atom], int]) -> Chem.Mol:
    """The molecule with so many hydrogens as count(atom) says, and no more can be added."""
    out = Chem.Mol(mol)
    for atom, before in zip(out.GetAtoms(), mol.GetAtoms()):
        atom.SetNumExplicitHs(count(before))
        atom.SetNoImplicit(True)
    return out


def opened(mol: Chem.Mol, best: Chem.Mol) -> list[int]:
    """The atoms that have a charge only in `best`, without those whose neighbour makes up for it, if others are left."""
    before, after = ([a.GetFormalCharge() for a in one.GetAtoms()] for one in (mol, best))
    atoms = [a for a in best.GetAtoms() if after[a.GetIdx()] != before[a.GetIdx()]]
    alone = [a for a in atoms if all(after[a.GetIdx()] * after[n.GetIdx()] >= 0 for n in a.GetNeighbors())]
    return [a.GetIdx() for a in alone or atoms]


def named(mol: Chem.Mol, atoms: Iterable[int]) -> str:
    return listed([f"{mol.GetAtomWithIdx(n).GetSymbol()}{n + 1}" for n in atoms])
