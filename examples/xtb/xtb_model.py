"""A molecule of xtb as a model process. A probe, the HIP, pushes atoms away; README.md has the
equations.
"""
import math

from hapgrid.apps.xtb import BOHR, HARTREE, Xtb

# Atomic number, van der Waals radius (Bondi) and covalent radius in angstrom, colour.
ELEMENTS = {"H": (1, 1.20, 0.31, [1.0, 1.0, 1.0]), "C": (6, 1.70, 0.76, [0.35, 0.35, 0.35]),
            "N": (7, 1.55, 0.71, [0.2, 0.3, 0.95]), "O": (8, 1.52, 0.66, [0.9, 0.1, 0.1]),
            "F": (9, 1.47, 0.57, [0.5, 0.85, 0.3]), "S": (16, 1.80, 1.05, [0.9, 0.8, 0.2])}
MAX_MOVE = 0.15  # angstrom: how far a step of a minimisation moves a coordinate at most
MAX_STEPS = 500


class ProbedMolecule:
    """State: x, y, z of all atoms in angstrom. Energies in kJ/mol."""

    def __init__(self, molecule, anchor, method="gfn2", charge=0, probe_radius=0.4,
                 probe_stiffness=60.0, contact_scale=0.7, force_scale=0.1, substep=0.5,
                 gradient=0.03, tolerance=0.02):
        for name, value in {"probe_radius": probe_radius, "probe_stiffness": probe_stiffness,
                            "contact_scale": contact_scale, "substep": substep,
                            "gradient": gradient}.items():
            if not value > 0:
                raise ValueError(f"parameter {name} is {value:g}, it must be above 0")
        symbols, start = read_xyz(molecule)
        if len(anchor) != len(symbols) or min(anchor) < 0:
            raise ValueError(f"parameter anchor must have {len(symbols)} numbers, none negative")
        numbers, radii, self.bonds, colours = zip(*(ELEMENTS[s] for s in symbols))
        self.reach = [probe_radius + contact_scale * r for r in radii]
        self.stiffness, self.substep, self.gradient = probe_stiffness, substep, gradient
        self.xtb = Xtb(numbers, [x / BOHR for x in start], method, charge)
        # The molecule first comes to rest without the anchor, which then holds it there.
        self.anchor, self.home, self.zero = [0.0] * len(start), start, 0.0
        far = [1e3, 1e3, 1e3]
        self.home, self.zero = self.relax(start, far, self.guess(start))
        self.anchor = [k for k in anchor for _ in range(3)]
        self.description = {
            "state_size": len(start), "d_max": 2.0, "tolerance": tolerance, "norm": "rms",
            "tolerance_unit": "angstrom", "length_unit": "angstrom", "energy_unit": "kJ/mol",
            "force_scale": force_scale, "hip_radius": probe_radius,
            "spheres": [{"radius": contact_scale * r, "colour": c, "label": s}
                        for s, r, c in zip(symbols, radii, colours)]}
        self.force_scale = force_scale

    def known_states(self, x):
        return [] if self.touches(self.home, x) else [self.home]

    def convert(self, s, x, d):
        substeps = max(1, math.ceil(math.hypot(*d) / self.substep))
        free = False  # s is a minimum without contact, so it is one wherever there is none
        energy, hessian = None, self.guess(s)
        for k in range(1, substeps + 1):
            hip = [a + b * (k / substeps) for a, b in zip(x, d)]
            if not free or self.touches(s, hip):
                s, energy = self.relax(s, hip, hessian)
                free = not self.touches(s, hip)
        return {"s": s, "energy": energy}

    def energy(self, s, x):
        return self.total(s, x)[0]

    def shape(self, s, x):
        return s

    def force(self, s, x):
        force = [0.0, 0.0, 0.0]
        for _, unit, depth in self.contacts(s, x):
            force = [f - self.force_scale * self.stiffness * depth * u for f, u in zip(force, unit)]
        return force

    def contacts(self, s, x):
        """For each atom that is touched: the index of its x, unit vector from the probe, depth."""
        for i, reach in enumerate(self.reach):
            u = [a - b for a, b in zip(s[3 * i:3 * i + 3], x)]
            distance = math.hypot(*u)
            if distance < reach:  # an atom in the probe's very centre is not pushed
                yield 3 * i, [a / distance if distance else 0.0 for a in u], reach - distance

    def touches(self, s, x):
        return any(True for _ in self.contacts(s, x))

    def surroundings(self, s, x):
        """Of anchor and probe: energy, gradient, Hessian, and its part that is never negative."""
        energy, slope, n = 0.0, [k * (a - b) for k, a, b in zip(self.anchor, s, self.home)], len(s)
        hessian = [[self.anchor[i] if i == j else 0.0 for j in range(n)] for i in range(n)]
        safe = [row[:] for row in hessian]
        energy += sum(g * (a - b) for g, a, b in zip(slope, s, self.home)) / 2
        for i, unit, depth in self.contacts(s, x):
            energy += self.stiffness / 2 * depth**2
            aside = self.stiffness * depth / max(self.reach[i // 3] - depth, 0.1)
            for a in range(3):
                slope[i + a] -= self.stiffness * depth * unit[a]
                hessian[i + a][i + a] -= aside
                for b in range(3):
                    hessian[i + a][i + b] += (self.stiffness + aside) * unit[a] * unit[b]
                    safe[i + a][i + b] += self.stiffness * unit[a] * unit[b]
        return energy, slope, hessian, safe

    def total(self, s, x):
        """The whole energy, the gradient of the molecule's own energy, and surroundings()."""
        energy, gradient = self.xtb([a / BOHR for a in s])
        around = self.surroundings(s, x)
        inner = [g * (HARTREE / BOHR) for g in gradient]
        return energy * HARTREE - self.zero + around[0], inner, around

    def relax(self, s, x, hessian):
        """The minimum that lies downhill of s, and its energy, by quasi-Newton steps that are short.
        hessian is an estimate for xtb alone, which BFGS improves on the way; the rest is exact."""
        energy, inner, around = self.total(s, x)
        for _ in range(MAX_STEPS):
            slope = add(inner, around[1])
            if max(map(abs, slope)) < self.gradient:
                return s, energy
            down = [-g for g in slope]
            step = solve(map(add, hessian, around[2]), down)
            if step is None:  # the quadratic model has no minimum
                step = solve(map(add, hessian, around[3]), down)
            if step is None:  # rounding has spoiled the estimate
                hessian[:] = self.guess(s)
                step = solve(map(add, hessian, around[3]), down)
            longest = max(map(abs, step))
            if longest > MAX_MOVE:
                step = [a * (MAX_MOVE / longest) for a in step]
            downhill = dot(step, slope)
            for _ in range(20):
                trial = add(s, step)
                trial_energy, trial_inner, trial_around = self.total(trial, x)
                # Energies are some 1e4 kJ/mol, and their last digits are noise.
                if trial_energy <= energy + 1e-4 * downhill + 1e-7:
                    break
                step, downhill = [a / 3 for a in step], downhill / 3
            else:
                raise ArithmeticError(f"no step downhill at ({x[0]:g}, {x[1]:g}, {x[2]:g})")
            update(hessian, step, [a - b for a, b in zip(trial_inner, inner)])
            s, energy, inner, around = trial, trial_energy, trial_inner, trial_around
        raise ArithmeticError(f"{max(map(abs, slope)):g} kJ/mol/angstrom are left after "
                              f"{MAX_STEPS} steps")

    def guess(self, s):
        """A first Hessian for xtb: springs between all pairs of atoms, softer with distance. Source:
        Lindh et al., Chem. Phys. Lett. 241 (1995) 423. Deviation: pairs instead of angles."""
        n = len(s)
        hessian = [[1.0 if i == j else 0.0 for j in range(n)] for i in range(n)]
        for i in range(0, n, 3):
            for j in range(0, i, 3):
                u = [a - b for a, b in zip(s[i:i + 3], s[j:j + 3])]
                square = dot(u, u)
                bond = self.bonds[i // 3] + self.bonds[j // 3]
                k = 2000.0 * min(1.0, math.exp(0.33 * (bond**2 - square))) / square
                for a in range(3):
                    for b in range(3):
                        c = k * u[a] * u[b]
                        hessian[i + a][i + b] += c
                        hessian[j + a][j + b] += c
                        hessian[i + a][j + b] -= c
                        hessian[j + a][i + b] -= c
        return hessian


def read_xyz(text):
    """Symbols and positions of an XYZ file."""
    lines = text.splitlines()
    try:
        rows = [line.split() for line in lines[2:2 + int(lines[0])]]
        positions = [float(a) for row in rows for a in (row[1], row[2], row[3])]
    except (IndexError, ValueError):
        raise ValueError("molecule is no XYZ file") from None
    for row in rows:
        if row[0] not in ELEMENTS:
            raise ValueError(f"element {row[0]} is none of {', '.join(ELEMENTS)}")
    return [row[0] for row in rows], positions


def add(a, b):
    return [p + q for p, q in zip(a, b)]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def update(hessian, step, change):
    """BFGS, only where the curvature is positive, so that the matrix stays positive definite."""
    image = [dot(row, step) for row in hessian]
    curvature, along = dot(step, image), dot(step, change)
    if along < 0.02 * curvature:
        return
    for i, row in enumerate(hessian):
        p, q = change[i] / along, image[i] / curvature
        hessian[i] = [h + p * c - q * m for h, c, m in zip(row, change, image)]


def solve(matrix, right):
    """matrix^-1 right, by Cholesky's method; None when the matrix is not positive definite."""
    lower, y = [], []
    for i, row in enumerate(matrix):
        new = []
        for j in range(i):
            new.append((row[j] - dot(new, lower[j])) / lower[j][j])
        y.append(right[i] - dot(new, y))
        pivot = row[i] - dot(new, new)
        if not pivot > 0:
            return None
        new.append(math.sqrt(pivot))
        y[i] /= new[i]
        lower.append(new)
    for i in reversed(range(len(y))):
        y[i] = (y[i] - sum(lower[k][i] * y[k] for k in range(i + 1, len(y)))) / lower[i][i]
    return y


if __name__ == "__main__":
    import os

    import hapgrid

    def quiet(**parameters):
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # of what xtb writes there
        return ProbedMolecule(**parameters)

    hapgrid.serve(quiet)
