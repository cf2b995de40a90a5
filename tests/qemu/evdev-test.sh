# play with a gamepad that rumbles and a stick with force, as the kernel shows them; uinput makes both. The hand goes
# from the middle to the left end of the box, pushes the ball there, and it snaps; or the second button takes it to its
# other level. What ends the play: its duration; a
# device that takes no effect any more; SIGSTOP; the cable. Other ends are in slow/word-stick-test.sh.
source "$(dirname "$0")/lib.sh"

seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o ball.grid
settings play.toml 'mapping.offset = [0.2, 0, 0]' 'mapping.speed = 0.8' 'safety.ramp = 100'
cat >session <<'END'
# The hand begins at x = 0.175, to the right of the ball.
common="play /ball.grid --config /play.toml"
uinput-device gamepad >/tmp/gamepad & gamepad=$!
uinput-device stick --slow 110 >/tmp/stick &
await /dev/input/event1 /dev/input/event2
event() {
  for name in /sys/class/input/event*/device/name; do grep -qx "$1" $name && basename ${name%/device/name}; done
}
played() { $common --log /tmp/log.session "$@" >/dev/null; echo "exit $?"; }
kept() { cat "/tmp/$1"; echo "== ${2:-$1} session"; base64 /tmp/log.session; rm /tmp/log.session; }

echo "== list"; play --list-devices; event 'emulated stick'
nobody="/bin/setpriv --reuid 65534 --regid 65534 --clear-groups"
$nobody play --list-devices | tail -n 1
$nobody $common --device "evdev:/dev/input/$(event 'emulated stick')" >/dev/null; echo "exit $?"
echo "== gamepad"; played --device evdev:045e:028e --duration 1.4; kept gamepad
echo "== next"
(exec $common --log /tmp/log.session --device evdev:045e:028e --duration 1.4 >/dev/null) & player=$!
usleep 900000; kill -USR1 $gamepad; wait $player; echo "exit $?"; kept gamepad next
echo "== stick"; played --device evdev:1209:0001 --realtime off; kept stick
echo "== stopped"  # while it pushes the ball
(exec $common --device evdev:045e:028e --realtime off --duration 3 >/dev/null) & player=$!
usleep 900000; kill -STOP $player; usleep 900000; tail -n 60 /tmp/gamepad
kill -CONT $player; wait $player; echo "exit $?"
echo "== unplugged"
(exec $common --device evdev:045e:028e --realtime off >/dev/null) & player=$!
usleep 300000; kill $gamepad; wait $player; echo "exit $?"
echo "== end"
END
KERNEL=amd64 TIMEOUT=${TIMEOUT:-900} machine "$qemu/uinput-device" "$HAPGRID_BIN/play" "$HAPGRID_BIN/hapgrid-guard" "$HAPGRID_BIN/hapgrid-evdev" "$HAPGRID_BIN/hapgrid-hid" "$HAPGRID_BIN/hapgrid-spacemouse" "$(command -v setpriv)" \
  "$HAPGRID_BUILD/models/hung-ball.so" ball.grid play.toml session -- 'sh session'
printf '%s\n' "$output" >got
python3 "$here/evdev_test.py" got
