#!/usr/bin/env bash
# What a grid's spacing and its tear fractions cost in the search, and what they are worth on paths that touch the
# molecule, for the grid alone and with the model beside it (branches.cpp): a table with a row for each grid. What
# stands before a slash is without tear fractions, and what stands behind it is with them.
#
#   tests/bench/spacing.sh [BUILD] [MOLECULE SPACING...]        (default: build, and the table of examples/guide/feel.md)
#
# Ethanol, glycol and 2-butanol get their definitions from `hapgrid molecule`, and SPACING is in Å. The others have
# theirs in examples/molecule, and SPACING is the number of points along the longest side of its box. CPU seconds are
# those of `expand`, user time of all its threads: 1,050 for the whole table.
wanted=("${@:2}")
source "$(dirname "$0")/lib.sh"
export TIMEFORMAT=%U
declare -A smiles=([ethanol]=CCO [glycol]=OCCO [2-butanol]='CCC(C)O')

row() { # WHAT DEFINITION OPTION_OF_SEED...
  local tears cost=()
  for tears in false true; do
    seed "$2" "${@:3}" --set search.tears=$tears >first
    { time expand --complete -j 2 -o all.grid first; } 2>seconds
    cost+=("$(tail -n 1 seconds | xargs printf %.0f)")
    "$HAPGRID_BUILD/bench/bench_branches" all.grid "$HAPGRID_BUILD/models" touch 0.3 5 1 20 5 2000 >tears-$tears
  done
  awk -F '\t' -v what="|$1|${cost[0]} / ${cost[1]}|" '
    NR == FNR { right[$2] = $4; off[$2] = $7; next }
    $2 != "paper" && $2 != "oracle" { what = what sprintf("%.1f / %.1f %%|%.2f / %.2f|", right[$2], $4, off[$2], $7) }
    END { print what sprintf("%.1f %%|", right["oracle"]) }' tears-false tears-true
}

rows() { # MOLECULE SPACING...
  local spacing definition options
  for spacing in "${@:2}"; do
    if [[ -n ${smiles[$1]-} ]]; then
      hapgrid molecule --push --smiles "${smiles[$1]}" --spacing "$spacing" --until definition -j 2 -q -o "$1" >/dev/null
      row "$1, $spacing Å" "$1/$1.toml"
    else
      definition=$HAPGRID_SOURCE/examples/molecule/$1/$1.toml
      mapfile -t options < <(scaled "$definition" "$spacing")
      row "$1, $spacing points" "$definition" "${options[@]}"
    fi
  done
}

echo '|grid|search, CPU s|grid alone: right|off|1 tick late: right|off|5 ticks late: right|off|oracle: right|'
echo '|---|---|---|---|---|---|---|---|---|'
if [[ ${#wanted[@]} != 0 ]]; then
  rows "${wanted[@]}"
  exit
fi
rows ethanol 0.35 0.45 0.5
rows glycol 0.45 0.5
rows 2-butanol 0.25 0.35 0.45 0.5
rows alanine-dipeptide 30 20
rows butane 40 30 20
rows leu-enkephalin 30
