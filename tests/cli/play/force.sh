# The force of a play: what it comes from, and grids that are played without their model.
source "$(dirname "$0")/../lib.sh"
coarse=(--set grid.spacing=0.1 --set 'grid.counts=[20,10,10]')
seed "$ball" "${coarse[@]}" | expand --complete -o grid
seed "$ball" "${coarse[@]}" --set 'search.store=["energy","force","shape"]' | expand --complete -o stored
[[ $(stats stored) == *"force, energy, shape of 49 spheres"* ]] || fail "stats: $(stats stored)"
for i in {-60..40}; do echo "$(printf '%de-2' "$i") 0.012 0.03"; done >path
summary='~play: 101 ticks, [^:]*: .*
play: ticks outside the box 0, .*
play: largest force .*'
used() { python3 -c 'import json; print(json.load(open("report"))["force"])'; }

# It comes from what the traversal implies, of a replay, too.
for words in '' '--traversal paper' '--traversal model'; do
  # shellcheck disable=SC2086  # words are split
  play grid --device path:path --beside off $words --report report --log "a$words" 2>/dev/null
  # shellcheck disable=SC2086
  expect 0 '' "$summary" -- play grid --device path:path --beside off $words --log a.session
  expect 0 '' "$summary" -- play grid --device replay:a.session --log b
  cmp "a$words" b >&2
  used
done >rules
[[ $(md5sum a a-* | cut -d ' ' -f 1 | sort -u | wc -l) == 3 ]] || fail "rules with the same forces: $(md5sum a a-*)"
same rules $'energy\nstate\nstate' "$(cat rules)"

# Without the plug-in, from what the grid stores: the same forces. Stored numbers are the model's own, so
# nothing is rounded on the way.
mkdir -p alone/bin alone/models
cp "$HAPGRID_BUILD/bin/play" alone/bin
play grid --device path:path --beside off --log evaluated 2>/dev/null
expect 0 '' "$summary" -- alone/bin/play stored --device path:path --log taken --report report
same rule energy "$(used)"
cmp <(cut -f 1-7 evaluated) <(cut -f 1-7 taken)

# An energy of the wrong sign; no energy; a grid too small to tell.
python3 - <<'PYTHON'
import os, sys
sys.path.insert(0, os.environ["HAPGRID_SOURCE"] + "/tests/cli/verify")
import planting
grid = planting.Grid(planting.read("stored"))
for row in grid.rows:
    row["energy"] = [-e for e in row["energy"]]
open("spoilt", "wb").write(grid.seal())
PYTHON
seed "$ball" "${coarse[@]}" --set 'search.store=["force"]' | expand --complete -o dull
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[2,2,2]' | expand --complete -o small
refused() { # GRID REASON
  expect 0 '' "~play: $2: the forces of the records are interpolated
${summary:1}" -- play "$1" --device path:path --report report
  same rule records "$(used)"
}
refused spoilt 'the energies do not tell of the forces \(off by [0-9.]+ N with the energy, 0\.[0-9]+ N without\), since the grid is too coarse or the force is not their gradient; verify says which'
refused dull 'no energy is known'
summary='~play: 101 ticks, [^:]*: .*
play: ticks outside the box [0-9]+, .*
play: largest force .*' refused small 'the grid is too small to compare force and energy'
verify stored --recompute none 2>/dev/null | grep '^gradient .* 0  note$' >/dev/null || fail "verify: stored"
# Where forces are interpolated, nobody knows what a closed walk gains.
expect 4 '~.*
gradient .* 1  note
.*' 'verify: not proved: passive' -- verify spoilt --recompute none

stores() { expect 1 '' "$2" -- seed "$ball" --set "search.store=$1"; }
stores '["heat"]' '~.*search.store names heat; energy, force and shape are possible'
stores 1 '~.*search.store must be an array.*'
