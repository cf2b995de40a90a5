#!/usr/bin/env bash
# Which branch the hand is on: the rules of traversal against the model itself (branches.cpp), as a table.
#
#   tests/bench/branches.sh [BUILD] [PATHS] [SEED]        (default: build 8 1)
#
# The grids are computed first: some minutes of CPU time. Another SEED draws other paths.
paths=${2:-8} seed=${3:-1}
source "$(dirname "$0")/lib.sh"

echo '|grid|paper: right|off|grid alone: right|off|with the model: right|off|5 ticks late: right|off|'
echo '|---|---|---|---|---|---|---|---|---|'
while read -r name points right; do
  definition=$HAPGRID_SOURCE/examples/molecule/$name/$name.toml
  [[ $name != hung-ball ]] || definition=$ball
  compute "$name" "$definition" "$points"
  "$HAPGRID_BUILD/bench/bench_branches" "$name.grid" "$HAPGRID_BUILD/models" "$right" "$paths" "$seed" |
    awk -F '\t' -v what="|$name, $points|" '{ what = what sprintf("%.1f %%|%.2f|", $3, $4) } END { print what }'
done <<<"hung-ball 40 0.05
alanine-dipeptide 30 0.3
butane 30 0.3"
