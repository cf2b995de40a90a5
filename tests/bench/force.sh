#!/usr/bin/env bash
# The forces that play can send, on grids of several sizes: their error against the number of conversions,
# what a tick costs, and the energy that comes back in a closed loop without the safety core.
#
#   tests/bench/force.sh [BUILD] [TICKS] [SESSIONS] [POINTS] [PICTURE]
#                                              (default: build 200000 1000 '12 20 30' force-error.png)
#
# The grids are computed first: some ten minutes of CPU time, most of it leu-enkephalin's.
ticks=${2:-200000} sessions=${3:-1000} points=${4:-12 20 30} picture=$(realpath "${5:-force-error.png}")
source "$(dirname "$0")/lib.sh"
molecules=$HAPGRID_SOURCE/examples/molecule
printf '[random]\nsessions = %d\n' "$sessions" >sim.toml
open=(--max-force 100)
for limit in slew max_speed buzz_force reserve; do open+=(--set "safety.$limit=inf"); done
for stage in ramp fade; do open+=(--set "safety.$stage=0"); done

returned() { # GRID FORCE
  play "$1" --device sim:sim.toml --force "$2" "${open[@]}" --report report 2>/dev/null
  python3 -c 'import json; r = json.load(open("report"))["simulation"]["returned_mJ"]
print("%.4f / %.2f" % (r["mean"], r["worst"]))'
}

echo '|model|points a side|conversions|force|whole cells: median / 99 %, N|torn: median / 99 %, N|ns a tick|returned: mean / worst, mJ|'
echo '|---|---|---|---|---|---|---|---|'
for model in hung-ball alanine-dipeptide butane leu-enkephalin; do
  definition=$molecules/$model/$model.toml
  [[ $model != hung-ball ]] || definition=$ball
  for n in $points; do
    compute "$model" "$definition" "$n"
    conversions=$(stats --get conversions "$model.grid")
    "$HAPGRID_BUILD/bench/bench_force" "$model.grid" "$HAPGRID_BUILD/models" "$ticks" >measured
    for force in energy records state; do
      read -r median most torn_median torn_most ns < <(awk -F '\t' -v force=$force '$1 == force {
        if ($2 == "whole") whole = $4 " " $5; else print whole, $4, $5, $6 }' measured)
      echo "|$model|$n|$conversions|$force|$median / $most|$torn_median / $torn_most|$ns|$(returned "$model.grid" $force)|"
      echo "$conversions $median $most" >>"$model.$force"
    done
  done
done

gnuplot <<END
set terminal pngcairo size 900,700 font ',11'
set output '$picture'
set multiplot layout 2,2
set logscale xy
set xlabel 'conversions'
set ylabel 'error of the force, median / N'
do for [model in 'hung-ball alanine-dipeptide butane leu-enkephalin'] {
  set title model
  plot for [force in 'energy records state'] model.'.'.force using 1:2 with linespoints title force
}
END
echo "picture: $picture"
