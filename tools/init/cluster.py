"""A cluster of atoms that a probe pushes, by any calculator of ASE. Put your own atoms and calculator in place of Cu4.

The state s is the positions of all atoms. The HIP x is the centre of a soft ball, the probe, which pushes every atom p
that is nearer than its radius; weak springs hold the atoms near where they rest without it, at the places h. With the
calculator's energy V the energy is

  E(s, x) = V(s) + hold/2 sum |p - h|^2 + push/2 sum max(0, radius - |p - x|)^2

and the force on the HIP is -dE/dx. help(hapgrid.serve) and help(hapgrid.relax) say what each function is for.
"""
import math

import ase
import ase.calculators.emt
import hapgrid
import numpy as np


class Cluster:
    # The parameters of the definition, with their defaults.
    def __init__(self, radius=2.5, push=2.0, hold=0.5, substep=0.4, tolerance=0.02):
        self.radius, self.push, self.hold, self.substep = radius, push, hold, substep
        self.atoms = ase.Atoms("Cu4", [[0.9, 0.9, 0.9], [0.9, -0.9, -0.9], [-0.9, 0.9, -0.9], [-0.9, -0.9, 0.9]])
        self.atoms.calc = ase.calculators.emt.EMT()
        self.home = hapgrid.relax(self.atoms, tolerance=1e-4)
        self.description = {
            "state_size": self.home.size, "d_max": 4.0, "tolerance": tolerance, "tolerance_unit": "Å",
            "length_unit": "Å", "energy_unit": "eV", "force_scale": 1, "hip_radius": radius / 2,
            "spheres": [{"radius": 1.2, "colour": [0.8, 0.5, 0.2], "label": s} for s in self.atoms.get_chemical_symbols()]}

    def probe(self, s, x):
        """How deep the probe is in each atom, and the unit vectors from the HIP to the atoms."""
        away = np.reshape(s, (-1, 3)) - x
        distance = np.linalg.norm(away, axis=1) + 1e-12
        return np.maximum(0, self.radius - distance), away / distance[:, None]

    def energy_and_gradient(self, s, x):
        self.atoms.positions = np.reshape(s, (-1, 3))
        moved, (depth, away) = self.atoms.positions - self.home, self.probe(s, x)
        energy = self.atoms.get_potential_energy() + self.hold / 2 * (moved**2).sum() + self.push / 2 * (depth**2).sum()
        return energy, -self.atoms.get_forces() + self.hold * moved - self.push * depth[:, None] * away

    def known_states(self, x):
        """What the search starts from, in the corners of the box: the cluster that nothing touches."""
        return [self.home] if not self.probe(self.home, x)[0].any() else []

    def convert(self, s, x, d):
        """C(s, x, d): the HIP moves in small steps, and after each the atoms go downhill, without a leap over a barrier."""
        steps, s = math.ceil(math.hypot(*d) / self.substep), np.reshape(s, (-1, 3))
        for k in range(1, steps + 1):
            there = np.array(x) + k / steps * np.array(d)
            s = hapgrid.relax(lambda p: self.energy_and_gradient(p, there), s, step=0.1, tolerance=1e-4)
        return s

    # What the grid keeps with the state s, for the HIP at x, so that play does not need this program.
    def force(self, s, x):
        depth, away = self.probe(s, x)
        return -self.push * depth @ away

    def energy(self, s, x):
        return self.energy_and_gradient(s, x)[0]

    def shape(self, s, x):
        return s


if __name__ == "__main__":
    hapgrid.serve(Cluster)
