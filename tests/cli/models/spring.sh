# The bead between two wells, from plug-ins in C and in Fortran: their grids are complete and verify, and both refuse in
# one line. Languages are compared in cli/launcher/init.
source "$(dirname "$0")/../lib.sh"
models=$(readlink -f "$HAPGRID_BIN/../models")
names=(spring-c)
if [[ -e $models/spring-fortran.so ]]; then names+=(spring-fortran); fi

small=(--set 'grid.origin=[-12.5, -14.5, -0.5]' --set 'grid.counts=[26, 30, 2]')
for name in "${names[@]}"; do
  toml=$HAPGRID_SOURCE/examples/$name/$name.toml
  seed "$toml" "${small[@]}" -o seeds
  expand --complete -j 2 seeds -o "$name.grid"
  expect 0 '~.*' '~verify: fine: [0-9]+ checks' -- verify "$name.grid" --recompute all
  expect 0 '~.*gradient +[1-9][0-9]* forces +0  ok.*' '~check-model: fine: .*' -- check-model "$toml"
  rounds seeds rounds.grid
  cmp rounds.grid "$name.grid"

  refuses "seed: model $name: unknown parameter weight \(known: wells, depth, stiffness, reach, strength, tolerance\)" \
    -- seed "$toml" --set model.parameters.weight=1
  # When the spring breaks, the message says where and from which state.
  seed "$toml" "${small[@]}" --set model.parameters.strength=12 -o weak.seeds
  refuses "expand: conversion at point [0-9]+ \([0-9, ]+\) level [01], direction [0-9]+: the spring broke: stretched to [0-9.eE+]+ mm, its strength is [0-9.eE+]+ mm" \
    -- expand --complete weak.seeds -o out
  [[ ! -e out ]] || fail 'half a grid'
done

# There are states in both wells at some points; which, is in unit/spring.
same "levels" '~\[0,[1-9][0-9]*,[1-9][0-9]*\]' "$(stats spring-c.grid --get levels_histogram)"
