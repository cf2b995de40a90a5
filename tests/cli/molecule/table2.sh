#!/bin/bash
# Table 2 of the paper at 12 points a side: both molecules through shards, verified; the bytes do not
# depend on the number of parts.
source "$(dirname "$0")/../lib.sh"
sanitized && skip "it takes minutes; what it computes with is in unit/molecule, and smaller in cli/view/window"

molecules=$HAPGRID_SOURCE/examples/molecule
for m in alanine-dipeptide leu-enkephalin; do
  toml=$molecules/$m/$m.toml
  seed "$toml" -o seeds
  # The shipped box with fewer points.
  h=$(awk "BEGIN { printf \"%.17g\", $(stats --get box.spacing seeds) * 29 / 11 }")
  [[ $(stats --get box.counts seeds) == '[30,30,30]' ]] || fail "$m has no 30 points a side"
  make -s -f "$HAPGRID_SOURCE/Makefile.example" -j2 grid MODEL="$toml" WORK=work PARTS=3 \
    SET="grid.spacing=$h grid.counts=[12,12,12]" HAPGRID_BIN="$HAPGRID_BIN" >/dev/null
  grid=work/$m.grid
  expect 0 '~.*' '~verify: fine: [0-9]+ checks' -- \
    verify "$grid" --recompute $(($(stats --get records "$grid") / 100 + 1))
  # The substep is fine enough: at most one conversion in a thousand depends on it.
  "$HAPGRID_BUILD/bench/bench_substeps" "$grid" 200 >substeps
  awk -F '[(%]' '/^substep/ { seen = 1; if ($2 > 0.1) exit 1 } END { exit !seen }' substeps || fail "$(tail -n 1 substeps)"
done
seed "$molecules/alanine-dipeptide/alanine-dipeptide.toml" --set "grid.counts=[12,12,12]" \
  --set "grid.spacing=$(stats --get box.spacing work/alanine-dipeptide.grid)" |
  expand --complete -j 2 | cmp - work/alanine-dipeptide.grid

# The table: the paper's two rows and ours, each with its columns.
"$molecules/table2" "$HAPGRID_BIN/stats" work alanine-dipeptide leu-enkephalin >table
same "lines" 5 "$(wc -l <table)"
grep -qE '^leu-enkephalin +1\.[0-9]{3} +0\.[0-9]{2} MB +[0-9.]+ s +[0-9]+ +[0-9.]+$' table ||
  fail "$(cat table)"
# Between one level a point and what a coarse grid of a soft molecule has.
awk '/^(alanine-d|leu)/ { if (!($2 >= 1.01 && $2 <= 1.6)) exit 1 }' table || fail "$(cat table)"
