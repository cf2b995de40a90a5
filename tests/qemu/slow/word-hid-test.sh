# All cells of the table of examples/devices/README.md in the emulated machine: a HID device.
source "$(dirname "$0")/../words.sh"
stuck_grid 0
cells=()
for who in play guard adapter play+guard play+adapter guard+adapter play+guard+adapter; do
  for what in KILL TERM SEGV STOP 120 500 SPIN; do cells+=("$who.$what"); done
done
words hid "${cells[@]}"
