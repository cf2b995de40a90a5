# Whoever ends, the last thing that the motors hear is zero: cells of the table of examples/devices/README.md for a HID device
# behind a real hidraw, in the machine's own time; evdev-test.sh has some for a gamepad, and qemu/slow/ has all cells, for a
# stick as well.
source "$(dirname "$0")/words.sh"
stuck_grid 0
words hid play.KILL play.STOP play.120 guard.KILL guard.SPIN adapter.KILL adapter.TERM adapter.STOP adapter.120 adapter.SPIN \
  play+guard.KILL play+adapter.KILL guard+adapter.STOP
