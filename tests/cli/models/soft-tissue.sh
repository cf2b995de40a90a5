# The block of soft tissue: a small grid is complete and verifies, is the same from one process and in
# rounds, and is played without the model. Refusals are one line.
source "$(dirname "$0")/../lib.sh"
toml=$HAPGRID_SOURCE/examples/soft-tissue/soft-tissue.toml

# The example's own grid, with states of 1521 numbers, takes minutes; the mesh here is coarser.
small=(--set 'model.parameters.elements=[4, 4, 2]' --set 'model.parameters.size=[48, 48, 24]'
  --set 'grid.origin=[-1.5, -1.5, 36.4]' --set 'grid.counts=[3, 3, 5]'
  --set 'seeds.points=[[-1.5, -1.5, 42.4]]')
seed "$toml" "${small[@]}" -o seeds
expand --complete -j 2 seeds -o grid
expect 0 '~.*' '~verify: fine: [0-9]+ checks' -- verify grid --recompute "$(sanitized && echo 10 || echo all)"
if ! sanitized; then
  rounds seeds rounds.grid
  cmp rounds.grid grid
fi
same 'components' 150 "$(header grid stateSize)"

# The path goes straight down to the lowest point of the middle and up again, 1 mm a tick. What the grid
# stores is enough to play it. At the top nothing pulls, at the bottom the tissue pushes up, and 1.4 mm
# above the touch it pulls harder on the way up, because the surface still clings to the ball.
awk 'BEGIN { for (i = 0; i <= 6; ++i) print 0, 0, 42.4 - i; for (i = 5; i >= 0; --i) print 0, 0, 42.4 - i }' >path
HAPGRID_MODEL_PATH=/nowhere play grid --device path:path --log log 2>play.err ||
  fail "play: $(cat play.err)"
awk '!/^#/ { f[++n] = $7 } END { exit !(n == 13 && f[1] == 0 && f[7] > 0.2 && f[11] < f[3] - 0.2) }' log ||
  fail "the log: $(cut -f 1-4 log)"

refuses 'seed: model soft-tissue: unknown parameter weight \(known: .*\)' \
  -- seed "$toml" --set model.parameters.weight=1
refuses 'seed: model soft-tissue: parameter poisson_ratio is 0\.5, it must be from 0 to 0\.45' \
  -- seed "$toml" --set model.parameters.poisson_ratio=0.5
refuses 'seed: model soft-tissue: parameter elements is 3, it must be an even number .*' \
  -- seed "$toml" --set 'model.parameters.elements=[3, 4, 2]'

# Where the ball goes too deep an element gives way, and the message says where.
seed "$toml" "${small[@]}" --set 'grid.origin=[0, 0, 28.9]' --set 'grid.counts=[1, 1, 10]' \
  --set 'seeds.points=[[0, 0, 42.4]]' -o deep.seeds
refuses 'expand: conversion at point [0-9]+ \([0-9, ]+\) level [0-9]+, direction [0-9]+: no equilibrium.*: [0-9.e-]+ N out of balance.*' \
  -- expand --complete deep.seeds -o out
[[ ! -e out ]] || fail 'half a grid'
