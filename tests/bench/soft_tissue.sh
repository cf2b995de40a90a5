#!/usr/bin/env bash
# What large rows cost: the soft tissue's grid (n = 1521 and 799 stored numbers) through each filter,
# in CPU seconds and peak memory, and a tick of play in microseconds.
#
#   tests/bench/soft_tissue.sh [BUILD] [SEED OPTION...]        (default: build, the example's own grid)
#
# as in tests/bench/soft_tissue.sh build --set 'grid.counts=[3,3,6]'. The grid is computed twice:
# in memory and in rounds through 4 shard files a generation.
set -euo pipefail
build=$(realpath "${1:-build}")
shift || true
source=$(realpath "$(dirname "$0")/../..")
PATH=$build/bin:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# measure NAME COMMAND...: appends "name CPU-seconds peak-kB" to the file `costs`. The peak is never
# below some 13 MB, which is what the process has before it becomes the command.
measure() {
  python3 - "$@" <<'PYTHON'
import resource, subprocess, sys
code = subprocess.run(sys.argv[2:]).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open("costs", "a") as out:
    print(sys.argv[1], used.ru_utime + used.ru_stime, used.ru_maxrss, file=out)
sys.exit(code)
PYTHON
}
# One line a name: how often, CPU seconds in all, the largest peak.
report() {
  awk '{ n[$1]++; s[$1] += $2; if ($3 > m[$1]) m[$1] = $3; if (n[$1] == 1) name[++count] = $1 }
       END { for (i = 1; i <= count; ++i) { c = name[i]
             printf "%-18s %5d times %9.2f CPU s %8.1f MB peak\n", c, n[c], s[c], m[c] / 1024 } }' costs
}

seed "$source/examples/soft-tissue/soft-tissue.toml" "$@" -o seeds
measure expand--complete expand --complete seeds -o grid
echo "$(stats --get points grid) points, $(stats --get records grid) records, $(stats --get conversions grid) conversions, $(stat -c %s grid) bytes"

cp seeds round
while [ "$(stats --get frontier round)" -gt 0 ]; do
  for k in 1 2 3 4; do measure expand expand --part $k/4 round -o requests.$k; done
  measure merge merge round requests.* -o next
  mv next round
done
cmp round grid

measure verify verify grid >/dev/null 2>&1
measure stats stats grid >/dev/null
measure stats--dump stats --dump grid >/dev/null

# A circle that goes up and down through the box; then nothing but the start.
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
report
awk -v n=$ticks '$1 == "play" { a = $2 } $1 == "play-start" { b = $2 }
  END { printf "a tick of play: %.1f us\n", (a - b) / n * 1e6 }' costs
