#!/usr/bin/env bash
# The cost of the search beyond the model: CPU nanoseconds a request, single thread, on the hung ball.
#
#   tests/bench/search.sh [BUILD] [POINTS A SIDE] [REPEATS]        (default: build 64 3)
#
# Ways to the same grid, each as the median of its runs:
#   in_memory    expand --complete
#   piped        rounds of an `expand` and a `merge` that stay (--serve), requests through a named pipe
#   files        the same through 8 shard files of requests
#   piped_anew   rounds of `expand | merge`, both started for each round
#   files_anew   rounds through 8 shard files, with 9 filters started for each round
# The grid is kept in layers, as Makefile.example does, and put together at the end.
#
# C itself is measured by build/bench/bench_conversions around each run and taken off. CPU time is what
# the kernel accounts to the filters, their start-up included; how much of it is start-up is said too.
# All of it is on one processor: two filters at the ends of a pipe would slow each other down in one
# core. The shards are in TMPDIR: on a disk, making files and syncing them is part of the figures, in
# /dev/shm it is not.
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
total() { awk '{ s += $1 + $2 } END { printf "%.3f\n", s }' cpu; rm cpu; }

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

piped_anew() {
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
files_anew() {
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

# Filters that stay: `ask` gives one a command line, `answered` waits for it.
ask() {  # FILTER WORD...
  local IFS=$'\t' to
  case $1 in expand) to=5 ;; merge) to=7 ;; esac
  echo "${*:2}" >&"$to"
}
answered() {  # FILTER
  local from code
  case $1 in expand) from=6 ;; merge) from=8 ;; esac
  read -r code <&"$from"
  return "$code"
}
# All rounds by filters that stay.
stay() {  # COMMAND: a round's requests and their merge
  local left=1
  mkfifo to_expand from_expand to_merge from_merge pipe
  begin
  times >before
  expand --serve <to_expand >from_expand &
  exec 5>to_expand 6<from_expand
  merge --serve <to_merge >from_merge 5>&- 6<&- &
  exec 7>to_merge 8<from_merge
  while [ "$left" -gt 0 ]; do
    form
    "$1"
    next
    read -r _ _ _ left <counts
  done
  ask merge "${layers[@]}" "$tip" -o joined
  answered merge
  exec 5>&- 6<&- 7>&- 8<&-
  wait
  times >after
  # Of its children alone: the shell that talks to them is none of the filters.
  awk -F'[ms ]' 'FNR == 2 { s = 60 * ($1 + $4) + $2 + $5; print (NR > 2 ? s - first : 0), 0; first = s }' \
    before after >>cpu
  rm to_expand from_expand to_merge from_merge pipe
  joined
}
round_by_pipe() {
  ask expand "$tip" -o pipe
  ask merge "${layers[@]}" "$tip" pipe "${form[@]}" --counts counts
  answered expand
  answered merge
}
round_by_files() {
  local k
  for k in {1..8}; do
    ask expand --part "$k/8" "$tip" -o "requests.$k"
    answered expand
  done
  ask merge "${layers[@]}" "$tip" requests.{1..8} "${form[@]}" --counts counts
  answered merge
}
piped() { stay round_by_pipe; }
files() { stay round_by_files; }

side=$(awk -v n="$n" 'BEGIN { print 1.95 / (n - 1) }')
seed "$source/examples/hung-ball/hung-ball.toml" --set "grid.counts=[$n,$n,$n]" \
  --set "grid.spacing=$side" --set 'grid.origin=[-0.975,-0.975,-0.975]' -o seeds
in_memory; rm cpu
requests=$(stats --get conversions complete)
generations=$(stats --get generation complete)
start=$(starting)
echo "hung ball, $n^3 points, $requests requests, $generations generations"
median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
for way in in_memory piped files piped_anew files_anew; do
  case $way in
    in_memory) processes=1 ;;
    piped | files) processes=2 ;;
    piped_anew) processes=$((2 * generations + 1)) ;;
    files_anew) processes=$((9 * generations + 1)) ;;
  esac
  rm -f all beyond
  for _ in $(seq "$repeats"); do
    before=$(bench_conversions complete 2>/dev/null)
    "$way"
    own=$(bench_conversions complete 2>/dev/null | awk -v before="$before" '{ print ($1 + before) / 2 }')
    echo "$own" >>own
    ns=$(total | awk -v requests="$requests" '{ print $1 / requests * 1e9 }')
    echo "$ns" >>all
    awk -v ns="$ns" -v own="$own" 'BEGIN { print ns - own }' >>beyond
  done
  awk -v way="$way" -v all="$(median <all)" -v beyond="$(median <beyond)" -v requests="$requests" \
    -v started="$processes" -v start="$start" '
      BEGIN { printf "%-11s %6.1f ns a request, %.1f beyond C, %.1f of them to start %d processes\n",
                     way, all, beyond, started * start / requests * 1e9, started }'
done
printf '%-11s %6.1f ns\n' 'C itself' "$(median <own)"
