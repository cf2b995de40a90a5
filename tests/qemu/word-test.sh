# Whoever ends, the last thing that the motors hear is zero: cells of the table of examples/devices/README.md for a HID device
# behind a real hidraw, in the machine's own time. evdev-test.sh has some of them for a gamepad.
source "$(dirname "$0")/lib.sh"

stuck_grid 0
cat >profile.toml <<'TOML'
name = "test device"
[match]
vid = 0x16c0
pid = 0x0486
[input]
length = 64
x = {bit = 0, bits = 32, scale = 1e-6}
[[output]]
length = 64
x = {bit = 0, bits = 16, newtons_per_count = 0.001}
[force]
max = 3.0
[workspace]
low = [-0.08, 0, 0]
high = [0.08, 0, 0]
TOML
echo '-40000 0 0' >place.txt
cat >session <<'END'
play="play /stuck.0 --model-path /bin --force state --rate 250 --set safety.ramp=20 --max-force 0.5"
child() { cut -d' ' -f1 /proc/$1/task/$1/children; }
# cell WHO WHAT: what the device records, from the play's begin to its end.
cell() {
  echo "== $1 $2"
  rawhid-device --rate 250 /place.txt >/tmp/record & device=$!; await /dev/hidraw0
  $play --device hid:/profile.toml >/tmp/out 2>&1 & player=$!
  usleep 600000
  guard=$(child $player); adapter=$(child $guard)
  victims=
  for name in $(echo $1 | tr + ' '); do
    case $name in play) victims="$victims $player" ;; guard) victims="$victims $guard" ;; adapter) victims="$victims $adapter" ;; esac
  done
  disturb $2 $victims
  usleep 450000
  echo "running $(kill -0 $player 2>/dev/null && echo yes)"
  kill -CONT $player $guard $adapter 2>/dev/null
  kill -TERM $player 2>/dev/null; wait $player; echo "exit $?"  # in the background SIGINT is ignored
  tries=0; while kill -0 $guard 2>/dev/null || kill -0 $adapter 2>/dev/null; do
    usleep 20000; tries=$((tries + 1)); [ $tries -lt 300 ] || { echo "left alive"; break; }
  done
  kill $device; wait $device; tail -n 400 /tmp/record
  while [ -e /dev/hidraw0 ]; do usleep 10000; done
}
cell play KILL; cell play STOP; cell play 120; cell guard KILL; cell adapter KILL; cell adapter TERM; cell adapter STOP
cell adapter 120; cell play+guard KILL; cell play+adapter KILL; cell guard+adapter STOP
echo "== end"
END
TIMEOUT=${TIMEOUT:-400} machine "$qemu/rawhid-device" "$qemu/disturb" "$HAPGRID_BIN/play" "$HAPGRID_BIN/hapgrid-guard" \
  "$HAPGRID_BIN/hapgrid-hid" "$HAPGRID_BUILD/tests/plugins/stuck.so" stuck.0 profile.toml place.txt session -- 'sh session'
printf '%s\n' "$output" >got
python3 "$here/word_test.py" got
