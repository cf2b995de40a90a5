# Table 2 of the paper at 12 points a side: both molecules, verified; rounds in parts give the same
# bytes. Leu-enkephalin with 10 points, 3.2 Å apart, or fewer is too coarse: verify finds walks that return energy.
source "$(dirname "$0")/../../lib.sh"
sanitized && skip "it takes minutes; what it computes with is in unit/molecule, and smaller in cli/view/window"

molecules=$HAPGRID_SOURCE/examples/molecule
[[ $(seed "$molecules/alanine-dipeptide/alanine-dipeptide.toml" | stats --get box.counts) == '[30,30,30]' ]] ||
  fail "alanine dipeptide has no 30 points a side"
"$molecules/table2" 12 >table 2>err || fail "$(cat err)"
same "grids that were verified" 2 "$(grep -cE '^verify: fine: [0-9]+ checks' err)"
small=(--set 'grid.counts=[12,12,12]' --set "grid.spacing=$(stats --get box.spacing table2/alanine-dipeptide.grid)")
# The substep is fine enough: half of it changes the number of one-way links by less than 1 %, where four times as much
# changes it by 1.8 %.
seed "$molecules/alanine-dipeptide/alanine-dipeptide.toml" "${small[@]}" --set model.parameters.substep=0.025 |
  expand --complete -j 2 -o finer
awk -v a="$(stats --get one_way_links finer)" -v b="$(stats --get one_way_links table2/alanine-dipeptide.grid)" \
  'BEGIN { exit !(a > 0.99 * b && a < 1.01 * b) }' || fail "with half the substep: $(stats finer)"
hapgrid rounds "$molecules/alanine-dipeptide/alanine-dipeptide.toml" "${small[@]}" -o rounds.grid >out 2>err || fail "$(cat err)"
cmp rounds.grid table2/alanine-dipeptide.grid

# The table: the paper's two rows and ours, each with its columns.
same "lines" 5 "$(wc -l <table)"
grep -qE '^leu-enkephalin +1\.[0-9]{3} +0\.[0-9]{2} MB +[0-9.]+ s +[0-9]+ +[0-9.]+$' table ||
  fail "$(cat table)"
# Between one level a point and what a coarse grid of a soft molecule has.
awk '/^(alanine-d|leu)/ { if (!($2 >= 1.01 && $2 <= 1.6)) exit 1 }' table || fail "$(cat table)"
