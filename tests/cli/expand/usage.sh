#!/bin/bash
# The command line of expand, and its progress line.
source "$(dirname "$0")/../lib.sh"

expect 0 '~hapgrid expand [0-9]+\.[0-9]+\.[0-9]+' '' -- expand --version
expand --help >help
for text in "standard input" "FILE=-" "-j,--threads N:INT in [1 - 1024]=1" "--part K/N|auto=1/1" --complete \
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

# Progress on a terminal, never in a log.
expect 0 '' '' -- expand --complete seeds -o out
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
seed - -o slow <<END
grid = {origin = [0, 0, 0], spacing = 1, counts = [2, 1, 1]}
model = {plugin = "toy", parameters = {milliseconds = 500}}
END
script -qec 'expand slow -o out' screen </dev/null >/dev/null
grep -qa 'expand: generation 0, frontier 2 records, .* of 2 conversions' screen || fail "$(cat screen)"
