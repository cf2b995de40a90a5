#!/usr/bin/env bash
# What verify costs on a large grid, all checks on the hung ball, in seconds and peak memory; and how long stats takes
# to write it for numpy and VTK (aim: 3 s each).
#
#   tests/bench/verify.sh [BUILD] [POINTS A SIDE] [THREADS]        (default: build 128 2)
#
# The force is not cut off (max_force): a force that is cut off is no gradient, and `passive` would not be proved.
n=${2:-128} threads=${3:-2}
source "$(dirname "$0")/lib.sh"

spacing=$(awk -v n="$n" 'BEGIN { print 1.95 / (n - 1) }')
seed "$ball" --set "grid.counts=[$n,$n,$n]" --set "grid.spacing=$spacing" \
  --set 'grid.origin=[-0.975,-0.975,-0.975]' --set model.parameters.max_force=1e6 |
  expand --complete -j "$threads" -o grid
for recompute in none 1000; do
  measure "recompute-$recompute" verify grid --recompute "$recompute" -j "$threads" >"report-$recompute"
done
measure npz stats grid --npz grid.npz
measure vti stats grid --vti grid.vti
measure vti-branch stats grid --vti grid.vti --branch 0
cat report-1000
print_costs
