#!/bin/bash
# play with gamepads and sticks with force, as the kernel shows them: two that uinput makes, a stick of
# the PID class on USB behind hid-pidff, and an Xbox controller behind hid-microsoft. The hand goes from
# the middle to the left end of the box, pushes the ball there, and it snaps. What ends the play: its
# duration; a device that takes no effect any more; SIGSTOP; SIGKILL; the cable.
source "$(dirname "$0")/lib.sh"

seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o ball.grid
cat >session <<'END'
# The hand begins at x = 0.175, to the right of the ball.
common="play /ball.grid --model-path /bin --set mapping.offset=[0.2,0,0] --set mapping.speed=0.8 --set safety.ramp=100"
usb-device >/tmp/usb &
gamepad-device >/tmp/xbox &
uinput-device gamepad >/tmp/gamepad & gamepad=$!
uinput-device stick --slow 150 >/tmp/stick &
await /dev/input/event1 /dev/input/event2 /dev/input/event3 /dev/input/event4
event() {
  for name in /sys/class/input/event*/device/name; do grep -qx "$1" $name && basename ${name%/device/name}; done
}
played() { $common --log /tmp/log.session "$@" >/dev/null; echo "exit $?"; }
kept() { cat "/tmp/$1"; echo "== $1 session"; base64 /tmp/log.session; rm /tmp/log.session; }
# after MICROSECONDS SIGNAL, to the play that was started last
after() { usleep "$1"; kill -$2 $player; }

echo "== list"; play --list-devices; event 'emulated stick'
nobody="/bin/setpriv --reuid 65534 --regid 65534 --clear-groups"
$nobody play --list-devices | tail -n 1
$nobody $common --device "evdev:/dev/input/$(event 'emulated stick')" >/dev/null; echo "exit $?"
echo "== gamepad"; played --device evdev:045e:028e --duration 1.4; kept gamepad
echo "== stick"; played --device evdev:1209:0001 --realtime off; kept stick
echo "== usb"
(exec $common --device evdev:2341:8036 --realtime off --log /tmp/log.session >/dev/null) & player=$!
after 1050000 STOP; usleep 800000
echo "stopped"; tail -n 1 /tmp/usb
kill -CONT $player; wait $player; echo "exit $?"; kept usb
echo "== xbox"
(exec $common --device evdev:045e:02fd --realtime off >/dev/null) & player=$!
after 1150000 KILL; wait $player; echo "exit $?"; usleep 300000; cat /tmp/xbox
echo "== unplugged"
(exec $common --device evdev:045e:028e --realtime off >/dev/null) & player=$!
usleep 300000; kill $gamepad; wait $player; echo "exit $?"
echo "== end"
END
KERNEL=amd64 TIMEOUT=300 machine "$qemu"/{usb,gamepad,uinput}-device "$HAPGRID_BIN/play" "$(command -v setpriv)" \
  "$HAPGRID_BUILD/models/hung-ball.so" ball.grid session -- 'sh session'
printf '%s\n' "$output" >got
python3 "$here/evdev_test.py" got
