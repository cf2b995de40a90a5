#!/usr/bin/env bash
# The cost of the search beyond the model: CPU nanoseconds a request, single thread, on the hung ball.
#
#   tests/bench/search.sh [POINTS A SIDE] [REPEATS] [BUILD...]        (default: 64 3 build)
#
# Ways to the same grid, each as the median of its runs:
#   in_memory    expand --complete
#   piped        rounds of `expand | merge`
#   files        rounds through 8 shard files, with 9 filters started for each round
# Several builds take turns, so that a drift of the machine falls on all of them.
#
# CPU time is what the kernel accounts to the filters, their start-up and C included; C itself, which
# build/bench/bench_conversions measures, is said too. All of it is on one processor: two filters at
# the ends of a pipe would slow each other down in one core. The shards are in TMPDIR: on a disk, making
# files and syncing them is part of the figures, in /dev/shm it is not.
set -euo pipefail
n=${1:-64} repeats=${2:-3}
shift $(($# < 2 ? $# : 2))
(($#)) || set -- build
builds=()
for build; do builds+=("$(realpath "$build")"); done
source=$(realpath "$(dirname "$0")/../..")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
taskset -pc "$(taskset -pc $$ | sed 's/.*: //; s/[-,].*//')" $$ >/dev/null
TIMEFORMAT='%U %S'

# Adds the user and system seconds that the commands took to the file `cpu`.
cpu() { { time "$@" 2>&3; } 3>&2 2>>cpu; }

in_memory() { cpu expand --complete seeds -o complete; }
rounds() { # COMMAND: writes `next` from `grid`
  cp seeds grid
  while [ "$(stats --get todo grid)" -gt 0 ]; do
    "$1"
    mv next grid
  done
  cmp grid complete
}
by_pipe() { expand grid | merge grid - -o next; }
by_files() {
  local k
  for k in {1..8}; do cpu expand --part "$k/8" grid -o "requests.$k"; done
  cpu merge grid requests.* -o next
}
pipe() { cpu by_pipe; }
piped() { rounds pipe; }
files() { rounds by_files; }

side=$(awk -v n="$n" 'BEGIN { print 1.95 / (n - 1) }')
use() { # BUILD: its filters, in a directory of its own
  PATH=$1/bench:$1/bin:${path:=$PATH}
  mkdir -p "$work/$1"
  cd "$work/$1"
}
for build in "${builds[@]}"; do
  use "$build"
  seed "$source/examples/hung-ball/hung-ball.toml" --set "grid.counts=[$n,$n,$n]" \
    --set "grid.spacing=$side" --set 'grid.origin=[-0.975,-0.975,-0.975]' -o seeds
done
for _ in $(seq "$repeats"); do
  for way in in_memory piped files; do
    for build in "${builds[@]}"; do
      use "$build"
      "$way"
      awk '{ s += $1 + $2 } END { print s }' cpu >>"all.$way"
      rm cpu
      if command -v bench_conversions >/dev/null; then bench_conversions complete >>own 2>/dev/null; fi
    done
  done
done
median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
for build in "${builds[@]}"; do
  use "$build"
  requests=$(stats --get conversions complete)
  echo "$build: hung ball, $n^3 points, $requests requests, $(stats --get generation complete) generations"
  for way in in_memory piped files; do
    awk -v way="$way" -v seconds="$(median <"all.$way")" -v requests="$requests" \
      'BEGIN { printf "%-10s %6.1f ns a request\n", way, seconds / requests * 1e9 }'
  done
  [[ ! -e own ]] || printf '%-10s %6.1f ns\n' 'C itself' "$(median <own)"
done
