#!/usr/bin/env bash
# The forces of a grid, on grids of several sizes: their error against the number of conversions and what a tick
# costs, all by the rule of branches, and the energy that comes back in a closed loop, without the energy tank and with
# it: by the rule of branches (energy) and by the paper's (state). No model walks beside the grid, whose force would be
# sent in place of these.
#
#   tests/bench/force.sh [BUILD] [TICKS] [SESSIONS] [POINTS] [MODELS]
#           (default: build 200000 1000 '20 30 40' 'hung-ball alanine-dipeptide butane leu-enkephalin')
#
# The grids are computed first: some six minutes of CPU time, most of it leu-enkephalin's. The pictures
# force-error.png and closed-loop.png are left where it was started.
ticks=${2:-200000} sessions=${3:-1000} points=${4:-20 30 40} into=$PWD
models=${5:-hung-ball alanine-dipeptide butane leu-enkephalin}
source "$(dirname "$0")/lib.sh"
molecules=$HAPGRID_SOURCE/examples/molecule
printf '[random]\nsessions = %d\n' "$sessions" >sim.toml
settings open.toml 'safety.reserve = inf' 'safety.ramp = 0'
open=(--max-force 100 --config open.toml)

returned() { # GRID OPTIONS...
  "$HAPGRID_BUILD/bench/bench_hands" "$1" sim.toml --beside off "${@:2}" --report report 2>/dev/null
  python3 -c 'import json; r = json.load(open("report"))["returned_mJ"]
print("%.4f / %.2f" % (r["mean"], r["worst"]))'
}

echo '|model|points a side|conversions|force|whole cells: median / 99 %, N|torn: median / 99 %, N|ns a tick|returned: mean / worst, mJ|with the core|'
echo '|---|---|---|---|---|---|---|---|---|'
for model in $models; do
  definition=$molecules/$model/$model.toml
  [[ $model != hung-ball ]] || definition=$ball
  for n in $points; do
    compute "$model" "$definition" "$n"
    conversions=$(stats --get conversions "$model.grid")
    "$HAPGRID_BUILD/bench/bench_force" "$model.grid" "$HAPGRID_BUILD/models" "$ticks" >measured
    for force in energy records state; do
      read -r median most torn_median torn_most ns < <(awk -F '\t' -v force=$force '$1 == force {
        if ($2 == "whole") whole = $4 " " $5; else print whole, $4, $5, $6 }' measured)
      returned='|'
      case $force in
        energy) returned="$(returned "$model.grid" "${open[@]}")|$(returned "$model.grid")" ;;
        state) returned="$(returned "$model.grid" --traversal paper "${open[@]}")|$(returned "$model.grid" --traversal paper)" ;;
      esac
      echo "|$model|$n|$conversions|$force|$median / $most|$torn_median / $torn_most|$ns|$returned|"
      echo "$conversions $median $most" >>"$model.$force"
    done
  done
done

# One session of the hung ball, in which the paper's rule returns most, by three kinds of play: the energy that
# the hand has got back beyond what the ball had stored.
compute loop "$ball" 40
printf '[random]\nsessions = 40\n' >loop.toml
loop() { # NAME OPTIONS...
  "$HAPGRID_BUILD/bench/bench_hands" loop.grid loop.toml --beside off --log loop.log --report report "${@:2}" 2>/dev/null
  [[ -n ${session:-} ]] ||
    session=$(python3 -c 'import json; print(json.load(open("report"))["returned_mJ"]["session"])')
  awk -v from=$((5000 * session)) '/^#/ { next }
    n++ < from || n > from + 5000 { next }
    first == "" { first = $1; stored = $(NF - 1) }
    { if ($1 > first) given += (a * ($2 - x) + b * ($3 - y) + c * ($4 - z)); x = $2; y = $3; z = $4; a = $8; b = $9; c = $10
      print $1 - first, given + $(NF - 1) - stored }' loop.log >"$1.loop"
}
loop paper --traversal paper "${open[@]}"
loop energy "${open[@]}"
loop core

PYTHONPATH=$HAPGRID_BIN/../python /usr/bin/python3 - "$into" $models <<'END'
import os
import sys

import numpy
from hapgrid import style

into, *models = sys.argv[1:]
with style.house_style():
    drawn = style.figure(6.2, 2.5 * ((len(models) + 1) // 2))
    for number, model in enumerate(models):
        axes = drawn.add_subplot((len(models) + 1) // 2, 2, number + 1, sharey=axes if number else None)
        for force, colour, marker in zip(("energy", "records", "state"), style.COLOURS, style.MARKERS):
            if os.path.exists(f"{model}.{force}"):
                conversions, error = numpy.loadtxt(f"{model}.{force}", ndmin=2)[:, :2].T
                axes.plot(conversions, error, color=colour, marker=marker, label=force)
        axes.set(xscale="log", yscale="log", title=model, xlabel="conversions", ylabel="median error of the force / N")
        if number % 2:
            axes.set(ylabel="")
            axes.tick_params(labelleft=False)
        if number == 0:
            axes.legend()
    style.save(drawn, f"{into}/force-error.png")
    drawn = style.figure()
    axes = drawn.add_subplot()
    for name, said, colour in (("paper", "paper, no tank", style.ORANGE), ("energy", "branch and energy, no tank", style.PURPLE),
                               ("core", "the same with the tank", style.GREEN)):
        axes.plot(*numpy.loadtxt(f"{name}.loop").T, color=colour, label=said, linestyle=(0, (4, 3)) if name == "core" else "-")
    axes.set(xlabel="time / s", ylabel="returned beyond\nwhat was stored / N rope lengths")
    style.legend(axes)
    style.save(drawn, f"{into}/closed-loop.png")
END
