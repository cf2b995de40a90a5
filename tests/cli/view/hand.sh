# hapgrid feel: the mouse pushes the hung ball until it snaps, on an X server without a screen; how it ends, and what
# it refuses. The law of the hand is in cli/play/hand.sh.
source "$(dirname "$0")/../lib.sh"
unset DISPLAY WAYLAND_DISPLAY
export ASAN_OPTIONS=detect_leaks=0 VALGRIND_OPTS=--leak-check=no LIBGL_ALWAYS_SOFTWARE=1
if sanitized; then export LP_NUM_THREADS=0; fi
mkdir tmp
export TMPDIR=$PWD/tmp
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid

expect 2 '' 'hapgrid: feel: which grid? (see hapgrid --help)' -- hapgrid feel
refuses 'hapgrid: feel: no display for the window; .*' -- hapgrid feel grid
mkdir bare
cp "$HAPGRID_BUILD"/bin/{hapgrid,feel,seed} bare
refuses 'hapgrid: feel: view is not built: make -f Makefile.example build' -- bare/hapgrid feel grid
DISPLAY=:nowhere expect 1 '' "~(play: .*"$'\n'")*view: no window: .*" -- hapgrid feel grid
DISPLAY=:nowhere refuses 'play: nowhere: No such file or directory' -- hapgrid feel nowhere
DISPLAY=:nowhere expect 2 '' '~play: .*--nonsense.*' -- hapgrid feel grid --nonsense
nothing_left tmp
see='(see view --help)'
expect 2 '' "view: --hand requires --window $see" -- view frames --hand hand
echo '0 0 0' >path
play grid --device path:path --frames frames 2>/dev/null
refuses 'view: path: is not a named pipe' -- view frames --window --hand path
same "path" '0 0 0' "$(cat path)"
mkfifo hand
refuses 'view: hand: nobody reads this pipe; it is for play --device path:hand' -- view frames --window --hand hand

source "$here/../xvfb.sh"
needs xdotool xdotool
start_x

# feel OPTION...: starts it in the background and waits for its window and the first frame in it.
feel() {
  : >err
  hapgrid feel grid "$@" 2>>err &
  feel=$!
  wait_for 60 "window" xdotool search --onlyvisible --name '^hung-ball - hapgrid view$'
  # A picture can be written as soon as there is a frame.
  wait_for 60 "frame" first_frame
  rm hapgrid-*.png
}
first_frame() { not_held_up && xdotool key s && sleep 0.1 && compgen -G 'hapgrid-*.png'; }
evidence() { cat err; }
# not_held_up: ends an attempt at once where play has let go of the hand.
not_held_up() { ! grep -q 'the haptic loop hangs' err || exit 1; }
# attempt COMMAND...: an attempt of in_time, from the beginning.
attempt() {
  trap 'kill ${feel-} 2>/dev/null || :; wait || :' EXIT
  rm -rf tmp/* hapgrid-*.png ./*.session ./*.session.part
  "$@"
}
# mouse DX DY STEPS: 50 steps a second.
mouse() { for ((i = 0; i < $3; ++i)); do xdotool mousemove_relative -- "$1" "$2"; sleep 0.02; done; }
shot() { not_held_up && compgen -G 'hapgrid-*.png'; }
shoot() {
  rm -f hapgrid-*.png
  xdotool key s
  wait_for 60 "picture" shot
  mv hapgrid-*.png "$1"
}

# To the left of the ball, and from there to the right through it.
push() {
  feel --log hand.session
  mouse -20 0 20
  shoot left.png
  xdotool click 4 # away, by a fortieth of the box
  shoot back.png # drawn after the keys were read: on a busy machine the moves could come before them
  mouse 20 0 40
  shoot moved.png # after all moves were read; then the HIP has time to follow the hand
  sleep 0.5
  shoot right.png
  xdotool key q
  wait $feel || fail "$(cat err)"
  nothing_left tmp
}
in_time err attempt push
/usr/bin/python3 "$here/png.py" order left.png blue yellow
/usr/bin/python3 "$here/png.py" order right.png yellow blue
play grid --device replay:hand.session --log again --frames again.frames 2>/dev/null
python3 - <<'PYTHON'
with open("again") as text:
    names = next(text)[1:].split()
    rows = [dict(zip(names, map(float, line.split()))) for line in text]
xs = [row["x"] for row in rows]
# 400 pixels of 1000 to the left and 800 to the right, of a box 1.9 long that nearly fills the window: both ends are
# near its faces.
assert min(xs) < -0.6 and xs[-1] > 0.6, (min(xs), xs[-1])
# The ball is pushed to the right, and falls back in one tick.
snaps = [i for i in range(1, len(rows)) if rows[i - 1]["s0"] - rows[i]["s0"] > 0.1]
assert len(snaps) == 1 and rows[snaps[0] - 1]["x"] > 0, snaps
# The wheel took the HIP along y.
far = max(row["y"] for row in rows) - rows[0]["y"]
assert 0.03 < far < 0.12, far
PYTHON

# A signal closes all of it.
stop() {
  feel --log other.session
  kill -TERM $feel
  local code=0
  wait $feel || code=$?
  not_held_up
  same "exit code" 143 $code
  grep -q '^play: [0-9]* ticks' err || fail "the play did not end in good order: $(cat err)"
  nothing_left tmp
  ! xdotool search --name '^hung-ball - hapgrid view$' || fail "there is still a window"
}
in_time err attempt stop
