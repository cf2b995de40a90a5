#!/usr/bin/env bash
# How the search's cost grows with the grid: CPU nanoseconds a request in memory, peak memory of a part of
# `expand` and of `merge`, and how much faster two threads are.
#
#   tests/bench/size.sh [BUILD] [REPEATS] [POINTS A SIDE...]        (default: build 3 30 64 128 256)
#
# The machine drifts, so sizes take turns and the least counts. Memory: a grid whose seeds are every fourth
# point, so that one generation touches all of it; parts have 4,096 records at most, whatever its size.
set -euo pipefail
build=$(realpath "${1:-build}") repeats=${2:-3}
shift $(($# < 2 ? $# : 2))
(($#)) || set -- 30 64 128 256
source=$(realpath "$(dirname "$0")/../..")
PATH=$build/bench:$build/bin:$PATH
export HAPGRID_MODEL_PATH=$build/models:$build/tests/plugins
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
ball=$source/examples/hung-ball/hung-ball.toml

# measured FIELD COMMAND...: user and system seconds (cpu), wall seconds (wall), or peak memory in MB (peak).
measured() {
  python3 - "$@" <<'END'
import resource, subprocess, sys, time
def cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
# A python3 that is a script which starts the real one has children before this.
before, start = cpu(), time.monotonic()
subprocess.run(sys.argv[2:], check=True)
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3
print({"cpu": cpu() - before, "wall": time.monotonic() - start, "peak": peak}[sys.argv[1]])
END
}
least() { sort -g | head -n 1; }
cube() { # POINTS A SIDE, MODEL.toml, MORE...
  seed "$2" --set "grid.counts=[$1,$1,$1]" --set "grid.spacing=$(awk -v n="$1" 'BEGIN { print 1.95 / (n - 1) }')" \
    --set 'grid.origin=[-0.975,-0.975,-0.975]' "${@:3}"
}

for n; do cube "$n" "$ball" -o "seeds.$n"; done
for _ in $(seq "$repeats"); do
  for n; do
    measured cpu expand --complete "seeds.$n" -o "grid.$n" >>"cpu.$n"
    bench_conversions "grid.$n" >>"own.$n" 2>/dev/null
  done
done
for n; do
  awk -v n="$n" -v cpu="$(least <"cpu.$n")" -v own="$(least <"own.$n")" -v requests="$(stats --get conversions "grid.$n")" '
    BEGIN { ns = cpu / requests * 1e9
            printf "%3d points a side: %5.1f ns a request in memory, %.1f of them C\n", n, ns, own }'
  rm "grid.$n"
done

for n; do
  {
    printf 'model = {plugin = "toy", parameters = {amplitude = 1, tolerance = 0.4}}\n'
    printf 'grid = {origin = [0, 0, 0], spacing = 1, counts = [%d, %d, %d]}\n[seeds]\npoints = [\n' "$n" "$n" "$n"
    awk -v n="$n" 'BEGIN { for (k = 1; k < n; k += 4) for (j = 1; j < n; j += 4) for (i = 1; i < n; i += 4) print "[" i "," j "," k "]," }'
    echo ']'
  } >lattice.toml
  seed lattice.toml -o lattice
  parts=$(($(stats --get records lattice) / 4096 + 1))
  part=$(measured peak expand lattice --part "$(((parts + 1) / 2))/$parts" -o part)
  expand lattice -o requests
  one=$(measured peak merge lattice requests -o next)
  for k in $(seq 1000); do expand lattice --part "$k/1000" -o "part.$k"; done
  printf '%3d points a side: expand of a part (of %d) %.0f MB, merge %.0f MB, of 1,000 parts %.0f MB\n' \
    "$n" "$parts" "$part" "$one" "$(measured peak merge lattice part.* -o next)"
  rm -f lattice requests next part part.*
done

# A conversion of 10 us of processor time.
sed 's/^plugin = .*/plugin = "sleeper"/; s/^radius/busy_microseconds = 10\nradius/' "$ball" >busy.toml
cube 40 busy.toml -o busy
for _ in $(seq "$repeats"); do
  for j in 1 2; do measured wall expand --complete busy -j "$j" -o grid >>"wall.$j"; done
done
awk -v one="$(least <wall.1)" -v two="$(least <wall.2)" \
  'BEGIN { printf "10 us a conversion: one thread %.2f s, two %.2f s: %.2f times\n", one, two, one / two }'
