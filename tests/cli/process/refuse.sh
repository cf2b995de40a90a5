# What a model process is not allowed to do, or does wrong, ends in one line and leaves no half file.
source "$(dirname "$0")/../lib.sh"
processes=$HAPGRID_SOURCE/tests/unit/model/processes

define() {  # NAME WORD...: the puppet, told to do something
  local words
  words=$(printf ', "%s"' "${@:2}")
  cat <<TOML
model = {name = "$1", process = ["python3", "$processes/puppet.py"$words]}
grid = {origin = [0, 0, 0], spacing = 1, counts = [3, 3, 3]}
seeds = {points = [[0, 0, 0]]}
TOML
}
define puppet >good.toml
who="process 'python3 [^ ]*/puppet\.py"

# Nothing is started that the command line does not allow.
cat >touch.toml <<TOML
model = {name = "puppet", process = ["touch", "started"]}
grid = {origin = [0, 0, 0], spacing = 1, counts = [3, 3, 3]}
TOML
refuses "seed: touch\.toml: the model is a process, 'touch started', which is only started with --allow-process" \
  -- seed touch.toml -o out
[[ ! -e started ]] || fail "it was started"
seed good.toml --allow-process -o seeds
expand --complete seeds --allow-process good.toml -o grid
only='is a process, which is only started with --allow-process MODEL\.toml'
refuses "expand: model puppet: $only" -- expand seeds -o out
refuses "expand: model puppet: $only" -- expand --complete seeds -o out
refuses "verify: model puppet: $only \(or leave C out: --recompute none\)" -- verify grid -o out
expect 0 '' '~verify: .*' -- verify grid --recompute none -o report
# Its force is not stored.
echo '0 0 0' >path
refuses "play: .*model puppet.*force.*" -- play grid --device path:path

# More processes than the system allows. Each thread has one, and each process three pipes.
few="; have fewer \(-j\), or raise the limit \(ulimit"
sanitized || (  # a sanitizer wants descriptors of its own
  ulimit -n 32
  refuses "expand: conversion at .*: $who.*' cannot be started: Too many open files$few -n\)" -- \
    expand --complete seeds --allow-process good.toml -j 16
)
if strace -o /dev/null true 2>/dev/null && ! sanitized; then
  refuses "expand: conversion at .*: $who.*' cannot be started: Resource temporarily unavailable$few -u\)" -- \
    strace -f -qq -o trace -e inject=vfork:error=EAGAIN:when=3+ expand --complete seeds --allow-process good.toml -j 8
  seed "$ball" --set 'grid.counts=[3,3,3]' -o few
  refuses "expand: thread [0-9] of 4 cannot be started: Resource temporarily unavailable$few -u\)" -- \
    strace -f -qq -o trace -e inject=clone3:error=EAGAIN:when=2+ expand few -j 4 -o out
fi
[[ -z $(compgen -G '.hapgrid.*') && ! -e out ]] || fail "something is left: $(ls -A)"

# A definition that is not the grid's.
define other >other.toml
refuses "expand: other\.toml: defines the model other, the grid's is puppet" -- \
  expand seeds --allow-process other.toml -o out
refuses "expand: $ball: (line [0-9]+: )?the key model\.process is missing" -- expand seeds --allow-process "$ball" -o out
refuses "expand: gone\.toml: No such file or directory" -- expand seeds --allow-process gone.toml -o out
refuses "expand: /dev/zero: is no regular file" -- expand seeds --allow-process /dev/zero -o out
expect 2 '' '~expand: .*' -- expand seeds --allow-process
for bad in 0 -1 nan 1e7 '"x"'; do
  sed "s/^model = {/&timeout = $bad, /" good.toml >bad.toml
  refuses 'expand: bad\.toml: line [0-9]+: model\.timeout .*' -- expand seeds --allow-process bad.toml -o out
  refuses 'seed: bad\.toml: line [0-9]+: model\.timeout .*' -- seed bad.toml --allow-process -o out
done
refuses "seed: $ball: .*model\.timeout is for a model\.process" -- seed "$ball" --set model.timeout=3 -o out

# Definitions.
bad() {  # SED MESSAGE
  sed "$1" good.toml >bad.toml
  refuses "seed: bad\.toml: (line [0-9]+: )?$2" -- seed bad.toml --allow-process -o out
}
bad 's/name = "puppet", //' 'the key model\.name is missing'
bad 's/"puppet"/"..\/puppet"/' "model\.name '\.\./puppet': it has only letters, digits, '-' and '_'"
bad 's/name = "puppet"/name = "puppet", plugin = "toy"/' 'model\.plugin and model\.process exclude each other'
bad 's/process = \[.*\]}/process = []}/' 'model\.process names no program'
bad 's/process = \[.*\]}/process = "python3"}/' 'model\.process must be an array'
bad 's/process = \[.*\]}/process = [1]}/' 'model\.process must be a text in quotes'
bad 's/process = \[.*\]}/plugin = "toy"}/' 'model\.name is for a model\.process; a plug-in has its own'

