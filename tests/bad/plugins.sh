# Plug-ins that are not there, are no plug-ins, or misbehave. (Names with a path in a shard:
# streams/.)
source "$(dirname "$0")/../cli/lib.sh"
plugins=$HAPGRID_BUILD/tests/plugins
models=$(readlink -f "$HAPGRID_BIN/../models")

# define NAME [PARAMETER = VALUE,...]
define() {
  cat <<END
grid = {origin = [0, 0, 0], spacing = 0.5, counts = [2, 2, 2]}
model = {plugin = "$1", parameters = {${2:-}}}
END
}
define nothing >nothing.toml
advice='\(add its folder to HAPGRID_MODEL_PATH\)'

# Which directories were searched, in order.
refuses "seed: model nothing: no plug-in nothing\.so in: $models $advice" -- seed nothing.toml -o out
export HAPGRID_MODEL_PATH=/nowhere:$plugins:
refuses "seed: model nothing: no plug-in nothing\.so in: /nowhere, $plugins, $models $advice" -- seed nothing.toml -o out

# The first directory that has one counts; also when what it has is none.
mkdir first second
echo "no shared object" >first/toy.so
cp "$plugins/toy.so" second
define toy >toy.toml
expect 0 '' '' -- seed toy.toml -o seeds
HAPGRID_MODEL_PATH=second:first expect 0 '' '' -- seed toy.toml -o seeds
HAPGRID_MODEL_PATH=first:second refuses "seed: model toy: .*/first/toy\.so: .*" -- seed toy.toml -o out
HAPGRID_MODEL_PATH=$work/in/first refuses "expand: model toy: .*/first/toy\.so: .*" -- expand seeds -o out
HAPGRID_MODEL_PATH='' refuses "expand: model toy: no plug-in toy\.so in: $models $advice" -- expand seeds -o out
HAPGRID_MODEL_PATH='' refuses "merge: model toy: no plug-in toy\.so in: $models $advice" -- merge seeds -o out
HAPGRID_MODEL_PATH=second expect 0 '' '' -- expand seeds -o requests

# Names are plain.
for name in ../toy ./toy toy.so /etc/passwd '' -toy 'to y'; do
  define "$name" >bad.toml
  refuses "seed: model '.*': a plug-in's name has only letters, digits, '-' and '_'; HAPGRID_MODEL_PATH says where NAME.so is" -- seed bad.toml -o out
done

# No plug-ins, or of another version of the interface.
not_one() { # PLUGIN MESSAGE
  define "$1" >bad.toml
  refuses "seed: model $1: $2" -- seed bad.toml -o out
}
not_one no_entry "$plugins/no_entry\.so is no hapgrid plug-in \(it has no function hapgrid_model_plugin\)"
not_one null_table 'hapgrid_model_plugin\(\) returned NULL'
not_one wrong_version "$plugins/wrong_version\.so has interface version 999, this hapgrid has 5; build the plug-in again"
for function in create destroy info known_states convert equal; do
  not_one "null_$function" "a required function of the plug-in's table is NULL"
done

# What it says of itself must make sense, and be what it was when the grid was seeded.
puppet() {
  define puppet "$1" >bad.toml
  refuses "seed: $2" -- seed bad.toml -o out
}
puppet 'state_size = 0' 'model puppet: a state of 0 components; 1 to 1048576 are possible'
puppet 'state_size = 1048577' 'model puppet: a state of 1048577 components; .*'
puppet 'd_max = 0' 'model puppet: d_max is not positive'
puppet 'd_max = nan' '.*d_max.*not finite'
for tolerance in -1 -1e-300; do
  puppet "tolerance = $tolerance" 'model puppet: the tolerance is negative or not finite'
done
puppet 'd_max = -1' 'model puppet: d_max is not positive'
puppet 'stored = 8' 'model puppet: info.stored has unknown bits'
for kind in 1 2 4; do
  puppet "stored = $kind" 'model puppet: info.stored names a function that is NULL'
done
puppet 'hip_radius = -1' 'model puppet: the radius of the HIP is negative or not finite'
puppet 'hip_radius = inf' '.*hip_radius.*not finite'
puppet 'refuse = "no\nway"' 'model puppet: no way'
puppet 'refuse = ""' 'model puppet: no reason given'
puppet 'overrun = 1' 'model puppet: x+'
puppet 'known = 0' 'seed point 0 \(0, 0, 0\) at \(0, 0, 0\): the model knows no state there; .*'
puppet 'known = 65' 'seed point 0 \(0, 0, 0\): 65 states, the level limit is 64 \(search\.max_levels\)'
puppet 'known = 255' 'known states: 255 states at one point, the limit is 254'
puppet 'lose = "lost it"' 'known states: lost it'

# Conversions that fail are named; those that are not finite are failures.
define puppet 'component = 0' >puppet.toml
seed puppet.toml -o puppet.seeds
python3 - "$HAPGRID_SOURCE/tests/cli" <<'END'
import sys
sys.path.insert(0, sys.argv[1])
import shard
for name, *parameters in (
    ("inf", {"key": "component", "value": {"number": "Infinity"}}),
    ("lose", {"key": "lose", "value": {"text": "lost\nit"}}),
    ("size", {"key": "state_size", "value": {"number": 2}}),
    ("tolerance", {"key": "tolerance", "value": {"number": 0.5}}),
    ("crash", {"key": "crash", "value": {"number": 1}}),
    ("unlike", {"key": "component", "value": {"number": 0.5}}, {"key": "unlike", "value": {"number": 0.5}}),
):
    messages = shard.decode(open("puppet.seeds", "rb").read())
    messages[0]["header"]["parameters"] = parameters
    open(name, "wb").write(shard.seal(messages))
END
conversion='conversion at point 0 \(0, 0, 0\) level 0, direction [0-9]+'
for threads in 1 2; do
  for tool in "expand" "expand --complete"; do
    refuses "expand: $conversion: component 0 of the state reached is not finite" -- $tool inf -o out -j $threads
    refuses "expand: $conversion: lost it" -- $tool lose -o out -j $threads
  done
done
changed='was the plug-in changed since the grid was seeded\?'
for tool in expand "expand --complete" merge; do
  name=${tool%% *}
  refuses "$name: model puppet: it and the grid differ in state size 2 and 1; $changed" -- $tool size -o out
  refuses "$name: model puppet: it and the grid differ in tolerance .* and .*; $changed" -- $tool tolerance -o out
done

# A state that the tolerance function tells from itself would become a level each time.
define puppet 'unlike = 0' >bad.toml
refuses 'seed: seed point 0 \(0, 0, 0\): .* tells state 0 from itself' -- seed bad.toml -o out
expand unlike -o unlike.requests
for tool in "expand --complete unlike" "merge unlike unlike.requests"; do
  refuses "${tool%% *}: model puppet: its tolerance function tells a state from itself: point [01] \([01], 0, 0\) level [01], reached from .*, direction [0-9]+" -- $tool -o out
done
# A crash ends the process as a crash does, with a line that says where, once; also where threads crash together.
for threads in 1 2 2 2 2 2 2 2 2 2; do
  code=0
  expand --complete crash -o out -j $threads 2>err || code=$?
  same "exit code of a crash" 134 "$code"
  same "message of a crash" '~expand: the model crashed \(signal 6\) in the conversion at point [0-7] level 0, direction [0-9]+' "$(cat err)"
done

[[ ! -e out ]] || fail "half a file"
