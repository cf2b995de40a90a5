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
define other >other.toml
cat >touch.toml <<TOML
model = {name = "puppet", process = ["touch", "started"]}
grid = {origin = [0, 0, 0], spacing = 1, counts = [3, 3, 3]}
TOML
sed 's/name = .*]}/name = "said", process = ["tail", "-f", "line"]}/' good.toml >said.toml
cat >good.line <<'END'
{"hapgrid": 1, "state_size": 2, "d_max": 1, "tolerance": 0.5, "norm": "rms", "weights": [1, 0.5], "tolerance_unit": "rad", "stored": ["shape", "force"], "version": "2.1", "in_flight": 26, "spheres": [{"radius": 1, "colour": [1, 0, 0.5], "label": "C"}, {"radius": 0}]}
END
seed good.toml --allow-process -o seeds
expand --complete seeds --allow-process good.toml -o grid
echo '0 0 0' >path
only='is a process, which is only started with --allow-process MODEL.toml'
who="process 'python3 [^ ]*/puppet\.py"
conversion='conversion at point 0 \(0, 0, 0\) level 0, direction 13'
mark=2$RANDOM$RANDOM  # seconds, for `sleep`
left() { pgrep -f "sleep 1000 $mark" >/dev/null; }
input() {
  case $1 in
    s/*) sed "$1" good.toml >bad.toml ;;
    line*) sed "${1:5}" good.line >line ;;
    '$ '*) eval "${1:2}" ;;
    *) eval "define puppet $1" >told.toml ;;
  esac
}
refusals "$here/refuse.tsv"
[[ ! -e started ]] || fail "it was started"
! left || fail "a bad end leaves what the model has started"
expect 0 '' '~verify: .*' -- verify grid --recompute none -o report

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

# A model that says itself what is wrong is asked once, and what it said is above the line. An old file stays.
echo before >out
define puppet raise >told.toml
expect 1 '' "~Traceback .*KeyError: 'gone'
expand: $conversion: $who raise' exited with status 1: KeyError: 'gone'" -- \
  expand seeds --allow-process told.toml -o out
same 'tracebacks' 1 "$(grep -c Traceback "$work/got/err")"
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

# Nor anything that a model has started and that is still in its group. A daemon may live on.
mark=1$RANDOM$RANDOM
define puppet group 1 "$mark" >told.toml
expect 0 '' '' -- expand seeds --allow-process told.toml -o requests
! left || fail "a good end leaves what the model has started"
