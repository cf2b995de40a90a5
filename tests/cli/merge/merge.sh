# A generation's requests into the grid; a finished grid that is stored small.
source "$(dirname "$0")/../lib.sh"

# Two points: each finds the state at 0 of the other.
seed "$ball" --set 'grid.counts=[2,1,1]' -o two
expand two -o two.requests
expect 0 '' '' -- merge two two.requests -o merged
same "records" '{"records":{"point":[0,1],"level":[0,0],"generation":[0,0],"state":[0,0],"links":[255,255,255,255,255,255,255,255,255,255,255,255,255,0,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,255,0,255,255,255,255,255,255,255,255,255,255,255,255,255]}}' \
  "$(decode merged | sed -n 2p | sed 's/-0\([],]\)/0\1/g')"
same "generation" 1 "$(header merged generation)"

# A grid whose frontier is empty stays as it is, byte by byte, with or without (empty) requests.
merge merged | cmp - merged
expand merged -o none
merge merged none | cmp - merged
merge none merged - <none | cmp - merged

# A larger one.
seed "$ball" -o grid
for ((g = 0; g < 24; ++g)); do
  expand grid | merge grid - -o next
  mv next grid
done
expand grid -o requests
merge grid requests -o next

# A finished grid, small: the same content in larger chunks, which merge leaves as they are.
expand --complete next -o grown
expect 0 '' '' -- merge --small grown -o small
merge --small - <grown | cmp - small
(($(stat -c %s small) < 3 * $(stat -c %s grown) / 4)) || fail "not small: $(wc -c small grown)"
for what in '--npy -' '--get records' '--get generation'; do
  # shellcheck disable=SC2086
  stats $what small | cmp - <(stats $what grown)
done
expect 0 "$(verify grown -j 2 --format json)" '~verify: .*' -- verify small -j 2 --format json
merge small | cmp - small
merge --small small | cmp - small
expand --complete small | cmp - grown
refuses 'merge: next: [0-9]+ records are still in the frontier; only a finished grid can be made small' -- merge --small next

# The next grid may replace the one it was made from.
cp grid same
merge same requests -o same
cmp same next
