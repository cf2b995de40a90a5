# A plug-in that is not thread-safe: check-model says so, with the way out, and that way gives the grid of one thread.
source "$(dirname "$0")/../lib.sh"

for name in shared crashes alone; do
  "${CC:-cc}" -std=c11 -D_POSIX_C_SOURCE=199309L $([[ $name == crashes ]] && echo -DCRASHES) $([[ $name == alone ]] && echo -DPROCESSES=1) -O1 -fPIC -shared \
    -I"$(hapgrid include)" "$here/shared.c" -o $name.so
  cat >$name.toml <<TOML
model = {plugin = "$name"}
grid = {origin = [-1, 0, 0], spacing = 1, counts = [3, 2, 2]}
TOML
done
export HAPGRID_MODEL_PATH=.
# Threads meet by chance; on a busy machine not always.
for attempt in 1 2 3 4 5; do
  (expect 3 '~.*together: C answers otherwise while two threads ask two models: they share data, which a plug-in must not have\. With info\.processes = 1 one thread asks one model, and hapgrid rounds --parts N gives each a process of its own.*' \
    '~check-model: broken: together .*' -- check-model shared.toml --steps 60) && break
  ((attempt < 5)) || fail 'two threads never met'
done
expect 134 '' '~check-model: the model crashed \(signal 6\) in the conversion at point [0-9]+ level 0, direction [0-9]+ while two threads asked two models: they share data, which a plug-in must not have\. With info\.processes = 1 one thread asks one model, and hapgrid rounds --parts N gives each a process of its own' \
  -- check-model crashes.toml --steps 60

seed shared.toml -o seeds
expand --complete seeds -o one
expect 0 '~.*' '' -- hapgrid rounds shared.toml --parts 3
cmp one shared.grid

# One that says it by itself: info.processes = 1.
expect 0 '~.*' '~check-model: fine: [0-9]+ checks' -- check-model alone.toml --steps 60
seed alone.toml -o seeds
expect 0 '' 'expand: the model wants no more than 1 of the 4 threads (processes = 1); hapgrid rounds --parts N uses more processors' \
  -- expand --complete seeds -j 4 -o alone.grid
cmp <(dump one) <(dump alone.grid)
expect 4 '~.*' 'verify: not proved: passive' -- verify alone.grid -j 4  # it has no energy
