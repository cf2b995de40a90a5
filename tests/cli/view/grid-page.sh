# The page that plays a grid by itself, view --html GRID. In node its player gives each number that play gives, on hands
# drawn anew in each run. In a browser without a screen, from a file, mouse and finger push until the model snaps; no request
# leaves; play repeats the saved path to the bit. Docking, whose states have an orientation, is in cli/docking/docking.sh.
source "$(dirname "$0")/../lib.sh"
unset DISPLAY WAYLAND_DISPLAY
mkdir tmp
export TMPDIR=$PWD/tmp
node_test() { # GRID: compares, and prints its snaps and what it took
  local seed=$((RANDOM * 32768 + RANDOM))
  view --html "$1.html" "$1"
  node "$here/player.mjs" draw $seed "$1.html" >"$1.path"
  play "$1" --device "path:$1.path" --beside off --log "$1.log" 2>/dev/null
  echo "$1: seed $seed: $(node "$here/player.mjs" compare "$1.html" "$1.path" "$1.log")" | tee -a compared
}
hung_ball() { seed "$ball" "$@" | expand --complete; }
hung_ball --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' >ball
# hapgrid feel: the same page, kept or in a new temporary file; words are those of view.
expect 2 '' 'hapgrid: feel: which grid? (see hapgrid --help)' -- hapgrid feel
expect 2 '' 'hapgrid: feel: -o: which file? (see hapgrid feel --help)' -- hapgrid feel ball -o
mkdir bare 'a b'
cp "$HAPGRID_BUILD"/bin/{hapgrid,feel,seed} bare
refuses 'hapgrid: feel: view is not built: make -f Makefile.example build' -- bare/hapgrid feel ball
refuses 'view: nowhere: No such file or directory' -- hapgrid feel nowhere
expect 2 '' '~view: .*--nonsense.*' -- hapgrid feel ball --nonsense
nothing_left tmp
cp ball 'a b/ball'
expect 0 '' 'hapgrid: feel: open in a browser: a b/kept.html' -- hapgrid feel 'a b/ball' -o 'a b/kept.html' --style sticks
expect 0 '' '' -- view --html sticks.html --style sticks ball
cmp 'a b/kept.html' sticks.html
expect 0 '' "~hapgrid: feel: open in a browser: $TMPDIR/hapgrid-feel\.[^/]*/feel\.html \(-o FILE\.html keeps it\)(.hapgrid: feel: only root can .*)?" -- hapgrid feel ball
view --html ball.html ball
cmp tmp/hapgrid-feel.*/feel.html ball.html
hapgrid feel ball -o - | cmp - ball.html

needs node nodejs
hung_ball --set grid.spacing=0.1 --set 'grid.counts=[20,1,10]' --set 'grid.origin=[-1,0,-0.5]' >flat
# Without an energy, the forces of the records are interpolated; here shape and force are stored.
hung_ball --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' --set 'search.store=["force","shape"]' >stored
seed "$HAPGRID_SOURCE/examples/molecule/dichloroethane/dichloroethane.toml" --set grid.spacing=1.1 \
  --set 'grid.counts=[13,11,11]' --set 'grid.origin=[-6.6,-5.5,-5.5]' | expand --complete >molecule
for grid in ball flat stored molecule; do node_test $grid; done
[[ $(sed -E 's/.*: ([0-9]+) snaps.*/\1/' compared | sort -n | tail -n 1) != 0 ]] || fail "nothing snaps"
# The same bytes, also from standard input but for the name; a page is small; what never moves is stored once.
view --html - ball | cmp - ball.html
view --html - <ball | sed 's/"grid":"hung-ball"/"grid":"ball"/' | cmp - ball.html
(($(stat -c %s ball.html) < 400000)) || fail "large: $(stat -c %s ball.html) bytes"
grep -E '<(script|img|iframe)[^>]*(src|href)|@import|url\(' ball.html && fail "loads from elsewhere"

for option in '' --web '--html x.html --png x.png'; do
  # shellcheck disable=SC2086  # words
  expect 2 '' '~view: ball: is a grid, of which --html alone makes something, .*' -- view ball $option
done
seed "$ball" >unfinished
refuses 'view: unfinished: .* grid points have no level.*|view: unfinished: .* records are still in the frontier.*' -- view unfinished --html x.html
hung_ball --set grid.spacing=0.02 --set 'grid.counts=[100,50,50]' >fine
refuses "view: fine: 49 spheres at [0-9]+ records need [0-9.]+ MB of a browser's memory, and 256 MB is the most: a grid of a spacing of 0\.02[0-9]* rope lengths would fit" \
  -- view fine --html x.html
[[ ! -e x.html ]] || fail "a page all the same"

needs chromium chromium
push() { # GRID WIDTH: to the bit the same by play
  rm -rf hapgrid-path.txt
  /usr/bin/python3 "$here/feel.py" "$PWD/$1.html" "$2" >felt 2>err || fail "$(cat err)"
  cat felt
  play "$1" --device path:hapgrid-path.txt --beside off --log again.log 2>/dev/null
  tail -n 1 felt | /usr/bin/python3 -c '
import json, sys
last = json.loads(input())
rows = [line.split("\t") for line in open("again.log")]
names, rows = rows[0], [list(map(float, row)) for row in rows[1:]]
assert len(rows) == last["ticks"], (len(rows), last)
sent = names.index("sent_x")
assert rows[-1][1:4] == last["hip"] and rows[-1][sent:sent + 3] == last["force"], (rows[-1], last)
assert sum(row[-1] for row in rows) == last["snaps"] > 0, last'
  node "$here/player.mjs" compare "$1.html" hapgrid-path.txt again.log
}
in_time err push ball 1300
in_time err push ball 390
in_time err push molecule 1300
# Without WebGL the curves go on, and the key n and a button go on to the next level.
bare() { /usr/bin/python3 "$here/feel.py" "$PWD/ball.html" 600 bare 2>err || fail "$(cat err)"; }
in_time err bare
