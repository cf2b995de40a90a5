# shellcheck shell=bash disable=SC2154
# What the tests of last words share.
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

# words hid|stick WHO.WHAT...: plays with the device, and disturbs WHO (play, guard and adapter, joined by +) by WHAT; checks
# the time until zero force with word_test.py.
words() {
  local device=$1
  shift
  hid_profile '-0.08, 0, 0' '0.08, 0, 0' >profile.toml
  settings play.toml 'safety.ramp = 20'
  echo '-40000 0 0' >place.txt
  cat >session <<'END'
hid() { rawhid-device --rate 250 /place.txt >/tmp/record & device=$!; await /dev/hidraw0; there=/dev/hidraw0; name=hid:/profile.toml; }
# The device is no process of its machine: one that spins there must not keep it from taking effects.
stick() { chrt -f 60 uinput-device stick >/tmp/record & device=$!; await /dev/input/event1; there=/dev/input/event1; name=evdev:1209:0001; }
child() { cut -d' ' -f1 /proc/$1/task/$1/children; }
# cell DEVICE WHO WHAT: what the device records, from the play's begin to its end.
cell() {
  echo "== $2 $3"
  $1
  play /stuck.0 --traversal paper --rate 250 --config /play.toml --max-force 0.5 --device $name >/tmp/out 2>&1 & player=$!
  usleep 600000
  guard=$(child $player); adapter=$(child $guard)
  victims=
  for who in $(echo $2 | tr + ' '); do
    case $who in play) victims="$victims $player" ;; guard) victims="$victims $guard" ;; adapter) victims="$victims $adapter" ;; esac
  done
  chrt -f 55 disturb $3 $victims
  usleep 600000
  echo "running $(kill -0 $player 2>/dev/null && echo yes)"
  kill -CONT $player $guard $adapter 2>/dev/null
  kill -TERM $player 2>/dev/null  # in the background SIGINT is ignored
  if [ $3 = SPIN ]; then kill -KILL $victims 2>/dev/null; fi
  wait $player; echo "exit $?"
  tries=0; while kill -0 $guard 2>/dev/null || kill -0 $adapter 2>/dev/null; do
    usleep 20000; tries=$((tries + 1)); [ $tries -lt 300 ] || { echo "left alive"; break; }
  done
  kill $device; wait $device; tail -n 400 /tmp/record
  while [ -e $there ]; do usleep 10000; done
}
END
  local cell
  for cell; do echo "cell $device ${cell%.*} ${cell#*.}"; done >>session
  echo 'echo "== end"' >>session
  KERNEL=$([[ $device == hid ]] && echo cloud-amd64 || echo amd64) TIMEOUT=${TIMEOUT:-$((400 + 60 * $#))} machine \
    "$qemu/rawhid-device" "$qemu/uinput-device" "$qemu/disturb" "$HAPGRID_BIN/play" "$HAPGRID_BIN/hapgrid-guard" \
    "$HAPGRID_BIN/hapgrid-hid" "$HAPGRID_BIN/hapgrid-evdev" "$HAPGRID_BUILD/tests/plugins/stuck.so" "$(command -v chrt)" \
    stuck.0 ./*.toml place.txt session -- 'sh session'
  printf '%s\n' "$output" >got
  python3 "$HAPGRID_SOURCE/tests/qemu/word_test.py" got "$device" "$@"
}

# all_words hid|stick: all cells of the table of examples/devices/README.md.
all_words() {
  local who what cells=()
  for who in play guard adapter play+guard play+adapter guard+adapter play+guard+adapter; do
    for what in KILL TERM SEGV STOP 120 500 SPIN; do cells+=("$who.$what"); done
  done
  stuck_grid 0
  words "$1" "${cells[@]}"
}
