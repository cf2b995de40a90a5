#!/bin/bash
# The command line of expand, and its progress line.
source "$(dirname "$0")/../lib.sh"

expect 0 '~hapgrid expand [0-9]+\.[0-9]+\.[0-9]+' '' -- expand --version
expand --help >help
for text in "standard input" "-o, --output FILE" "-j, --threads N" "--part K/N|auto" --complete \
  "--cost FILE" "seconds" "--model-path DIR" "HAPGRID_MODEL_PATH" "Exit codes:" \
  "  0  done" "  1  could not" "  2  the command line is wrong"; do
  grep -qF -- "$text" help || fail "--help does not say: $text"
done

seed "$ball" -o seeds
usage() { expect 2 '' "~expand: .* \(see expand --help\)" "$@"; }
usage -- expand --nix
for part in 0/3 4/3 1 1/0 0/0 -1/3 1/-3 1/3x ' 1/3' 1//3 /3 1/ x '' 1/4294967296 \
  18446744073709551617/18446744073709551618; do
  usage -- expand seeds -o out --part "$part"
done
for threads in 0 -1 1025 x 1.5 ''; do usage -- expand seeds -o out -j "$threads"; done
usage -- expand seeds -o out --complete --part 1/2
usage -- expand seeds seeds -o out
nothing_left . help seeds

# Progress only when asked for, or on a terminal: never in a log.
expand --complete seeds --set x 2>/dev/null && fail "an unknown option"
expect 0 '' '' -- expand --complete seeds -o out
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
if [[ -e $HAPGRID_MODEL_PATH/slow.so ]]; then
  seed "$ball" --set model.plugin=slow --set 'model.parameters={}' -o slow
  expand slow -o out 2>err
  grep -q $'expand: generation 0, frontier 8 records, .* of 56 conversions' err || fail "$(cat err)"
fi
