# Settings: the table [play] of a TOML file, which may be the MODEL.toml; the command line counts more. The mapping's own
# numbers are in tests/unit/loop.
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
play grid --config model.toml --device path:path --log there 2>err
grep -qE ' 0.05 N sent; safety, in ticks: .*clamped' err || fail "$(cat err)"
# What the file changed comes first.
same "the file's settings" "play: model.toml sets gain = 0.5, mapping.offset = [0.1,0,0], \
max-force = 0.05, safety.ramp = 600, safety.reserve = 0.5, axes = -z,x,y" "$(head -1 err)"
# The same from a file of its own, and from the command line.
settings own.toml 'safety.ramp = 600' 'safety.reserve = 0.5'
play grid --config own.toml --max-force 0.05 --gain 0.5 --device path:path --log here 2>err
cmp here there
same "the file's settings" "play: own.toml sets safety.ramp = 600, safety.reserve = 0.5" "$(head -1 err)"
play grid --config model.toml --device path:path --max-force 0.1 2>err
grep -q ' 0.1 N sent' err || fail "the command line counts more: $(cat err)"
same "the file's settings" "play: model.toml sets gain = 0.5, mapping.offset = [0.1,0,0], \
safety.ramp = 600, safety.reserve = 0.5, axes = -z,x,y" "$(head -1 err)"
settings empty.toml
play grid --config empty.toml --device path:path 2>err
same "an empty table" "play: empty.toml sets nothing" "$(head -1 err)"
settings own.toml 'safety.ramp = 1e6'
play grid --config own.toml --device path:path 2>err
grep -qE '; safety, in ticks: ramped 1801$' err || fail "the ramp: $(cat err)"

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
wrong 'ramb = 1' "--config: line 2: unknown key 'ramb'; did you mean 'safety.ramp'\?"
wrong 'safety.slew = 1' "--config: line 2: unknown key 'safety.slew'; play --help has a table of keys"
for value in -1 nan true '[1,2]' '"fast"'; do
  wrong "safety.reserve = $value" "--config: line 2: safety.reserve must be a number from 0 to inf mJ"
done
wrong 'mapping.offset = 1' "--config: line 2: mapping.offset must be 3 numbers in \[ \] from -1e\+15 to 1e\+15 units"
expect 2 '' "~play: --scale: '-1' is not a number from 0 to 1e\+15 UNITS/M $help" \
  -- play grid --device path:path --scale -1
# No file chooses code, or where play writes and listens.
for line in 'beside = "off"' 'log = "log"' 'report = "report"' 'frames = "frames"' 'device = "keys"' 'rate = 1' \
  'duration = 1' 'realtime = "off"' 'traversal = "paper"' 'selftest = true' 'config = "model.toml"'; do
  wrong "$line" "--config: line 2: ${line%% *} cannot be set by a file, only by the command line"
done
wrong 'grid = "grid"' "--config: line 2: unknown key 'grid'; .*"
# A file with other tables may be a stranger's: it turns no force around, and makes no limit looser.
strangers() { # LINE MESSAGE
  printf '[grid]\n[play]\n%s\n' "$1" >wrong.toml
  expect 2 '' "~play: --config: line 3: $2 $help" -- play grid --config wrong.toml --device path:path
}
for line in evdev.max_force=0.1 evdev.range=0.1 'evdev.signs=[1,1]' 'mapping.push=[-1,1,1]' loop.spin=1; do
  strangers "$line" "${line%%=*} can only be set by a file that has the table \[play\] alone"
  settings good.toml "$line"
  play grid --config good.toml --device path:path 2>err
  grep -q "sets ${line%%=*} = " err || fail "$line: $(cat err)"
done
only() { # KEY VALUE DEFAULT less|more: it can only be set to the default and further
  local other=more
  [[ $4 == less ]] || other=less
  strangers "$1 = $2" "$1 = $2: this file can only set $3 or $4; one that has the table \[play\] alone can set $other"
  for line in "$1 = ${3%% *}" "$1 = $2"; do
    settings good.toml "$line"
    play grid --config good.toml --device path:path 2>/dev/null
  done
}
only safety.ramp 0 '500 ms' more
only safety.reserve 1 '0.5 mJ' less
only safety.encoder 1e-05 '5.5e-05 m' more
# No file has more force.
wrong 'gain = 1.01' "--config: line 2: gain = 1.01: a file can only set 1 or less; the command line can set more"
wrong 'max-force = 3.01' "--config: line 2: max-force = 3.01: a file can only set 3 N or less; the command line can set more"
nothing_left . empty.toml err good.toml grid here model.toml own.toml path there wrong.toml

for file in /dev/zero pipe; do
  [[ -e $file ]] || mkfifo $file
  expect 2 '' "~play: $file: is no regular file $help" -- \
    timeout 10 play grid --config $file --device path:path
done
expect 1 '' 'play: hapgrid-hid: pipe: is no regular file' -- timeout 10 play grid --device hid:pipe
rm pipe
expect 2 '' "~play: .*none.toml.* $help" -- play grid --config none.toml --device path:path

# The help's table, which is also the manual page's, has each key once.
play --help >help
same "keys" "11" "$(grep -oE '^  [a-z]+\.[a-z_]+ +[A-Z]' help | cut -d' ' -f3 | sort -u | wc -l)"
same "a straight column" "" "$(grep -E '^  [a-z]+\.[a-z_]+ ' help | grep -vE '^.{19} [A-Z]')"
