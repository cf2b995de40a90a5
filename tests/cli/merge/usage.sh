#!/bin/bash
# The command line of merge.
source "$(dirname "$0")/../lib.sh"

expect 0 '~hapgrid merge [0-9]+\.[0-9]+\.[0-9]+' '' -- merge --version
merge --help >help
for text in "standard input" "FILE=-" "--frontier PATTERN" "{}" "--parts N:UINT in [1 - 1000000]=1" \
  "--final" "--precision E" "1e-12 to 0.1" "--report FILE" "seconds" --progress "--model-path DIR" "HAPGRID_MODEL_PATH" "Exit codes:" \
  "  0  done" "  1  could not" "  2  the command line is wrong"; do
  grep -qF -- "$text" help || fail "--help does not say: $text"
done

seed "$ball" -o seeds
expand seeds -o requests
usage() { expect 2 '' "~merge: .* \(see merge --help\)" "$@"; }
usage -- merge --nix
usage -- merge seeds requests -o out --frontier part --parts 2
usage -- merge seeds - - -o out
for parts in 0 -1 x 1.5 '' 1000001; do
  usage -- merge seeds requests -o out --frontier 'part{}' --parts "$parts"
done
nothing_left . help seeds requests
