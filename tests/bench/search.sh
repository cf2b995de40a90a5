#!/usr/bin/env bash
# The cost of the search beyond the model: CPU nanoseconds a request, single thread, on the hung ball.
#
#   tests/bench/search.sh [POINTS A SIDE] [REPEATS] [BUILD]        (default: 64 3 build)
#
# Ways to the same grid, each as the median of its runs:
#   in_memory    expand --complete
#   piped        rounds of `expand | merge`
#   files        rounds through 8 shard files, with 9 filters started for each round
#
# CPU time is what the kernel accounts to the filters, their start-up and C included; C itself, which
# build/bench/bench_conversions measures, is said too. All of it is on one processor: two filters at
# the ends of a pipe would slow each other down in one core. The shards are in TMPDIR: on a disk, making
# files and syncing them is part of the figures, in /dev/shm it is not.
n=${1:-64} repeats=${2:-3}
shift $(($# < 2 ? $# : 2))
source "$(dirname "$0")/lib.sh"
taskset -pc "$(taskset -pc $$ | sed 's/.*: //; s/[-,].*//')" $$ >/dev/null
TIMEFORMAT='%U %S'

# Adds the user and system seconds that the commands took to the file `cpu`.
cpu() { { time "$@" 2>&3; } 3>&2 2>>cpu; }

in_memory() { cpu expand --complete seeds -o complete; }
rounds_by() { # COMMAND: writes `next` from `grid`
  cp seeds grid
  while [ "$(stats --get frontier grid)" -gt 0 ]; do
    "$1"
    mv next grid
  done
  cmp grid complete
}
by_pipe() { expand grid | merge grid - -o next; }
pipe() { cpu by_pipe; }
by_files() {
  local k
  for k in {1..8}; do cpu expand --part "$k/8" grid -o "requests.$k"; done
  cpu merge grid requests.* -o next
}
piped() { rounds_by pipe; }
files() { rounds_by by_files; }

seed "$ball" --set "grid.counts=[$n,$n,$n]" --set "grid.spacing=$(awk -v n="$n" 'BEGIN { print 1.95 / (n - 1) }')" \
  --set 'grid.origin=[-0.975,-0.975,-0.975]' -o seeds
for _ in $(seq "$repeats"); do
  for way in in_memory piped files; do
    "$way"
    awk '{ s += $1 + $2 } END { print s }' cpu >>"all.$way"
    rm cpu
    "$HAPGRID_BUILD/bench/bench_conversions" complete >>own 2>/dev/null || true
  done
done
median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
requests=$(stats --get conversions complete)
echo "hung ball, $n^3 points, $requests requests, $(stats --get generation complete) generations"
for way in in_memory piped files; do
  awk -v way="$way" -v seconds="$(median <"all.$way")" -v requests="$requests" \
    'BEGIN { printf "%-10s %6.1f ns a request\n", way, seconds / requests * 1e9 }'
done
[[ ! -s own ]] || printf '%-10s %6.1f ns\n' 'C itself' "$(median <own)"
