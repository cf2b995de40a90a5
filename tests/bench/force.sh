#!/usr/bin/env bash
# The forces of a grid, as rows of the table in README.md: their errors by the rule of branches, and the energy that comes
# back in a closed loop, without the energy tank and with it: by the rule of branches (energy) and by the paper's (state).
# No model walks beside the grid, whose force would be sent in place of these.
#
#   tests/bench/force.sh [BUILD] [TICKS] [SESSIONS] [POINTS] [MODELS]
#           (default: build 200000 1000 '20 30 40' 'hung-ball alanine-dipeptide butane leu-enkephalin')
#
# The grids are computed first: some six minutes of CPU time, most of it leu-enkephalin's.
ticks=${2:-200000} sessions=${3:-1000} points=${4:-20 30 40}
models=${5:-hung-ball alanine-dipeptide butane leu-enkephalin}
source "$(dirname "$0")/lib.sh"
settings open.toml 'safety.reserve = inf' 'safety.ramp = 0'

played() { # GRID OPTIONS...
  "$HAPGRID_BUILD/bench/bench_hands" "$1" --sessions "$sessions" --beside off --table table "${@:2}" 2>/dev/null
  returned table
}

echo '|model|points a side|conversions|force|error: median / 99 %, N|ns a tick|returned: mean / worst, mJ|with the core|'
echo '|---|---|---|---|---|---|---|---|'
for model in $models; do
  definition=$HAPGRID_SOURCE/examples/molecule/$model/$model.toml
  [[ $model != hung-ball ]] || definition=$ball
  for n in $points; do
    compute "$model" "$definition" "$n"
    "$HAPGRID_BUILD/bench/bench_force" "$model.grid" "$HAPGRID_BUILD/models" "$ticks" | while read -r force median most ns; do
      rule=()
      [[ $force != state ]] || rule=(--traversal paper)
      echo "|$model|$n|$(stats --get conversions "$model.grid")|$force|$median / $most|$ns|$(
        played "$model.grid" "${rule[@]}" --max-force 100 --config open.toml)|$(played "$model.grid" "${rule[@]}")|"
    done
  done
done
