# Makefile.example's grid: any PARTS, interruptions, a changed definition, two makes at once.
source "$(dirname "$0")/../lib.sh"

small="grid.counts=[12,6,6] grid.spacing=0.15"
build() {
  make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL="$ball" HAPGRID_BIN="$HAPGRID_BIN" \
    SET="$small" "$@" >make.out 2>make.err || return
}
reference() {
  seed "$ball" $(printf -- '--set %s ' $1) | expand --complete -o reference
}

reference "$small"
build PARTS=3 -j 2 || fail "$(cat make.err)"
cmp work/hung-ball.grid reference
# Repeated, it does nothing.
before=$(stat -c %Y.%i work/hung-ball.grid)
build PARTS=3 -j 2
[[ ! -s make.out && $(stat -c %Y.%i work/hung-ball.grid) == "$before" ]] || fail "done twice: $(cat make.out)"
# The last whole generations stay, everything else is cleaned up.
[[ $(ls work/hung-ball | grep -c '\.grid$') -eq 2 && -z $(ls work/hung-ball | grep requests) ]]
# The reports add up to the conversions that the grid needed.
[[ $(stats work/hung-ball.grid --reports work/hung-ball/report --get reports.conversions) == \
   $(stats work/hung-ball.grid --get conversions) ]]

# Killed in the middle, with another number of parts afterwards.
rm -rf work
setsid make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL="$ball" HAPGRID_BIN="$HAPGRID_BIN" \
  SET="$small" PARTS=2 RUN='sleep 0.02;' -j 2 >/dev/null 2>&1 &
group=$!
until [[ -e work/hung-ball/0002.grid ]]; do sleep 0.02; done
kill -KILL -- -$group
wait $group 2>/dev/null || true
[[ ! -e work/hung-ball.grid ]]
generation=$(ls work/hung-ball | grep -c '^000[2-9].grid')
[[ $generation -gt 0 ]]
build PARTS=5 -j 2 || fail "$(cat make.err)"
cmp work/hung-ball.grid reference
! grep -q 'generation 0,' make.out || fail 'it began again'

# Another definition: the search starts again.
small="grid.counts=[12,6,5] grid.spacing=0.15"
reference "$small"
build PARTS=2 || fail "$(cat make.err)"
cmp work/hung-ball.grid reference

# Two makes in one directory: one of them ends with a line that says why.
exec 8>work/hung-ball/lock
flock -n 8
small="grid.counts=[12,5,5] grid.spacing=0.15"
! build PARTS=2 || fail 'it worked in a locked directory'
grep -q 'work/hung-ball: another make is at work here' make.err
exec 8>&-

# What failed is said, and nothing is taken for a grid.
small="grid.spacing=0.3"
! build PARTS=2 || fail 'it took a spacing beyond d_max'
grep -q 'seed: grid.spacing 0.3 is too coarse' make.err
small="grid.counts=[12,6,6] grid.spacing=0.15 search.max_levels=1"
! build PARTS=2 || fail 'it went beyond the level limit'
grep -q 'merge: level limit: ' make.err
[[ ! -e work/hung-ball.grid ]]
