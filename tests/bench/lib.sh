# shellcheck shell=bash
# What the benchmarks share: sourced as a script's first line, it takes the build's directory from the
# script's first argument (default: build), and has all that tests/cli/lib.sh has.
HAPGRID_BUILD=$(realpath "${1:-build}")
source "$(dirname "${BASH_SOURCE[0]}")/../cli/lib.sh"

# scaled MODEL POINTS_OF_THE_LONGEST_SIDE: the options of seed, a line each, that give the model's own box another spacing.
scaled() {
  local spacing counts
  spacing=$(seed "$1" | stats --get box.spacing) counts=$(seed "$1" | stats --get box.counts | tr -d '[]')
  awk -v counts="$counts" -v points="$2" -v spacing="$spacing" 'BEGIN {
    n = split(counts, c, ","); m = c[1]; for (i in c) if (c[i] + 0 > m) m = c[i] + 0
    s = (m - 1) / (points - 1); printf "--set=grid.spacing=%.17g\n--set=grid.counts=[", spacing * s
    for (i = 1; i <= n; ++i) printf "%s%d", (i > 1 ? "," : ""), int((c[i] - 1) / s + 1.5); print "]" }'
}

# compute NAME MODEL POINTS_OF_THE_LONGEST_SIDE OPTION_OF_SEED...: a grid of the model's own box with another spacing.
compute() {
  local options
  mapfile -t options < <(scaled "$2" "$3")
  seed "$2" "${options[@]}" "${@:4}" | expand --complete -j 2 -o "$1.grid"
}

# returned TABLE: the energy that hands got back, from the table of bench_hands: mean / worst, mJ.
returned() { awk 'NR > 1 { sum += $4; if ($4 > worst) worst = $4 } END { printf "%.4f / %.2f", sum / (NR - 1), worst }' "$1"; }
