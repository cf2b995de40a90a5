# What play does not take: one line on stderr, the exit code, and no log left behind.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
echo '0 0 0' >path

help='(see play --help)'
forms='path:FILE, keys, replay:FILE, hid:PROFILE, evdev[:WHICH], spacemouse[:WHICH], process:COMMAND'
cp grid kept
while IFS='|' read -r arguments said; do
  expect 2 '' "play: $said $help" -- play $arguments
done <<TABLE
|grid is required
grid|--device is required
grid --device falcon|--device: 'falcon' is not a device: $forms
grid --device path:|--device: 'path:' is not a device: $forms
- --device path:-|the grid and the device cannot both be standard input
grid --device process:|--device: 'process:' is not a device: $forms
grid --device process:true --rate 19|--rate: an adapter lets go of the hand below 20 Hz
grid --device path:path --rate 0|--rate: '0' is not a rate from 0.001 to 1000000 Hz
grid --device path:path --rate nan|--rate: 'nan' is not a rate from 0.001 to 1000000 Hz
grid --device path:path --rate 1e7|--rate: '1e7' is not a rate from 0.001 to 1000000 Hz
grid --device path:path --max-force -1|--max-force: '-1' is not a number from 0 to 1e+06 N
grid --device path:path --traversal best|--traversal: 'best' is not one of paper, branch, model
grid --device keys --beside 5|--beside: how late the model is for a live device cannot be chosen
grid --device path:path --traversal paper --beside on|--beside: only --traversal branch has branches between which to choose
grid --device path:path --beside 20ms|--beside: '20ms' is not on, off or a whole number of ticks from 1 to 10000
grid --device path:path --log ./grid|--log: would replace the grid
grid --device path:path --log ./path|--log: would replace the file that --device names
grid --device keys --log log|--log: a text log cannot be used with a live device; give a name that ends in .session
TABLE
expect 2 '' "play: --device: process: names no program $help" -- play grid --device 'process: '
cmp grid kept

# Paths; tests/unit/device has what is wrong in one.
printf '0 0 0\n# comment\n0 over 0\n' >word
expect 1 '' "play: word: line 3: 'over' is not a number" -- play grid --device path:word --log log
expect 1 '' "play: standard input: line 3: 'over' is not a number" -- play grid --device path:- <word
expect 1 '' "play: none: No such file or directory" -- play grid --device path:none

# Grids.
expect 1 '' "play: none.grid: No such file or directory" -- play none.grid --device path:path
seed "$ball" -o seeds
expect 1 '' "play: seeds: 8 records are still in the frontier: finish the grid with expand --complete" \
  -- play seeds --device path:path --log log
head -c 1000 grid >cut
refuses 'play: cut: .*' -- play cut --device path:path --log log

# Models. The directory beside a copy of play has none.
mkdir bin
cp "$HAPGRID_BUILD/bin/play" bin/
refuses "play: model hung-ball: no plug-in hung-ball.so in: $PWD/models .*" -- \
  bin/play grid --device path:path
cat >puppet.toml <<'TOML'
model.plugin = "puppet"
grid = {origin = [0, 0, 0], spacing = 0.5, counts = [2, 2, 2]}
search.max_levels = 1
TOML
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
seed puppet.toml | expand --complete -o puppet.grid
expect 1 '' "play: model puppet: has no force function, forces cannot be computed" \
  -- play puppet.grid --device path:path --log log
unset HAPGRID_MODEL_PATH

# Logs.
expect 1 '' "play: nowhere/log: No such file or directory" \
  -- play grid --device path:path --log nowhere/log
expect 1 '' "play: /dev/full: No space left on device" -- play grid --device path:path --log /dev/full

# An older session is lost only when play begins: not by a grid, device or log that is refused, nor
# by a signal while play still waits for a viewer.
echo 'an older session' >old.session
cp old.session kept
for command in 'cut --device path:path' 'grid --device path:word' 'grid --device process:false' \
  'grid --device path:path --frames nowhere/frames'; do
  # shellcheck disable=SC2086
  refuses 'play: .*' -- play $command --log old.session
  cmp old.session kept
done
play grid --device path:path --log old.session 2>stderr
cmp -s old.session kept && fail "the session was not written"
rm old.session kept stderr
nothing_left . bin cut grid path puppet.grid puppet.toml seeds word
