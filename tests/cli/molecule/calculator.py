"""Calculators of ASE for tests: calculator(charge, uhf) is the one that HAPGRID_TEST_CALCULATOR names.

gfnff, gfn2    libxtb, as hapgrid asks it by itself
mmff           RDKit's MMFF94 of ethanol
mmff32         the same beside an energy of 1e4 eV, with what a calculator in 32 bits makes of it

HAPGRID_TEST_BATCHES is a file that gets the number of shapes of each batch; without it there are no batches.
"""
import os

import numpy as np
from ase.calculators.calculator import Calculator, all_changes
from ase.units import Bohr, Hartree, kcal, mol
from hapgrid.apps.xtb import Xtb
from rdkit import Chem
from rdkit.Chem import AllChem


class Ours(Calculator):
    implemented_properties = ["energy", "forces"]

    def __init__(self, kind, charge, uhf):
        super().__init__()
        self.kind, self.charge, self.uhf, self.own = kind, charge, uhf, None

    def calculate(self, atoms=None, properties=("energy",), system_changes=all_changes):
        super().calculate(atoms, properties, system_changes)
        if self.own is None:
            self.own = self.mmff() if self.kind.startswith("mmff") else Xtb(
                atoms.numbers.tolist(), (atoms.positions / Bohr).ravel(), self.kind, self.charge, self.uhf)
        if self.kind.startswith("mmff"):
            flat = atoms.positions.ravel().tolist()
            energy = self.own.CalcEnergy(flat) * kcal / mol
            forces = -np.array(self.own.CalcGrad(flat)).reshape(-1, 3) * kcal / mol
        else:
            energy, gradient = self.own(atoms.positions.ravel() / Bohr)
            energy, forces = energy * Hartree, -np.array(gradient).reshape(-1, 3) * Hartree / Bohr
        if self.kind == "mmff32":
            energy, forces = float(np.float32(energy - 1e4)), forces.astype(np.float32)
        self.results = {"energy": energy, "forces": forces}

    def mmff(self):
        self.rd = Chem.AddHs(Chem.MolFromSmiles("CCO"))
        AllChem.EmbedMolecule(self.rd, randomSeed=1)
        return AllChem.MMFFGetMoleculeForceField(self.rd, AllChem.MMFFGetMoleculeProperties(self.rd))


def calculator(charge, uhf):
    return Ours(os.environ["HAPGRID_TEST_CALCULATOR"], charge, uhf)


if "HAPGRID_TEST_BATCHES" in os.environ:
    def batch(own, shapes):
        with open(os.environ["HAPGRID_TEST_BATCHES"], "a", encoding="utf-8") as file:
            print(len(shapes), file=file)
        own.calculate(shapes[0])
        found = []
        for atoms in shapes:
            own.calculate(atoms)
            found.append(own.results)
        return [one["energy"] for one in found], [one["forces"] for one in found]
