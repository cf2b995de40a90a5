# The page of view --html: in a browser without a screen it shows the picture of --png at any time of play, the
# numbers and the snaps, loads nothing from elsewhere, and has nothing to complain about.
source "$(dirname "$0")/../lib.sh"
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90} {89..-90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
settings bare.toml 'safety.ramp = 0'
play grid --device path:path --config bare.toml --frames x.frames --log x.session 2>words
snaps=$(sed -nE 's/.*the state snapped in ([0-9]+) ticks?/\1/p' words)
((snaps > 0)) || fail "nothing snaps"

expect 0 '' '' -- view x.frames --html x.html
view --html - <x.frames | cmp - x.html
# A session is played again for its page.
refuses 'view: x.session: a session has no shape to show; play GRID --device replay:FILE .*' -- \
  view x.session --html y.html
play grid --device replay:x.session --frames - 2>/dev/null | view --html - | cmp - x.html
# The strings of a stream end no script.
frames=$HAPGRID_SOURCE/schemas/frame.capnp
capnp decode "$frames" Message <x.frames | sed 's|"hung-ball"|"</script><script>alert(1)"|' |
  capnp encode "$frames" Message >hostile
view hostile --html hostile.html
grep -q '</script><script>alert' hostile.html && fail "a model's name is code"
capnp decode "$frames" Message <x.frames | sed 's|hipRadius = [0-9.e-]*|hipRadius = 1.7e308|' |
  capnp encode "$frames" Message >large
refuses 'view: (large: )?the picture has no size: a radius or the box is too large' -- prlimit --as=$((1 << 30)) view large --html large.html
grep -E '<(script|link|img|iframe)[^>]*(src|href)|@import|url\(' x.html | grep -v '<link rel="icon" href="data:,">' && fail "loads from elsewhere"
# 30 s of a molecule of 75 atoms take at most 3 MB: 750 frames of 75 spheres, 80 bonds, and 400 bytes besides.
(($(stat -c %s x.html) + 750 * (75 * 3 * 8 + 80 * 8 + 400) < 3000000)) || fail "large"

needs chromium chromium
# browse ARGUMENTS... URL: what the page has to say is on standard error. Chromium sometimes hangs when it starts on a
# busy machine: then it is started again.
browse() {
  for _ in 1 2 3; do
    rm -rf browser
    chromium_once "$@" && break
  done
  grep CONSOLE messages && fail "messages of the page"
  return 0
}
chromium_once() {
  timeout 60 chromium --headless --no-sandbox --hide-scrollbars --use-angle=swiftshader --enable-unsafe-swiftshader \
    --user-data-dir="$work/browser" --window-size=400,573 --virtual-time-budget=200 --enable-logging=stderr \
    "$@" 2>messages
}
# Rims and lines differ, which are a pixel wide here. Much differ 8 of 1,000 (measured), and 70 as soon as the view is
# a degree off.
browse --screenshot=shot.png "file://$PWD/x.html#t=0.12"
same "size" "400 x 573" "$(/usr/bin/python3 "$here/png.py" size shot.png)"
view x.frames --at 0.12 --size 400x300 --png drawn.png
/usr/bin/python3 "$here/png.py" near shot.png drawn.png 0.06 0.012
view x.frames --at 0.12 --size 400x300 --png drawn.png --from 31,20
/usr/bin/python3 "$here/png.py" near shot.png drawn.png 0.06 0.012 2>/dev/null && fail "compares nothing"
# Balls and sticks.
view x.frames --style sticks --html sticks.html
browse --screenshot=shot.png "file://$PWD/sticks.html#t=0.12"
view x.frames --at 0.12 --size 400x300 --style sticks --png drawn.png
/usr/bin/python3 "$here/png.py" near shot.png drawn.png 0.06 0.012
view x.frames --at 0.12 --size 400x300 --png drawn.png
/usr/bin/python3 "$here/png.py" near shot.png drawn.png 0.06 0.012 2>/dev/null && fail "whole spheres"
# At the end, with the hostile name: the last frame's numbers, and every snap that play counted.
browse --dump-dom "file://$PWD/hostile.html#t=99" >dom
last=$(view x.frames | sed -nE 's/^frames .* to ([0-9.]+) s$/\1/p')
same "status" "~t $last s   force [0-9.e-]+ N   energy [0-9.e-]+ N rope lengths   snaps $snaps of $snaps" \
  "$(sed -nE 's/.*<div id="status">([^<]*)<.*/\1/p' dom)"
# Without WebGL the page says so, and shows the same numbers and the curve of the force, which is all that is teal.
for picture in --dump-dom --screenshot=bare.png; do
  browse --disable-gpu --disable-3d-apis "$picture" "file://$PWD/x.html#t=99" >dom
  [[ $picture == --dump-dom ]] || break
  grep -q '<div id="say"[^>]*>This browser has no WebGL' dom || fail "does not say that there is no picture"
  same "status" "~t $last s   force .*   snaps $snaps of $snaps" "$(sed -nE 's/.*<div id="status">([^<]*)<.*/\1/p' dom)"
done
/usr/bin/python3 "$here/png.py" order bare.png teal
# The live page does not grow in ten minutes. A browser sometimes hangs on a busy machine.
ten_minutes() {
  : >err
  /usr/bin/python3 "$here/minutes.py" x.html 2>err || fail "$(cat err)"
}
in_time err ten_minutes
