#!/usr/bin/env bash
# What large rows cost: the soft tissue's grid (states of 1521 numbers, 799 more stored with each) through
# every filter, in seconds and peak memory, and a tick of play in microseconds.
#
#   tests/bench/soft_tissue.sh [BUILD] [SEED OPTION...]        (default: build, the example's own grid)
#
# as in tests/bench/soft_tissue.sh build --set 'grid.counts=[3,3,6]'. The grid is computed twice: in one
# process, and in rounds of 4 parts.
source "$(dirname "$0")/lib.sh"
shift || true

seed "$HAPGRID_SOURCE/examples/soft-tissue/soft-tissue.toml" "$@" -o seeds
measure expand--complete expand --complete seeds -o grid
echo "$(stats --get points grid) points, $(stats --get records grid) records, $(stats --get conversions grid) conversions, $(stat -c %s grid) bytes"

cp seeds round
while (($(stats --get todo round) > 0)); do
  for k in 1 2 3 4; do measure expand expand --part $k/4 round -o "requests.$k"; done
  measure merge merge round requests.? -o next
  mv next round
done
cmp round grid

measure verify verify grid >/dev/null 2>&1
measure stats stats grid >/dev/null
measure stats--dump stats --dump grid >/dev/null

# A circle that goes up and down through the box; then only its start.
read -r lowest highest radius < <(stats --format json grid | python3 -c '
import json, sys
box = json.load(sys.stdin)["box"]
low, size = box["origin"], [box["spacing"] * (n - 1) for n in box["counts"]]
print(low[2], low[2] + size[2], min(size[:2]) / 2)')
ticks=200000
awk -v n=$ticks -v a="$lowest" -v b="$highest" -v r="$radius" 'BEGIN {
  for (i = 0; i < n; ++i) { t = i / 2000
    print 0.9 * r * cos(t), 0.9 * r * sin(t), (a + b) / 2 + (b - a) / 2 * cos(t / 7) } }' >path
head -n 1 path >start
measure play play grid --device path:path 2>/dev/null
measure play-start play grid --device path:start 2>/dev/null
print_costs
awk -v n=$ticks '$1 == "play" { a = $3 } $1 == "play-start" { b = $3 }
  END { printf "a tick of play: %.1f us\n", (a - b) / n * 1e6 }' costs
