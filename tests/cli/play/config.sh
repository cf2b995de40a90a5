# Settings: keys of --set, and the table [play] of a TOML file, which may be the MODEL.toml; the command
# line counts more. The mapping's own numbers are in tests/unit/loop.
source "$(dirname "$0")/../lib.sh"
cp "$ball" model.toml
cat >>model.toml <<'TOML'
[play]
max-force = 0.05
axes = "-z,x,y"
gain = 0.5
[play.safety]
ramp = 600
reserve = 0.5
[play.mapping]
offset = [0.1, 0, 0]
TOML
# The other filters pass over the table.
seed model.toml --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete | cmp - grid
for i in {-900..900}; do echo "$(printf '%de-3' "$i") 0 0"; done >path
# --set takes one value each: the grid behind it is the grid.
play --max-force 0.05 --gain 0.5 --set safety.ramp=600 --set safety.reserve=0.5 grid \
  --device path:path --log here 2>/dev/null
play grid --config model.toml --device path:path --log there 2>err
cmp here there
grep -qE ' 0.05 N sent; safety, in ticks: .*clamped' err || fail "$(cat err)"
# What the file changed comes first.
same "the file's settings" "play: model.toml sets gain = 0.5, mapping.offset = [0.1,0,0], \
max-force = 0.05, safety.ramp = 600, safety.reserve = 0.5, axes = -z,x,y" "$(head -1 err)"
play grid --config model.toml --device path:path --max-force 0.1 --axes x,y,z 2>err
grep -q ' 0.1 N sent' err || fail "the command line counts more: $(cat err)"
same "the file's settings" "play: model.toml sets gain = 0.5, mapping.offset = [0.1,0,0], \
safety.ramp = 600, safety.reserve = 0.5" "$(head -1 err)"
printf '[play]\n' >empty.toml
play grid --config empty.toml --device path:path 2>err
same "an empty table" "play: empty.toml sets nothing" "$(head -1 err)"
# One key of the command line changes that key alone.
play grid --config model.toml --device path:path --set safety.ramp=1e6 2>err
grep -qE '; safety, in ticks: ramped 1801$' err || fail "the command line counts more: $(cat err)"

help='\(see play --help\)'
wrong() { # LINE MESSAGE
  printf '[play]\n%s\n' "$1" >wrong.toml
  expect 2 '' "~play: $2 $help" -- play grid --config wrong.toml --device path:path
}
wrong 'max-forse = 1' "--config: line 2: unknown key 'max-forse'; did you mean 'max-force'\?"
wrong '"--max-force" = 1' "--config: line 2: unknown key '--max-force'; did you mean 'max-force'\?"
wrong 'max-force = -1' "--config: line 2: --max-force must be a number from 0 to 1e\+06 N"
wrong 'axes = "x,x,y"' "--config: line 2: axes: 'x,x,y' is not like -z,x,y"
wrong 'axes = 1' "--config: line 2: axes must be a text in quotes"
wrong 'scale = 1 2' '--config: line 2: .*'
wrong 'scale = 2020-01-01' '--config: line 2: --scale must be a number from 0 to 1e\+15 UNITS/M'
wrong $'[play.safety]\nramb = 1' "--config: line 3: unknown key 'safety.ramb'; did you mean 'safety.ramp'\?"
# A stranger's file chooses no code, writes and listens nowhere, and raises no limit.
cannot='cannot be set by a file, only by the command line'
for line in 'model-path = ["."]' 'log = "log"' 'report = "report"' 'frames = "frames"' 'sessions = "table"' \
  'device = "keys"' 'grid = "grid"' 'rate = 1' \
  'duration = 1' 'realtime = "off"' 'traversal = "paper"' 'selftest = true' \
  'config = "model.toml"' 'set = "safety.ramp=1"'; do
  [[ $line == grid* ]] || wrong "$line" "--config: line 2: ${line%% *} $cannot"
  [[ $line != grid* ]] || wrong "$line" "--config: line 2: unknown key 'grid'; .*"
done
for key in evdev.max_force evdev.range evdev.signs loop.spin; do
  wrong "$key = 0.1" "--config: line 2: $key $cannot"
done
only() { # KEY VALUE DEFAULT less|more: it can only be set to the default and further
  local other=more
  [[ $4 == less ]] || other=less
  wrong "$1 = $2" "--config: line 2: $1 = $2: a file can only set $3 or $4; the command line can set $other"
  printf '[play]\n%s = %s\n' "$1" "${3%% *}" >good.toml
  play grid --config good.toml --device path:path 2>/dev/null
}
only gain 1.01 1 less
only gain 5 1 less
only max-force 3.01 '3 N' less
only safety.ramp 0 '500 ms' more
only safety.reserve 1 '0.5 mJ' less
only safety.encoder 1e-05 '5.5e-05 m' more
nothing_left . empty.toml err good.toml grid here model.toml path there wrong.toml

for file in /dev/zero pipe; do
  [[ -e $file ]] || mkfifo $file
  expect 2 '' "~play: $file: is no regular file $help" -- \
    timeout 10 play grid --config $file --device path:path
done
expect 1 '' 'play: hapgrid-hid: pipe: is no regular file' -- timeout 10 play grid --device hid:pipe
expect 1 '' 'play: pipe: is no regular file' -- timeout 10 play grid --device sim:pipe
rm pipe

expect 2 '' "~play: .*none.toml.* $help" -- play grid --config none.toml --device path:path

wrong_set() { # SETTING MESSAGE
  expect 2 '' "~play: --set: $2 $help" -- play grid --device path:path --set "$1"
}
wrong_set ramb=1 "unknown key 'ramb'; did you mean 'safety.ramp'\?"
wrong_set safety.slew=1 "unknown key 'safety.slew'; play --help has a table of keys"
wrong_set velocity=1 "unknown key 'velocity'; play --help has a table of keys"
wrong_set safety.reserve=-1 "safety.reserve must be a number from 0 to inf mJ"
wrong_set safety.reserve=nan "safety.reserve must be a number from 0 to inf mJ"
wrong_set safety.reserve=fast "'safety.reserve=fast' is not like KEY=VALUE"
wrong_set safety.reserve=true "safety.reserve must be a number from 0 to inf mJ"
wrong_set 'safety.reserve=[1,2]' "safety.reserve must be a number from 0 to inf mJ"
wrong_set $'safety.reserve=1\nx=2' "'safety.reserve=1 x=2' is not like KEY=VALUE"
wrong_set mapping.offset=1 "mapping.offset must be 3 numbers in \[ \] from -1e\+15 to 1e\+15 units"
wrong_set safety.reserve "'safety.reserve' is not like KEY=VALUE"
wrong_set '=1' "unknown key ''; .*"
expect 2 '' "~play: --scale: '-1' is not a number from 0 to 1e\+15 UNITS/M $help" \
  -- play grid --device path:path --scale -1

# The help's table, which is also the manual page's, has each key once.
play --help >help
same "keys" "11" "$(grep -oE '^  [a-z]+\.[a-z_]+ +[A-Z]' help | cut -d' ' -f3 | sort -u | wc -l)"
same "a straight column" "" "$(grep -E '^  [a-z]+\.[a-z_]+ ' help | grep -vE '^.{19} [A-Z]')"
