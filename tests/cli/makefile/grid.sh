# Makefile.example's grid: make starts the parts of hapgrid rounds, as many at a time as -j allows, and each by RUN; a
# signal to make ends all of it. rounds/rounds.sh has names of any letters, and what is not make's.
source "$(dirname "$0")/../lib.sh"
small='--set grid.counts=[4,6,6] --set grid.spacing=0.15'
seed "$ball" $small | expand --complete -o reference
driver=(make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL="$ball" HAPGRID_BIN="$HAPGRID_BIN" OPTIONS="$small")

# RUN counts how many parts are at work.
cat >counting <<'END_OF_IT'
#!/bin/bash
mkdir -p at-work
touch at-work/$$
find at-work -type f | wc -l >>most
sleep 0.05
"$@"
rm at-work/$$
END_OF_IT
chmod +x counting
expect 0 '~work/hung-ball.grid: round 1 is for 8 records.*' '' -- "${driver[@]}" PARTS=4 RUN=./counting -j 2
cmp work/hung-ball.grid reference
same "parts at a time" 2 "$(sort -n most | tail -n 1)"
same "parts" $((4 * $(stats --get generation reference))) "$(wc -l <most)"
expect 0 'work/hung-ball.grid: is complete' '' -- "${driver[@]}"

# A part that fails: the others are made, and the same command goes on.
rm -r work
expect 2 '~.*' '~(.*\[.*part-2\] Error 1.*)rounds: work/hung-ball.grid: round 1 failed \(parts: 2 of 3\): .*' -- \
  "${driver[@]}" PARTS=3 RUN='[[ -e again || $* != 2 ]] &&'
touch again
expect 0 '~.*' '' -- "${driver[@]}" PARTS=3
cmp work/hung-ball.grid reference

# A signal to make.
rm -r work
setsid "${driver[@]}" PARTS=2 RUN='echo $$$$ >sleeping; sleep 1234;' -j 2 >/dev/null 2>&1 &
wait_for 60 "part" test -s sleeping
kill -TERM $!
wait $! || true
wait_for 20 "end of the part" eval '[[ $(ps -o stat= -p "$(cat sleeping)") != [!Z]* ]]'
expect 0 '~.*' '' -- "${driver[@]}" PARTS=5 -j 2
cmp work/hung-ball.grid reference

expect 2 '' "~no filters in 'nowhere': make build first.*" -- "${driver[@]}" HAPGRID_BIN=nowhere
expect 2 '' '~.*SET=: give OPTIONS in its place.*' -- "${driver[@]}" SET=grid.spacing=1
expect 2 '' '~rounds: .*--nonsense.*' -- make -s -f "$HAPGRID_SOURCE/Makefile.example" grid OPTIONS=--nonsense HAPGRID_BIN="$HAPGRID_BIN"
