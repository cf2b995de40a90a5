#!/bin/bash
# How grids of the hung ball grow, a line for each generation, for simulate.py:
#
#   tests/bench/scaling/growth.sh [BUILD [POINTS A SIDE...]] > growth.tsv      (default: build 30 50 128 256)
#
# The largest box takes a minute of CPU time and 2 GB of memory.
set -euo pipefail
build=$(realpath "${1:-build}")
shift $(($# > 0))
(($#)) || set -- 30 50 128 256
ball=$(realpath "$(dirname "$0")/../../../examples/hung-ball/hung-ball.toml")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf '# points a side\tgeneration\tconversions\n'
for n; do
  "$build/bin/seed" "$ball" --set "grid.counts=[$n,$n,$n]" --set 'grid.origin=[-0.975,-0.975,-0.975]' \
    --set "grid.spacing=$(awk "BEGIN { print 1.95 / ($n - 1) }")" |
    "$build/bin/expand" --complete -o "$work/grid"
  "$build/bench/bench_growth" "$work/grid" | sed "s/^/$n\t/"
done
