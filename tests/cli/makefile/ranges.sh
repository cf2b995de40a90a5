# Makefile.example's rounds in several ranges of points: only those are rewritten that the frontier
# touches, and PARTS and RANGES may change in the middle.
source "$(dirname "$0")/../lib.sh"

# 36 planes, and seeds in the first 16: from there the search reaches one more plane a round at most.
points=
for z in -0.525 -0.315 -0.075; do
  for x in -0.465 -0.165 0.165 0.465; do
    for y in -0.465 -0.165 0.165 0.465; do points+="[$x,$y,$z],"; done
  done
done
small="grid.counts=[32,32,36] grid.spacing=0.03 grid.origin=[-0.465,-0.465,-0.525] seeds.points=[${points%,}]"
seed "$ball" $(printf -- '--set %s ' $small) | expand --complete -o reference

# It stops where STOP says, as one that is killed does.
cat >until <<'END'
#!/bin/bash
[[ $2 < $STOP ]] && exec "$@"
END
chmod +x until
build() {
  make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL="$ball" HAPGRID_BIN="$HAPGRID_BIN" PAUSE=0 TRIES=1 \
    SET="$small" RUN=./until -j 2 "$@" >make.out 2>make.err
}
state() { ls work/hung-ball/*/*.whole; }
# merges GENERATION: the merges that led to it.
merges() { grep -c "\"tool\":\"merge\",\"generation\":$1," work/hung-ball/*/report.*; }

# Until generation 8: three ranges of 12 planes.
! STOP=0008 build PARTS=2 RANGES=3 || fail "it went on"
same "state" "~work/hung-ball/[^/]*/0008.whole" "$(state)"
same "ranges" 3 "$(wc -l <"$(state)")"
# The first round cuts the seeds' grid. The last range is 9 rounds away; until then, its shard stays
# what it is.
same "merges" "3 2 2 2 2 2 2 2" "$(for g in 1 2 3 4 5 6 7 8; do merges $g; done | paste -sd ' ')"
same "the last range" 3,0001,0,0,0,0001 "$(sed -n 3p "$(state)" | tr '\t' ,)"
same "its layers and those of the others" "0001 0002 0003 0004 0005 0006 0007 0008" "$(sed -n 1p "$(state)" | cut -f 6)"
nothing_left work/hung-ball/*/ $(awk -F '\t' '
    { for (i = split($6, layer, " "); i; --i) print layer[i] ".grid." $1 "-of-3"
      if ($5 > 0) print "0008.frontier." $1 "-of-3" }' "$(state)") \
  0008.whole 0008.round.2x3 "report.$HOSTNAME" shard
# What the table says is what the shards hold.
directory=$(dirname "$(state)")
same "frontier" "$(stats --get frontier "$directory"/0*.{grid,frontier}.*)" "$(awk '{ n += $4 } END { print n }' "$(state)")"
same "conversions" "$(stats --get conversions_left "$directory"/0*.{grid,frontier}.*)" "$(awk '{ n += $5 } END { print n }' "$(state)")"
same "points" "$(stats --get points_reached "$directory"/0*.{grid,frontier}.*)" "$(awk '{ n += $3 } END { print n }' "$(state)")"

# The ninth layer is not one more: the range is written anew.
! STOP=0009 build PARTS=2 RANGES=3 || fail "it went on"
same "layers" "0009" "$(sed -n 1p "$(state)" | cut -f 6)"

# Two ranges from here on, and other parts; then as many as there can be, to the end.
! STOP=0011 build PARTS=5 RANGES=2 || fail "it went on"
grep -q 'generation 9,' make.out && ! grep -q 'generation 8,' make.out || fail "it began again: $(cat make.out)"
same "ranges" 2 "$(wc -l <"$(state)")"
same "points" "$(stats --get points_reached "$directory"/0*.{grid,frontier}.*)" "$(awk '{ n += $3 } END { print n }' "$(state)")"
STOP=9999 build PARTS=3 RANGES=1000 || fail "$(cat make.err)"
cmp work/hung-ball.grid reference
