# Makefile.example's grid: any PARTS and MODE, interruptions, a changed definition, two makes at once.
source "$(dirname "$0")/../lib.sh"

small="grid.counts=[12,6,6] grid.spacing=0.15"
driver=(make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL="$ball" HAPGRID_BIN="$HAPGRID_BIN" PAUSE=0)
build() {
  "${driver[@]}" SET="$small" "$@" >make.out 2>make.err || return
}
reference() {
  seed "$ball" $(printf -- '--set %s ' $1) | expand --complete -o reference
}

reference "$small"
build PARTS=3 -j 2 || fail "$(cat make.err)"
cmp work/hung-ball.grid reference
[[ ! -s make.err ]] || fail "$(cat make.err)"
# A line a generation: its frontier, the share of the box, the rate.
last=$(($(stats --get generation reference) - 1))
same "lines" $((last + 2)) "$(wc -l <make.out)"
line='~hung-ball: generation 0, frontier of 8 records, 1\.9 % of the box reached'
same "first line" "$line" "$(head -n 1 make.out)"
line="~hung-ball: generation $last, frontier of [0-9]+ records, 100\.0 % of the box reached, [1-9][0-9]* conversions/s"
same "line" "$line" "$(tail -n 2 make.out | head -n 1)"
# Repeated, it does nothing.
before=$(stat -c %Y.%i work/hung-ball.grid)
build PARTS=3 -j 2
[[ ! -s make.out && $(stat -c %Y.%i work/hung-ball.grid) == "$before" ]] || fail "done twice: $(cat make.out)"
# The last whole generation stays, everything else is cleaned up.
nothing_left work hung-ball hung-ball.grid hung-ball.report
end=$(printf %04d $((last + 1)))
nothing_left work/hung-ball/*/ "$end.complete" "$end.whole" "report.$HOSTNAME" shard
# The reports add up to the conversions that the grid needed.
[[ $(stats work/hung-ball.grid --reports work/hung-ball.report --get reports.conversions) == \
   $(stats work/hung-ball.grid --get conversions) ]]

# Less of it, for the ways there. Shards handed out in other ways: three tasks that claim them, and numbers on standard input.
cat >three-tasks <<'END'
#!/bin/bash
for task in 1 2 3; do "$@" & done
wait
END
chmod +x three-tasks
small="grid.counts=[4,6,6] grid.spacing=0.15"
reference "$small"
build WORK=claim MODE=claim RUN=./three-tasks PARTS=7 || fail "$(cat make.err)"
cmp claim/hung-ball.grid reference
# Each shard was made once.
[[ $(stats reference --reports claim/hung-ball.report --get reports.conversions) == \
   $(stats reference --get conversions) ]]
build WORK=alone MODE=claim PARTS=2 || fail "$(cat make.err)"
cmp alone/hung-ball.grid reference
build WORK=list MODE=list RUN='xargs -P 2 -n 2' PARTS=5 EXPAND='-j 2' || fail "$(cat make.err)"
cmp list/hung-ball.grid reference
parallel=$(command -v parallel || true)
if [[ $parallel ]]; then
  build WORK=gnu MODE=list RUN='parallel -j 2' PARTS=5 || fail "$(cat make.err)"
  cmp gnu/hung-ball.grid reference
fi
! build WORK=bad MODE=magic || fail 'it took an unknown mode'
grep -q "MODE is make, claim, list or array, not 'magic'" make.err

# A tool that loses every ninth task, saying that all is well, or not; and one that loses them all.
cat >forgetful <<'END'
#!/bin/bash
exec 8>>count
flock 8
echo >>count
(($(wc -l <count) % 9)) || exit ${FORGETFUL:-0}
exec 8>&-
exec "$@"
END
chmod +x forgetful
build WORK=lost RUN=./forgetful PARTS=4 -j 2 || fail "$(cat make.err)"
cmp lost/hung-ball.grid reference
grep -q 'expanded\.[0-9]: it was said to be there, and is not' make.err
grep -q 'hung-ball: generation [0-9]*: 1 of 4 shards are missing, again in 0 s' make.err
FORGETFUL=1 build WORK=lost2 RUN=./forgetful PARTS=4 -j 2 || fail "$(cat make.err)"
cmp lost2/hung-ball.grid reference
FORGETFUL=9 build WORK=lost3 MODE=list RUN='xargs -n 1 ./forgetful' PARTS=4 || fail "$(cat make.err)"
cmp lost3/hung-ball.grid reference
! build WORK=lost4 MODE=claim RUN='true' PARTS=9 TRIES=2 || fail 'a grid of nothing'
same "what is missing" 'hung-ball: generation 0: 9 of 9 shards are missing: 1-9' "$(sed -n '/1-9/p' make.err)"

# What expand refuses is tried once more, and no more.
! build WORK=refused RUN=env EXPAND=--nonsense PARTS=2 || fail 'expand knows --nonsense'
[[ $(grep -c 'again in 0 s' make.err) -eq 1 && $(grep -c '^expand: ' make.err) -eq 4 ]] || fail "$(cat make.err)"
! build WORK=bad RUN='./nobody -x' || fail 'it started a tool that is not there'
grep -q '^RUN: no command \./nobody$' make.err

# Killed in the middle: all of it, only the make, or with a signal it can see. Afterwards another
# number of parts. What is left running at the time does no harm.
small="grid.counts=[12,6,6] grid.spacing=0.15"
reference "$small"
for how in group make TERM; do
  rm -rf work
  # Not here with SIGINT: the shell ignores it in the background.
  setsid "${driver[@]}" SET="$small" PARTS=2 RUN='sleep 0.2;' -j 2 >/dev/null 2>&1 &
  group=$!
  until compgen -G 'work/hung-ball/*/0002.whole' >/dev/null; do sleep 0.02; done
  case $how in
    group) kill -KILL -- -$group ;;
    make) kill -KILL $group ;;
    TERM) kill -TERM $group ;;
  esac
  wait $group 2>/dev/null || true
  [[ ! -e work/hung-ball.grid ]]
  # Killed alone, make leaves a driver behind, which may have the lock.
  until build PARTS=5 -j 2; do grep -q 'another make is at work here' make.err || fail "$how: $(cat make.err)"; done
  cmp work/hung-ball.grid reference
  ! grep -q 'generation 0,' make.out || fail "$how: it began again"
