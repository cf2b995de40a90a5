# The window of view, on an X server without a screen and Mesa's software OpenGL: that it shows what --png draws, takes
# the keys, and says in one line where there is no display.
source "$(dirname "$0")/../lib.sh"
unset DISPLAY WAYLAND_DISPLAY
terminal='--terminal shows frames in a terminal, --png draws one into a file'
# What OpenGL and X keep at the end is theirs, and so is how Mesa's threads share the picture.
export ASAN_OPTIONS=detect_leaks=0 VALGRIND_OPTS=--leak-check=no LIBGL_ALWAYS_SOFTWARE=1
if sanitized; then export LP_NUM_THREADS=0; fi

seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
play grid --device path:path --set safety.ramp=0 --frames frames 2>/dev/null

# Nothing here shows windows: one line, and no file is left.
mkdir empty
refuses "view: no window: .*DISPLAY.*; $terminal" -- view frames --window --screenshot empty/x
DISPLAY=:nowhere refuses "view: no window: .*; $terminal" -- view --window <frames
nothing_left empty
see='(see view --help)'
expect 2 '' "view: --png excludes --window $see" -- view frames --window --png x
expect 2 '' "view: --close requires --window $see" -- view frames --close
expect 2 '' "view: --screenshot requires --window $see" -- view frames --screenshot x

source "$here/../xvfb.sh"
needs xdotool xdotool
start_x -extension GLX
refuses "view: no window: .*; $terminal" -- view frames --window --screenshot empty/x
start_x

# A whole file in its own time; the last frame stays. The same picture as --png, above the curves: OpenGL has 2 x 2 rays a
# pixel and --png has 3 x 3, so that rims differ. Much differ 23 of 10,000 at most (measured), and 200 as soon as the
# view is a degree off.
same_picture() { /usr/bin/python3 "$here/png.py" near "$1" drawn.png 0.04 0.0025; }
how=(--azimuth=-70 --elevation=65)
expect 0 '' '' -- view --window --close --size 360x360 "${how[@]}" --screenshot shot.png <frames
view frames --png drawn.png --size 360x240 "${how[@]}"
same_picture shot.png
view frames --png drawn.png --size 360x240 --azimuth=-69 --elevation=65
same_picture shot.png 2>/dev/null && fail "compares nothing"
refuses 'view: nowhere/x: No such file or directory' -- view frames --window --close --screenshot nowhere/x

# Live: s writes the picture, the wheel changes it, r undoes that; at the end of the stream it stays, until q.
view frames --png drawn.png --size 360x240
view --window --size 360x360 <frames 2>err &
view=$!
wait_for 60 "window" xdotool search --onlyvisible --name '^hung-ball - hapgrid view$'
xdotool mousemove --window "$(xdotool search --name '^hung-ball - hapgrid view$')" 100 100
shoot() {
  xdotool key s
  wait_for 60 "picture" compgen -G 'hapgrid-180.png'
  mv hapgrid-180.png "$1"
}
shoot first.png
same_picture first.png
xdotool click 4
shoot changed.png
cmp -s first.png changed.png && fail "the wheel does nothing"
xdotool key r
shoot reset.png
cmp first.png reset.png
kill -0 $view || fail "it went with the stream"
xdotool key q
wait $view
grep -qx "view: wrote hapgrid-180.png" err || fail "$(cat err)"
