#!/usr/bin/env bash
# Which branch the hand is on: both rules of traversal against the model itself (branches.cpp), as a table,
# and a picture of a tear-off.
#
#   tests/bench/branches.sh [BUILD] [PATHS] [SEED] [PICTURE]        (default: build 100 1 tear-off.png)
#
# The grids are computed first: the hung ball with two spacings, alanine dipeptide with 30 and 40 points a side,
# butane with 20, leu-enkephalin with 12, and the soft tissue with 8: some minutes of CPU time. To ask the soft
# tissue takes long, so it gets a tenth of the paths. Another SEED draws other paths.
picture=$(realpath "${4:-tear-off.png}") paths=${2:-100} seed=${3:-1}
source "$(dirname "$0")/lib.sh"

molecules=$HAPGRID_SOURCE/examples/molecule
compute ball "$ball" 40
compute ball-fine "$ball" 79
compute alanine "$molecules/alanine-dipeptide/alanine-dipeptide.toml" 30
compute alanine-fine "$molecules/alanine-dipeptide/alanine-dipeptide.toml" 40
compute butane "$molecules/butane/butane.toml" 20
compute leu-enkephalin "$molecules/leu-enkephalin/leu-enkephalin.toml" 12
compute soft-tissue "$HAPGRID_SOURCE/examples/soft-tissue/soft-tissue.toml" 8

models=$HAPGRID_BUILD/models
echo '|grid|paths|paper: right|off 99 %|branch: right|off median|off 99 %|'
echo '|---|---|---|---|---|---|---|'
row() { # GRID RIGHT KIND PATHS
  "$HAPGRID_BUILD/bench/bench_branches" "$1.grid" "$models" "$3" "$2" "$4" "$seed" |
    awk -F '\t' -v grid="$1" '{ n = $3; right[NR] = $4; median[NR] = $5; most[NR] = $6 }
      END { if (n > 0) printf "|%s|%s|%.1f %%|%.2f|%.1f %%|%.3f|%.2f|\n", grid, $1, right[1], most[1],
              right[2], median[2], most[2] }'
}
for grid in ball ball-fine; do
  for kind in straight smooth diagonal tear-off; do row "$grid" 0.05 "$kind" "$paths"; done
done
for grid in alanine alanine-fine butane leu-enkephalin; do
  for kind in smooth tear-off; do row "$grid" 0.3 "$kind" "$paths"; done
done
for kind in smooth tear-off; do row soft-tissue 0.3 "$kind" $((paths / 10 + 1)); done

# Straight across the hung ball, off its middle: what tears off, and where.
awk 'BEGIN { for (x = -0.9; x <= 0.9; x += 0.001) print x, 0.07, 0.03 }' >path
for rule in paper branch model; do
  play ball.grid --device path:path --traversal "$rule" --log "$rule.log" 2>/dev/null
done
gnuplot <<END
set terminal pngcairo size 900,420 font ',11'
set output '$picture'
set xlabel 'x of the HIP / rope lengths'
set ylabel 'angle of the ball α / rad'
set xrange [-0.2:0.9]
set key left
plot 'model.log' using 2:19 with lines lw 6 lc rgb '#cccccc' title 'the model', \
  'paper.log' using 2:19 with lines lw 1.5 lc rgb '#d95f02' title 'paper', \
  'branch.log' using 2:19 with lines lw 1.5 lc rgb '#1b9e77' title 'branch'
END
