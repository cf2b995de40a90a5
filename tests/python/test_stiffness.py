"""The rule of hapgrid.apps.molecule.stiffness with Hessians of closed form."""
import numpy as np
import pytest
from hapgrid.apps.molecule import geometry, stiffness

# A cross of four equal atoms. A torsion moves one of them, 3 Å from the centre, by 2 Å for a unit of t.
X = np.array([[3.0, 0, 0], [-3, 0, 0], [0, 3, 0], [0, -3, 0]])
MASSES = np.ones(4)
V = np.zeros((4, 3))
V[0] = [0, 0, 2]


def rule(hessian, torsions=(V,), penalty=1000, turn=np.eye(3), shift=0):
    return stiffness.rule(hessian, X @ turn + shift, MASSES, [v @ turn for v in torsions], penalty)


def test_the_anchors_yield_half_as_far_as_the_torsion():
    one = rule(20 * np.eye(12))  # k = 20 kJ/(mol Å²) for each coordinate
    # 2 Å of one of four atoms: 1 Å RMS, with 4 kJ/(mol Å) at the top.
    assert (one.shift, one.rotation, one.morph) == (pytest.approx(80), pytest.approx(80 * 9), pytest.approx(4))
    # How far a force takes the pushed atom with the torsion and with the molecule as a whole, along z: the minimum of
    # ½ κ t² + ½ shift z² + ½ rotation φ² - force (2 t + z + 3 φ), where κ is 4 k.
    assert 7 / one.shift + 3 * 3 * 7 / one.rotation == pytest.approx(2 * 2 * 7 / (4 * 20) / 2)


def test_a_flat_path_gets_what_it_lacks_and_no_anchor_is_stiffer_than_half_the_penalty():
    flat, stiff = rule(0.1 * np.eye(12)), rule(200 * np.eye(12), penalty=100)
    assert (flat.morph, flat.shift) == (pytest.approx(5 - 0.4), pytest.approx(20))
    assert (stiff.shift, stiff.rotation) == (pytest.approx(50), pytest.approx(450))
    assert stiff.softer(2) == stiffness.Stiffness(25, 225, stiff.morph)
    assert stiff.softer(8) == stiff.softer(16) == stiffness.Stiffness(20, 100, stiff.morph)


def test_of_two_torsions_the_one_that_asks_for_more_decides_wherever_the_molecule_is():
    one, softer = rule(20 * np.eye(12)), np.diag([20.0] * 3 + [10.0] * 9)
    assert rule(softer, [V, V[::-1]]) == rule(softer, [V[::-1], V]) == one
    assert rule(softer, [V[::-1]]).rotation == pytest.approx(40 * 9)
    turn = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
    assert rule(20 * np.eye(12), turn=turn, shift=[5, -2, 1]).rotation == pytest.approx(one.rotation)
    assert rule(np.eye(12), [], 100) == stiffness.Stiffness()


@pytest.mark.parametrize("start", [0, 4, 10])
def test_the_tangent_of_a_torsion_keeps_bonds_and_turns_and_shifts_nothing(start):
    # Hydrogen peroxide's torsion by 60 degrees in eleven nodes, from either end and from inside.
    masses = np.array([1.008, 16.0, 16.0, 1.008])
    nodes = [np.array([[0.9, 0, -0.3], [0, 0, 0], [0, 0, 1.45], [0.9 * np.cos(turn), 0.9 * np.sin(turn), 1.75]])
             for turn in np.radians(np.linspace(90, 150, 11))]
    tree = geometry.Tree([[1], [0, 2], [1, 3], [2]], [1, 8, 8, 1])
    v, x = stiffness.tangent(tree, nodes, start, masses), nodes[start]
    assert abs((geometry.torsion_gradient(x, 0, 1, 2, 3) * v).sum()) == pytest.approx(np.radians(60), abs=1e-4)
    for a, b in ((0, 1), (1, 2), (2, 3), (0, 2)):
        assert (x[a] - x[b]) @ (v[a] - v[b]) == pytest.approx(0, abs=1e-6)
    assert masses @ v == pytest.approx(np.zeros(3), abs=1e-5)
    assert (masses[:, None] * np.cross(geometry.centred(x, masses), v)).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-5)
