#!/usr/bin/env bash
# The cost of the search beyond the model: CPU nanoseconds a request, single thread, on the hung ball.
#
#   tests/bench/search.sh [BUILD] [POINTS A SIDE] [REPEATS]        (default: build 64 3)
#
# Four ways to the same grid, as medians: in memory (expand --complete), rounds of `expand | merge`
# through a pipe, rounds through 8 shard files of requests, and these by filters that stay (--serve).
# The grid is kept in layers, as Makefile.example does, and put together at the end.
# C itself is measured by build/bench/bench_conversions and taken off. CPU time is what the kernel
# accounts to the processes, their start-up included; how much of it is start-up is said too. All of it
# is on one processor: two filters at the ends of a pipe would slow each other down in one core.
set -euo pipefail
build=$(realpath "${1:-build}") n=${2:-64} repeats=${3:-3}
source=$(realpath "$(dirname "$0")/../..")
PATH=$build/bench:$build/bin:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
taskset -pc "$(taskset -pc $$ | sed 's/.*: //; s/[-,].*//')" $$ >/dev/null
TIMEFORMAT='%U %S'

# Adds the user and system seconds that the commands took to the file `cpu`.
cpu() { { time "$@" 2>&3; } 3>&2 2>>cpu; }
total() { awk '{ s += $1 + $2 } END { printf "%.3f", s }' cpu; rm cpu; }

# What it costs to start a filter that does nothing, CPU seconds.
starting() { for _ in $(seq 100); do cpu expand --version; done >/dev/null; total | awk '{ print $1 / 100 }'; }

in_memory() { cpu expand --complete seeds -o complete; }
# Rounds in layers, each eighth of which makes a new ground: what a merge writes is in `form`, what it
# takes in `layers`.
begin() {
  tip=seeds round=0 layers=()
}
form() {
  round=$((round + 1))
  form=(--tip "tip.$round" -o "layer.$round")
  ((round % 8 == 0)) || form+=(--layer)
}
next() {
  tip=tip.$round
  ((round % 8)) || layers=()
  layers+=("layer.$round")
}
joined() {
  cmp joined complete
  rm layer.* tip.*
}

piped() {
  begin
  while [ "$(stats --get frontier "$tip")" -gt 0 ]; do
    form
    pipe() { expand "$tip" | merge "${layers[@]}" "$tip" - "${form[@]}"; }
    cpu pipe
    next
  done
  cpu merge "${layers[@]}" "$tip" -o joined
  joined
}
files() {
  local k
  begin
  while [ "$(stats --get frontier "$tip")" -gt 0 ]; do
    form
    for k in {1..8}; do cpu expand --part "$k/8" "$tip" -o "requests.$k"; done
    cpu merge "${layers[@]}" "$tip" requests.* "${form[@]}"
    rm -f requests.*
    next
  done
  cpu merge "${layers[@]}" "$tip" -o joined
  joined
}

served() {
  begin
  mkfifo to_expand from_expand to_merge from_merge
  cpu rounds_of_served
  rm to_expand from_expand to_merge from_merge
  joined
}
rounds_of_served() {
  local k left=1
  expand --serve <to_expand >from_expand &
  exec 5>to_expand 6<from_expand
  merge --serve <to_merge >from_merge 5>&- 6<&- &
  exec 7>to_merge 8<from_merge
  ask() {  # TO FROM WORD...
    local IFS=$'\t' code
    echo "${*:3}" >&"$1"
    read -r code <&"$2"
    return "$code"
  }
  while [ "$left" -gt 0 ]; do
    form
    for k in {1..8}; do ask 5 6 --part "$k/8" "$tip" -o "requests.$k"; done
    ask 7 8 "${layers[@]}" "$tip" requests.{1..8} "${form[@]}" --counts counts
    read -r _ _ _ left <counts
    next
  done
  ask 7 8 "${layers[@]}" "$tip" -o joined
  exec 5>&- 6<&- 7>&- 8<&-
  wait
}

side=$(awk -v n="$n" 'BEGIN { print 1.95 / (n - 1) }')
seed "$source/examples/hung-ball/hung-ball.toml" --set "grid.counts=[$n,$n,$n]" \
  --set "grid.spacing=$side" --set 'grid.origin=[-0.975,-0.975,-0.975]' -o seeds
in_memory; rm cpu
requests=$(stats --get conversions complete)
generations=$(stats --get generation complete)
start=$(starting)
echo "hung ball, $n^3 points, $requests requests, $generations generations"
for _ in $(seq "$repeats"); do bench_conversions complete 2>/dev/null; done | sort -g |
  awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }' > own
printf '%-10s %6s ns\n' 'C itself' "$(cat own)"
for way in in_memory piped files served; do
  case $way in in_memory) processes=1 ;; served) processes=2 ;; piped) processes=$((2 * generations)) ;; files) processes=$((9 * generations)) ;; esac
  for _ in $(seq "$repeats"); do "$way"; total; echo; done | sort -g |
    awk -v way="$way" -v requests="$requests" -v own="$(cat own)" -v started="$processes" -v start="$start" '
      { v[NR] = $1 }
      END { ns = v[int((NR + 1) / 2)] / requests * 1e9
            printf "%-10s %6.1f ns a request, %.1f beyond C, %.1f of them to start %d processes\n",
                   way, ns, ns - own, started * start / requests * 1e9, started }'
done
