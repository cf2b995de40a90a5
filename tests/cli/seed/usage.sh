#!/bin/bash
# The command line of seed.
source "$(dirname "$0")/../lib.sh"

expect 0 '~hapgrid seed [0-9]+\.[0-9]+\.[0-9]+' '' -- seed --version
seed --help >help
for text in "MODEL.toml" "hapgrid-seed(1)" "--set KEY=VALUE" "--model-path DIR" "HAPGRID_MODEL_PATH" "-o, --output FILE"; do
  grep -qF -- "$text" help || fail "--help does not say: $text"
done

usage() { expect 2 '' "~seed: .* \(see seed --help\)" "$@"; }
usage -- seed
usage -- seed --nix "$ball"
usage -- seed "$ball" "$ball"
usage -- seed "$ball" --set
usage -- seed "$ball" -o
# A mistake in the command line reads and writes nothing.
usage -- seed "$ball" -o out --nix
nothing_left . help

expect 2 '' "seed: --set: 'grid' is not like KEY=VALUE (see seed --help)" -- seed "$ball" --set grid
expect 2 '' "seed: --set: '=1' is not like KEY=VALUE (see seed --help)" -- seed "$ball" --set =1
refuses "seed: --set grid..x=1: an empty key" -- seed "$ball" --set grid..x=1
refuses "seed: --set grid.spacing.x=1: spacing is no table" -- seed "$ball" --set grid.spacing.x=1
refuses "seed: --set grid.spacing=1.*" -- seed "$ball" --set $'grid.spacing=1\nmodel.plugin="x"'
