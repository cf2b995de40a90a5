"""The molecule that is felt, and what the steps have in common."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.work import Work

from . import calculator, geometry, single_points, stereo
from .molecule import Molecule
from .torsions import Torsion
from .xtb import Potential, Surface


@dataclass
class Start:
    """The molecule that is felt, and what the steps have in common. options: of the command line; source: of the molecule, in
    words; given: paths of its own, or None; search: whether conformers are searched; method: of xtb; turning: bonds (torsions.Torsion);
    isomer: which no step may leave, told: the same in words."""
    options: Namespace
    folder: Work
    molecule: Molecule
    source: str
    search: bool
    method: str
    turning: list[Torsion]
    isomer: stereo.Isomer
    told: str
    given: dict[str, Any] | None = None  # of along.read()

    @property
    def words(self) -> str:
        return f"{self.method}-in-{self.options.solvent}" if self.options.solvent else self.method

    def surface(self, x: Array) -> Potential:
        """xtb's, or that of --calculator. x: the conformation, bohr."""
        if self.calculator is not None:
            return calculator.CalculatorSurface(self.molecule.numbers, x, self.calculator, self.tree)
        return Surface(self.molecule.numbers, x, self.method, self.molecule.charge, self.tree, self.molecule.unpaired,
                       self.options.solvent)

    @cached_property
    def tree(self) -> geometry.Tree:
        one = self.molecule
        return geometry.Tree(one.neighbours, one.numbers, geometry.straight(one.neighbours, one.positions))

    @cached_property
    def calculator(self) -> tuple[Any, calculator.Batch | None] | None:
        """A process makes its own: what one of them holds cannot be shared."""
        by = self.options.calculator
        return None if by is None else by.make(self.molecule.charge, self.molecule.unpaired)

    @cached_property
    def points(self) -> single_points.SinglePoints | None:
        """The SinglePoints of --single-points, or None."""
        command = self.options.single_points
        return None if command is None else single_points.SinglePoints(command, self.molecule, self.folder.cache)

    def turned_by(self, paths: Sequence[str]) -> list[Torsion]:
        return [t for t in self.turning if {t.name, *t.file_names()} & set(paths)]
