# The stiffness that `hapgrid molecule` chooses for a grid that breaks a rule; python/test_stiffness.py has the rule itself.
source "$(dirname "$0")/../lib.sh"

# A verify that finds a fault the first time: the anchors become half as stiff, and the next time it is fine.
mkdir filters
ln -s "$HAPGRID_BIN"/* filters
rm filters/verify
cat >filters/verify <<END
#!/bin/bash
[[ -e $PWD/was ]] && exec "$HAPGRID_BIN/verify" "\$@"
touch "$PWD/was"
cp methanol.toml "$PWD/first.toml"
exit 3
END
chmod +x filters/verify
methanol=(molecule --push --smiles CO --method gfnff --spacing 1.5 -o methanol)
HAPGRID_BIN=$PWD/filters expect 0 '~hapgrid feel .*' '~.*breaks a rule: .*: anchors half as stiff are tried.*' -- "${methanol[@]}"
number() { sed -n "s/^$2_stiffness = \([0-9.]*\) .*/\1/p" "$1"; }
same "shift" '50 25' "$(number first.toml shift) $(number methanol/methanol.toml shift)"
same "least rotation" '100 100' "$(number first.toml rotation) $(number methanol/methanol.toml rotation)"
# Again, it is known.
HAPGRID_BIN=$PWD/filters expect 0 '~hapgrid feel .*' '' -- "${methanol[@]}" --quiet
same "shift" 25 "$(number methanol/methanol.toml shift)"

# twisted counts the same records as the dump has: i j k level, t, shift ...
dump methanol/methanol.grid | awk '!/^#/ { n++; touched = $6 || $7 || $8; contact += touched
    points[$1, $2, $3]; if ($5 > 0.5) { all++; twisted += touched } }
  END { printf "%.2f\t%.1f\t%.3f\tmethanol/methanol.grid\n", 100 * all / n, 100 * twisted / contact, n / length(points) }' >counted
same "twisted" "$(cat counted)" "$("$HAPGRID_SOURCE/examples/molecule/twisted" methanol/methanol.grid | tail -n 1)"
[[ $(cut -f 1 counted) != 0.00 ]] || fail "nothing is twisted: $(cat counted)"

# A path with which the model gives up is left out. What expand says has no part in that: the file of --cost has a word.
rm filters/expand
cat >filters/expand <<END
#!/bin/bash
[[ -e $PWD/gave-up ]] && exec "$HAPGRID_BIN/expand" "\$@"
touch "$PWD/gave-up"
while [[ \$1 != --cost ]]; do shift; done
echo '{"cpu_seconds": 0, "failed": "model"}' >"\$2"
echo 'expand: anything' >&2
exit 1
END
chmod +x filters/expand
HAPGRID_BIN=$PWD/filters expect 0 '~NOTHING TURNS in this grid; .*hapgrid feel .*' \
  '~.*H3-C1-O2-H6 is left out: with it the molecule does not come to rest.*' -- \
  "${methanol[@]::${#methanol[@]}-1}" rigid

# So is one with which the grid breaks a rule, however soft the anchors are. Its report is kept.
ln -sf "$HAPGRID_BIN/expand" filters/expand
cat >filters/verify <<END
#!/bin/bash
grep -q transition_states *.toml && echo 'snaps   256 one-way links   34  broken' && exit 3
exec "$HAPGRID_BIN/verify" "\$@"
END
HAPGRID_BIN=$PWD/filters expect 0 '~NOTHING TURNS in this grid; H3-C1-O2-H6: with it the grid breaks the rule snaps: see verify-H3-C1-O2-H6\.txt; try --spacing below [0-9.]+.*' \
  '~.*H3-C1-O2-H6 is left out: with it the grid breaks the rule snaps.*' -- "${methanol[@]::${#methanol[@]}-1}" broken
grep -q '34  broken' broken/verify-H3-C1-O2-H6.txt || fail "the report is not kept"
