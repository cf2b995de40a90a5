"""Checks the rule of hapgrid.apps.molecule.stiffness with Hessians of closed form."""

from hapgrid.apps.molecule import geometry, stiffness
import numpy as np

# A cross of four equal atoms. A torsion moves one of them, 3 Å from the centre, by 2 Å for a unit of t.
X = np.array([[3.0, 0, 0], [-3, 0, 0], [0, 3, 0], [0, -3, 0]])
MASSES = np.ones(4)
V = np.zeros((4, 3))
V[0] = [0, 0, 2]


def push(k, one, force):
    """How far the pushed atom goes with the torsion and with the molecule as a whole, along z: the minimum of
    ½ κ t² + ½ shift z² + ½ rotation φ² - force (2 t + z + 3 φ)."""
    kappa = 4 * k
    return 2 * (2 * force / kappa), force / one.shift + 3 * (3 * force / one.rotation)


def close(what, got, expected, tolerance=1e-9):
    assert abs(got - expected) <= tolerance * max(1, abs(expected)), f"{what}: {got}, not {expected}"


# The Hessian has k = 20 kJ/(mol Å²) for each coordinate: the anchors yield half as far as the torsion.
one = stiffness.rule(20 * np.eye(12), X, MASSES, [V], 1000)
close("shift", one.shift, 80)
close("rotation", one.rotation, 80 * 9)
close("morph", one.morph, 4.0)  # 2 Å of one of four atoms: 1 Å RMS, with 4 kJ/(mol Å) at the top
shape, rigid = push(20, one, 7.0)
close("share", rigid, shape / 2)

# A path that is flat at its foot gets what it lacks, and no anchor becomes stiffer than half the penalty.
flat = stiffness.rule(0.1 * np.eye(12), X, MASSES, [V], 1000)
close("morph of a flat path", flat.morph, 5.0 - 0.4)
close("least shift", flat.shift, 20)
stiff = stiffness.rule(200 * np.eye(12), X, MASSES, [V], 100)
close("largest shift", stiff.shift, 50)
close("largest rotation", stiff.rotation, 450)
assert stiff.softer(2) == stiffness.Stiffness(25, 225, stiff.morph)
assert stiff.softer(8) == stiff.softer(16) == stiffness.Stiffness(20, 100, stiff.morph)

# Of two torsions the one that asks for more decides, whatever the order; turned and shifted, the same.
softer = np.diag([20.0] * 3 + [10.0] * 9)
two = [stiffness.rule(softer, X, MASSES, order, 1000) for order in ([V, V[::-1]], [V[::-1], V])]
assert two == [one, one], two
close("rotation, softer", stiffness.rule(softer, X, MASSES, [V[::-1]], 1000).rotation, 40 * 9)
turn = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
moved = stiffness.rule(20 * np.eye(12), X @ turn + [5, -2, 1], MASSES, [V @ turn], 1000)
close("rotation, turned", moved.rotation, one.rotation)
assert stiffness.rule(np.eye(12), X, MASSES, [], 100) == stiffness.Stiffness()

# The tangent of hydrogen peroxide's torsion by 60 degrees in eleven nodes, from either end and from inside: the
# torsion grows by 60 degrees for a unit of t, the bonds stay, and the molecule neither shifts nor turns.
masses = np.array([1.008, 16.0, 16.0, 1.008])
nodes = []
for turn in np.radians(np.linspace(90, 150, 11)):
    nodes.append(np.array([[0.9, 0, -0.3], [0, 0, 0], [0, 0, 1.45], [0.9 * np.cos(turn), 0.9 * np.sin(turn), 1.75]]))
tree = geometry.Tree([[1], [0, 2], [1, 3], [2]], [1, 8, 8, 1])
for start in (0, 4, 10):
    v, x = stiffness.tangent(tree, nodes, start, masses), nodes[start]
    rate = (geometry.torsion_gradient(x, 0, 1, 2, 3) * v).sum()
    close("torsion", abs(rate), np.radians(60), 1e-4)
    for a, b in ((0, 1), (1, 2), (2, 3), (0, 2)):
        close("a distance's rate", (x[a] - x[b]) @ (v[a] - v[b]), 0, 1e-6)
    assert np.abs(masses @ v).max() < 1e-5, masses @ v
    momentum = (masses[:, None] * np.cross(geometry.centred(x, masses), v)).sum(axis=0)
    assert np.abs(momentum).max() < 1e-5, momentum
