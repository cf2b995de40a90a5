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
input() { eval "define $1" >bad.toml; }
export HAPGRID_MODEL_PATH=$plugins

mkdir first second
echo "no shared object" >first/toy.so
cp "$plugins/toy.so" second
define toy >toy.toml
expect 0 '' '' -- seed toy.toml -o seeds
HAPGRID_MODEL_PATH=second:first expect 0 '' '' -- seed toy.toml -o seeds
HAPGRID_MODEL_PATH=second expect 0 '' '' -- expand seeds -o requests

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
expand unlike -o unlike.requests
conversion='conversion at point 0 \(0, 0, 0\) level 0, direction [0-9]+'
refusals "$here/plugins.tsv"
# A crash ends the process as a crash does, with a line that says where, once; also where threads crash together.
for threads in 1 2 2 2 2 2 2 2 2 2; do
  code=0
  expand --complete crash -o out -j $threads 2>err || code=$?
  same "exit code of a crash" 134 "$code"
  same "message of a crash" '~expand: the model crashed \(signal 6\) in the conversion at point [0-7] level 0, direction [0-9]+' "$(cat err)"
done

[[ ! -e out ]] || fail "half a file"
