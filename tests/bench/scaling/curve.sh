#!/usr/bin/env bash
# Simulates the curve, and draws it with what was measured (measured.txt, by run.sh).
#
#   tests/bench/scaling/curve.sh [PNG]          (default: examples/cluster/curve.png); some minutes
set -euo pipefail
cd "$(dirname "$0")"
png=$(realpath "${1:-../../../examples/cluster/curve.png}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Tasks of 10 threads; as even as conversions are, as few shards.
simulate() { ./simulate.py --rounds 24 "$@"; }
simulate --way stay --threads 10 --cut equal:1 --times lognormal:0.5 >"$work/even"
simulate --way stay --threads 10 --cut guided:4 >"$work/molecule"
simulate --way make srun claim --threads 10 --cut equal:1 --times lognormal:0.5 -n 50 256 >"$work/ways"
simulate --way claim --cut equal:1 --times lognormal:0.5 -n 50 256 | sed 's/ claim / single /' >"$work/single"
{ cat "$work/even"; grep -hv '^#' "$work/molecule" "$work/ways" "$work/single"; } >curve.txt
gnuplot <<END
set terminal pngcairo size 1500,520 font 'DejaVu Sans,11' noenhanced
set output '$work/png'
set multiplot layout 1,3
set logscale x
set xlabel 'workers'
set yrange [0:103]
set grid
set key bottom left
line(file, n, way) = sprintf("< awk '\$2 == %d && \$3 == \\"%s\\"' $work/%s", n, way, file)
set title 'Tasks that stay: how even the conversions are'
set ylabel 'efficiency / %'
array side[4] = [30, 50, 128, 256]
plot for [i=1:4] line('even', side[i], 'stay') u 5:8 w l lw 2 lc i t sprintf('%d³', side[i]), \\
     for [i=1:4] line('molecule', side[i], 'stay') u 5:8 w l lw 2 lc i dt 2 notitle, \\
     NaN w l lw 2 lc 'black' t 'log-normal, σ = 0.5', NaN w l lw 2 dt 2 lc 'black' t 'as a molecule takes'
set title 'Ways to hand out shards (50³ and 256³, log-normal)'
way(i) = word('stay claim srun make single', i)
array names[5] = ['tasks that stay', 'tasks that claim', 'srun a shard', 'make', 'claim, of 1 thread']
from(i) = word('even ways ways ways single', i)
plot for [i=1:5] line(from(i), 256, way(i)) u 5:8 w l lw 2 lc 4 dt i t names[i], \\
     for [i=1:5] line(from(i), 50, way(i)) u 5:8 w l lw 2 lc 2 dt i notitle
set title 'Measured on 2 processors: models that sleep'
set xrange [0.8:80]
plot for [i=1:2] "< grep -v '^#' measured.txt" u (strcol(2) eq word('make claim', i) ? \$1 : NaN):9 \\
       w p pt 7 ps 1.5 lc i t word('make claim', i) . ', measured', \\
     for [i=1:2] "< grep -v '^#' measured.txt" u (strcol(2) eq word('make claim', i) ? \$1 : NaN):11 \\
       w p pt 6 ps 2.2 lw 2 lc i t 'simulated'
END
mv "$work/png" "$png"
