# All cells of the table of examples/devices/README.md in the emulated machine: a HID device.
source "$(dirname "$0")/../words.sh"
all_words hid
