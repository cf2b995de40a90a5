# The round of tear fractions: its parts, what it costs, what does not fit, and grids without it.
source "$(dirname "$0")/../lib.sh"

small=(--set 'grid.counts=[8,4,4]' --set grid.spacing=0.15 --set 'grid.origin=[-0.525,-0.225,-0.225]')
seed "$ball" "${small[@]}" -o seeds
expand --complete seeds --cost cost -o whole
cp seeds lacking
while (($(stats --get frontier lacking) > 0)); do expand lacking | merge lacking - -o lacking; done
links=$(stats --get one_way_links lacking)
((links > 100)) || fail "only $links one-way links"
expect 0 "$(stats --get records lacking)" '' -- stats lacking --get todo
expect 0 false '' -- stats lacking --get tears
stats lacking | grep -q '^one-way .*, whose tear fractions are still to be found$' || fail "$(stats lacking)"

# Parts share the links evenly, in any order, as files that are named and kept; a part may come twice.
for k in 3 1 2; do
  expect 0 '' '' -- expand lacking --part $k/3 -j $k -o 'part.{}' --cost cost.parts
done
same "content" tears "$(header part.1-of-3 content)"
decode part.*-of-3 | python3 -c '
import json, sys
counts = [len(m["tears"]["tears"]) for m in map(json.loads, sys.stdin) if "tears" in m]
assert sum(counts) == int(sys.argv[1]) and max(counts) - min(counts) <= 1, counts' "$links"
expect 0 '' '' -- merge part.2-of-3 lacking part.3-of-3 part.1-of-3 part.2-of-3 -o torn
cmp torn whole
expand lacking | merge lacking - | cmp - whole
expand --complete lacking -j 2 | cmp - whole
expect 0 0 '' -- stats torn --get todo
expect 0 true '' -- stats torn --get tears

# Its conversions are told apart from the search's: the first bisection takes two a link, the others one or two.
tears=$(stats whole --cost cost --get costs.tear_conversions)
((tears >= 6 * links && tears <= 10 * links)) || fail "$tears conversions for $links links"
expect 0 "$(stats whole --get conversions)" '' -- stats whole --cost cost --get costs.conversions
expect 0 "$tears" '' -- stats whole --cost cost.parts --get costs.tear_conversions

# What does not belong together.
lost='tear fractions are missing: [0-9]+ of the '$links' one-way links, the first of point .*; was a shard lost, or is one still to be expanded\?'
refuses "merge: $lost" -- merge lacking part.1-of-3 part.3-of-3 -o out
refuses "merge: $lost" -- merge lacking -o out
refuses 'merge: part\.1-of-3: tear fractions of generation [0-9]+, the grid.s frontier is 0' -- merge seeds part.1-of-3 -o out
refuses 'merge: part\.1-of-3: tear fractions, which the grid does not lack' -- merge torn part.1-of-3 -o out
refuses 'merge: part\.1-of-3: tear fractions, but no grid to merge them into' -- merge part.1-of-3 -o out
refuses 'expand: part\.1-of-3: holds tear fractions where a grid is needed' -- expand part.1-of-3 -o out
expand torn -o none
same "content" requests "$(header none content)"
refuses 'expand: part\.1-of-3 is there already, and holds no requests for generation [0-9]+ of this grid: remove it first' -- \
  expand torn --part 1/3 -o 'part.{}'

# A definition without them: what the search finds is the same, and the grid is complete without them.
seed "$ball" "${small[@]}" --set search.tears=false | expand --complete --cost cost.without -o without
cmp <(dump without) <(dump whole)
expect 0 0 '' -- stats without --get todo
expect 0 0 '' -- stats without --cost cost.without --get costs.tear_conversions
merge without | cmp - without
refuses 'merge: .*: another grid than .*: whether it has tear fractions' -- merge without part.1-of-3 -o out
echo '-0.5 0 0' >path
for grid in without lacking whole; do expect 0 '' '~play: .*' -- play $grid --device path:path --log log; done
