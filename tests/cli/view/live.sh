# hapgrid feel and view --web: in a browser without a screen the mouse, and then a finger, pushes the hung ball until it
# snaps; another page watches; without WebGL the key n and a button go on to the next level; strangers are refused; a
# closed page ends the play. The law of the hand is in cli/play/hand.sh.
source "$(dirname "$0")/../lib.sh"
unset DISPLAY WAYLAND_DISPLAY
export ASAN_OPTIONS=detect_leaks=0 VALGRIND_OPTS=--leak-check=no # what libwebsockets keeps at the end is its own
mkdir tmp
export TMPDIR=$PWD/tmp
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid

expect 2 '' 'hapgrid: feel: which grid? (see hapgrid --help)' -- hapgrid feel
mkdir bare
cp "$HAPGRID_BUILD"/bin/{hapgrid,feel,seed} bare
refuses 'hapgrid: feel: view is not built: make -f Makefile.example build' -- bare/hapgrid feel grid
refuses 'play: nowhere: No such file or directory' -- hapgrid feel nowhere
expect 2 '' '~play: .*--nonsense.*' -- hapgrid feel grid --nonsense
# A page that cannot be served ends the play, which would wait for a hand for ever.
refused() { # CODE PORT LINE
  HAPGRID_FEEL_PORT=$2 expect "$1" "" "~(play: .*)?$3" -- timeout 60 hapgrid feel grid
  nothing_left tmp
  ! pgrep -f "$TMPDIR/hapgrid-feel" || fail 'a play was left'
}
refused 2 http "view: --port: .http. is not a port from 0 to 65535 \(see view --help\)"
python3 -c 'import socket, time
s = socket.create_server(("127.0.0.1", 0))
print(s.getsockname()[1], flush=True)
time.sleep(600)' >taken &
first=$!
wait_for 60 port test -s taken
refused 1 "$(cat taken)" "view: cannot listen on port $(cat taken) of 127.0.0.1: is another program there\?"
kill $first
wait $first || :
# A grid whose path has a blank, until a signal ends it.
mkdir 'a b'
cp grid 'a b/grid'
hapgrid feel 'a b/grid' 2>err &
first=$!
wait_for 60 address grep -q '^hapgrid: feel: http' err
kill $first
wait $first && fail 'no exit code' || same 'exit code' 143 $?
nothing_left tmp
see='(see view --help)'
for option in '--hand hand' --close; do
  # shellcheck disable=SC2086  # words
  expect 2 '' "view: ${option%% *} requires --web $see" -- view frames $option
done
for option in '--port 80' '--address 127.0.0.1'; do
  # shellcheck disable=SC2086  # words
  expect 2 '' "view: ${option%% *} requires --web or --imd $see" -- view frames $option
done
expect 2 '' "view: --png excludes --web $see" -- view frames --web --png x
expect 2 '' "view: --address: 'here' is not an IPv4 address $see" -- view frames --web --address here
echo '0 0 0' >path
play grid --device path:path --frames frames 2>/dev/null
refuses 'view: path: is not a named pipe' -- view frames --web --hand path
same "path" '0 0 0' "$(cat path)"
mkfifo hand
refuses 'view: hand: nobody reads this pipe; it is for play --device path:hand' -- view frames --web --hand hand
# A port that another one has, and an address that others reach.
view frames --web >address &
first=$!
wait_for 60 "address" grep -q http address
port=$(sed -E 's|.*:([0-9]+)/.*|\1|' address)
refuses "view: cannot listen on port $port of 127.0.0.1: is another program there\?" -- view frames --web --port "$port"
kill $first
wait $first || :
expect 0 '~http://.*:[0-9]+/[0-9a-f]{32}/' '~view: whoever reaches 0\.0\.0\.0 .*' -- \
  view frames --web --close --address 0.0.0.0

needs chromium chromium
evidence() { cat err; }
# attempt: from the beginning, as in_time does it.
attempt() {
  trap 'kill ${feel-} 2>/dev/null || :; wait || :' EXIT
  rm -rf tmp/* ./*.session ./*.session.part
  : >err
  hapgrid feel grid --log hand.session 2>>err &
  feel=$!
  wait_for 60 "address" grep -q http err
  mkdir -p browser  # where Chromium leaves what it does not remove
  HOME=$PWD TMPDIR=$PWD/browser /usr/bin/python3 "$here/live.py" "$@" "$(sed -nE 's/^hapgrid: feel: //p' err)" 2>>err ||
    fail "$(cat err)"
  wait $feel || fail "$(cat err)"
  nothing_left tmp
  grep -q '^play: [0-9]* ticks' err || fail "the play did not end in good order: $(cat err)"
}
# The session of a hand that went to the left of the ball, and from there to the right through it.
pushed() {
  play grid --device replay:hand.session --log again 2>/dev/null
  python3 - <<'PYTHON'
with open("again") as text:
    names = next(text)[1:].split()
    rows = [dict(zip(names, map(float, line.split()))) for line in text]
xs = [row["x"] for row in rows]
assert min(xs) < -0.5 and xs[-1] > 0.5, (min(xs), xs[-1])
# The ball is pushed to the right, and falls back in one tick.
snaps = [i for i in range(1, len(rows)) if rows[i - 1]["s0"] - rows[i]["s0"] > 0.1]
assert len(snaps) == 1 and rows[snaps[0] - 1]["x"] > 0, snaps
# The wheel took the HIP along y.
far = max(row["y"] for row in rows) - rows[0]["y"]
assert 0.03 < far < 0.12, far
PYTHON
}
in_time err attempt mouse
pushed
in_time err attempt finger
pushed
in_time err attempt next

# A signal closes all of it.
stop() {
  rm -rf tmp/*
  : >err
  hapgrid feel grid 2>>err &
  feel=$!
  wait_for 60 "address" grep -q http err
  kill -TERM $feel
  local code=0
  wait $feel || code=$?
  same "exit code" 143 $code
  nothing_left tmp
}
stop
