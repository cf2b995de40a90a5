# verify --walks and --accuracy on real models: the error falls as interpolation's must, and the
# spacing that is told is enough.
source "$(dirname "$0")/../lib.sh"

# figure NAME FILE: of the row `accurate` in a report as JSON.
figure() {
  python3 - "$1" "$2" <<'PY'
import json, sys
row = next(c for c in json.load(open(sys.argv[2]))["checks"] if c["name"] == "accurate")
print(next(f["value"] for f in row["figures"] if f["name"] == sys.argv[1]))
PY
}
# within LOW VALUE HIGH
within() { awk -v a="$1" -v x="$2" -v b="$3" 'BEGIN { exit !(a <= x && x <= b) }' || fail "$2 is not in [$1, $3]"; }
# accuracy MODEL SPACING COUNTS OPTION...: the report on a grid of the model, in `report`.
accuracy() {
  seed "$1" "${set[@]}" --set "grid.spacing=$2" --set "grid.counts=$3" | expand --complete -j 2 -o grid
  shift 3
  verify grid --recompute none -j 2 --format json "$@" >report 2>err || [[ $? == [34] ]]
}

# Half the spacing, a quarter of the median: kinks and ends of branches are in few places. 300 walks
# leave some per cent; and the ball's radius of 0.1 must be resolved first.
spring=$HAPGRID_SOURCE/examples/spring-c/spring-c.toml
# Of the ball's box the middle; the force not cut: the other checks are quick then.
middle=(--set 'grid.origin=[-0.475,-0.3,-0.3]' --set model.parameters.max_force=1e6)
halved() {
  accuracy "$1" "$2" "$3" --walks 300
  local coarse
  coarse=$(figure 'state median' report)
  accuracy "$1" "$4" "$5" --walks 300
  within 3.3 "$(awk -v a="$coarse" -v b="$(figure 'state median' report)" 'BEGIN { print a / b }')" 4.7
  within 1.8 "$(figure 'median order' report)" 2.2
}
if ! sanitized; then
  set=("${middle[@]}")
  halved "$ball" 0.04 '[24,16,16]' 0.02 '[47,31,31]'
fi
set=()
halved "$spring" 2 '[21,16,16]' 1 '[41,31,31]'

# The spacing that a coarse grid tells for a smaller error is right, to a third of the error: two
# quantiles of 300 walks. The ball's 99 % are at its kinks (order 1), the spring's, in a box about
# the end of one well, are smooth (order 2).
told() {
  local model=$1 h=$2 n=$3 wanted=$4 order=$5 x=$6 y=$7
  accuracy "$model" "$h" "$n" --walks 300 --accuracy "$wanted"
  grep -q '^verify: broken: .*accurate' err || fail "$(cat err)"
  within "$(awk -v p="$order" 'BEGIN { print 0.85 * p }')" "$(figure order report)" \
    "$(awk -v p="$order" 'BEGIN { print 1.15 * p }')"
  h=$(figure 'sufficient spacing' report)
  n=$(awk -v h="$h" -v x="$x" -v y="$y" 'BEGIN { printf "[%d,%d,%d]", x / h + 1, y / h + 1, y / h + 1 }')
  accuracy "$model" "$h" "$n" --walks 300
  within "$(awk -v e="$wanted" 'BEGIN { print 0.67 * e }')" "$(figure 'state 99 %' report)" \
    "$(awk -v e="$wanted" 'BEGIN { print 1.33 * e }')"
}
if ! sanitized; then
  set=("${middle[@]}")
  told "$ball" 0.02 '[48,31,31]' 0.008 1 0.95 0.6
fi
set=(--set 'grid.origin=[4.5,-7.5,-7.5]')
told "$spring" 1 '[16,16,16]' 0.002 2 15 15

# The same with any -j.
verify grid --recompute none --walks 20 -j 1 --format json >one 2>err
verify grid --recompute none --walks 20 -j 3 --format json 2>err | cmp - one

# Not asked for, not there; alone, --accuracy walks.
verify grid --recompute none 2>err >report
! grep -q accurate report || fail "walks that nobody asked for"
verify grid --recompute none --accuracy 100 2>err | grep -q '^accurate  *3200 places  *0  ok$'

see='\(see verify --help\)'
for value in 0 -1 some; do
  expect 2 '' "~verify: --accuracy: .*$see" -- verify grid --accuracy $value
  expect 2 '' "~verify: --walks: .*$see" -- verify grid --walks $value
done
