# Settings: keys of --set, and the table [play] of a TOML file, which may be the MODEL.toml; the command
# line counts more. The mapping's own numbers are in tests/unit/haptic.
source "$(dirname "$0")/../lib.sh"
cp "$ball" model.toml
cat >>model.toml <<'TOML'
[play]
max-force = 0.05
axes = "-z,x,y"
model-path = ["models"]
[play.safety]
ramp = 0
slew = inf
[play.mapping]
offset = [0.1, 0, 0]
TOML
ln -s "$HAPGRID_BUILD/models" models
# The other filters pass over the table.
seed model.toml --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete | cmp - grid
for i in {-90..90}; do echo "$(printf '%de-2' "$i") 0 0"; done >path
# --set takes one value each: the grid behind it is the grid.
play --max-force 0.05 --set safety.ramp=0 --set safety.slew=inf grid \
  --device path:path --log here 2>/dev/null
play grid --config model.toml --device path:path --log there 2>err
cmp here there
grep -q ' 0.05 N sent; safety, in ticks: clamped' err || fail "$(cat err)"
play grid --config model.toml --device path:path --max-force 0.1 2>err
grep -q ' 0.1 N sent' err || fail "the command line counts more: $(cat err)"
# One key of the command line changes that key alone.
play grid --config model.toml --device path:path --set safety.ramp=1e6 2>err
grep -qE '; safety, in ticks: ramped 181$' err || fail "the command line counts more: $(cat err)"

help='\(see play --help\)'
wrong() { # LINE MESSAGE
  printf '[play]\n%s\n' "$1" >wrong.toml
  expect 2 '' "~play: $2 $help" -- play grid --config wrong.toml --device path:path
}
wrong 'max-forse = 1' "--config: line 2: unknown key 'max-forse'; did you mean '--max-force'\?"
wrong 'max-force = -1' "--max-force: '-1' is not a number from 0 to 1e\+06 N"
wrong 'axes = "x,x,y"' "--axes: 'x,x,y' is not like -z,x,y"
wrong 'realtime = "perhaps"' "--realtime: 'perhaps' is not require, try or off"
wrong 'realtime = 1' "--realtime: '1' is not require, try or off"
wrong 'scale = 1 2' '--config: line 2: .*'
wrong 'scale = 2020-01-01' '--config: line 2: play.scale must be a number, a text, true or false, or an array'
wrong 'set = "safety.slew=1"' "--config: line 2: unknown key 'set'; .*"
wrong $'[play.safety]\nslow = 1' "--config: line 3: unknown key 'safety.slow'; did you mean 'safety.slew'\?"
expect 2 '' "~play: .*none.toml.* $help" -- play grid --config none.toml --device path:path

wrong_set() { # SETTING MESSAGE
  expect 2 '' "~play: --set: $2 $help" -- play grid --device path:path --set "$1"
}
wrong_set slow=1 "unknown key 'slow'; did you mean 'safety.slew'\?"
wrong_set velocity=1 "unknown key 'velocity'; play --help has a table of keys"
wrong_set safety.slew=-1 "safety.slew must be a number from 0 to inf N/ms"
wrong_set safety.slew=nan "safety.slew must be a number from 0 to inf N/ms"
wrong_set safety.slew=fast "'safety.slew=fast' is not like KEY=VALUE"
wrong_set safety.slew=true "safety.slew must be a number from 0 to inf N/ms"
wrong_set 'safety.slew=[1,2]' "safety.slew must be a number from 0 to inf N/ms"
wrong_set $'safety.slew=1\nx=2' "'safety.slew=1 x=2' is not like KEY=VALUE"
wrong_set mapping.offset=1 "mapping.offset must be 3 numbers in \[ \] from -1e\+15 to 1e\+15 units"
wrong_set imd.wait=1e9 "imd.wait must be a number from 0 to 86400 s"
wrong_set safety.slew "'safety.slew' is not like KEY=VALUE"
wrong_set '=1' "unknown key ''; .*"
expect 2 '' "~play: --scale: '-1' is not a number from 0 to 1e\+15 UNITS/M $help" \
  -- play grid --device path:path --scale -1

# The help's table, which is also the manual page's, has each key once.
play --help >help
same "keys" "18" "$(grep -oE '^  [a-z]+\.[a-z_]+ +[^ ]+ +[^ ]+ +[^ ]+ to [^ ]+ +[A-Z]' help |
  cut -d' ' -f3 | sort -u | wc -l)"
