# The window of view, on an X server without a screen and Mesa's software OpenGL: that it shows what
# --png draws, that frames are shown as they come, keys and mouse, and where there is no display.
source "$(dirname "$0")/../lib.sh"
unset DISPLAY WAYLAND_DISPLAY
frames=$HAPGRID_SOURCE/schemas/frame.capnp
terminal='--terminal shows frames in a terminal, --png draws one into a file'
# What OpenGL and X keep at the end is theirs, and so is how Mesa's threads share the picture.
export ASAN_OPTIONS=detect_leaks=0 VALGRIND_OPTS=--leak-check=no LIBGL_ALWAYS_SOFTWARE=1
if sanitized; then export LP_NUM_THREADS=0; fi

seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
play grid --device path:path --set safety.ramp=0 --frames ball.frames 2>/dev/null
molecule=$HAPGRID_SOURCE/examples/molecule/alanine-dipeptide/alanine-dipeptide.toml
seed "$molecule" --set grid.spacing=3 --set 'grid.counts=[4,4,4]' --set 'grid.origin=[-4.5,-4.5,-4.5]' |
  expand --complete -j 2 -o molecule.grid
for i in {0..60}; do echo "0 -3 $(printf '%de-1' $((i - 30)))"; done >path
play molecule.grid --device path:path --set safety.ramp=0 --frames molecule.frames 2>/dev/null

# one FRAMES NUMBER: the scene and one frame.
one() {
  capnp decode --short "$frames" Message <"$1" | sed -n "1p;$(($2 + 1))p" |
    capnp encode "$frames" Message
}
one ball.frames 4 >ball.one
one molecule.frames 2 >molecule.one
capnp decode --short "$frames" Message <ball.frames | sed -n 1p | capnp encode "$frames" Message >scene

# Nothing here shows windows: one line, and no file is left.
mkdir empty
refuses "view: no window: .*DISPLAY.*; $terminal" -- view ball.frames --window --screenshot empty/x
DISPLAY=:nowhere refuses "view: no window: .*; $terminal" -- view --window <ball.frames
nothing_left empty
see='(see view --help)'
expect 2 '' "view: --png excludes --window $see" -- view ball.frames --window --png x
expect 2 '' "view: --close requires --window $see" -- view ball.frames --close
expect 2 '' "view: --screenshot requires --window $see" -- view ball.frames --screenshot x
expect 2 '' "view: --size requires --png or --window $see" -- view ball.frames --size 10x10
expect 2 '' "view: --azimuth requires --png, --html, --window or --terminal $see" -- \
  view ball.frames --azimuth 1

source "$here/../xvfb.sh"
needs xdotool xdotool
start_x -extension GLX
refuses "view: no window: .*; $terminal" -- view ball.frames --window --screenshot empty/x
nothing_left empty
start_x

# The same picture as --png, above the curves. OpenGL has 2 x 2 rays a pixel and --png has 3 x 3, so
# that rims differ: 12 lines of some 150 pixels and the outlines of spheres are 3 of 100 pixels.
# Much differ 23 of 10,000 at most (measured; most are of the legend's lines and letters, whose strokes are one pixel
# wide, wherever these fall between two pixels), and 200 as soon as the view is a degree off.
for name in ball molecule; do
  for angles in "30 20" "-70 65"; do
    read -r azimuth elevation <<<"$angles"
    how=(--azimuth="$azimuth" --elevation="$elevation")
    expect 0 '' '' -- view $name.one --window --close --size 360x360 "${how[@]}" --screenshot shot.png
    same "size" "360 x 360" "$(/usr/bin/python3 "$here/png.py" size shot.png)"
    view $name.one --png drawn.png --size 360x240 "${how[@]}"
    /usr/bin/python3 "$here/png.py" near shot.png drawn.png 0.04 0.0025
  done
  # And the comparison sees a degree.
  view $name.one --png drawn.png --size 360x240 --azimuth=-69 --elevation=65
  /usr/bin/python3 "$here/png.py" near shot.png drawn.png 0.04 0.002 2>/dev/null && fail "compares nothing"
done
# HIP and force from the side, as in view.sh, and a low window is the picture alone.
view ball.one --window --close --azimuth 0 --elevation 0 --size 640x200 --hip-radius 0.1 \
  --screenshot front.png
/usr/bin/python3 "$here/png.py" order front.png red blue yellow
view ball.one --png drawn.png --azimuth 0 --elevation 0 --size 640x200 --hip-radius 0.1
/usr/bin/python3 "$here/png.py" near front.png drawn.png 0.04 0.002

