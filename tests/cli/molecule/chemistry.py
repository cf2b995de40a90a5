"""chemistry.py FOLDER: checks of FOLDER's preparation that need no grid: wave numbers, names of bonds and of paths."""

import sys

sys.path.insert(0, sys.argv[1])
import preparation  # noqa: F401  before numpy
import numpy as np
from command import reading, rotors
from preparation import geometry, naming, optimise, torsions, xtb
from preparation.xtb import BOHR, HARTREE


def minimum(smiles):
    """(molecule, surface, its minimum on principal axes), by GFN2-xTB."""
    one, _ = reading.read(None, smiles, print)
    tree = geometry.Tree(one.neighbours, one.numbers)
    surface = xtb.Surface(one.numbers, one.positions / BOHR, "gfn2", one.charge, tree)
    x, _, _ = optimise.minimum(surface, one.relaxed(one.positions)[1] / BOHR)
    return one, surface, geometry.on_principal_axes(x, surface.masses)


# Planar molecules on their principal axes, where libxtb 6.5.1 leaves out terms of the gradient (grimme-lab/xtb#986).
# The Hessian is symmetric to 1e-4 hartree/bohr² before anything makes it so: central differences with steps of 0.005
# bohr are off by the fourth derivatives times 4e-6. The softest vibration is that of the energies alone: with them the
# third derivatives cancel, and the fourth are below a percent of 2 for steps of 0.03 bohr.
for smiles, wave in (("CN=[N+]=[N-]", 90), ("NC=O", 320), ("C#N", 777)):
    _, surface, x = minimum(smiles)
    rows = surface.differences(x)
    assert np.abs(rows - rows.T).max() < 1e-4, (smiles, np.abs(rows - rows.T).max())
    values, vectors = optimise.projected((rows + rows.T) / 2, x)
    step = 0.03 * vectors[:, 0].reshape(-1, 3)
    curvature = (surface.energy(x + step) + surface.energy(x - step) - 2 * surface.energy(x)) / 0.03**2
    assert abs(curvature / values[0] - 1) < 0.02, (smiles, curvature, values[0])
    first = optimise.wave_numbers(surface.hessian(x), x, surface.masses)[0]
    assert abs(first - wave) < 2, (smiles, first)  # by the program xtb, for the molecule turned by hand


# The chi of cystine end at the bridge, those of glutathione's glutamate at the cysteine, and no name comes twice.
def named(smiles):
    reading._check = lambda *_: None  # names need no shape
    one, _ = reading.read(None, smiles, print)
    found = {t.name: "-".join(rotors.label(one.numbers, a) for a in t.atoms) for t in rotors.find(one)[0]}
    assert len(found) == len(rotors.find(one)[0]), found
    return found


cystine = named("CC(=O)N[C@@H](CSSC[C@@H](C(=O)NC)NC(C)=O)C(=O)NC")
assert {name for name in cystine if name.startswith("chi")} == {"chi1_1", "chi1_2", "chi2_1", "chi2_2"}, cystine
assert cystine["chi2_2"] == "S7-S8-C9-C10" and "C6-S7-S8-C9" in cystine, cystine
glutathione = named("N[C@@H](CCC(=O)N[C@@H](CS)C(=O)NCC(=O)O)C(=O)O")
assert {n for n in glutathione if n.startswith("chi")} == {"chi1_1", "chi1_2", "chi1_3", "chi2_1", "chi2_2"}, glutathione

# A path has the name of the bond that turns. Bond a is a methyl group, whose name has no sign.
a, b, c = (torsions.Torsion(name, (0, 1, 2, 3), (3,), (1, -1), name == "a") for name in "abc")
deg = np.radians


def of(number, turns, height, job):
    return naming.Candidate(job, number, deg(np.array(turns)), height)


names, left = naming.names([a, b, c], {
    0: of(1, [59, 3, 0], 2.0, "b-plus"),  # the P-OH, whose barrier is the methyl group's
    1: of(1, [0, -40, 70], 3.0, "b-minus"),  # b turns, too
    2: of(2, [0, 5, 60], 9.0, "c-plus"),
    3: of(2, [1, 2, 3], 9.0, "c-minus"),
}, {"a", "b-plus", "b-minus", "c-plus", "c-minus"}, True)
assert names == {2: "c-plus", 1: "b-minus", 0: "a"}, names
assert left == [("c-minus", "no bond turns on the way to its barrier"),
                ("b-plus", "turns a instead, by 59 degrees against 3")], left
# Of two that turn a the lower is kept, unless a itself was driven. What nobody asked for is no path.
names, left = naming.names([a, b, c], {0: of(1, [59, 3, 0], 2.0, "b-plus"), 1: of(2, [58, 3, 0], 1.0, "c-plus"),
                                       2: of(2, [0, -60, 1], 1.0, "c-minus")}, {"a", "c-plus"}, True)
assert names == {1: "a"} and dict(left)["b-plus"] == "turns a instead, by 59 degrees against 3", (names, left)
assert dict(left)["c-minus"] == "turns b-minus instead, by 60 degrees against 1, which is not looked for", left
names, _ = naming.names([a, b], {0: of(1, [59, 3], 2.0, "b-plus"), 1: of(0, [60, 0], 5.0, "a")}, {"a"}, True)
assert names == {1: "a"}, names


# A rotor turns freely on a surface that is flat, and does not where the energy only climbs.
class Bond:
    """Hydrogen peroxide, held by springs, whose torsion has the energy slope times its angle."""
    tree, masses = None, np.ones(4)

    def __init__(self, x, slope):
        self.x, self.slope, self.start = x, slope, geometry.torsion(x, 0, 1, 2, 3)

    def __call__(self, x):
        pairs = [(0, 1), (1, 2), (2, 3), (0, 2), (1, 3)]
        energy, gradient = 0.0, np.zeros_like(x)
        for i, j in pairs:
            r, r0 = np.linalg.norm(x[i] - x[j]), np.linalg.norm(self.x[i] - self.x[j])
            energy += (r - r0) ** 2 / 2
            push = (r - r0) * (x[i] - x[j]) / r
            gradient[i] += push
            gradient[j] -= push
        turn = geometry.wrapped(geometry.torsion(x, 0, 1, 2, 3) - self.start) % (2 * np.pi)
        return energy + self.slope * turn, gradient + self.slope * geometry.torsion_gradient(x, 0, 1, 2, 3)

    def energy(self, x):
        return self(x)[0]

    def hessian(self, x):
        rows = [(self((x.ravel() + d).reshape(-1, 3))[1] - self((x.ravel() - d).reshape(-1, 3))[1]).ravel() / 2e-3
                for d in 1e-3 * np.eye(x.size)]
        return (np.array(rows) + np.array(rows).T) / 2


place = np.array([[1.8, 0, -0.6], [0, 0, 0], [0, 0, 2.8], [0.9, 1.5, 3.4]])
turn = torsions.Torsion("turn", (0, 1, 2, 3), (3,), (1,), True)
for slope, why in ((0.0, "turns freely, without a barrier of 0.1 kJ/mol"), (1 / HARTREE, "no barrier within half a turn")):
    bond = Bond(place, slope)
    try:
        torsions.scan(bond, place, bond.hessian(place), turn, 1)
        raise AssertionError("a barrier on a slope")
    except torsions.NoBarrier as no:
        assert str(no).startswith(why), no
