# Atoms of ASE: relax() moves them, and hapgrid init --lang ase makes a model that is fine.
source "$(dirname "$0")/../lib.sh"
needs_python ase python3-ase
python=$(realpath "$HAPGRID_BIN/../python")

# relax() moves atoms to the minimum, which is known: two atoms of Lennard-Jones rest at 2^(1/6) σ. Constraints hold.
PYTHONPATH=$python /usr/bin/python3 - <<'PYTHON'
import ase
import hapgrid
from ase.calculators.lj import LennardJones
from ase.constraints import FixAtoms

atoms = ase.Atoms("Ar2", [[0, 0, 0], [1.5, 0.2, 0]], calculator=LennardJones(sigma=1, epsilon=1, rc=10), constraint=FixAtoms([0]))
places = hapgrid.relax(atoms, step=0.05, tolerance=1e-8)
# The force at rest has a stiffness of 57 ε/σ²; the cut at 10 σ shifts the energy and not the place.
assert abs(atoms.get_distance(0, 1) - 2**(1 / 6)) < 1e-8 and (places == atoms.positions).all() and (places[0] == 0).all()
PYTHON

hapgrid init cluster --lang ase >/dev/null
(($(wc -l <cluster/cluster.py) <= 90)) || fail 'the model is long'
expect 0 '~.*' '~check-model: fine: [0-9]+ checks' -- check-model cluster/cluster.toml --allow-process --steps 6
