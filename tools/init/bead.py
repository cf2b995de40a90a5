"""A model in Python: a bead between two wells, pulled by a spring. Put your own in place of Bead.

The bead slides on a rail along x and rests in one of two wells. The HIP pulls it by a spring that weakens with the
HIP's distance from the rail. The state s is the bead's place, in mm. With the HIP at (x, y, z) and q = y^2 + z^2,

  E = b/4 (s^2 - a^2)^2 + k(q)/2 (x - s)^2      k(q) = k0 / (1 + q/R^2)
  dE/ds = b s (s^2 - a^2) - k(q) (x - s)

The bead rests where dE/ds = 0: in two places, one on each side, or in a single one.
help(hapgrid.serve) and help(hapgrid.relax) say what each function is for.
"""
import math

import hapgrid


class Bead:
    # The parameters of the definition, with their defaults.
    def __init__(self, wells=10.0, depth=5.0, stiffness=0.25, reach=10.0, strength=60.0, tolerance=1e-6):
        if min(wells, depth, stiffness, reach, strength, tolerance) <= 0:
            raise ValueError("the parameters must be positive")
        self.wells, self.stiffness, self.reach, self.strength = wells, stiffness, reach, strength
        self.b = 4 * depth / wells**4
        self.description = {
            "state_size": 1, "d_max": reach, "tolerance": tolerance, "tolerance_unit": "mm",
            "length_unit": "mm", "energy_unit": "N mm", "force_scale": 1,
            "spheres": [{"radius": wells / 5, "colour": [0.9, 0.9, 0.3]},
                        {"radius": wells / 20, "colour": [0.4, 0.4, 0.9]},
                        {"radius": wells / 20, "colour": [0.4, 0.4, 0.9]}]}

    def spring(self, x):
        return self.stiffness / (1 + (x[1] * x[1] + x[2] * x[2]) / (self.reach * self.reach))

    def settle(self, place, x):
        """Downhill in energy from a place of the bead to the next well. Your equations go here."""
        k = self.spring(x)

        def energy_and_gradient(s):
            well, u = s[0] * s[0] - self.wells * self.wells, x[0] - s[0]
            return self.b / 4 * well * well + k / 2 * u * u, [self.b * s[0] * well - k * u]

        return hapgrid.relax(energy_and_gradient, [place], step=self.wells / 50, tolerance=1e-9)[0]

    def known_states(self, x):
        """What the search starts from, in the corners of the box: a state for each side, or a single one."""
        left, right = self.settle(-self.wells, x), self.settle(self.wells, x)
        return [[left], [right]] if left < 0 < right else [[left]]

    def convert(self, s, x, d):
        """C(s, x, d): the HIP walks from x to x + d in steps that are short against the reach of the spring."""
        place, steps = s[0], math.ceil(math.hypot(*d) / (self.reach / 16))
        for step in range(1, steps + 1):
            hip = [a + step / steps * b for a, b in zip(x, d)]
            place = self.settle(place, hip)
            if math.dist(hip, [place, 0, 0]) > self.strength:
                raise ValueError(f"the spring broke: it is longer than {self.strength:g} mm")
        return [place]

    # What the grid keeps with the state s, for the HIP at x, so that play does not need this program.
    def force(self, s, x):
        """-dE/dx, in newtons."""
        k, u = self.spring(x), x[0] - s[0]
        sideways = u * u * k * k / (self.stiffness * self.reach * self.reach)  # -k'(q) u^2
        return [-k * u, sideways * x[1], sideways * x[2]]

    def energy(self, s, x):
        well, u = s[0] * s[0] - self.wells * self.wells, x[0] - s[0]
        return self.b / 4 * well * well + self.spring(x) / 2 * u * u

    def shape(self, s, x):
        """The centres of the spheres: the bead and the two wells."""
        return [s[0], 0, 0, -self.wells, 0, 0, self.wells, 0, 0]


if __name__ == "__main__":
    hapgrid.serve(Bead)
