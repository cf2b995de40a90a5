#!/bin/bash
# Report descriptors as Linux reads them. play-test.sh plays with a PID joystick behind a real hidraw;
# the reports for other joysticks are in tests/unit/device.
source "$(dirname "$0")/lib.sh"

machine "$qemu/kernel-fields" -- kernel-fields
same 'fields' 'Teensy RawHID: 2 fields, the same
SpaceMouse: 4 fields, the same
mouse: 2 fields, the same
gamepad: 5 fields, the same
PID, bits: 26 fields, the same
PID, array: 26 fields, the same
PID, high ids: 26 fields, the same' "$(grep fields, <<<"$output")"
