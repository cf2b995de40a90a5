#!/usr/bin/env bash
# What verify costs on a large grid: all checks on the hung ball, wall and CPU seconds and the memory.
#
#   tests/bench/verify.sh [BUILD] [POINTS A SIDE] [THREADS]        (default: build 128 2)
#
# The force is not cut (max_force), since a cut one is no gradient: verify shows closed walks that
# return energy with it.
set -euo pipefail
build=$(realpath "${1:-build}") n=${2:-128} threads=${3:-2}
source=$(realpath "$(dirname "$0")/../..")
PATH=$build/bin:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

side=$(awk -v n="$n" 'BEGIN { print 1.95 / (n - 1) }')
seed "$source/examples/hung-ball/hung-ball.toml" --set "grid.counts=[$n,$n,$n]" \
  --set "grid.spacing=$side" --set 'grid.origin=[-0.975,-0.975,-0.975]' \
  --set model.parameters.max_force=1e6 | expand --complete -j "$threads" -o grid
for recompute in none 1000; do
  echo "--recompute $recompute -j $threads:"
  python3 - verify grid --recompute "$recompute" -j "$threads" <<'END'
import resource, subprocess, sys, time

start = time.monotonic()
report = subprocess.run(sys.argv[1:], stdout=subprocess.PIPE, check=True, text=True).stdout
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(report.split("\n\n")[1])
print(f"{time.monotonic() - start:.1f} s, {used.ru_utime + used.ru_stime:.1f} s of CPU, "
      f"{used.ru_maxrss / 1024:.0f} MiB")
END
done