# Live: the window stays, the newest frame is in it, keys and mouse do what the help says.
mkfifo live
mkdir shots
cd shots
view ../live --window --size 360x360 --screenshot ../last.png 2>../err &
view=$!
exec 4>../live
cat ../molecule.one >&4
wait_for 60 "window" xdotool search --onlyvisible --name '^molecule - hapgrid view$'
window=$(xdotool search --name '^molecule - hapgrid view$')
same "window" "~(.|"$'\n'")*Geometry: 360x360(.|"$'\n'")*" "$(xdotool getwindowgeometry "$window")"
same "named" 'molecule - hapgrid view' "$(xdotool getwindowname "$window")"
xdotool mousemove --window "$window" 100 100

# shoot NAME: presses s and takes the file that it writes, before a first frame when that is there.
tick=$(capnp decode --short "$frames" Message <../molecule.one | sed -nE '2s/.*tick = ([0-9]+).*/\1/p')
shoot() {
  xdotool key s
  wait_for 60 "picture" test -e "hapgrid-$tick.png"
  mv "hapgrid-$tick.png" "../$1"
}
shoot first.png
view ../molecule.one --png ../drawn.png --size 360x240
/usr/bin/python3 "$here/png.py" near ../first.png ../drawn.png 0.04 0.0025
shoot again.png
cmp ../first.png ../again.png
# changes WHAT UNDO WORD...: what xdotool does, and a key that undoes it.
changes() {
  xdotool "${@:3}"
  shoot changed.png
  cmp -s ../first.png ../changed.png && fail "$1 does nothing"
  xdotool key "$2"
  shoot reset.png
  cmp ../first.png ../reset.png
}
changes "the wheel" r click 4
changes dragging r mousedown 1 mousemove_relative 50 20 mouseup 1
changes "dragging with the right button" r mousedown 3 mousemove_relative 40 0 mouseup 3
# Help is in place of the curves.
changes h question key h
xdotool key h
shoot help.png
/usr/bin/python3 "$here/png.py" near ../help.png ../drawn.png 0.04 0.0025
xdotool key h
# Balls and sticks, and whole spheres again.
xdotool key b
shoot sticks.png
view ../molecule.one --png ../sticks.drawn.png --size 360x240 --style sticks
/usr/bin/python3 "$here/png.py" near ../sticks.png ../sticks.drawn.png 0.045 0.0025
/usr/bin/python3 "$here/png.py" near ../sticks.png ../drawn.png 0.045 0.0025 2>/dev/null && fail "b changes nothing"
xdotool key b
shoot reset.png
cmp ../first.png ../reset.png
# Paused, another frame changes nothing; then it is there.
xdotool key space
wait_for 60 "window" xdotool search --name '^molecule - hapgrid view \(paused\)$'
size=$(capnp decode --short "$frames" Message <../molecule.frames | sed -n 1p |
  capnp encode "$frames" Message | wc -c)
one ../molecule.frames 3 | tail -c +$((size + 1)) >&4
shoot paused.png
/usr/bin/python3 "$here/png.py" near ../paused.png ../drawn.png 0.04 0.0025
xdotool key space
wait_for 60 "window" xdotool search --name '^molecule - hapgrid view$'
tick=$(capnp decode --short "$frames" Message <../molecule.frames |
  sed -nE '4s/.*tick = ([0-9]+).*/\1/p')
shoot next.png
cmp -s ../paused.png ../next.png && fail "the next frame is not shown"
# At the end of the stream it stays, until q.
exec 4>&-
kill -0 $view || fail "it went with the stream"
xdotool key q
wait $view
grep -qx "view: wrote hapgrid-$tick.png" ../err || fail "$(cat ../err)"
cmp -s ../last.png ../paused.png && fail "--screenshot is not what was shown last"
same "size" "360 x 360" "$(/usr/bin/python3 "$here/png.py" size ../last.png)"
cd ..

# A whole file in its own time: 0.18 s and not a tenth of that; the last frame stays.
expect 0 '' '' -- view --window --close --size 360x360 --screenshot shot.png <ball.frames
cmp -s shot.png front.png && fail "shows the first frame"

# A stream without frames, and a picture that cannot be written.
expect 0 '' '' -- view scene --window --close
refuses 'view: scene: no frame in it, nothing to draw' -- \
  view scene --window --close --screenshot empty/x
nothing_left empty
refuses 'view: nowhere/x: No such file or directory' -- \
  view ball.one --window --close --screenshot nowhere/x
