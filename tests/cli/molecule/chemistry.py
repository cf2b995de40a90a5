"""Checks of hapgrid.apps.molecule that need no grid: wave numbers, names of bonds and of paths."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import replace
from types import SimpleNamespace

from hapgrid.apps.molecule import geometry, optimise, reading, results, rotors, search, single_points, torsions, xtb
from hapgrid.apps.molecule.molecule import relaxed
from hapgrid.apps.molecule.results import Dropped, Path, Point
from hapgrid.apps.molecule.xtb import BOHR, HARTREE
from hapgrid.apps.common import programs
import numpy as np


def minimum(smiles):
    """(molecule, surface, its minimum on principal axes), by GFN2-xTB."""
    one = reading.read(None, smiles)
    tree = geometry.Tree(one.neighbours, one.numbers)
    surface = xtb.Surface(one.numbers, one.positions / BOHR, "gfn2", one.charge, tree)
    x = optimise.minimum(surface, relaxed(one.rd, one.positions, 500)[1] / BOHR).x
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
    one = reading.read(None, smiles)
    found = {t.name: "-".join(rotors.label(one.numbers, a) for a in t.atoms) for t in rotors.find(one)}
    assert len(found) == len(rotors.find(one)), found
    return found


assert [rotors.pdb_name(*one) for one in (("H", 8), ("C", 99), ("Cl", 98), ("Cl", 99))] == ["H9", "C100", "Cl99", "Cl00"]
cystine = named("CC(=O)N[C@@H](CSSC[C@@H](C(=O)NC)NC(C)=O)C(=O)NC")
assert {name for name in cystine if name.startswith("chi")} == {"chi1_1", "chi1_2", "chi2_1", "chi2_2"}, cystine
assert cystine["chi2_2"] == "S7-S8-C9-C10" and "C6-S7-S8-C9" in cystine, cystine
glutathione = named("N[C@@H](CCC(=O)N[C@@H](CS)C(=O)NCC(=O)O)C(=O)O")
assert {n for n in glutathione if n.startswith("chi")} == {"chi1_1", "chi1_2", "chi1_3", "chi2_1", "chi2_2"}, glutathione

# A path has the name of the bond that turns. Bond a is a methyl group, whose name has no sign.
a, b, c = (torsions.Torsion(name, (0, 1, 2, 3), (3,), (1, -1), name == "a") for name in "abc")
deg = np.radians


def of(number, turns, height):
    return rotors.Candidate(number, deg(np.array(turns)), height)


names, left = rotors.names([a, b, c], {
    "b-plus": of(1, [59, 3, 0], 2.0),  # the P-OH, whose barrier is the methyl group's
    "b-minus": of(1, [0, -40, 70], 3.0),  # b turns, too
    "c-plus": of(2, [0, 5, 60], 9.0),
    "c-minus": of(2, [1, 2, 3], 9.0),
}, {"a", "b-plus", "b-minus", "c-plus", "c-minus"}, True)
assert names == {"c-plus": "c-plus", "b-minus": "b-minus", "b-plus": "a"}, names
assert left == [("b-plus", "turns a instead, by 59 degrees against 3"),
                ("c-minus", "no bond turns on the way to its barrier")], left
# Of two that turn a the lower is kept, unless a itself was driven. What nobody asked for is no path.
names, left = rotors.names([a, b, c], {"b-plus": of(1, [59, 3, 0], 2.0), "c-plus": of(2, [58, 3, 0], 1.0),
                                       "c-minus": of(2, [0, -60, 1], 1.0)}, {"a", "c-plus"}, True)
assert names == {"c-plus": "a"} and dict(left)["b-plus"] == "turns a instead, by 59 degrees against 3", (names, left)
assert dict(left)["c-minus"] == "turns b-minus instead, by 60 degrees against 1, which is not looked for", left
names, _ = rotors.names([a, b], {"b-plus": of(1, [59, 3], 2.0), "a": of(0, [60, 0], 5.0)}, {"a"}, True)
assert names == {"a": "a"}, names


# Where a turns freely it does not matter how far it does on the way: the path is of b, which turns less.
chain = np.array([[0, 1, -0.5], [0, 0, 0], [0, 0, 1.5], [0, 1.4, 2], [0.5, 1.5, 3.5]])
a, b = (torsions.Torsion(name, atoms, (), (1, -1), False) for name, atoms in (("a", (0, 1, 2, 3)), ("b", (1, 2, 3, 4))))
turned = geometry.rotated_about(geometry.rotated_about(chain, 1, 2, [3, 4], deg(70)), 2, 3, [4], deg(20))
for free, name in ((set(), "a-plus"), ({"a"}, "b-plus"), ({"a", "b"}, "b-plus")):
    one = rotors.candidate([a, b], b, Path([chain, turned], [1.0]), free)
    names, _ = rotors.names([a, b], {"b-plus": one}, {"a-plus", "b-plus"}, True)
    assert names == {"b-plus": name}, (free, names)


# A saddle's near side is the conformation where that needs a methyl group, a, turned back; not where b has turned, too, or where
# it is no equal minimum.
methyl = replace(a, rotor=True, moved=(3, 4))
rest = SimpleNamespace(x=chain, torsions=[methyl, b], above=lambda energy: energy,
                       same=lambda x, y: geometry.rms(geometry.aligned(x, y, np.ones(5)), y) < 0.1)
for turn, other, energy, expected in ((70, 0, 0.05, -70), (70, 90, 0.05, None), (70, 0, 0.2, None), (0, 0, 0.0, 0)):
    near = geometry.rotated_about(methyl.turned(chain, deg(turn)), 2, 3, [4], deg(other))
    turns = search.Search.turns_back(rest, Point(near, energy, None, 0.0))
    if turns:
        (bond, angle), = turns
        assert bond is methyl and abs(np.degrees(angle) - expected) < 1e-9, (turn, turns)
    else:
        assert turns is None if expected is None else turns == [] and expected == 0, (turn, other, turns)


# A step leads to the stationary point of a quadratic surface: to the lowest one, or along a climbed mode to the highest.
# Where that is too far, no other step of this length leads lower.
curvatures, slopes = np.array([-0.5, 1.0, 3.0]), np.array([0.1, -0.2, 0.3])
assert np.allclose(optimise.step_within(curvatures, slopes, 0, 9.0), -slopes / curvatures)
assert np.allclose(optimise.step_within(-curvatures[:1], slopes[:1], None, 9.0), -0.2)
short = optimise.step_within(curvatures, slopes, None, 0.05)
others = np.random.default_rng(1).normal(size=(1000, 3))
others *= 0.05 / np.linalg.norm(others, axis=1)[:, None]
assert abs(np.linalg.norm(short) - 0.05) < 1e-9, short
assert short @ slopes + curvatures @ short**2 / 2 < (others @ slopes + others**2 @ curvatures / 2).min(), short


# A rotor turns freely on a surface that is flat, and does not where the energy only climbs.
class Bond:
    """Hydrogen peroxide, held by springs. rise(turn): the energy of its torsion from x on, and the slope of that."""
    masses, renewal, noise = np.ones(4), 3, (0.0, 0.0)

    def __init__(self, x, rise):
        self.x, self.rise, self.start = x, rise, geometry.torsion(x, 0, 1, 2, 3)

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
        rise, slope = self.rise(turn)
        return energy + rise, gradient + slope * geometry.torsion_gradient(x, 0, 1, 2, 3)

    def energy(self, x):
        return self(x)[0]

    def hessian(self, x):
        rows = [(self((x.ravel() + d).reshape(-1, 3))[1] - self((x.ravel() - d).reshape(-1, 3))[1]).ravel() / 2e-3
                for d in 1e-3 * np.eye(x.size)]
        return (np.array(rows) + np.array(rows).T) / 2


place = np.array([[1.8, 0, -0.6], [0, 0, 0], [0, 0, 2.8], [0.9, 1.5, 3.4]])
turn = torsions.Torsion("turn", (0, 1, 2, 3), (3,), (1,), True)
for slope, why in ((0.0, "turns freely, without a barrier of 0.1 kJ/mol"), (1 / HARTREE, "no barrier within half a turn")):
    bond = Bond(place, lambda turn, slope=slope: (slope * turn, slope))
    try:
        torsions.scan(bond, Point(place, bond.energy(place), bond.hessian(place), 0.0), turn, 1)
        raise AssertionError("a barrier on a slope")
    except optimise.NoPath as no:
        assert str(no).startswith(why), no


# On both sides of a barrier so low that its slope is hardly felt the way leads down, and not back over it.
low = Bond(place, lambda turn: (1e-4 * np.cos(2 * turn), -2e-4 * np.sin(2 * turn)))
for start in (-0.02, -0.01, 0.01, 0.02):
    found = optimise.minimum(low, geometry.rotated_about(place, 1, 2, [3], start), longest=0.1)
    turned = geometry.wrapped(geometry.torsion(found.x, 0, 1, 2, 3) - low.start)
    assert abs(turned - np.copysign(np.pi / 2, start)) < 0.05, (start, turned)

# Other energies: nodes a little below the conformation are left out, a path ends at its highest node, and a much lower node
# becomes the conformation, from which its path leads both ways.
class Given(single_points.SinglePoints):
    """Energies in kJ/mol by the torsion in whole degrees."""

    def __init__(self, energies):
        self.energies, self.method, self.words = energies, "given", ["given"]

    def energy(self, x):
        return self.energies[round(np.degrees(geometry.torsion(x, 0, 1, 2, 3)))] / HARTREE - 5


class Quiet:
    def each(self, _, compute, values, threads):
        return list(map(compute, values))


def energies_of(given):
    """[(name, rises in kJ/mol)] of two paths that turn hydrogen peroxide from 100 degrees on, and what is left out."""
    def shape(angle):
        return geometry.rotated_about(place, 1, 2, [3], deg(angle) - geometry.torsion(place, 0, 1, 2, 3))
    masses = np.array([1.0, 16, 16, 1])
    found = [Path([shape(100 + sign * 10 * k) for k in range(5)], [0.0] * 5, name=f"turn-{way}", nu1=-300.0,
                  far=Point(shape(100 + sign * 70), 0.0, None, 100.0)) for way, sign in (("plus", 1), ("minus", -1))]
    result = results.Result([1, 8, 8, 1], masses, "gfn2", [], shape(100), -3.0, 200.0, found)
    Given(given).put_into(result, 1, Quiet())
    assert result.method == "given//gfn2" and all(f.nodes[0] is result.x or geometry.rms(f.nodes[0], result.x) < 1e-6
                                                 for f in result.found)
    return [(f.name, [round((e - result.energy) * HARTREE, 6) for e in f.energies]) for f in result.found], result


base = {100: 1, 110: 0.5, 120: 4, 130: 9, 140: 8, 170: 2, 90: 3, 80: 5, 70: 7, 60: 10, 30: 2}
paths, result = energies_of(base)
assert paths == [("turn-plus", [0, 3, 8]), ("turn-minus", [0, 2, 4, 6, 9])], paths
assert result.found[0].nu1 is None and result.found[1].nu1 == -300 and result.nu1 == 200, result.found
paths, result = energies_of({**base, 110: -1, 120: -3, 140: 10})
assert paths == [("turn-plus", [0, 12, 13]), ("turn-minus", [0, 2, 4])], paths
assert result.nu1 is None and result.found[1].far is None and result.dropped == [], result

# What was kept of a step counts only in the form that the step gives it. Here are two atoms and, on a way, four nodes.
pair, bend = np.array([[0.0, 0, 0], [0.0, 0, 1.5]]), np.full((6, 6), 0.5)
low = Point(pair, -1.5, bend, 30.5)
for one in (low, Path([pair] * 4, [-1.5] * 4, 3, {1: "saddle", 3: "minimum"}, "the end"),
            Path([pair] * 2, [-1.5, -1.25], nu1=-20.5, near=low, far=low), Dropped("why")):
    kept = json.loads(json.dumps(results.plain(one)))
    again = results.restored([type(one)], kept, 2)
    assert type(again) is type(one) and results.plain(again) == kept, one
    assert not isinstance(one, Path) or again.kinds == one.kinds and again.minima() == [3] * one.goes_on, again

    def refused(value, atoms=2, types=(type(one),)):
        try:
            return results.restored(types, value, atoms) is None
        except (ValueError, TypeError):
            return True
    assert all(refused(other) for other in (None, [], "x", 7, {}, [kept], {**kept, "more": 1})), one
    assert isinstance(one, Dropped) or refused(kept, 3) and refused(kept, types=[Dropped]), one
    for name in kept:
        wrong = [{}, 10**400, float("nan"), [[1]], [[1], [1, 2]], ["x"], [[9, "saddle"]], [[0, "hill"]], {"why": "x"}]
        wrong += [] if name in ("why", "name") else ["x"]
        wrong += [] if isinstance(one, Path) and name in ("nu1", "near", "far") else [None]
        for value in wrong:
            assert refused({**kept, name: value}), (one, name, value)

# One that all processes get, as from timeout, ends them, also where one waits for work; and so does one that comes when
# processes are there, but not the threads that give them work.
WORKS = """
import time
from hapgrid.apps.common import programs
programs.catch_signals()
with programs.workers(2) as pool:
    print(flush=True)
    list(pool.imap(time.sleep, [0, 1000]))
"""
BEGINS = """
import os, signal, threading
from hapgrid.apps.common import programs
programs.catch_signals()
threading.Thread.start = lambda thread: os.kill(os.getpid(), signal.SIGTERM)
print(flush=True)
programs.workers(2)
"""
for asked in (WORKS, BEGINS):
    began = subprocess.Popen([sys.executable, "-c", asked], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                             start_new_session=True)
    began.stdout.readline()
    if asked is WORKS:
        time.sleep(0.5)  # for the one that sleeps for no time
        os.killpg(began.pid, signal.SIGTERM)
    try:
        began.wait(60)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(began.pid, signal.SIGKILL)

# A signal that comes while processes are forked is not lost.
programs.catch_signals()
os.register_at_fork(after_in_parent=lambda: os.kill(os.getpid(), signal.SIGTERM))
folder = SimpleNamespace(counted=lambda what, count: print)
asked = SimpleNamespace(start=SimpleNamespace(folder=folder, options=SimpleNamespace(threads=1)))
try:
    raise AssertionError(list(search.Search.each(asked, "asking", hasattr, ["start"])))
except programs.Stopped as by:
    assert by.number == signal.SIGTERM, by
