#!/usr/bin/env bash
# Whether contacts hold that a trembling hand holds (tremor.cpp): a table.
#
#   tests/bench/tremor.sh [BUILD] [CONTACTS] [SECONDS] [SEED]        (default: build 20 60 1)
#
# The grids are computed first. A row has tremors of 0.05 to 0.3 mm, and hands of 60, 300 and 900 N/m: twelve times
# CONTACTS, each held for SECONDS. All rows together take an hour of CPU time, with 6 contacts and 20 seconds some
# minutes. Another SEED draws other contacts.
contacts=${2:-20} seconds=${3:-60} seed=${4:-1}
source "$(dirname "$0")/lib.sh"
molecules=$HAPGRID_SOURCE/examples/molecule
compute ball "$ball" 40

while read -r molecule points; do
  compute "$molecule" "$molecules/$molecule/$molecule.toml" "$points"
done <<<"alanine-dipeptide 20
butane 30
dichloroethane 20
leu-enkephalin 30"

echo '|model|gain|the hand|contacts|faded, at most of a hand'\''s|the most faded|'
echo '|---|---|---|---|---|---|'
for grid in ball alanine-dipeptide butane dichloroethane leu-enkephalin; do
  for gain in 1 3; do
    for start in approach contact; do
      "$HAPGRID_BUILD/bench/bench_tremor" $grid.grid "$HAPGRID_BUILD/models" 0.05,0.1,0.2,0.3 60,300,900 $gain $start \
        "$contacts" "$seconds" "$seed" |
        awk -F '\t' -v what="|$grid|$gain|$start|" 'BEGIN { least = 1 }
          { n += $5; if ($6 > faded) faded = $6; if ($7 < least) least = $7 }
          END { printf "%s%d|%d|%.0f %%|\n", what, n, faded, 100 * least }'
    done
  done
done
