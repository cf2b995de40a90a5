#!/usr/bin/env bash
# What comes back to the hand with the default rules and the safety core, for hands of several kinds, and what the
# energy tank of the core holds back for it: a table. The model walks beside the grid, one tick late.
#
#   tests/bench/hands.sh [BUILD] [SESSIONS] [SEED]        (default: build 1000 1)
#
# SESSIONS of 5 s each for a row: some ten minutes of CPU time. Another SEED draws other hands.
sessions=${2:-1000} seed=${3:-1}
source "$(dirname "$0")/lib.sh"
compute ball "$ball" 40
compute alanine "$HAPGRID_SOURCE/examples/molecule/alanine-dipeptide/alanine-dipeptide.toml" 30

# simulate GRID SESSIONS OPTIONS...
simulate() {
  "$HAPGRID_BUILD/bench/bench_hands" "$1.grid" --sessions "$2" --seed "$seed" --beside 1 "${@:3}" 2>error || fail "$(cat error)"
}
# off GAIN: the mean difference between the force of the model and the one that is sent, from a text log.
off() {
  awk -F '\t' -v gain="$1" '!/^#/ { sum += sqrt((gain * $5 - $8)^2 + (gain * $6 - $9)^2 + (gain * $7 - $10)^2); n++ }
    END { printf "%.9f", sum / n }'
}
# row WHAT GAIN SETTING OPTIONS...: in the mean over 40 sessions the tank holds back what it adds to that difference.
row() {
  local line="|$1|" grid with without
  for grid in ball alanine; do
    settings with.toml "$3"
    settings without.toml "$3" 'safety.reserve = inf'
    simulate $grid "$sessions" "${@:4}" --gain "$2" --config with.toml --table table
    with=$(simulate $grid 40 "${@:4}" --gain "$2" --config with.toml --log - | off "$2")
    without=$(simulate $grid 40 "${@:4}" --gain "$2" --config without.toml --log - | off "$2")
    line+=$(returned table)$(awk -v a="$with" -v b="$without" 'BEGIN { printf "|%.4f|", a > b ? a - b : 0 }')
  done
  echo "$line"
}

echo '|hand|ball: mean / worst, mJ|held back, N|alanine dipeptide|held back, N|'
echo '|---|---|---|---|---|'
row '300 N/m, at 1 kHz' 1 ''
row '300 N/m, at 5 kHz' 1 '' --rate 5000
row '100 N/m' 1 '' --stiffness 100
row '1,000 N/m' 1 '' --stiffness 1000
row 'gain 3' 3 ''
row 'forces a tick late, which play is not told' 1 '' --delay 1
row 'steps of 0.2 mm' 1 'safety.encoder = 2e-4' --encoder 2e-4
row '1,000 N/m, gain 3, a tick late, steps of 0.2 mm' 3 'safety.encoder = 2e-4' --stiffness 1000 --encoder 2e-4 --delay 1
