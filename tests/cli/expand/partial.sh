#!/bin/bash
# expand --complete keeps the last whole generation beside its output, and goes on from it: after the level
# limit, an error of the model, and a kill. The grid has the same bytes in the end.
source "$(dirname "$0")/../lib.sh"
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins

# The level limit. What is kept is what rounds of expand and merge have made.
box=(--set grid.counts=[40,6,6] --set grid.origin=[-0.975,-0.125,-0.125])
seed "$ball" "${box[@]}" --set search.max_levels=1 -o limited
limit='expand: level limit: .*; out\.partial keeps generation [0-9]+, from which the same command goes on'
limit+=', also when the grid is seeded with a larger search\.max_levels'
refuses "$limit" -- expand --complete limited -o out
last=$(stats out.partial --get generation)
((last >= 3)) || fail "only generation $last is kept"
cp limited rounds
for ((g = 0; g < last; ++g)); do
  expand rounds | merge rounds - -o rounds.new
  mv rounds.new rounds
done
cmp out.partial rounds
expand rounds | merge rounds - -o next 2>/dev/null && fail "one more round was whole"
# With the same limit it ends there again; with a larger one it goes on.
from="expand: goes on from generation $last, which out\.partial keeps"
expect 1 '' "~$from"$'\n'"$limit" -- expand --complete limited -o out
cmp out.partial rounds
for levels in 2 8; do
  seed "$ball" "${box[@]}" --set search.max_levels=$levels -o wide
  expand --complete wide -o direct
  cp rounds out.partial
  expect 0 '' "~$from" -- expand --complete wide -o out --cost cost
  cmp out direct
  [[ ! -e out.partial ]] || fail "it stays after success"
done
(($(tail -1 cost | grep -oP '"conversions":\K[0-9]+') < $(stats out --get conversions))) || fail "nothing was saved"

# Nothing is kept of a pipe, or when nothing was found.
refuses 'expand: level limit: .* than its tolerance' -- bash -c 'set -o pipefail; expand --complete limited | cat'
refuses 'expand: level limit: .* than its tolerance' -- expand --complete limited -o /dev/null
rm -f out

# A file of another definition, of other seeds, of a lower level limit, of something else: it is refused.
cp rounds out.partial
other() { # MESSAGE SEED-OPTION...
  seed "$ball" "${box[@]}" --set search.max_levels=8 "${@:2}" -o other
  refuses "expand: out\.partial: $1; remove it to begin anew" -- expand --complete other -o out
  cmp out.partial rounds
  [[ ! -e out ]] || fail "a grid"
}
other 'another grid than other: .*radius.*' --set model.parameters.radius=0.09
other 'another grid than other: .*' --set grid.counts=[40,6,5]
other 'another grid than other: .*' --set search.tears=false
other 'did not grow from other, which has other seeds or is of a later generation' \
  --set seeds.points=[[-0.975,-0.125,-0.125]]
expand --complete wide -o out --keep 30 2>/dev/null && cp out whole && cp rounds out.partial && rm out
expand wide | merge wide - -o later
for ((g = 0; g <= last; ++g)); do expand later | merge later - -o later.new && mv later.new later; done
refuses 'expand: out\.partial: did not grow from later, .*; remove it to begin anew' -- expand --complete later -o out
cp whole out.partial
refuses 'expand: out\.partial: did not grow from wide, .*; remove it to begin anew' -- expand --complete wide -o out
cp later out.partial
refuses 'expand: out\.partial: was found with a level limit of 8, which is now 1; remove it to begin anew' -- \
  expand --complete limited -o out
head -c 1000 rounds >out.partial
refuses 'expand: out\.partial: .*truncated.*' -- expand --complete wide -o out
rm out.partial

# An error of the model, in a process that is mended then.
cat >good.toml <<TOML
model = {name = "puppet", process = ["python3", "$HAPGRID_SOURCE/tests/unit/model/processes/puppet.py"]}
grid = {origin = [0, 0, 0], spacing = 1, counts = [5, 5, 5]}
seeds = {points = [[0, 0, 0]]}
TOML
sed 's/puppet.py"/puppet.py", "fail", "200"/' good.toml >fails.toml
seed good.toml --allow-process -o seeds
expand --complete seeds --allow-process good.toml -o direct
refuses 'expand: conversion at .*: told to fail; out\.partial keeps generation [0-9]+, from which the same command goes on' \
  -- expand --complete seeds --allow-process fails.toml -o out
expand --complete seeds --allow-process good.toml -o out 2>/dev/null
cmp out direct
rm out

