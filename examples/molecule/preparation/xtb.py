"""Energies, gradients and Hessians of xtb, through its C library.

The alternative, one run of the xtb program a point, costs more for starting than for computing: a
path takes thousands of points of a few milliseconds each.

Units here and in the other modules: bohr, hartree, and atomic mass units in mass-weighted
coordinates. Positions are arrays (atoms, 3). Files and messages are in angstrom and kJ/mol.
"""

import ctypes
import os
import tempfile

import numpy as np

BOHR = 0.529177210903  # angstrom
HARTREE = 2625.4996394799  # kJ/mol
# sqrt(hartree / (bohr^2 amu)) as a wave number, cm^-1
WAVE_NUMBER = 5140.487144

METHODS = ("gfn2", "gfnff")
SYMBOLS = (
    "X H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga Ge As Se "
    "Br Kr Rb Sr Y Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe").split()
# Standard atomic weights, amu. What is not here is refused: a wrong mass would give wrong wave
# numbers without a word.
MASSES = {1: 1.00794, 3: 6.941, 5: 10.811, 6: 12.0107, 7: 14.0067, 8: 15.9994, 9: 18.9984,
          11: 22.98977, 12: 24.305, 14: 28.0855, 15: 30.97376, 16: 32.065, 17: 35.453, 19: 39.0983,
          20: 40.078, 30: 65.38, 34: 78.96, 35: 79.904, 53: 126.90447}


class XtbError(Exception):
    """xtb is missing or did not compute a point."""


_library = None


def _load():
    global _library  # the one handle of a shared library; loading it twice gives the same
    if _library is None:
        try:
            _library = ctypes.CDLL("libxtb.so.6")
        except OSError:
            raise XtbError("libxtb.so.6 not found: install the Debian package libxtb6") from None
        for name in ("newEnvironment", "newMolecule", "newCalculator", "newResults"):
            getattr(_library, "xtb_" + name).restype = ctypes.c_void_p
    return _library


def _array(values, kind=ctypes.c_double):
    return (kind * len(values))(*values)


class Surface:
    """The potential energy of one molecule.

    positions: where the force field GFN-FF reads off its bonds. All later points of a molecule are
    computed with these bonds, or the energy would jump where two atoms come close.
    tree: internal coordinates along which searches step, see geometry.Tree.
    """

    # Steps of a search between exact Hessians: what is cheap is asked often.
    renewal = property(lambda self: {"gfn2": 12, "gfnff": 3}[self.method])

    def __init__(self, numbers, positions, method="gfn2", charge=0, tree=None):
        self.numbers = [int(z) for z in numbers]
        self.method = method
        self.charge = charge
        self.tree = tree
        self.calls = 0
        missing = sorted({SYMBOLS[z] for z in self.numbers if z not in MASSES})
        if missing:
            raise XtbError("no mass is known for element " + missing[0])
        self.masses = np.array([MASSES[z] for z in self.numbers])
        self._xtb = _load()
        self._environment = ctypes.c_void_p(self._xtb.xtb_newEnvironment())
        self._xtb.xtb_setVerbosity(self._environment, 0)
        self._molecule = self._new_molecule(np.asarray(positions, float))
        self._calculator = ctypes.c_void_p(self._xtb.xtb_newCalculator())
        self._results = ctypes.c_void_p(self._xtb.xtb_newResults())
        self._load_method()

    def _new_molecule(self, positions):
        molecule = self._xtb.xtb_newMolecule(
            self._environment, ctypes.byref(ctypes.c_int(len(self.numbers))),
            _array(self.numbers, ctypes.c_int), _array(positions.ravel()),
            ctypes.byref(ctypes.c_double(self.charge)), ctypes.byref(ctypes.c_int(0)), None, None)
        self._check("molecule")
        return ctypes.c_void_p(molecule)

    def _load_method(self):
        load = {"gfn2": self._xtb.xtb_loadGFN2xTB, "gfnff": self._xtb.xtb_loadGFNFF}[self.method]
        # GFN-FF leaves its topology in the current directory and would read an old one from there.
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as directory:
            os.chdir(directory)
            try:
                load(self._environment, self._molecule, self._calculator, None)
                self._check(self.method)
                # Soft modes need exact gradients: the default would leave 1e-4 kJ/mol of noise.
                self._xtb.xtb_setAccuracy(self._environment, self._calculator,
                                          ctypes.c_double(0.01))
                self._check(self.method)
            finally:
                os.chdir(here)

    def _check(self, what):
        if self._xtb.xtb_checkEnvironment(self._environment):
            size = 4096
            text = ctypes.create_string_buffer(size)
            self._xtb.xtb_getError(self._environment, text, ctypes.byref(ctypes.c_int(size)))
            words = " ".join(text.value.decode(errors="replace").split())
            raise XtbError(f"xtb: {what}: {words or 'failed'}")

    def __call__(self, positions):
        """(energy, gradient (atoms, 3)) in hartree and bohr."""
        positions = np.asarray(positions, float)
        if not np.isfinite(positions).all():
            raise XtbError("xtb: a position is not finite")
        self._xtb.xtb_updateMolecule(self._environment, self._molecule,
                                     _array(positions.ravel()), None)
        self._check("positions")
        self._xtb.xtb_singlepoint(self._environment, self._molecule, self._calculator,
                                  self._results)
        self._check("energy")
        energy = ctypes.c_double()
        gradient = (ctypes.c_double * positions.size)()
        self._xtb.xtb_getEnergy(self._environment, self._results, ctypes.byref(energy))
        self._xtb.xtb_getGradient(self._environment, self._results, gradient)
        self._check("gradient")
        self.calls += 1
        return energy.value, np.array(gradient).reshape(-1, 3)

    def energy(self, positions):
        return self(positions)[0]

    def hessian(self, positions, step=0.005):
        """Second derivatives (3 atoms, 3 atoms) by central differences of the gradient."""
        flat = np.asarray(positions, float).ravel()
        rows = []
        for k in range(flat.size):
            shift = np.zeros_like(flat)
            shift[k] = step
            ahead = self((flat + shift).reshape(-1, 3))[1]
            behind = self((flat - shift).reshape(-1, 3))[1]
            rows.append((ahead - behind).ravel() / (2 * step))
        hessian = np.array(rows)
        return (hessian + hessian.T) / 2
