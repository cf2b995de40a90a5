# A truss that SciPy's BFGS relaxes: it leaps over the barrier, at places that depend on the steps of the HIP, and
# check-model says so. With relax() it snaps at the limit point of the closed form, whatever the steps.
source "$(dirname "$0")/../lib.sh"
/usr/bin/python3 -c 'import scipy' 2>/dev/null || { missing 'python3-scipy'; exit 77; }

cat >truss.py <<'PYTHON'
import math
import hapgrid
import numpy as np
from scipy.optimize import minimize


class Truss:
    """Two bars from (-1, 0) and (1, 0) to an apex at height 0.5, which a spring ties to the HIP. The state is the apex."""
    bars, tie, height = 50.0, 2.0, 0.5
    rest = math.hypot(1, height)
    description = {"state_size": 2, "d_max": 3.0, "tolerance": 1e-4, "force_scale": 1}

    def __init__(self, minimiser, substep=0.7):
        self.minimiser, self.substep = minimiser, substep

    def energy_and_gradient(self, s, x):
        pull = np.array([s[0] - x[0], s[1] - x[2]])
        energy, gradient = self.tie / 2 * (pull @ pull + x[1]**2), self.tie * pull
        for end in (-1, 1):
            bar = np.array([s[0] - end, s[1]])
            length = np.linalg.norm(bar)
            energy += self.bars / (2 * self.rest) * (length - self.rest)**2
            gradient = gradient + self.bars / self.rest * (length - self.rest) / length * bar
        return energy, gradient

    def convert(self, s, x, d):
        steps = max(1, math.ceil(math.hypot(*d) / self.substep))
        for k in range(1, steps + 1):
            there = np.array(x) + k / steps * np.array(d)
            function = lambda p: self.energy_and_gradient(p, there)
            if self.minimiser == "BFGS":
                s = minimize(function, s, jac=True, method="BFGS", options={"gtol": 1e-7}).x
            else:
                s = hapgrid.relax(function, np.array(s), step=0.05, tolerance=1e-7)
        return s

    def known_states(self, x):
        up, down = (self.convert([0.0, z], x, [0, 0, 0]) for z in (0.5, -0.5))
        return [up, down] if math.dist(up, down) > 0.01 else [up]

    def force(self, s, x):
        return [self.tie * (s[0] - x[0]), -self.tie * x[1], self.tie * (s[1] - x[2])]

    def energy(self, s, x):
        return self.energy_and_gradient(s, x)[0]


if __name__ == "__main__":
    hapgrid.serve(Truss)
PYTHON
PYTHONPATH=$(realpath "$HAPGRID_BIN/../python") /usr/bin/python3 - <<'PYTHON'
import math
from truss import Truss

# The force of the bars on the apex at height w is F(w) = 2 EA w (1/L0 - 1/L), L² = 1 + w². The apex snaps where
# F' + tie = 0: 1/L³ = 1/L0 + tie / (2 EA); the HIP is then at w + F(w) / tie.
w = math.sqrt((1 / (1 / Truss.rest + Truss.tie / (2 * Truss.bars)))**(2 / 3) - 1)
limit = w + 2 * Truss.bars * w * (1 / Truss.rest - 1 / math.hypot(1, w)) / Truss.tie


def snap(minimiser, substep):
    s, z = [0.0, Truss.height], Truss.height
    while s[1] > 0:
        s = Truss(minimiser, substep).convert(s, [0, 0, z], [0, 0, -substep])
        z -= substep
    return z


# The HIP looks every substep, and so the first place behind the limit is where it snaps.
for substep in 0.4, 0.2, 0.1, 0.05, 0.02:
    z = snap("relax", substep)
    assert limit - substep - 1e-3 < z < limit + 1e-3, (substep, z, limit)
leaps = [snap("BFGS", substep) for substep in (0.4, 0.3, 0.2)]
assert max(leaps) > limit + 0.1 and len({round(z, 2) for z in leaps}) > 1, (leaps, limit)
PYTHON
for minimiser in BFGS relax; do
  cat >truss.toml <<TOML
model = {process = ["/usr/bin/python3", "truss.py"], name = "truss", parameters = {minimiser = "$minimiser", substep = $([[ $minimiser == BFGS ]] && echo 0.7 || echo 0.05)}}
grid = {origin = [-0.35, 0, -1.4], spacing = 0.35, counts = [3, 2, 9]}
TOML
  any='(.|'$'\n'')*'
  if [[ $minimiser == BFGS ]]; then
    expect 3 "~${any}snaps: steps along which the model snaps, .*C leaps over barriers$any" '~check-model: broken: .*snaps .*' -- \
      check-model truss.toml --allow-process --steps 120 --seconds 60
  else
    expect 0 "~${any}snaps +[1-9][0-9]* steps +0  note$any" '~check-model: fine: .*' -- \
      check-model truss.toml --allow-process --steps 120 --seconds 60
  fi
done
