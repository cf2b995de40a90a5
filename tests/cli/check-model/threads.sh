# A plug-in that is not thread-safe: check-model says so, with the way out, and that way gives the grid of one thread.
source "$(dirname "$0")/../lib.sh"

for name in shared crashes; do
  "${CC:-cc}" -std=c11 -D_POSIX_C_SOURCE=199309L $([[ $name == crashes ]] && echo -DCRASHES) -O1 -fPIC -shared \
    -I"$(hapgrid init --include)" "$here/shared.c" -o $name.so
  cat >$name.toml <<TOML
model = {plugin = "$name"}
grid = {origin = [-1, 0, 0], spacing = 1, counts = [3, 2, 2]}
search = {tears = true}
TOML
done
expect 3 '~.*together: C answers otherwise while two threads ask two models: they share data, which a plug-in must not have\. hapgrid rounds --parts N gives each model a process of its own.*' \
  '~check-model: broken: together .*' -- check-model shared.toml --model-path . --steps 60
expect 134 '' '~check-model: the model crashed \(signal 6\) in the conversion at point [0-9]+ level 0, direction [0-9]+ while two threads asked two models: they share data, which a plug-in must not have\. hapgrid rounds --parts N gives each model a process of its own' \
  -- check-model crashes.toml --model-path . --steps 60

seed shared.toml --model-path . -o seeds
expand --complete seeds --model-path . -o one
expect 0 '~.*' '' -- hapgrid rounds shared.toml --model-path . --parts 3
cmp one shared.grid
