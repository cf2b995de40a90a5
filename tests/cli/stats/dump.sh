# The dump: a record a line, as design.md says it, whatever the locale.
source "$(dirname "$0")/../lib.sh"

# Two points in a row, one of them the seed of the other.
seed "$ball" --set 'grid.counts=[2,1,1]' --set 'grid.origin=[-0.9,0.0,0.0]' -o seeds
head="# i	j	k	level	s0$(printf '\td%s' {0..25})"
minus=$'\t-\t-\t-\t-\t-\t-\t-\t-\t-\t-\t-\t-'
t=$'\t'
expect 0 "$head
0${t}0${t}0${t}0${t}0$minus${t}-${t}?$minus
1${t}0${t}0${t}0${t}0$minus${t}?${t}-$minus" '' -- stats --dump seeds
expand --complete seeds -o grid
expect 0 "$head
0${t}0${t}0${t}0${t}0$minus${t}-${t}0$minus
1${t}0${t}0${t}0${t}0$minus${t}0${t}-$minus" '' -- stats --dump grid

# A grid in which the ball is pushed: every line has 31 columns, states agree with the stock tools'
# digits, and levels are what --get counts.
seed "$ball" | expand --complete -o ball.grid
stats ball.grid --dump >dump
awk -F'\t' 'NF != 31 { exit 1 }' dump || fail "columns of the dump"
same "lines" "$(stats ball.grid --get records)" "$(grep -vc "^#" dump)"
same "points" "$(stats ball.grid --get points)" "$(tail -n +2 dump | cut -f1-3 | sort -u | wc -l)"
awk -F'\t' 'NR > 1 && $5 != 0 && n++ < 50 { print $5 }' dump | while read -r digits; do
  same "17 digits" "$(LC_ALL=C printf '%.17g' "$digits")" "$digits"
done
# Ascending by (point, level), i fastest.
tail -n +2 dump | cut -f1-4 >keys
LC_ALL=C sort -c -t "$t" -k3,3n -k2,2n -k1,1n -k4,4n keys || fail "order of the dump"

comma=$(locale -a | grep -m1 -E '^(de|cs|fr)_' || true)
if [[ -n $comma ]]; then
  LC_ALL=$comma stats ball.grid --dump | cmp - dump || fail "dump in $comma"
fi