# Processes that do not start; tests/unit/model has the other ways.
define puppet version >told.toml
for tool in "seed told.toml --allow-process" "expand seeds --allow-process told.toml"; do
  refuses "${tool%% *}: model puppet: $who version' it speaks version 2 of the protocol, this hapgrid speaks 1" \
    -- $tool -o out
done
# Another tolerance function than the grid's.
define puppet rms >told.toml
changed='was the process changed since the grid was seeded\?'
refuses "expand: model puppet: it and the grid differ in the tolerance function; $changed" -- \
  expand seeds --allow-process told.toml -o out
seed told.toml --allow-process -o rms.seeds
expand rms.seeds --allow-process told.toml -o rms.requests
refuses "merge: rms\.requests: another grid than seeds: the tolerance function" -- merge seeds rms.requests -o out

# Conversions that fail are named, the same with any number of processes; an old file stays.
echo before >out
conversion='conversion at point 0 \(0, 0, 0\) level 0, direction 13'
fails() {  # WORDS MESSAGE OPTION...
  define puppet $1 >told.toml
  refuses "expand: $conversion: $who $1' $2; asked 3 times" -- \
    expand seeds --allow-process told.toml -o out "${@:3}"
}
fails 'die 1' 'exited with status 7'
fails 'die 1' 'exited with status 7' -j 3
# A model that says itself what is wrong is asked once, and what it said is above the line.
define puppet raise >told.toml
expect 1 '' "~Traceback .*KeyError: 'gone'
expand: $conversion: $who raise' exited with status 1: KeyError: 'gone'" -- \
  expand seeds --allow-process told.toml -o out
same 'tracebacks' 1 "$(grep -c Traceback "$work/got/err")"
define puppet fail >told.toml
refuses "expand: $conversion: told to fail" -- expand seeds --allow-process told.toml -o out
same "the old file" before "$(cat out)"
rm out

# Standard error passes through. The model has no other file of this program's open.
define puppet stderr >told.toml
expect 0 '' 'hello from the model' -- expand seeds --allow-process told.toml -o requests
cat >fds.py <<'PYTHON'
import os, sys
exec(open(sys.argv[1]).read().replace('fault = ', 'say_fds = sorted(int(f) for f in os.listdir("/proc/self/fd") if os.path.exists(f"/proc/self/fd/{f}"))\nprint(say_fds, file=sys.stderr)\nfault = ', 1).replace("sys.argv", "['']"))
PYTHON
sed "s|\"$processes/puppet.py\"|\"fds.py\", &|" good.toml >fds.toml
expect 0 '' '[0, 1, 2]' -- expand seeds --allow-process fds.toml -o requests 9</dev/null

# No process is left after a signal to the tool, and no half of a file.
for signal in TERM HUP KILL; do
  define puppet "hang" >told.toml
  mark=$RANDOM$RANDOM
  sed -i "s/\"hang\"/\"hang\", \"1\", \"$mark\"/" told.toml
  "$HAPGRID_BIN/expand" seeds --allow-process "$PWD/told.toml" -j 2 -o half &
  tool=$!
  until [[ $(pgrep -c -f "puppet.py hang 1 $mark") -ge 2 ]]; do sleep 0.05; done
  kill -$signal $tool
  wait $tool 2>/dev/null || true
  for try in $(seq 100); do
    pgrep -f "puppet.py hang 1 $mark" >/dev/null || break
    sleep 0.05
  done
  ! pgrep -f "puppet.py hang 1 $mark" >/dev/null || fail "a model is left after $signal"
  [[ ! -e half ]] || fail "half a file after $signal"
done

# Nor anything that a model has started and that is still in its group: after a good end, and when a model
# is replaced. A daemon may live on.
group() {  # FAULT: the model dies at its first question, or never
  mark=1$RANDOM$RANDOM  # seconds, for `sleep`
  define puppet "$1" 1 "$mark" >told.toml
}
left() { pgrep -f "sleep 1000 $mark" >/dev/null; }
group group
expect 0 '' '' -- expand seeds --allow-process told.toml -o requests
! left || fail "a good end leaves what the model has started"
group dying-group
refuses "expand: $conversion: $who dying-group 1 .*' exited with status 7; asked 3 times" -- \
  expand seeds --allow-process told.toml -o out
! left || fail "a bad end leaves what the model has started"
