#!/usr/bin/env bash
# What comes back to the hand with the default rules and the safety core, for hands of several kinds: a table.
#
#   tests/bench/hands.sh [BUILD] [SESSIONS] [SEED]        (default: build 1000 1)
#
# SESSIONS of 5 s each for a row: some ten minutes of CPU time. Another SEED draws other hands.
sessions=${2:-1000} seed=${3:-1}
source "$(dirname "$0")/lib.sh"
compute ball "$ball" 40
compute alanine "$HAPGRID_SOURCE/examples/molecule/alanine-dipeptide/alanine-dipeptide.toml" 30

# row WHAT STIFFNESS DEVICE PLAY_OPTIONS...: DEVICE as lines of TOML
row() {
  printf '%s\n[hand]\nstiffness = %d\n[random]\nseed = %d\nsessions = %d\n' "$3" "$2" "$seed" "$sessions" >sim.toml
  for grid in ball alanine; do
    play "$grid.grid" --device sim:sim.toml --report "$grid.report" "${@:4}" 2>error || fail "$(cat error)"
  done
  python3 - "$1" <<'PYTHON'
import json, sys
cells = [sys.argv[1]]
for grid in "ball", "alanine":
    returned = json.load(open(f"{grid}.report"))["simulation"]["returned_mJ"]
    cells += [f"{returned['mean']:.4f} / {returned['worst']:.2f}"]
print("|" + "|".join(cells) + "|", flush=True)
PYTHON
}

echo '|hand|ball: mean / worst, mJ|alanine dipeptide|'
echo '|---|---|---|'
row '300 N/m, at 1 kHz' 300 ''
row '300 N/m, at 5 kHz' 300 '' --rate 5000
row '100 N/m' 100 ''
row '1,000 N/m' 1000 ''
row 'with --gain 3' 300 '' --gain 3
row 'forces a tick late, which play is not told' 300 'delay = 1'
row 'steps of 0.2 mm' 300 'encoder = 2e-4' --set safety.encoder=2e-4
row '1,000 N/m, --gain 3, a tick late, steps of 0.2 mm' 1000 $'encoder = 2e-4\ndelay = 1' --gain 3 --set safety.encoder=2e-4
