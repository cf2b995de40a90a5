#!/usr/bin/env bash
# What handing out shards costs: whole builds with models that sleep, beside what simulate.py foretells.
#
#   tests/bench/scaling/run.sh [BUILD] [WORKERS...] > measured.txt      (default: build 1 2 16 64)
#
# The hung ball's conversions are slowed to some milliseconds that need no processor (sleeper.c), so
# that many workers fit on a machine with few. With 1 and 2 workers: make on this machine. With more:
# an own Slurm (as root, tests/cluster/slurm.sh), 8 CPUs a node, by make and srun, by tasks that claim
# shards, and by job arrays, which are not simulated. Efficiency is conversions * milliseconds /
# (workers * wall).
set -euo pipefail
HAPGRID_BUILD=$(realpath "${1:-build}")
shift $(($# > 0))
(($#)) || set -- 1 2 16 64
# shellcheck source=../../cli/lib.sh
source "$(dirname "$0")/../../cli/lib.sh"
# shellcheck source=../../cluster/slurm.sh
source "$here/../../cluster/slurm.sh"
original=$ball
most=$(printf '%s\n' "$@" | sort -n | tail -n 1)
((most <= 2)) || cluster_start $(((most + 7) / 8)) 8

# measure WORKERS MODE WAY MILLISECONDS PARTS COMMAND...: one build, one row.
measure() {
  local workers=$1 mode=$2 way=$3 ms=$4 parts=$5 start wall foretold=
  shift 5
  rm -rf work
  start=$EPOCHREALTIME
  "$@" PARTS="$parts" RANGES=1
  wall=$(awk "BEGIN { print $EPOCHREALTIME - $start }")
  cmp work/hung-ball.grid reference
  [[ $way == - ]] || foretold=$("$here/simulate.py" --growth growth --times even \
    --mean "$(awk "BEGIN { print $ms / 1000 }")" --grid small --points 1 --workers "$workers" --way "$way" \
    --cut "parts:$parts" --ranges 0 --cores "$(nproc)" | awk '!/^#/ { print $7, $8 }')
  awk -v w="$workers" -v mode="$mode" -v ms="$ms" -v parts="$parts" -v wall="$wall" \
    -v foretold="${foretold:-- -}" -v n="$(stats --get conversions reference)" \
    -v g="$(stats --get generation reference)" 'BEGIN {
      split(foretold, f, " ")
      printf "%7d  %-6s %11d %8d %6d %7d %8.1f %8.1f %10.0f %10s %10s\n",
        w, mode, n, ms, g, parts, n * ms / 1000 / w, wall, n * ms / 10 / w / wall, f[1], f[2] }'
}
# grid MILLISECONDS SETS...: what is built, and computed once without the pauses.
grid() {
  local ms=$1
  shift
  small=("$@")
  ball=$original
  slowed "$ms"
  reference
  "$HAPGRID_BUILD/bench/bench_growth" reference 64 | sed 's/^/small 1 /' >growth
}

cat >tasks <<'END'
#!/bin/bash
for _ in $(seq "$1"); do "${@:2}" & done
wait
END
chmod +x tasks
printf '#%6s  %-6s %11s %8s %6s %7s %8s %8s %10s %10s %10s\n' \
  workers mode conversions ms/conv rounds shards ideal wall efficiency simulated efficiency
for workers; do
  if ((workers <= 2)); then
    grid 5 "grid.counts=[8,6,6]" grid.spacing=0.15
    measure "$workers" make make 5 $((4 * workers)) build -j "$workers"
    measure "$workers" claim claim 5 $((4 * workers)) build MODE=claim RUN="./tasks $workers"
  else
    # Few rounds, since each waits up to 10 s for sbatch; long conversions, to fill them.
    ms=$((4 * workers))
    grid $ms "grid.counts=[4,6,6]" grid.spacing=0.15
    measure "$workers" make srun $ms $((2 * workers)) in_allocation "$workers" RUN='srun -N1 -n1 --exclusive' -j "$workers"
    measure "$workers" claim claim $ms $((4 * workers)) in_allocation "$workers" MODE=claim RUN=srun
    measure "$workers" array - $ms $((2 * workers)) build MODE=array LIMIT="$workers"
  fi
done
