# check-model: a model that is fine, and what is refused. mistakes.sh has one fault at a time.
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

cat >order.toml <<END
model = {plugin = "puppet", parameters = {component = 1, above = 1}}
grid = {origin = [0, 0, 0], spacing = 0.5, counts = [3, 3, 3]}
END
HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins expect 3 "~.*symmetric: .*1 and 0.*" "~check-model: broken: symmetric \([0-9]+ of 60\)" \
  -- check-model order.toml --steps 60
sed 's/plugin = "puppet"/process = ["true"], name = "puppet"/' order.toml >process.toml
refuses 'check-model: process\.toml: the model is a process, .*only started with --allow-process' -- check-model process.toml
refuses 'check-model: gone\.toml: No such file or directory' -- check-model gone.toml
