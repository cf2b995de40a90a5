"""Energies, gradients and Hessians of xtb, through its C library: starting the program takes longer than computing a point.

Units here and in the other modules: bohr, hartree, and atomic mass units in mass-weighted
coordinates. Positions are arrays (atoms, 3). Files and messages are in angstrom and kJ/mol.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.xtb import BOHR, HARTREE, Xtb, XtbError, load

from .elements import MASSES

if TYPE_CHECKING:
    from .geometry import Tree

__all__ = ["BOHR", "HARTREE", "Potential", "Surface", "WAVE_NUMBER", "XtbError", "load"]

# sqrt(hartree / (bohr^2 amu)) as a wave number, cm^-1
WAVE_NUMBER = 5140.487144


class Potential(ABC):
    """What all searches ask: energies, gradients and Hessians of one molecule's shapes.

    tree: internal coordinates, see geometry.Tree; renewal: steps of a search between exact Hessians; noise: of an energy,
    hartree, and of a component of the gradient, hartree/bohr.
    """
    tree: Any
    masses: Array
    renewal: int
    noise: tuple[float, float] = (0.0, 0.0)

    @abstractmethod
    def __call__(self, positions: Array) -> tuple[float, Array]:
        """(energy, gradient (atoms, 3)) in hartree and bohr."""

    @property
    def step(self) -> float:
        """Of differences, bohr."""
        return 0.005

    def many(self, shapes: Sequence[Array]) -> list[tuple[float, Array]]:
        """The same of several shapes, which a calculator may compute together."""
        return [self(x) for x in shapes]

    def energy(self, positions: Array) -> float:
        return self(positions)[0]

    def energies(self, shapes: Sequence[Array]) -> list[float]:
        return [energy for energy, _ in self.many(shapes)]

    def hessian(self, positions: Array) -> Array:
        rows = self.differences(positions)
        return (rows + rows.T) / 2

    def differences(self, positions: Array) -> Array:
        """The rows of the Hessian by central differences of the gradient. They are symmetric to 1e-4 hartree/bohr²:
        a gradient with which they are not is wrong."""
        flat = np.asarray(positions, float).ravel()
        step = self.step
        shifts = step * np.eye(flat.size)
        slopes = [slope.ravel() for _, slope in self.many([(flat + s).reshape(-1, 3) for s in [*shifts, *-shifts]])]
        return np.array([(ahead - back) / (2 * step) for ahead, back in zip(slopes[:flat.size], slopes[flat.size:])])


class Surface(Potential):
    """The potential energy of one molecule.

    positions: where the force field GFN-FF reads off its bonds. All later points of a molecule are
    computed with these bonds; otherwise the energy would jump where two atoms come close.
    tree: internal coordinates, see geometry.Tree. unpaired: electrons. solvent: around the
    molecule, or None.
    """

    def __init__(self, numbers: Sequence[int], positions: Array, method: str = "gfn2", charge: int = 0,
                 tree: Tree | None = None, unpaired: int = 0, solvent: str | None = None) -> None:
        numbers = [int(z) for z in numbers]
        self.tree: Any = tree
        # Steps of a search between exact Hessians: where these are cheap they are computed often.
        self.renewal = {"gfn2": 12, "gfnff": 3}[method]
        self.masses = np.array([MASSES[z] for z in numbers])
        self._xtb = Xtb(numbers, np.asarray(positions, float).ravel(), method, charge, unpaired, solvent)

    def __call__(self, positions: Array) -> tuple[float, Array]:
        positions = np.asarray(positions, float)
        if not np.isfinite(positions).all():
            raise XtbError("xtb: a position is not finite")
        energy, gradient = self._xtb(positions.ravel())  # from a fresh guess: the same bits in each process
        return energy, np.array(gradient).reshape(-1, 3)
