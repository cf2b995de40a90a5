#!/usr/bin/env bash
# How long large grids take to open, and with how much memory: `play` along a short path, `stats`, and `verify
# --recompute none`.
#
#   tests/bench/large.sh [BUILD] [GRID...]        (default: build, and hung balls of 64 and 128 points a side)
#
# A line a program and grid: wall seconds, CPU seconds of user and system, peak memory.
source "$(dirname "$0")/lib.sh"
shift $(($# < 1 ? $# : 1))

grids=()
for grid; do grids+=("$(cd "$OLDPWD" && realpath "$grid")"); done  # lib.sh has left the directory
if (($# == 0)); then
  for n in 64 128; do
    spacing=$(awk -v n="$n" 'BEGIN { print 1.95 / (n - 1) }')
    seed "$ball" --set "grid.counts=[$n,$n,$n]" --set "grid.spacing=$spacing" \
      --set 'grid.origin=[-0.975,-0.975,-0.975]' | expand --complete -j 2 -o "$n.grid"
    grids+=("$n.grid")
  done
fi
awk 'BEGIN { for (i = 0; i < 400; ++i) { t = i * 0.02
             printf "%.6f %.6f %.6f\n", 0.9 * sin(t), 0.1 * sin(1.6 * t + 0.5), 0.2 * sin(2.4 * t + 1) } }' >path
for grid in "${grids[@]}"; do
  for command in "play --device path:path" stats "verify --recompute none"; do
    command time -o costs -f '%e s %U + %S CPU s %M kB peak' $command "$grid" >/dev/null 2>&1 || true
    echo "$(basename "$grid" .grid) $command: $(tail -n 1 costs)"
  done
done
