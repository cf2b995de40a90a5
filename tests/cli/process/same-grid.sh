# A model as a process: the one in Python finds what the plug-in finds, and the grid does not depend on how its processes
# worked. Answers in another order and processes that die are in unit/model, questions at a time in python/test_serve.py.
source "$(dirname "$0")/../lib.sh"
example=$HAPGRID_SOURCE/examples/hung-ball
toml=$example/hung-ball-process.toml
small='--set grid.counts=[8,4,4] --set grid.spacing=0.15 --set grid.origin=[-0.525,-0.225,-0.225]'
allow="--allow-process $toml"

# The same records as the plug-in's. A dump's columns: i j k level, the state, 26 levels.
expect 0 '' '' -- seed "$toml" $small --allow-process -o seeds
expect 0 '' '' -- expand --complete seeds $allow -o grid
seed "$ball" $small | expand --complete >plugin.grid
[[ $(stats --get records grid) -gt 128 ]] || fail "no point has two levels"
cmp <(dump grid | cut -f 1-31) <(dump plugin.grid | cut -f 1-31)

# The same bytes with more copies, and in rounds, where only
# expand needs the process. In another directory the command still runs beside its definition.
mkdir elsewhere
expect 0 '' '' -- env -C elsewhere "$HAPGRID_BIN/expand" --complete ../seeds $allow -j 3 -o ../grid.3
cmp grid grid.3
rounds seeds round $allow -j 2
cmp grid round

# In parts, of which each starts a process.
hapgrid rounds "$toml" --allow-process --parts 2 -o parts.grid --set grid.counts=[8,4,4] --set grid.spacing=0.15 \
  --set grid.origin=[-0.525,-0.225,-0.225] >out 2>&1 || fail "$(cat out)"
cmp grid parts.grid

# What is played is what is stored.
echo '-0.5 0 0' >path
expect 0 '' '~play: .*' -- play grid --device path:path --log log

# What needs no process: checks of what is stored, statistics.
verify grid --recompute none >report 2>err || fail "$(cat err)"
same "verdict" '~verify: .*' "$(cat err)"
same "norm" max "$(stats --get norm grid)"
[[ $(stats grid) == *'hung-ball-py, a process'* ]] || fail "stats does not say what the model is"
# C asked again, and the force of each record.
for threads in 1 2; do
  verify grid --recompute 40 $allow -j $threads >report.$threads 2>err || fail "$(cat report.$threads err)"
done
cmp report.1 report.2
grep -q 'fidelity' report.1
