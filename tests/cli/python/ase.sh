# Atoms of ASE: hapgrid init --lang ase makes a grid, and a cluster that ASE's BFGS relaxes to fmax = 0.05 is less exact
# than a tolerance of 1e-3, which check-model says.
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

# As an owner makes it: the optimiser of ASE, and its usual fmax.
cat >cluster/loose.py <<'PYTHON'
import math
import hapgrid
import numpy as np
from ase import Atoms
from ase.optimize import BFGS
from cluster import Cluster


class Pushed(Atoms):
    """Atoms whose energy and forces are those with the probe at x."""

    def get_potential_energy(self, **_):
        return self.function(self.positions, self.x)[0]

    def get_forces(self, **_):
        return -self.function(self.positions, self.x)[1]


class Loose(Cluster):
    def convert(self, s, x, d):
        atoms = Pushed("Cu4", np.reshape(s, (-1, 3)))
        atoms.function = self.energy_and_gradient
        steps = math.ceil(math.hypot(*d) / self.substep)
        for k in range(1, steps + 1):
            atoms.x = np.array(x) + k / steps * np.array(d)
            BFGS(atoms, logfile=None).run(fmax=0.05)
        return atoms.positions


hapgrid.serve(Loose)
PYTHON
sed 's/"cluster.py"/"loose.py"/; s/^tolerance = 0.02/tolerance = 1e-3/' cluster/cluster.toml >cluster/loose.toml
# Which of the two rows says so first depends on the steps: a state in two halves is another one, or one in 64 pieces is.
any='(.|'$'\n'')*'
expect 3 "~$any(halves|snaps): [^:]*: C (is less exact than that|leaps over barriers that are still there, or is less exact)$any" \
  '~check-model: broken: .*(halves|snaps) .*' -- check-model cluster/loose.toml --allow-process --steps 12 --seconds 60
