#!/bin/bash
# Tasks that stay: one that dies with a shard in hand, and a driver that dies.
source "$(dirname "$0")/../../cli/lib.sh"

cat >tasks <<'END'
#!/bin/bash
for task in 1 2 3; do "$@" & done
wait
END
chmod +x tasks
sed 's/^plugin = .*/plugin = "sleeper"/; s/^radius/milliseconds = 20\nradius/' "$ball" >hung-ball.toml
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
small=(grid.counts=[4,6,6] grid.spacing=0.15)
seed hung-ball.toml "${small[@]/#/--set=}" | expand --complete -j 32 -o reference
build() {
  exec make -s -f "$HAPGRID_SOURCE/Makefile.example" grid MODEL=hung-ball.toml HAPGRID_BIN="$HAPGRID_BIN" \
    SET="${small[*]}" PAUSE=1 MODE=claim RUN=./tasks PARTS=6 >make.out 2>make.err
}
# of_task NAME: processes of this test's tasks.
of_task() { pgrep -f "$PWD/work/hung-ball/[^ ]*/$1" >/dev/null; }
evidence() { cat make.err; }

# The task and what it runs, so that its claim is all that is left of it; the others go on, and after a
# minute one of them makes its shard.
build &
driver=$!
# expanding: a `task` at work on a shard of round 1, its own process `maker` for that, and the filter that
# stays with it, `victim`.
expanding() {
  local round=(work/hung-ball/*/0001.round.6x1) all
  compgen -G "${round[0]}/step.*/[1-6]" >/dev/null && [[ ! -e ${round[0]}/merge ]] || return
  all=" $(pgrep -d ' ' -f "^/bin/bash $PWD/work/hung-ball/[^ ]*/shard --stay") "
  for maker in $all; do
    task=$(ps -o ppid= -p "$maker" | tr -d ' ')
    [[ $all == *" $task "* ]] && victim=$(pgrep -P "$task" -f '/expand .*--serve') && return
  done
  return 1
}
wait_for 60 "shard of round 1" expanding
kill -KILL "$task" "$maker" "$victim"
wait $driver || fail "$(cat make.err)"
cmp work/hung-ball.grid reference
same "what was said" '~hung-ball: generation 1: [1-6] is handed out again, its task does not answer' \
  "$(grep -v Killed make.err)"
wait_for 5 "end of the tasks" eval '! of_task shard'

# Without its driver, a task ends by itself, and leaves its shard whole.
rm -rf work
build &
driver=$!
wait_for 60 "shard of round 1" expanding
kill -KILL "$(pgrep -P $driver)" $driver
wait $driver 2>/dev/null || true
wait_for 90 "end of the tasks" eval '! of_task shard'
(build) || fail "$(cat make.err)"
cmp work/hung-ball.grid reference
