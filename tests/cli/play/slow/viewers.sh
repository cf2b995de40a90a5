#!/bin/bash
# Viewers of frames and of IMD that die, sleep, or wake up late.
source "$(dirname "$0")/../../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90} {90..-90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
python3 "$here/../viewers.py" grid path
python3 "$here/../imd.py" ball "$HAPGRID_SOURCE/schemas/frame.capnp" grid path asleep
