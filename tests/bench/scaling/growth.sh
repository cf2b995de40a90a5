#!/usr/bin/env bash
# How grids grow: a line for each generation, for simulate.py.
#
#   tests/bench/scaling/growth.sh [BUILD] [POINTS A SIDE...] > growth.txt   (default: build 30 50 128 256)
#
# ball: the hung ball in a cube around it. alone: the same box, where the ball is never touched, so
# that there is one level, and the grid grows from its eight corners and stops in its middle.
# The largest box takes about a minute of CPU time for each of them, and 2 GB of memory.
set -euo pipefail
build=$(realpath "${1:-build}")
shift $(($# > 0))
(($#)) || set -- 30 50 128 256
source=$(realpath "$(dirname "$0")/../../..")
PATH=$build/bench:$build/bin:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

echo "# $(basename "$0"): grid points generation conversions chunks busiest-of-64-ranges"
for n; do
  spacing=$(awk -v n="$n" 'BEGIN { print 1.95 / (n - 1) }')
  for grid in ball:-0.975 alone:10; do
    at=${grid#*:}
    seed "$source/examples/hung-ball/hung-ball.toml" --set "grid.counts=[$n,$n,$n]" \
      --set "grid.spacing=$spacing" --set "grid.origin=[$at,$at,$at]" |
      expand --complete -o "$work/grid"
    bench_growth "$work/grid" 64 | sed "s/^/${grid%:*} $n /"
  done
done
