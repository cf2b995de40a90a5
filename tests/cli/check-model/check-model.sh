# check-model: a model that is fine, and one fault at a time in a model process that was, each found by
# the check that is meant for it.
source "$(dirname "$0")/../lib.sh"

expect 0 '~.*gradient +[0-9]+ forces +0  ok.*whole grid +about 1\.[0-9]+ levels a point \([0-9.]+ to [0-9.]+\), [0-9]+ conversions: about [0-9.]+ (ms|s) \([0-9.]+ m?s to [0-9.]+ m?s\) on one core.*' \
  '~check-model: fine: 9 checks(, but only [0-9] snaps? w.*)?' \
  -- check-model "$ball"
# The same walks, as numbers; what is counted does not depend on the run.
check-model "$ball" --format json --steps 300 -o first 2>/dev/null
check-model "$ball" --format json --steps 300 -o second 2>/dev/null
python3 - <<'END'
import json

first, second = (json.load(open(name)) for name in ("first", "second"))
assert first["verdict"] == "fine" and first["checks"] == second["checks"]
# (3·40 - 2)(3·20 - 2)² pairs of neighbours, less the points, for each level. The grid has 1.29 levels a point.
levels = first["grid"]["levels"]
low, high = first["grid"]["levels_range"]
assert 1 < levels < 1.6 and 1 <= low <= levels <= high < 2 and abs(first["grid"]["conversions"] - levels * (118 * 58 * 58 - 40 * 20 * 20)) <= 0.5
assert first["convert"]["calls"] == 300 and first["median_force_error"] < 1e-3
assert first["longest_step"] < first["d_max"]
END

cat >faulty.py <<'END'
import random
import hapgrid


class Faulty:
    """A spring between the HIP and a state that follows it; its faults are told by name."""

    def __init__(self, fault):
        self.fault = fault
        self.description = {"state_size": 1, "d_max": 2.0, "tolerance": 1e-9, "energy_unit": "J", "force_scale": 1}

    def known_states(self, x):
        return [[x[0] / 2]]

    def convert(self, s, x, d):
        branch = round(s[0] - x[0] / 2)  # 0, or 1 with the fault "halves": another state at rest
        if self.fault == "halves" and max(map(abs, d)) > 0.4:
            branch = 1 - branch
        s = [(x[0] + d[0]) / 2 + branch]
        if self.fault == "deterministic":
            s[0] += 1e-11 * random.random()
        if self.fault == "stays":
            s[0] += 1e-3 * (sum(map(abs, d)) > 0)
        if self.fault == "defined" and x[0] + d[0] > 1:
            raise ValueError("nothing is known beyond 1")
        return s

    def force(self, s, x):
        return [-x[0] / 2 if self.fault != "gradient" else x[0] / 2, 0.0, 0.0]

    def energy(self, s, x):
        return x[0]**2 / 4


if __name__ == "__main__":
    hapgrid.serve(Faulty)
END
for fault in none halves deterministic stays defined gradient; do
  cat >faulty.toml <<END
model = {process = ["python3", "faulty.py"], name = "faulty", parameters = {fault = "$fault"}}
grid = {origin = [-2, 0, 0], spacing = 0.5, counts = [9, 3, 3]}
END
  if [[ $fault == none ]]; then
    expect 0 '~.*' '~check-model: fine: [0-9]+ checks' -- check-model faulty.toml --allow-process --steps 60
  else
    expect 3 "~.*$fault: .*
whole grid +no estimate, because a check is broken" "~check-model: broken: $fault \([0-9]+ of [0-9]+\)" \
      -- check-model faulty.toml --allow-process --steps 60
  fi
done
cat >order.toml <<END
model = {plugin = "puppet", parameters = {component = 1, above = 1}}
grid = {origin = [0, 0, 0], spacing = 0.5, counts = [3, 3, 3]}
END
HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins expect 3 "~.*symmetric: .*1 and 0.*" "~check-model: broken: symmetric \([0-9]+ of 60\)" \
  -- check-model order.toml --steps 60
refuses 'check-model: faulty\.toml: the model is a process, .*only started with --allow-process' -- check-model faulty.toml
refuses 'check-model: gone\.toml: No such file or directory' -- check-model gone.toml
