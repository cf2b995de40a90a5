#!/bin/bash
# The command line of merge.
source "$(dirname "$0")/../lib.sh"

expect 0 '~hapgrid merge [0-9]+\.[0-9]+\.[0-9]+' '' -- merge --version
merge --help >help
for text in standard "-o, --output FILE" "--small" "--cost FILE" "seconds" "--model-path DIR" "HAPGRID_MODEL_PATH" "Exit codes:" \
  "  0  done" "  1  could not" "  2  the command line is wrong"; do
  grep -qF -- "$text" help || fail "--help does not say: $text"
done

seed "$ball" -o seeds
expand seeds -o requests
usage() { expect 2 '' "~merge: .* \(see merge --help\)" "$@"; }
usage -- merge --nix
usage -- merge --small seeds requests -o out
usage -- merge seeds - - -o out
nothing_left . help seeds requests
