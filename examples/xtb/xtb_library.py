"""Energies and gradients of xtb (GFN2-xTB, GFN-FF) through its C library and ctypes.

Positions are flat lists of 3 numbers an atom in angstrom, energies in kJ/mol. No call sees what was
computed before it: each starts from a fresh guess, so equal positions give equal bits.
"""
import ctypes
import os
import tempfile

BOHR = 0.529177210903  # angstrom
HARTREE = 2625.4996394799  # kJ/mol
METHODS = {"gfn2": "xtb_loadGFN2xTB", "gfnff": "xtb_loadGFNFF"}
# Of the SCF. The default of 1 leaves noise in the gradient that minimisation would feel.
ACCURACY = 0.01


class XtbError(ValueError):
    """xtb is missing, or did not compute a point."""


class Xtb:
    def __init__(self, numbers, positions, method, charge):
        """positions: where GFN-FF reads off its bonds, for good."""
        if method not in METHODS:
            raise XtbError(f"parameter method is {method}, it must be one of {', '.join(METHODS)}")
        # Sums over threads come in no fixed order. OpenMP reads this when the library is loaded.
        os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
        try:
            self.library = ctypes.CDLL("libxtb.so.6")
        except OSError:
            raise XtbError("libxtb.so.6 not found: install the Debian package libxtb6") from None
        self.size = len(positions)
        self.environment = self._new("Environment")
        self.library.xtb_setVerbosity(self.environment, 0)
        self.molecule = self._new(
            "Molecule", self.environment, ctypes.byref(ctypes.c_int(len(numbers))),
            (ctypes.c_int * len(numbers))(*numbers), self._bohr(positions),
            ctypes.byref(ctypes.c_double(charge)), ctypes.byref(ctypes.c_int(0)), None, None)
        self._check("molecule")
        self.calculator = self._new("Calculator")
        # GFN-FF leaves its topology in the current directory and would read an old one from there.
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as directory:
            os.chdir(directory)
            try:
                getattr(self.library, METHODS[method])(
                    self.environment, self.molecule, self.calculator, None)
            finally:
                os.chdir(here)
        self.library.xtb_setAccuracy(self.environment, self.calculator, ctypes.c_double(ACCURACY))
        self._check(method)

    def __call__(self, positions):
        """Energy in kJ/mol, and its gradient in kJ/mol/angstrom."""
        energy, gradient = ctypes.c_double(), (ctypes.c_double * self.size)()
        # New results: old ones hold a wave function from which the SCF would go on.
        results = self._new("Results")
        try:
            self.library.xtb_updateMolecule(
                self.environment, self.molecule, self._bohr(positions), None)
            self.library.xtb_singlepoint(
                self.environment, self.molecule, self.calculator, results)
            self._check("energy")
            self.library.xtb_getEnergy(self.environment, results, ctypes.byref(energy))
            self.library.xtb_getGradient(self.environment, results, gradient)
            self._check("gradient")
        finally:
            self.library.xtb_delResults(ctypes.byref(results))
        return energy.value * HARTREE, [g * (HARTREE / BOHR) for g in gradient]

    def _new(self, what, *arguments):
        create = getattr(self.library, "xtb_new" + what)
        create.restype = ctypes.c_void_p
        return ctypes.c_void_p(create(*arguments))

    def _bohr(self, positions):
        return (ctypes.c_double * self.size)(*(x / BOHR for x in positions))

    def _check(self, what):
        if self.library.xtb_checkEnvironment(self.environment):
            text = ctypes.create_string_buffer(4096)
            self.library.xtb_getError(
                self.environment, text, ctypes.byref(ctypes.c_int(len(text))))
            words = " ".join(text.value.decode(errors="replace").split())
            raise XtbError(f"xtb: {what}: {words or 'failed'}")
