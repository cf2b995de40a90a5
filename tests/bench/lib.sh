# shellcheck shell=bash
# What the benchmarks share: sourced as a script's first line, it takes the build's directory from the
# script's first argument (default: build), and has all that tests/cli/lib.sh has.
HAPGRID_BUILD=$(realpath "${1:-build}")
source "$(dirname "${BASH_SOURCE[0]}")/../cli/lib.sh"

# measure NAME COMMAND...: appends a line to the file `costs`: the name, wall seconds, CPU seconds, peak
# in kB. The peak is never below some 13 MB, which the process has before it becomes the command.
measure() {
  python3 - "$@" <<'PYTHON'
import resource, subprocess, sys, time
start = time.monotonic()
code = subprocess.run(sys.argv[2:]).returncode
wall, used = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
with open("costs", "a") as out:
    print(sys.argv[1], wall, used.ru_utime + used.ru_stime, used.ru_maxrss, file=out)
sys.exit(code)
PYTHON
}

# print_costs: a line for each name: how often it ran, seconds in all, the largest peak.
print_costs() {
  awk '{ n[$1]++; w[$1] += $2; s[$1] += $3; if ($4 > m[$1]) m[$1] = $4; if (n[$1] == 1) name[++count] = $1 }
       END { for (i = 1; i <= count; ++i) { c = name[i]
             printf "%-18s %5d times %9.2f s %9.2f CPU s %8.1f MB peak\n", c, n[c], w[c], s[c], m[c] / 1024 } }' costs
}

# compute NAME MODEL POINTS_OF_THE_LONGEST_SIDE OPTION_OF_SEED...: the model's own box with another spacing.
compute() {
  local spacing counts scaled
  spacing=$(seed "$2" | stats --get box.spacing) counts=$(seed "$2" | stats --get box.counts | tr -d '[]')
  scaled=$(awk -v counts="$counts" -v points="$3" -v spacing="$spacing" 'BEGIN {
    n = split(counts, c, ","); m = c[1]; for (i in c) if (c[i] + 0 > m) m = c[i] + 0
    s = (m - 1) / (points - 1); printf "%.17g", spacing * s
    for (i = 1; i <= n; ++i) printf "%s%d", (i > 1 ? "," : " "), int((c[i] - 1) / s + 1.5) }')
  seed "$2" --set "grid.spacing=${scaled% *}" --set "grid.counts=[${scaled#* }]" "${@:4}" | expand --complete -j 2 -o "$1.grid"
}
