# expand --complete keeps a whole generation beside its output, and goes on from it: after the level limit, an
# error of the model, and a kill. The grid has the same bytes in the end.
source "$(dirname "$0")/../lib.sh"
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins

toy() { # PARAMETERS COUNTS SEARCH
  printf 'model = {plugin = "toy", parameters = {%s}}\nsearch = {%s}\n' "$1" "$3"
  echo "grid = {origin = [0, 0, 0], spacing = 1, counts = [$2]}"
}
# rounds_of SEEDS N FILE: the grid after N rounds of expand and merge.
rounds_of() {
  cp "$1" "$3"
  for ((g = 0; g < $2; ++g)); do
    expand -j 4 "$3" | merge "$3" - -o "$3.new"
    mv "$3.new" "$3"
  done
}
generation() { stats out.partial --get generation; }

# The level limit. What is kept is what rounds of expand and merge have made.
toy 'milliseconds = 8, tolerance = 0.1' 40,2,2 'max_levels = 8' | seed - -o limited
limit='expand: level limit: .*; out\.partial keeps generation [0-9]+, from which the same command goes on'
limit+=', also when the grid is seeded with a larger search\.max_levels'
refuses "$limit" -- expand --complete limited -j 4 -o out
last=$(generation)
((last >= 1)) || fail "only generation $last is kept"
rounds_of limited $last rounds
cmp out.partial rounds
# With the same limit it ends again; with a larger one it goes on.
from='expand: goes on from generation [0-9]+, which out\.partial keeps'
expect 1 '' "~$from"$'\n'"$limit" -- expand --complete limited -j 4 -o out
(($(generation) >= last)) || fail "a generation was lost"
toy 'milliseconds = 8, tolerance = 0.1' 40,2,2 'max_levels = 12' | seed - -o wide
expand --complete wide -j 32 -o direct 2>/dev/null
expect 0 '' "~$from" -- expand --complete wide -j 32 -o out --cost cost
cmp out direct
[[ ! -e out.partial ]] || fail "it stays after success"
(($(tail -1 cost | grep -oP '"conversions":\K[0-9]+') < $(stats out --get conversions))) || fail "nothing was saved"
rm out

# Nothing is kept of a pipe, nor in the first second.
box=(--set grid.counts=[40,6,6] --set grid.origin=[-0.975,-0.125,-0.125])
seed "$ball" "${box[@]}" --set search.max_levels=1 -o limited
refuses 'expand: level limit: .* than its tolerance, or .*' -- bash -c 'set -o pipefail; expand --complete limited | cat'
refuses 'expand: level limit: .* than its tolerance, or .*' -- expand --complete limited -o /dev/null
refuses 'expand: level limit: .* than its tolerance, or .*' -- expand --complete limited -o out
[[ ! -e out.partial ]] || fail "kept in the first second"

rounds_of limited 3 rounds
for levels in 2 8; do
  seed "$ball" "${box[@]}" --set search.max_levels=$levels -o wide
  expand --complete wide -o direct
  cp rounds out.partial
  expect 0 '' 'expand: goes on from generation 3, which out.partial keeps' -- expand --complete wide -o out
  cmp out direct
  [[ ! -e out.partial ]] || fail "it stays after success"
done
rm out

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
other 'did not grow from other, which has other seeds or is of a later generation' \
  --set seeds.points=[[-0.975,-0.125,-0.125]]
rounds_of wide 5 later
refuses 'expand: out\.partial: did not grow from later, .*; remove it to begin anew' -- expand --complete later -o out
cp later out.partial
refuses 'expand: out\.partial: was found with a level limit of 8, which is now 1; remove it to begin anew' -- \
  expand --complete limited -o out
head -c 1000 rounds >out.partial
refuses 'expand: out\.partial: .*truncated.*' -- expand --complete wide -o out
rm out.partial

# An error of the model, in the middle of the box.
toy 'fail = 19, milliseconds = 8' 40,2,2 'max_levels = 100' | seed - -o seeds
refuses 'expand: conversion at .*: told to fail; out\.partial keeps .*, from which the same command goes on' -- \
  expand --complete seeds -j 8 -o out
last=$(generation)
((last >= 1)) || fail "only generation $last is kept"
rounds_of seeds $last rounds
cmp out.partial rounds
rm out.partial

# SIGKILL at any moment, also while the file is written: the one before is there, and nothing is lost.
kills=0
toy 'milliseconds = 1' 6,6,6 'max_levels = 100' | seed - -o slow
expand --complete slow -j 8 -o direct
for delay in 1.1 1.3 1.5; do
  before=$(generation 2>/dev/null || echo 0)
  expand --complete slow -j 4 -o out 2>>err &
  tool=$!
  sleep $delay
  kill -KILL $tool 2>/dev/null || break
  wait $tool 2>/dev/null || true
  ((++kills))
  rm -f .hapgrid.??????
  [[ ! -e out ]] || fail "half a grid"
  [[ $before == 0 ]] || (($(generation) >= before)) || fail "a generation was lost"
done
((kills >= 2)) || fail "only $kills kills"
expand --complete slow -j 8 -o out 2>>err
cmp out direct

# A signal: the tool says what is kept, and how to go on.
rm -f out out.partial
notice='expand: stops after the conversions that are under way; once more: at once'
for signal in INT TERM HUP; do
  rm -f out.partial err # of the signal before
  # A job in the background of a script ignores SIGINT.
  env --default-signal=$signal expand --complete slow -j 4 -o out 2>err &
  tool=$!
  wait_for 60 "checkpoint" test -e out.partial
  kill -$signal $tool
  code=0
  wait $tool || code=$?
  same "exit code after SIG$signal" $((128 + $(kill -l $signal))) $code
  [[ ! -e out ]] || fail "half a grid"
  last=$(generation)
  ((last >= 1)) || fail "only generation $last is kept after SIG$signal"
  same "what is said after SIG$signal" "$notice
expand: interrupted; out.partial keeps generation $last, from which the same command goes on" "$(cat err)"
done
expect 0 '' "expand: goes on from generation $last, which out.partial keeps" -- expand --complete slow -j 8 -o out
cmp out direct
evidence() { cat err; }
rm out
# Before anything is whole, and when the model does not answer: the second signal ends it.
cat >good.toml <<TOML
model = {name = "puppet", process = ["python3", "$HAPGRID_SOURCE/tests/unit/model/processes/puppet.py"]}
grid = {origin = [0, 0, 0], spacing = 1, counts = [5, 5, 5]}
seeds = {points = [[0, 0, 0]]}
TOML
sed 's/puppet.py"/puppet.py", "hang"/' good.toml >hangs.toml
seed good.toml --allow-process -o puppets
rm err
HANGS=$PWD/hangs expand --complete puppets --allow-process hangs.toml -o out 2>err &
tool=$!
wait_for 20 "question" test -e hangs
kill -TERM $tool
wait_for 10 "notice" grep -qF "$notice" err
kill -TERM $tool
code=0
wait $tool || code=$?
same "exit code after two signals" 143 $code
[[ ! -e out && ! -e out.partial ]] || fail "something was kept"
same "temporary files" '' "$(compgen -G '.hapgrid.*')"

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
  -- bash -c "trap '' XFSZ; ulimit -f 1; exec expand --complete slow -j 4 -o out"
[[ ! -e out && ! -e out.partial ]] || fail "something was left"
