"""Reading molecules and sampling their conformers, with Open Babel."""

import errno
import io
import itertools
import os
import re
import stat

import numpy as np

from . import geometry
from . import torsions as torsions_of

FORCE_FIELD = "MMFF94"
MOST_BYTES = 8 << 20  # of a file from outside
TRIES = 200  # combinations of torsions, at least: all of a dipeptide


class BadInput(Exception):
    """A molecule that cannot be read or built; the message names it."""


class Molecule:
    """numbers: elements; positions: angstrom; neighbours: of each atom; double: pairs (j < k) of
    the bonds that do not turn, which are double bonds and amides; charge: e; ob: Open Babel's
    molecule."""

    def __init__(self, ob, what):
        from openbabel import openbabel
        self.ob = ob
        atoms = [ob.GetAtom(n + 1) for n in range(ob.NumAtoms())]
        self.numbers = [a.GetAtomicNum() for a in atoms]
        self.positions = np.array([[a.GetX(), a.GetY(), a.GetZ()] for a in atoms])
        self.charge = ob.GetTotalCharge()
        if len(atoms) < 2 or 0 in self.numbers:
            raise BadInput(f"{what}: not a molecule of two atoms or more")
        self.neighbours = [[] for _ in atoms]
        self.double, self.amides = set(), []
        for bond in openbabel.OBMolBondIter(ob):
            j, k = sorted((bond.GetBeginAtomIdx() - 1, bond.GetEndAtomIdx() - 1))
            self.neighbours[j].append(k)
            self.neighbours[k].append(j)
            if bond.GetBondOrder() != 1 or bond.IsAmide():
                self.double.add((j, k))
            if bond.IsAmide() and not bond.IsInRing():
                self.amides.append((j, k))
        self.neighbours = [sorted(n) for n in self.neighbours]
        if len(_reached(self.neighbours)) < len(atoms):
            raise BadInput(f"{what}: more than one molecule")

    def formal_charges(self):
        from openbabel import openbabel
        return [atom.GetFormalCharge() for atom in openbabel.OBMolAtomIter(self.ob)]

    def amide_torsions(self):
        return [torsions_of.make(self.numbers, self.neighbours, None, None, j, k, None)
                for j, k in self.amides if min(len(self.neighbours[j]), len(self.neighbours[k])) > 1]

    def relaxed(self, positions, steps=500):
        """(energy, positions in angstrom) after some steps with the force field. Energies can only
        be compared with each other."""
        from openbabel import openbabel
        field = openbabel.OBForceField.FindForceField(FORCE_FIELD)
        ob = openbabel.OBMol(self.ob)
        for n, (x, y, z) in enumerate(positions):
            ob.GetAtom(n + 1).SetVector(float(x), float(y), float(z))
        if not field.Setup(ob):
            raise BadInput(f"{FORCE_FIELD} has no parameters for this molecule, so its conformers cannot be "
                           "searched: give a file with its shape")
        field.ConjugateGradients(steps, 1e-6)
        field.GetCoordinates(ob)
        atoms = [ob.GetAtom(n + 1) for n in range(ob.NumAtoms())]
        return field.Energy(False), np.array([[a.GetX(), a.GetY(), a.GetZ()] for a in atoms])


def _reached(neighbours):
    seen, stack = {0}, [0]
    while stack:
        for n in neighbours[stack.pop()]:
            if n not in seen:
                seen.add(n)
                stack.append(n)
    return seen


def open_babel():
    """The module, which prints nothing from here on."""
    try:
        from openbabel import openbabel
    except ImportError:
        raise BadInput(
            "Open Babel not found: install the Debian package python3-openbabel") from None
    openbabel.obErrorLog.SetOutputLevel(-1)
    return openbabel


def parsed(smiles):
    """Open Babel's molecule of SMILES, without hydrogens and coordinates."""
    openbabel = open_babel()
    conversion, ob = openbabel.OBConversion(), openbabel.OBMol()
    conversion.SetInFormat("smi")
    what = f"SMILES '{smiles}'"
    # Open Babel does not refuse an open bracket, a second word, or a ring that cannot be aromatic.
    if not re.fullmatch(r"\S+", smiles) or smiles.count("(") != smiles.count(")"):
        raise BadInput(f"{what}: not understood")
    log = openbabel.obErrorLog
    before = log.GetErrorMessageCount() + log.GetWarningMessageCount()
    if (not conversion.ReadString(ob, smiles) or ob.NumAtoms() == 0
            or log.GetErrorMessageCount() + log.GetWarningMessageCount() > before):
        raise BadInput(f"{what}: not understood")
    return ob


