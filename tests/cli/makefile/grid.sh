# Makefile.example's grid: any PARTS, parts that fail or get lost, a signal, a changed definition, two makes at once.
source "$(dirname "$0")/../lib.sh"

small="grid.counts=[12,6,6] grid.spacing=0.15"
driver=(make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL="$ball" HAPGRID_BIN="$HAPGRID_BIN")
build() { "${driver[@]}" SET="$small" "$@" >make.out 2>make.err; }
# fails REGEX OPTION...: the build ends with exit code 2, says such a line, and leaves no grid behind.
fails() {
  local code=0
  build "${@:2}" || code=$?
  [[ $code == 2 ]] || fail "exit code $code: ${*:2}"
  grep -qE "^$1\$" make.err || fail "$(cat make.err)"
  [[ ! -e work/hung-ball.grid ]] || fail "a grid after ${*:2}"
}
# reference SET: what one process makes of it.
reference() { seed "$ball" $(printf -- '--set %s ' $1) | expand --complete -o reference; }

reference "$small"
build PARTS=3 -j 2 || fail "$(cat make.err)"
cmp work/hung-ball.grid reference
[[ ! -s make.err ]] || fail "$(cat make.err)"
# A line a round, of which the last one finds tear fractions, and one at the end.
last=$(($(stats --get generation reference) + 1))
same "lines" $((last + 1)) "$(wc -l <make.out)"
same "first line" 'hung-ball: round 1 is for 8 records' "$(head -n 1 make.out)"
same "last line" "hung-ball: complete after $last rounds: work/hung-ball.grid" "$(tail -n 1 make.out)"
# The parts' costs add up to the conversions that the grid needed.
[[ $(stats work/hung-ball.grid --cost work/hung-ball.cost --get costs.conversions) == \
   $(stats work/hung-ball.grid --get conversions) ]]
nothing_left work hung-ball hung-ball.grid hung-ball.cost
nothing_left work/hung-ball cost.1 cost.2 cost.3 cost.merge lock seeds
# Repeated, it does nothing.
before=$(stat -c %y.%i work/hung-ball.grid)
build PARTS=5
[[ ! -s make.out && $(stat -c %y.%i work/hung-ball.grid) == "$before" ]] || fail "done twice: $(cat make.out)"

# Another definition: the search starts again, and the old grid is not taken for the new one.
small="grid.counts=[12,6,5] grid.spacing=0.15"
fails 'expand: .*--nonsense.*' PARTS=2 EXPAND=--nonsense
build PARTS=2 EXPAND='-j 2' || fail "$(cat make.err)"
seed "$ball" --set 'grid.counts=[12,6,5]' --set grid.spacing=0.15 | expand --complete | cmp - work/hung-ball.grid
# Removed, the grid is computed again.
rm work/hung-ball.grid
build && [[ -e work/hung-ball.grid ]] || fail "$(cat make.err)"

# A launcher that loses every ninth part, saying that all is well (0), or not (1): the others are
# made, and the same command makes what is missing.
small="grid.counts=[4,6,6] grid.spacing=0.15"
reference "$small"
cat >forgetful <<'END'
#!/bin/bash
exec 8>>count
flock 8
echo >>count
(($(wc -l <count) % 9)) || exit "$LOSS"
exec 8>&-
exec "$@"
END
chmod +x forgetful
for LOSS in 0 1; do
  export LOSS
  rm -rf work count
  said=0
  until build RUN=./forgetful PARTS=4 -j 2; do
    grep -qx 'hung-ball: this round failed; the same command goes on with what is missing' make.err || fail "$(cat make.err)"
    ((LOSS)) || grep -q '^work/hung-ball/0000[0-9].requests.[1-4]-of-4: its command ended well, but the file is not there$' make.err ||
      fail "$(cat make.err)"
    ((++said < 9)) || fail "it does not go on"
  done
  ((said > 0)) || fail "nothing was lost"
  cmp work/hung-ball.grid reference
  # Each part was made once.
  same "conversions" "$(stats reference --get conversions)" \
    "$(stats reference --cost work/hung-ball.cost --get costs.conversions)"
done

# With a signal that make sees, and afterwards another number of parts; kills.sh has SIGKILL. Not with SIGINT here: the
# shell ignores it in the background.
small="grid.counts=[12,6,6] grid.spacing=0.15"
reference "$small"
rm -rf work
setsid "${driver[@]}" SET="$small" PARTS=2 RUN='sleep 0.2;' -j 2 >/dev/null 2>&1 &
group=$!
wait_for 60 "second generation" test -e work/hung-ball/00002.grid
kill -TERM $group
wait $group 2>/dev/null || true
[[ ! -e work/hung-ball.grid ]] || fail "it was too late"
until build PARTS=5 -j 2; do grep -q 'another make is at work here' make.err || fail "$(cat make.err)"; done
cmp work/hung-ball.grid reference
! grep -q 'generation 0 ' make.out || fail "it began again"

# Two makes in one directory: the second ends with a line that says why, and touches nothing.
rm -r work/hung-ball.grid
(
  flock 8
  fails 'work/hung-ball: another make is at work here' PARTS=2
) 8>work/hung-ball/lock

# What failed is said, and nothing is taken for a grid.
fails 'no filters in "nowhere": .*' HAPGRID_BIN=nowhere
small="grid.spacing=0.3"
fails 'seed: grid.spacing 0.3 is too coarse.*' PARTS=2
small="grid.counts=[12,6,6] grid.spacing=0.15 search.max_levels=1"
fails 'merge: level limit: .*' PARTS=2
