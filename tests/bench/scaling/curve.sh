#!/usr/bin/env bash
# The curve: how efficient builds on many workers are, simulated, and drawn with what was measured.
#
#   tests/bench/scaling/curve.sh            a minute: curve.txt, examples/cluster/curve.png
#   tests/bench/scaling/curve.sh BUILD      first measures with that build: costs.json, measured.txt;
#                                           five minutes on a machine that does nothing else
#
# What it rests on is beside it: growth.txt (growth.sh), times.txt (tests/bench/conversion_times.cpp).
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if (($#)); then
  build=$(realpath "$1")
  cd "$(dirname "$0")"
  ./costs.sh "$build" >"$work/costs"
  ./run.sh "$build" >"$work/measured"
  mv "$work/costs" costs.json
  mv "$work/measured" measured.txt
else
  cd "$(dirname "$0")"
fi

# Tasks of so many threads, as far as there are workers for them; a shard a task where conversions
# take about as long as each other, 8 where they do not.
simulate() { ./simulate.py --rounds 24 "$@"; }
even=(--cut equal:1 --times lognormal:0.5)
simulate --threads 50 --way claim "${even[@]}" >"$work/even"
simulate --threads 50 --way claim --cut equal:8 >"$work/molecule"
simulate --threads 50 --way srun start "${even[@]}" -n 50 256 >"$work/ways"
simulate --threads 10 --way claim "${even[@]}" -n 50 256 | sed 's/ claim / ten   /' >"$work/ten"
simulate --threads 1 --way claim "${even[@]}" -n 50 256 | sed 's/ claim / one   /' >"$work/one"
simulate --threads 1 --way start "${even[@]}" -n 50 256 | sed 's/ start / one-st/' >"$work/one-start"
{ cat "$work/even"; grep -hv '^#' "$work/molecule" "$work/ways" "$work/ten" "$work/one" "$work/one-start"; } >curve.txt
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
set title 'Tasks of 50 threads claim shards'
set ylabel 'efficiency / %'
array side[4] = [30, 50, 128, 256]
plot for [i=1:4] line('even', side[i], 'claim') u 5:8 w l lw 2 lc i t sprintf('%d³', side[i]), \\
     for [i=1:4] line('molecule', side[i], 'claim') u 5:8 w l lw 2 lc i dt 2 notitle, \\
     NaN w l lw 2 lc 'black' t 'log-normal, σ = 0.5', NaN w l lw 2 dt 2 lc 'black' t 'as a molecule takes'
set title 'Ways to hand out shards (50³ and 256³, log-normal)'
way(i) = word('claim start srun ten one', i)
from(i) = word('even ways ways ten one', i)
array names[5] = ['tasks that claim', 'started for each step', 'srun a shard', 'claim, 10 threads', 'claim, 1 thread']
plot for [i=1:5] line(from(i), 256, way(i)) u 5:8 w l lw 2 lc 4 dt i t names[i], \\
     for [i=1:5] line(from(i), 50, way(i)) u 5:8 w l lw 2 lc 2 dt i notitle
set title 'Measured on 2 processors: models that sleep'
set xrange [0.8:80]
plot for [i=1:2] "< grep -v '^#' measured.txt" u (strcol(2) eq word('make claim', i) ? \$1 : NaN):9 \\
       w p pt 7 ps 1.5 lc i t word('make claim', i) . ', measured', \\
     for [i=1:2] "< grep -v '^#' measured.txt" u (strcol(2) eq word('make claim', i) ? \$1 : NaN):11 \\
       w p pt 6 ps 2.2 lw 2 lc i t 'simulated'
END
mv "$work/png" ../../../examples/cluster/curve.png
