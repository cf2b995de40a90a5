# What play does not take: one line on stderr, the exit code, and no log left behind.
source "$(dirname "$0")/../lib.sh"
plugins=$HAPGRID_BUILD/tests/plugins
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
seed "$ball" --set 'grid.counts=[4,3,2]' | expand --complete -o small
export PYTHONPATH=$HAPGRID_SOURCE/tests/cli/verify
echo '0 0 0' >path
cat >puppet.toml <<'TOML'
model.plugin = "puppet"
grid = {origin = [0, 0, 0], spacing = 0.5, counts = [2, 2, 2]}
search.max_levels = 1
TOML
echo 'an older session' >old.session
cp grid grid.kept
cp old.session kept
forms='path:FILE, keys, replay:FILE, hid:PROFILE, evdev[:WHICH], spacemouse[:WHICH], process:COMMAND'
refusals "$here/refuse.tsv"
input() {
  sed "$1" "$here/good.toml" >p
  ! cmp -s "$here/good.toml" p || fail "no edit: $1"
}
refusals "$here/profile.tsv" 'play grid --device hid:p'
cmp grid grid.kept
cmp old.session kept
play grid --device path:path --log old.session 2>stderr
cmp -s old.session kept && fail "the session was not written"
nothing_left . bad.grid bin cut grid grid.kept kept old.session p path puppet.grid puppet.toml seeds small stderr word
