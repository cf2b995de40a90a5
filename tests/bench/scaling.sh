#!/usr/bin/env bash
# What handing out shards costs: the efficiency of whole builds with models that sleep.
#
#   tests/bench/scaling.sh [BUILD] [WORKERS...]        (default: build 1 2 64)
#
# The hung ball's conversions are slowed to some milliseconds that need no processor (sleeper.c), so
# that many workers fit on a machine with few. With 1 and 2 workers: make on this machine. With more:
# an own Slurm (as root, tests/cluster/slurm.sh), 8 CPUs a node, by make and srun, by tasks that claim
# shards, and by job arrays. Efficiency is conversions * milliseconds / (workers * wall).
set -euo pipefail
HAPGRID_BUILD=$(realpath "${1:-build}")
shift $(($# > 0))
(($#)) || set -- 1 2 64
# shellcheck source=../cli/lib.sh
source "$(dirname "$0")/../cli/lib.sh"
# shellcheck source=../cluster/slurm.sh
source "$here/../cluster/slurm.sh"
original=$ball
most=$(printf '%s\n' "$@" | sort -n | tail -n 1)
((most <= 2)) || cluster_start $(((most + 7) / 8)) 8

# measure WORKERS MODE MILLISECONDS PARTS COMMAND...: one build, one row.
measure() {
  local workers=$1 mode=$2 ms=$3 parts=$4 start wall
  shift 4
  rm -rf work
  start=$EPOCHREALTIME
  "$@" PARTS="$parts"
  wall=$(awk "BEGIN { print $EPOCHREALTIME - $start }")
  cmp work/hung-ball.grid reference
  awk -v w="$workers" -v mode="$mode" -v ms="$ms" -v parts="$parts" -v wall="$wall" \
    -v n="$(stats --get conversions reference)" -v g="$(stats --get generation reference)" 'BEGIN {
      printf "%7d  %-6s %11d %8d %6d %7d %8.1f %8.1f %11.0f %%\n",
        w, mode, n, ms, g, parts, n * ms / 1000 / w, wall, n * ms / 10 / w / wall }'
}
# grid MILLISECONDS SETS...: what is built, and computed once without the pauses.
grid() {
  local ms=$1
  shift
  small=("$@")
  ball=$original
  slowed "$ms"
  reference
}

cat >tasks <<'END'
#!/bin/bash
for _ in $(seq "$1"); do "${@:2}" & done
wait
END
chmod +x tasks
printf '%7s  %-6s %11s %8s %6s %7s %8s %8s %13s\n' \
  workers mode conversions ms/conv rounds shards 'ideal s' 'wall s' efficiency
for workers; do
  if ((workers <= 2)); then
    grid 1 'grid.counts=[12,6,6]' grid.spacing=0.15
    measure "$workers" make 1 $((4 * workers)) build -j "$workers"
    measure "$workers" claim 1 $((4 * workers)) build MODE=claim RUN="./tasks $workers"
  else
    # Few rounds, since each waits up to 10 s for sbatch; long conversions, to fill them.
    ms=$((2 * workers))
    grid $ms 'grid.counts=[4,6,6]' grid.spacing=0.15
    measure "$workers" make $ms $((2 * workers)) in_allocation "$workers" RUN='srun -N1 -n1 --exclusive' -j "$workers"
    measure "$workers" claim $ms $((4 * workers)) in_allocation "$workers" MODE=claim RUN=srun
    measure "$workers" array $ms $((2 * workers)) build MODE=array LIMIT="$workers"
  fi
done