def repeatable(molecule):
    """Rebuilds a molecule, which Open Babel places in a random orientation, from its internal
    coordinates without their last digits: these are the same each time. (Where Open Babel joins
    rings to chains, a torsion is random, too; conformers() sets those that turn.)"""
    tree = geometry.Tree(molecule.neighbours, molecule.numbers)
    molecule.positions = tree.build(np.round(tree.read(molecule.positions), 6))
    return molecule


def read_bytes(path):
    """The content of a file from outside. A device or a pipe, which might never end, is refused."""
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOCTTY)
    try:
        status = os.fstat(descriptor)
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
        if not stat.S_ISREG(status.st_mode):
            raise BadInput(f"{path}: is no regular file")
        if status.st_size > MOST_BYTES:
            raise BadInput(f"{path}: {status.st_size} bytes, the limit is {MOST_BYTES}")
        with open(descriptor, "rb", closefd=False) as file:
            return file.read(MOST_BYTES)
    finally:
        os.close(descriptor)


def read_text(path):
    """The same as text; raises UnicodeDecodeError."""
    return io.StringIO(read_bytes(path).decode("utf-8"), newline=None).getvalue()


def from_file(path):
    openbabel = open_babel()
    conversion, ob = openbabel.OBConversion(), openbabel.OBMol()
    kind = os.path.splitext(path)[1][1:].lower()
    if kind not in ("xyz", "sdf", "mol"):
        raise BadInput(f"{path}: not an .xyz, .sdf or .mol file")
    text = read_text(path)
    conversion.SetInFormat(kind)
    if not conversion.ReadString(ob, text) or ob.NumAtoms() == 0:
        raise BadInput(f"{path}: not understood as {kind.upper()}")
    molecule = Molecule(ob, path)
    if np.ptp(molecule.positions, axis=0).max() < 0.1 or not np.isfinite(molecule.positions).all():
        raise BadInput(f"{path}: no coordinates")
    return molecule


def _clash(molecule, x):
    """Whether atoms three bonds apart or more are closer than 1.5 angstrom."""
    distance = np.linalg.norm(x[:, None] - x[None], axis=2)
    for a, near in enumerate(molecule.neighbours):
        distance[a, a] = 9
        for n in near:
            distance[a, n] = 9
            distance[a, molecule.neighbours[n]] = 9
    return distance.min() < 1.5


def conformers(molecule, torsions, number, seed):
    """Up to `number` shapes (angstrom), relaxed by the force field, lowest first, none twice.

    Each torsion is turned in steps of 60 degrees, and amides are cis and trans. All combinations
    are tried when they are few, otherwise random ones. Open Babel's Confab (DiverseConfGen) finds
    the same for the dipeptide, but it leaves hydroxyl groups as they are: its lowest ethylene glycol is
    1.6 kcal/mol above the one that this finds.
    """
    turns = [(t, np.radians(np.arange(-180, 180, 60))) for t in torsions
             if not t.rotor and tuple(sorted(t.atoms[1:3])) not in molecule.amides]
    turns += [(t, np.radians([180, 0])) for t in molecule.amide_torsions()]
    combinations = np.prod([len(angles) for _, angles in turns], dtype=float)
    tries = max(TRIES, 20 * number)
    if combinations <= tries:
        choices = itertools.product(*(angles for _, angles in turns))
    else:
        random = np.random.default_rng(seed)
        choices = ([random.choice(angles) for _, angles in turns] for _ in range(tries))
    _, first = molecule.relaxed(molecule.positions)
    found = []
    for choice in choices:
        x = first
        for (t, _), wanted in zip(turns, choice):
            turn = wanted - geometry.torsion(x, *t.atoms)
            x = geometry.rotated_about(x, *t.atoms[1:3], list(t.moved), turn)
        if _clash(molecule, x):
            continue
        energy, x = molecule.relaxed(x)
        print_ = geometry.fingerprint(molecule.numbers, x)
        if all(abs(energy - e) > 0.02 or np.abs(print_ - p).max() > 0.1 for e, p, _ in found):
            found.append((energy, print_, x))
    found.sort(key=lambda f: f[0])
    return [x for _, _, x in found[:number]] or [first]
