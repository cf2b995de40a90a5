# Options from the table [play] of a TOML file, which may be the MODEL.toml; the command line counts
# more. The mapping's own numbers are in tests/unit/haptic.
source "$(dirname "$0")/../lib.sh"
cp "$ball" model.toml
cat >>model.toml <<'TOML'
[play]
max-force = 0.05
ramp = 0
blend = 0
slew = inf
axes = "-z,x,y"
offset = [0.1, 0, 0]
model-path = ["models"]
TOML
ln -s "$HAPGRID_BUILD/models" models
# The other filters pass over the table.
seed model.toml --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete | cmp - grid
for i in {-90..90}; do echo "$(printf '%de-2' "$i") 0 0"; done >path
play grid --device path:path --max-force 0.05 --ramp 0 --blend 0 --slew inf --log here 2>/dev/null
play grid --config model.toml --device path:path --log there 2>err
cmp here there
grep -q ' 0.05 N sent; safety, in ticks: clamped' err || fail "$(cat err)"
play grid --config model.toml --device path:path --max-force 0.1 2>err
grep -q ' 0.1 N sent' err || fail "the command line counts more: $(cat err)"

wrong() { # LINE MESSAGE
  printf '[play]\n%s\n' "$1" >wrong.toml
  expect 2 '' "~play: $2 \\(see play --help\\)" -- play grid --config wrong.toml --device path:path
}
wrong 'max-forse = 1' '.*max-forse.*'
wrong 'max-force = -1' "--max-force: '-1' is not a force from 0 to 1000000 N"
wrong 'axes = "x,x,y"' "--axes: 'x,x,y' is not like -z,x,y"
wrong 'realtime = "perhaps"' "--realtime: 'perhaps' is not require, try or off"
wrong 'realtime = 1' "--realtime: '1' is not require, try or off"
wrong 'slew = 1 2' '--config: line 2: .*'
wrong 'slew = 2020-01-01' '--config: play.slew must be a number, a text, true or false, or an array'
expect 2 '' "~play: .*none.toml.* \\(see play --help\\)" -- play grid --config none.toml --device path:path
expect 2 '' "play: --scale: '-1' is not a scale from 0 to 1e15 (see play --help)" \
  -- play grid --device path:path --scale -1