done

# Another definition: the search starts again, and the grid of the old one is not taken for it. Back
# again, all is there.
small="grid.counts=[12,6,5] grid.spacing=0.15"
! build PARTS=2 EXPAND=--nonsense || fail 'expand knows --nonsense'
[[ ! -e work/hung-ball.grid ]] || fail 'a grid of another definition'
build PARTS=2 || fail "$(cat make.err)"
cmp work/hung-ball.grid <(seed "$ball" --set 'grid.counts=[12,6,5]' --set grid.spacing=0.15 | expand --complete)
small="grid.counts=[12,6,6] grid.spacing=0.15"
build PARTS=2 || fail "$(cat make.err)"
cmp work/hung-ball.grid reference
same "what it did" '~hung-ball: complete after [0-9]+ generations: work/hung-ball.grid' "$(cat make.out)"

# Two makes in one directory: one of them ends with a line that says why.
exec 8>work/hung-ball/lock
flock -n 8
small="grid.counts=[12,5,5] grid.spacing=0.15"
! build PARTS=2 || fail 'it worked in a locked directory'
grep -q 'work/hung-ball: another make is at work here' make.err
# The grid that the other one has finished meanwhile stays.
cat >flock <<'END'
#!/bin/bash
cp reference work/hung-ball.grid
exit 1
END
chmod +x flock
rm work/hung-ball.grid
! PATH=$PWD:$PATH build PARTS=2 || fail 'it worked in a locked directory'
cmp work/hung-ball.grid reference
exec 8>&-

# What failed is said, and nothing is taken for a grid.
small="grid.spacing=0.3"
! build PARTS=2 || fail 'it took a spacing beyond d_max'
grep -q 'seed: grid.spacing 0.3 is too coarse' make.err
small="grid.counts=[12,6,6] grid.spacing=0.15 search.max_levels=1"
! build PARTS=2 || fail 'it went beyond the level limit'
grep -q 'merge: level limit: ' make.err
[[ ! -e work/hung-ball.grid ]]