# In the search for tear fractions, which alone asks at x = 0.5: all generations are kept.
toy() { # PARAMETER SIDE OPTION
  printf 'model = {plugin = "toy", parameters = {%s}}\nsearch = {max_levels = 100, %s}\n' "$1" "$3"
  echo "grid = {origin = [0, 0, 0], spacing = 1, counts = [$2, $2, $2]}"
}
toy 'fail = 0.5' 4 tears=true | seed - -o seeds
refuses 'expand: tear fraction of .*: told to fail; out\.partial keeps .*, from which the same command goes on' -- \
  expand --complete seeds -o out
rounds seeds all 2>/dev/null || true
cmp out.partial all
rm out.partial

# SIGKILL at any moment, also while the file is written: the one before is there, and nothing is lost.
kills=0
toy 'milliseconds = 0.1' 4 tears=false | seed - -o seeds
expand --complete seeds -o direct
for delay in 0.05 0.1 0.15 0.2; do
  before=$(stats out.partial --get generation 2>/dev/null || echo 0)
  expand --complete seeds -o out --keep 0 2>>err &
  tool=$!
  sleep $delay
  kill -KILL $tool 2>/dev/null || break
  wait $tool 2>/dev/null || true
  ((++kills))
  [[ ! -e out ]] || fail "half a grid"
  [[ $before == 0 ]] || (($(stats out.partial --get generation) >= before)) || fail "a generation was lost"
done
((kills >= 3)) || fail "only $kills kills"
if [[ ! -e out.partial ]]; then # a slow machine has no generation so soon
  expand --complete seeds -o out --keep 0 2>>err &
  tool=$!
  while kill -0 $tool 2>/dev/null && [[ ! -e out.partial ]]; do sleep 0.02; done
  kill -KILL $tool 2>/dev/null || true
  wait $tool 2>/dev/null || true
fi
[[ -e out.partial ]] || fail "nothing was kept"
expect 0 '' '~expand: goes on from generation [0-9]+, which out\.partial keeps' -- expand --complete seeds -o out
cmp out direct
grep -qxE 'expand: out\.partial keeps generation [0-9]+ and later ones: after an interruption the same command goes on from it' err

# A signal in the first 30 s: the last whole generation is kept, and the tool says how to go on.
rm -f out out.partial
toy 'milliseconds = 1' 6 tears=false | seed - -o slow
expand --complete slow -j 8 -o slow.direct
notice='expand: stops after the conversions that are under way; once more: at once'
for signal in INT TERM HUP; do
  rm -f out.partial err # of the signal before: it has what is waited for
  # A job in the background of a script ignores SIGINT.
  env --default-signal=$signal expand --complete slow -j 4 -o out --progress 2>err &
  tool=$!
  wait_for 60 "second generation" grep -sq 'generation [23],' err
  kill -$signal $tool
  code=0
  wait $tool || code=$?
  same "exit code after SIG$signal" $((128 + $(kill -l $signal))) $code
  [[ ! -e out ]] || fail "half a grid"
  last=$(stats out.partial --get generation)
  ((last >= 1)) || fail "only generation $last is kept after SIG$signal"
  tr '\r' '\n' <err | sed 's/^\x1b\[K//' >lines
  grep -qF "$notice" lines || fail "$(cat err)"
  same "the last line after SIG$signal" "expand: interrupted; out.partial keeps generation $last, \
from which the same command goes on" "$(tail -1 lines)"
done
expect 0 '' "expand: goes on from generation $last, which out.partial keeps" -- expand --complete slow -j 8 -o out
cmp out slow.direct
evidence() { cat err; }
rm out
# Before anything is whole, and when the model does not answer: the second signal ends it.
sed 's/puppet.py"/puppet.py", "hang"/' good.toml >hangs.toml
seed good.toml --allow-process -o puppets
rm err
expand --complete puppets --allow-process hangs.toml -o out --progress 2>err &
tool=$!
wait_for 20 "question" grep -sq 'generation 0' err
kill -TERM $tool
wait_for 10 "notice" grep -qF "$notice" err
kill -TERM $tool
code=0
wait $tool || code=$?
same "exit code after two signals" 143 $code
[[ ! -e out && ! -e out.partial ]] || fail "something was kept"

# A link that somebody has put there leads nowhere.
echo precious >elsewhere
ln -s elsewhere out.partial
refuses 'expand: out\.partial: is no regular file; remove it to begin anew' -- expand --complete seeds -o out
rm out.partial
mkfifo out.partial
refuses 'expand: out\.partial: is no regular file; remove it to begin anew' -- expand --complete seeds -o out
rm out.partial
same "what the link named" precious "$(cat elsewhere)"

# A disk that has no room for it: the search goes on as long as it can.
expect 1 '' '~expand: cannot keep what is found: out\.partial: File too large'$'\n''expand: out: File too large' \
  -- bash -c "trap '' XFSZ; ulimit -f 1; exec expand --complete seeds -o out --keep 0"
[[ ! -e out && ! -e out.partial ]] || fail "something was left"
