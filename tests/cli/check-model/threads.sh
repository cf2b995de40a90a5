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
expect 3 '~.*together: C answers otherwise while two threads ask two models: they share data, which a plug-in must not have\. expand --processes N gives each model a process of its own.*' \
  '~check-model: broken: together .*' -- check-model shared.toml --model-path . --steps 60
expect 134 '' '~check-model: the model crashed \(signal 6\) in the conversion at point [0-9]+ level 0, direction [0-9]+ while two threads asked two models: they share data, which a plug-in must not have\. expand --processes N gives each model a process of its own' \
  -- check-model crashes.toml --model-path . --steps 60

seed shared.toml --model-path . -o seeds
expand --complete seeds --model-path . -o one
expect 0 '' '' -- expand --complete seeds --model-path . --processes 3 -o three --cost cost
cmp one three
expand --complete - --model-path . --processes 2 <seeds | cmp - one
(($(wc -l <cost) >= 4)) || fail "few costs: $(cat cost)"
expect 0 '' '' -- expand seeds --model-path . --processes 2 -o requests
merge seeds requests --model-path . -o second
expand seeds --model-path . | merge seeds - --model-path . | cmp - second
# What fails is said once, and nothing is left.
refuses 'expand: model shared: no plug-in shared\.so in: .*' -- expand --complete seeds --processes 3 -o none
expect 2 '' '~expand: --processes: .*' -- expand seeds --model-path . --processes 2 --part 1/2 -o none
expect 2 '' '~expand: --processes: .*' -- expand seeds --model-path . --processes 0 -o none
nothing_left . shared.so crashes.so shared.toml crashes.toml seeds one three cost requests second
