#!/bin/bash
# The efficiency over the number of workers, simulated: curve.tsv and examples/cluster/curve.png.
set -euo pipefail
cd "$(dirname "$0")"
./simulate.py >curve.tsv
gnuplot <<'END'
set terminal pngcairo size 760,480 font 'DejaVu Sans,11' noenhanced
set output '../../../examples/cluster/curve.png'
set datafile separator "\t"
set logscale x
set xlabel 'workers, in tasks of 50 threads'
set ylabel 'efficiency / %'
set yrange [0:103]
set grid
set key bottom left
array side[4] = [30, 50, 128, 256]
of(n, times) = sprintf("< awk -F '\t' '$1 == \"%s\" && $2 == %d' curve.tsv", times, n)
plot for [i=1:4] of(side[i], 'log-normal') u 3:4 w l lw 2 lc i t sprintf('%d³', side[i]), \
     for [i=1:4] of(side[i], 'alanine') u 3:4 w l lw 2 lc i dt 2 notitle, \
     NaN w l lw 2 lc 'black' t 'log-normal, σ = 0.5', NaN w l lw 2 dt 2 lc 'black' t "alanine's own times"
END
