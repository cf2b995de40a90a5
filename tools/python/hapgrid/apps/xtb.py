"""Energies and gradients of xtb (GFN2-xTB, GFN-FF) through its C library and ctypes.

Positions are flat: 3 numbers for each atom. Lengths are in bohr and energies in hartree.
hapgrid.apps.molecule and the model of examples/xtb use it.
"""
from __future__ import annotations

import ctypes
import os
import tempfile
from collections.abc import Sequence
from typing import Any

BOHR = 0.529177210903  # angstrom
HARTREE = 2625.4996394799  # kJ/mol
METHODS = {"gfn2": "xtb_loadGFN2xTB", "gfnff": "xtb_loadGFNFF"}
# The accuracy of the SCF. The default of 1 leaves a noise of 1e-4 kJ/mol, which minimisation and
# soft modes would feel.
ACCURACY = 0.01
# Directions in which an atom's surface is sampled where there is a solvent. With xtb's own 230 the energy depends on
# the orientation by 1e-5 hartree, and a minimum is not found to 3e-6 hartree/bohr.
SURFACE = 2030


def _rotation(w: float, x: float, y: float, z: float) -> list[list[float]]:
    """The rotation of a quaternion, as the rows of its matrix."""
    n = w * w + x * x + y * y + z * z
    rows = ((w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z))
    return [[value / n for value in row] for row in rows]


# libxtb 6.5.1 leaves out terms of the gradient of GFN2-xTB where two atoms have an equal coordinate
# (grimme-lab/xtb#986): a planar molecule on its principal axes is the worst case. So xtb computes
# each molecule turned by a rotation along which nobody places atoms. It is the same for all
# molecules, so equal positions give equal bits.
TURN = _rotation(5**0.5, 1, 2**0.5, 3**0.5)
BACK = [list(column) for column in zip(*TURN)]


def _turned(rotation: Sequence[Sequence[float]], flat: Any) -> list[float]:
    """Flat vectors, each multiplied by the rotation."""
    return [a * flat[k] + b * flat[k + 1] + c * flat[k + 2]
            for k in range(0, len(flat), 3) for a, b, c in rotation]


class XtbError(ValueError):
    """xtb is missing, or did not compute a point."""


def load() -> ctypes.CDLL:
    """The C library. Raises XtbError where there is none."""
    # Threads add up sums in no fixed order. OpenMP reads this when the library is loaded.
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    try:
        return ctypes.CDLL("libxtb.so.6")
    except OSError:
        raise XtbError("libxtb.so.6 not found: install the Debian package libxtb6") from None


class Xtb:
    """One molecule. positions: GFN-FF reads its bonds off these and keeps them. solvent: of GBSA, as xtb names it."""

    def __init__(self, numbers: Sequence[int], positions: Any, method: str, charge: int, unpaired: int = 0,
                 solvent: str | None = None) -> None:
        if method not in METHODS:
            raise XtbError(f"parameter method is {method}, it must be one of {', '.join(METHODS)}")
        self.library = load()
        self.size = len(positions)
        self.environment = self._new("Environment")
        self.library.xtb_setVerbosity(self.environment, 0)
        self.molecule = self._new(
            "Molecule", self.environment, ctypes.byref(ctypes.c_int(len(numbers))),
            (ctypes.c_int * len(numbers))(*numbers), self._turned(positions),
            ctypes.byref(ctypes.c_double(charge)), ctypes.byref(ctypes.c_int(unpaired)), None, None)
        self._check("molecule")
        self.calculator = self._new("Calculator")
        # GFN-FF leaves its topology in the current directory and would read an old one from there.
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as directory:
            os.chdir(directory)
            try:
                getattr(self.library, METHODS[method])(
                    self.environment, self.molecule, self.calculator, None)
                self._check(method)
                if solvent is not None:  # at 298.15 K
                    self.library.xtb_setSolvent(self.environment, self.calculator, solvent.encode(), None, None,
                                                ctypes.byref(ctypes.c_int(SURFACE)))
                    self._check(f"solvent {solvent} of {method}")
            finally:
                os.chdir(here)
        self.library.xtb_setAccuracy(self.environment, self.calculator, ctypes.c_double(ACCURACY))
        self._check(method)

    def new_results(self) -> ctypes.c_void_p:
        """Results hold a wave function, from which the next SCF starts."""
        return self._new("Results")

    def __call__(self, positions: Any, results: ctypes.c_void_p | None = None) -> tuple[float, list[float]]:
        """The energy and its gradient, flat. Without results the SCF starts from a fresh guess, so
        that equal positions give equal bits, whatever was computed before."""
        energy, gradient = ctypes.c_double(), (ctypes.c_double * self.size)()
        given, results = results, results or self.new_results()
        try:
            self.library.xtb_updateMolecule(
                self.environment, self.molecule, self._turned(positions), None)
            self._check("positions")
            self.library.xtb_singlepoint(
                self.environment, self.molecule, self.calculator, results)
            self._check("energy")
            self.library.xtb_getEnergy(self.environment, results, ctypes.byref(energy))
            self.library.xtb_getGradient(self.environment, results, gradient)
            self._check("gradient")
        finally:
            if given is None:
                self.library.xtb_delResults(ctypes.byref(results))
        return energy.value, _turned(BACK, gradient)

    def _new(self, what: str, *arguments: Any) -> ctypes.c_void_p:
        create = getattr(self.library, "xtb_new" + what)
        create.restype = ctypes.c_void_p
        return ctypes.c_void_p(create(*arguments))

    def _turned(self, positions: Any) -> Any:
        return (ctypes.c_double * self.size)(*_turned(TURN, positions))

    def _check(self, what: str) -> None:
        if self.library.xtb_checkEnvironment(self.environment):
            text = ctypes.create_string_buffer(4096)
            self.library.xtb_getError(
                self.environment, text, ctypes.byref(ctypes.c_int(len(text))))
            words = " ".join(text.value.decode(errors="replace").split())
            raise XtbError(f"xtb: {what}: {words or 'failed'}")
