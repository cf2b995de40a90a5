# The time that check-model estimates is that of the search, within a factor of 3. Both are by the clock, which a busy
# machine makes longer, so the least of three counts.
source "$(dirname "$0")/../../lib.sh"
sanitized && skip "sanitizers change what is compared"
examples=$HAPGRID_SOURCE/examples

# compare NAME DEFINITION OPTION...
compare() {
  local name=$1
  shift
  for run in 1 2 3; do
    check-model "$@" --format json -o "$name.$run.json" 2>said || fail "$(cat said)"
    seed "$@" | expand --complete -j 1 --cost "$name.$run.cost" -o "$name.grid"
  done
  python3 - "$name" "$(stats "$name.grid" --get average_levels)" <<'PYTHON' || fail "$name"
import json
import sys
name, levels = sys.argv[1], float(sys.argv[2])
runs = [f"{name}.{run}" for run in (1, 2, 3)]
told = min((json.load(open(run + ".json"))["grid"] for run in runs), key=lambda grid: grid["cpu_seconds"])
searches = [[json.loads(line) for line in open(run + ".cost")] for run in runs]
spent = {key: min(sum(cost[key] for cost in costs) for costs in searches) for key in ("conversions", "wall_seconds")}
print(f"{name}: told {told['cpu_seconds']:.3g} s, spent {spent['wall_seconds']:.3g} s; levels {told['levels']:.3f}, {levels:.3f};"
      f" conversions {told['conversions']} {spent['conversions']}")
sys.exit(not 1 / 3 < told["cpu_seconds"] / spent["wall_seconds"] < 3)
PYTHON
}
# points DEFINITION N: options for a grid of N points a side in the same box.
points() {
  seed "$1" | stats --get box.spacing | awk -v n="$2" -v counts="$(seed "$1" | stats --get box.counts | tr -dc '0-9,' | cut -d, -f1)" \
    '{ printf "--set grid.spacing=%.17g --set grid.counts=[%d,%d,%d]", $1 * (counts - 1) / (n - 1), n, n, n }'
}
compare ball "$ball" --set grid.spacing=0.025 --set 'grid.counts=[80,40,40]'
compare spring "$examples/spring-c/spring-c.toml" --set grid.spacing=0.5
for name in butane alanine-dipeptide; do
  definition=$examples/molecule/$name/$name.toml
  # shellcheck disable=SC2046  # words
  compare "$name" "$definition" $(points "$definition" 20)
done
