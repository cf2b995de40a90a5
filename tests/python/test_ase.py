"""Atoms of ASE: relax() moves them, and hapgrid init --lang ase makes a model that is fine."""
import pathlib
import re

import hapgrid


def test_relax_moves_atoms_to_the_minimum(needs):
    ase = needs("ase", "python3-ase")
    from ase.calculators.lj import LennardJones
    from ase.constraints import FixAtoms

    # Two atoms of Lennard-Jones rest at 2^(1/6) σ. The force at rest has a stiffness of 57 ε/σ²; the cut at 10 σ shifts the
    # energy and not the place. Constraints hold.
    atoms = ase.Atoms("Ar2", [[0, 0, 0], [1.5, 0.2, 0]], calculator=LennardJones(sigma=1, epsilon=1, rc=10), constraint=FixAtoms([0]))
    places = hapgrid.relax(atoms, step=0.05, tolerance=1e-8)
    assert abs(atoms.get_distance(0, 1) - 2**(1 / 6)) < 1e-8 and (places == atoms.positions).all() and (places[0] == 0).all()


def test_the_template_is_fine(needs, run):
    needs("ase", "python3-ase")
    run("hapgrid", "init", "cluster", "--lang", "ase")
    assert len(pathlib.Path("cluster/cluster.py").read_text().splitlines()) <= 90
    said = run("check-model", "cluster/cluster.toml", "--allow-process", "--steps", "6")[1]
    assert re.fullmatch("check-model: fine: [0-9]+ checks\n", said)
