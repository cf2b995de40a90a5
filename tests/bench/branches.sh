#!/usr/bin/env bash
# Which branch the hand is on: the rules of traversal against the model itself (branches.cpp), as a table, and
# a picture of a tear-off.
#
#   tests/bench/branches.sh [BUILD] [PATHS] [SEED] [PICTURE]        (default: build 8 1 tear-off.png)
#
# The grids are computed first: some minutes of CPU time. Another SEED draws other paths.
picture=$(realpath "${4:-tear-off.png}") paths=${2:-8} seed=${3:-1}
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

# Straight across the hung ball, off its middle: what tears off, and where.
awk 'BEGIN { for (x = -0.9; x <= 0.9; x += 0.001) print x, 0.07, 0.03 }' >path
for rule in paper branch model; do
  play hung-ball.grid --device path:path --beside off --traversal "$rule" --log "$rule" 2>/dev/null
done
plot columns model paper branch --x x --y s0 --grid hung-ball.grid -o "$picture"
