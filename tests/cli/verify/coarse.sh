# A force whose waves are shorter than two spacings: verify asks the model, which is right, and names the spacing that would
# do. A force that is another multiple of the slope is a fault on the same grid.
source "$(dirname "$0")/../lib.sh"

cat >waves.py <<'PYTHON'
import math
import hapgrid


class Waves:
    """A field without a state."""
    description = {"state_size": 1, "d_max": 10, "tolerance": 1e-6, "energy_unit": "J", "force_scale": 1, "length_unit": "m"}

    def __init__(self, factor=1.0):
        self.factor = factor

    def known_states(self, x):
        return [[0]]

    def convert(self, s, x, d):
        return [0]

    def energy(self, s, x):
        return -sum(math.cos(7.8 * a) for a in x) / 7.8

    def force(self, s, x):
        return [-self.factor * math.sin(7.8 * a) for a in x]


hapgrid.serve(Waves)
PYTHON
cat >waves.toml <<'TOML'
model = {process = ["/usr/bin/python3", "waves.py"], name = "waves"}
grid = {origin = [0.1, 0.2, 0.3], spacing = 0.5, counts = [7, 6, 5]}
TOML
seed waves.toml --allow-process | expand --complete --allow-process waves.toml -o waves.grid
words="the force is right, the grid is too coarse for the energy's gradient: h = 0.25 m would do"
expect 0 "~.*gradient +[0-9]+ forces +1  note.*" "~verify: fine: [0-9]+ checks, but $words" -- verify waves.grid --allow-process waves.toml
fine=(--set grid.spacing=0.25 --set 'grid.counts=[13,11,9]')
seed waves.toml --allow-process "${fine[@]}" | expand --complete --allow-process waves.toml -o fine.grid
expect 0 '~.*' '~verify: fine: [0-9]+ checks' -- verify fine.grid --allow-process waves.toml --recompute 50
seed waves.toml --allow-process --set model.parameters.factor=0.8 | expand --complete --allow-process waves.toml -o wrong.grid
expect 3 "~.*gradient: the energy's negative gradient is 1\.25 times the force: .*" '~verify: broken: gradient .*' -- \
  verify wrong.grid --allow-process waves.toml
