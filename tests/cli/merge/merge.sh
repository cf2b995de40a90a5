#!/bin/bash
# A generation's requests into the grid, and the next frontier beside it.
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

# A larger one with its frontier.
seed "$ball" -o grid
for ((g = 0; g < 12; ++g)); do
  expand grid | merge grid - -o next
  mv next grid
done
expand grid -o requests
merge grid requests -o next
expect 0 '' '' -- merge grid requests -o with --frontier 'frontier.{}.{}' --parts 3
cmp with next
mkdir parts
expect 0 '' '' -- merge grid requests -o with --frontier parts/{} --parts 100
cmp with next
same "files" 100 "$(ls -A parts | wc -l)"
nothing_left . two two.requests merged none grid requests next with parts \
  'frontier.1.{}' 'frontier.2.{}' 'frontier.3.{}'
expand next -o whole
expand parts/* | cmp - whole
expand frontier.* | cmp - whole
# The shards take equally much work, and one after the other they are the frontier in order.
for k in $(seq 100); do
  decode parts/$k | tail -n 1 | sed 's/.*"conversions":"\([0-9]*\)".*/\1/'
done | sort -n | sed -n '1p;$p' | { read -r least; read -r most; ((most - least <= 1)); } ||
  fail "unequal frontier shards"

# Frontier of nothing: shards that are empty, and expand takes them.
merge merged --frontier 'nothing.{}' --parts 2 | cmp - merged
expand nothing.1 nothing.2 | cmp - none

# Grid shards: merge reads what together is one grid.
expect 0 '' '' -- merge two two.requests -o /dev/null

# The next grid may replace the one it was made from.
cp grid same
merge same requests -o same
cmp same next
