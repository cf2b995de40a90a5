#!/usr/bin/env bash
# What a grid's spacing costs in the search, and what it is worth on paths that touch the molecule, for the grid alone
# and with the model beside it (branches.cpp): a table with a row for each grid.
#
#   tests/bench/spacing.sh BUILD MOLECULE SPACING...
#
# Ethanol, glycol and 2-butanol get their definitions from `hapgrid molecule`, and SPACING is in Å. The others have
# theirs in examples/molecule, and SPACING is the number of points along the longest side of its box. All grids of a
# molecule are measured on the same paths, 20 ticks for the spacing of the last one. CPU seconds are those of `expand`,
# user time of all its threads.
wanted=("${@:2}")
source "$(dirname "$0")/lib.sh"
export TIMEFORMAT=%U
declare -A smiles=([ethanol]=CCO [glycol]=OCCO [2-butanol]='CCC(C)O')

# search NAME DEFINITION OPTION_OF_SEED...: a grid, and its CPU seconds.
search() {
  seed "${@:2}" >first
  { time expand --complete -j 2 -o "$1.grid" first; } 2>seconds
  tail -n 1 seconds | xargs printf %.0f >"$1.seconds"
}

rows() { # MOLECULE SPACING...
  local spacing definition options name unit=points
  for spacing in "${@:2}"; do
    if [[ -n ${smiles[$1]-} ]]; then
      unit=Å
      hapgrid molecule --push --smiles "${smiles[$1]}" --spacing "$spacing" --until definition -j 2 -q -o "$1" >/dev/null
      search "$1, $spacing Å" "$1/$1.toml"
    else
      definition=$HAPGRID_SOURCE/examples/molecule/$1/$1.toml
      mapfile -t options < <(scaled "$definition" "$spacing")
      search "$1, $spacing points" "$definition" "${options[@]}"
    fi
  done
  for spacing in "${@:2}"; do
    name="$1, $spacing $unit"
    "$HAPGRID_BUILD/bench/bench_branches" "$name.grid" "$HAPGRID_BUILD/models" 0.3 5 1 "$1, ${*: -1} $unit.grid" |
      awk -F '\t' -v what="|$name|$(<"$name.seconds")|" '
        $1 != "paper" { what = what sprintf("%.1f %%|%.2f|", $3, $4) }
        END { print what }'
  done
}

echo '|grid|search, CPU s|grid alone: right|off|1 tick late: right|off|5 ticks late: right|off|'
echo '|---|---|---|---|---|---|---|---|'
rows "${wanted[@]}"
