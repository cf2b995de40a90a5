#!/bin/bash
# Report descriptors as Linux reads them. (play-test.sh plays with a PID joystick behind a real hidraw;
# the reports for other joysticks are in tests/unit/device.) Then the emulated three-axis device itself:
# reports at the rate that was asked for, forces as they were sent, unplugged when told to. 5000 Hz in
# the machine's own time, however slow it is here.
source "$(dirname "$0")/lib.sh"

cat >positions.txt <<'END'
1 -2 3
100000 -200000 300000
-2147483648 2147483647 0
END
cat >session <<'END'
set -e
kernel-fields
echo "== device"
rawhid-device --rate 5000 --unplug-after 2000 positions.txt >/tmp/record &
await /dev/hidraw0
exec 3<>/dev/hidraw0
# A report with its id 0: forces 1, -2 and 32767 mN, flags 513; then one that is a byte short.
zeros() { head -c "$1" /dev/zero; }
{ printf '\0\1\0\376\377\377\177\1\2'; zeros 56; } >/tmp/report
cat /tmp/report >&3
{ head -c 64 /tmp/report; } >/tmp/short
cat /tmp/short >&3
head -c 256 <&3 | hexdump -v -e '1/4 "%d " 1/4 "%d " 1/4 "%d " 1/4 "%u " 1/1 "%u" 47/1 "" "\n"'
wait $!
test ! -e /dev/hidraw0
cat /tmp/record
END
machine "$qemu/kernel-fields" "$qemu/rawhid-device" positions.txt session -- 'sh session'
same 'fields' 'Teensy RawHID: 2 fields, the same
SpaceMouse: 4 fields, the same
mouse: 2 fields, the same
gamepad: 5 fields, the same
PID, bits: 26 fields, the same
PID, array: 26 fields, the same
PID, high ids: 26 fields, the same' "$(grep fields, <<<"$output")"
output=${output#*== device$'\n'}

same 'input reports' '1 -2 3 0 0
100000 -200000 300000 1 0
-2147483648 2147483647 0 2 0
-2147483648 2147483647 0 3 0' "$(head -n 4 <<<"$output")"
same 'events' 'open
out 1 -2 32767 513
short 64' "$(grep -v end <<<"$output" | tail -n +5 | cut -d' ' -f2-)"
# The last of 2000 reports is 0.3998 s behind the first. A report takes some 20 microseconds of the
# machine's time; half a period of lateness is allowed.
awk '$2 == "end" { found = 1; exit !($3 == 2000 && $1 >= 399800 && $1 < 401000 && $4 < 100) }
  END { if (!found) exit 1 }' <<<"$output" || fail "rate: $(grep end <<<"$output")"
