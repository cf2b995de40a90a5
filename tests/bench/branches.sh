#!/usr/bin/env bash
# Which branch the hand is on: the rules of traversal against the model itself (branches.cpp), as two tables, and
# a picture of a tear-off.
#
#   tests/bench/branches.sh [BUILD] [PATHS] [SEED] [PICTURE]        (default: build 8 1 tear-off.png)
#
# The grids are computed first: the hung ball, alanine dipeptide and leu-enkephalin with 30 and 40 points a side,
# and butane with 30: some ten minutes of CPU time. Another SEED draws other paths.
picture=$(realpath "${4:-tear-off.png}") paths=${2:-8} seed=${3:-1}
source "$(dirname "$0")/lib.sh"

molecules=$HAPGRID_SOURCE/examples/molecule
compute ball "$ball" 40
for points in 30 40; do
  compute "alanine-$points" "$molecules/alanine-dipeptide/alanine-dipeptide.toml" $points
  compute "leu-enkephalin-$points" "$molecules/leu-enkephalin/leu-enkephalin.toml" $points
done
compute butane-30 "$molecules/butane/butane.toml" 30

follow() { # GRID RIGHT KIND
  "$HAPGRID_BUILD/bench/bench_branches" "$1.grid" "$HAPGRID_BUILD/models" "$3" "$2" "$paths" "$seed" 20 5 2000
}
row() { # GRID RIGHT KIND: right and off of each rule
  follow "$@" | awk -F '\t' -v what="|$1|$3|" '{ what = what sprintf("%.1f %%|%.2f|", $4, $7) } END { print what }'
}
echo '|grid|paths|paper: right|off 99 %, N|grid alone: right|off|with the model: right|off|5 ticks late: right|off|oracle: right|off|'
echo '|---|---|---|---|---|---|---|---|---|---|---|---|'
for kind in touch smooth straight diagonal tear-off; do row ball 0.05 $kind; done
for grid in alanine-30 alanine-40 butane-30 leu-enkephalin-30 leu-enkephalin-40; do
  for kind in touch smooth tear-off; do row $grid 0.3 $kind; done
done
echo
echo '|grid|paper|grid alone|with the model|5 ticks late|oracle|'
echo '|---|---|---|---|---|---|'
for grid in alanine-30 butane-30 leu-enkephalin-30; do
  follow $grid 0.3 back | awk -F '\t' -v what="|$grid|" '{ what = what sprintf("%.1f %%|", $4) } END { print what }'
done

# Straight across the hung ball, off its middle: what tears off, and where.
awk 'BEGIN { for (x = -0.9; x <= 0.9; x += 0.001) print x, 0.07, 0.03 }' >path
for rule in paper branch model; do
  play ball.grid --device path:path --beside off --traversal "$rule" --log "$rule" 2>/dev/null
done
plot columns model paper branch --x x --y s0 --grid ball.grid -o "$picture"
