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

input() { printf '[play]\n%b\n' "$1" >wrong.toml; }
mkfifo pipe
refusals "$here/config.tsv" 'play grid --config wrong.toml --device path:path'
# What a file with other tables cannot set is taken from one that has none, and so are the defaults.
for line in evdev.max_force=0.1 evdev.range=0.1 'evdev.signs=[1,1]' 'mapping.push=[-1,1,1]' loop.spin=1 \
  safety.ramp={500,0} safety.reserve={0.5,1} safety.encoder={5.5e-05,1e-05}; do
  settings good.toml "$line"
  play grid --config good.toml --device path:path 2>err
  grep -q "sets ${line%%=*} = " err || [[ $line =~ =(500|0.5|5.5e-05)$ ]] || fail "$line: $(cat err)"
done
nothing_left . empty.toml err good.toml grid here model.toml own.toml path pipe there wrong.toml

# The help's table, which is also the manual page's, has each key once.
play --help >help
same "keys" "11" "$(grep -oE '^  [a-z]+\.[a-z_]+ +[A-Z]' help | cut -d' ' -f3 | sort -u | wc -l)"
same "a straight column" "" "$(grep -E '^  [a-z]+\.[a-z_]+ ' help | grep -vE '^.{19} [A-Z]')"
