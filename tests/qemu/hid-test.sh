#!/bin/bash
# Report descriptors as Linux reads them, and a PID class joystick's reports through a real hidraw.
source "$(dirname "$0")/lib.sh"

# A session is held twice: blocks that the first did not give back would be missing in the second.
cat >sessions <<'END'
set -e
kernel-fields
for layout in bits array high-ids; do
  pid-device $layout >/tmp/record &
  await /dev/hidraw0
  echo "$layout:"
  pid-session /dev/hidraw0
  pid-session /dev/hidraw0
  kill $!
  wait $!
  cut -d' ' -f2- /tmp/record
  while [ -e /dev/hidraw0 ]; do usleep 10000; done
done
END
machine "$qemu"/{kernel-fields,pid-device,pid-session} sessions -- 'sh sessions'

same 'fields' 'Teensy RawHID: 2 fields, the same
SpaceMouse: 4 fields, the same
mouse: 2 fields, the same
gamepad: 5 fields, the same
PID, bits: 26 fields, the same
PID, array: 26 fields, the same
PID, high ids: 26 fields, the same' "$(grep fields, <<<"$output")"

# The sequence of the PID class, byte for byte: arguments are the ids in hex and what differs.
session() {
  local effect=$1 constant=$2 operation=$3 free=$4 control=$5 gain=$6 create=$7 load=$8
  local reset=$9 enable=${10} stop=${11} east=${12} north=${13} n1=${14} p1=${15} half=${16} full=${17}
  local blocks=(01 02) directions=("$east" "$north") i
  echo 'at 0.025001 0.012500'
  echo 'at 0.025001 0.012500'
  local times
  for times in 1 2; do
    echo "output $control $reset"
    echo "output $control $enable"
    echo "output $gain ff"
    for i in 0 1; do
      echo "set $create 01 00 00"
      echo "get $load ${blocks[i]} 01 40 00"
      # index, constant force, no end, no repeat, sample, delay; gain, no button, direction enable
      echo "output $effect ${blocks[i]} 01 ff ff 00 00 00 00 00 00 ff 00 04 ${directions[i]}"
      echo "output $constant ${blocks[i]} 00 00"
      echo "output $operation ${blocks[i]} 01 ff"
    done
    echo "output $constant 01 $p1"
    echo "output $constant 02 $n1"
    echo "output $constant 01 $half"
    echo "output $constant 02 $full"
    echo "output $constant 01 00 00"
    echo "output $constant 02 00 00"
    echo "output $constant 01 00 00"
    echo "output $constant 02 00 00"
    echo "output $control $stop"
    echo "output $free 01"
    echo "output $free 02"
  done
}

of() { sed -n "/^$1:\$/,/^[a-z-]*:\$/{/:\$/!p}" <<<"$output"; }

# 1 N and 0.5 N of 2 N, and more than that; along y, which is turned: 16384, -16384, 8192, -32767.
same 'PID, bits' "$(session 01 05 0a 0b 0c 0d 11 12 08 01 04 '28 23 00 00' '00 00 00 00' \
  '00 c0' '00 40' '00 20' '01 80')" "$(of bits)"
# 5000, -5000, 2500, -10000; a circle of 256.
same 'PID, array' "$(session 01 05 0a 0b 0c 0d 05 06 04 01 03 '40 00' '00 00' \
  '78 ec' '88 13' 'c4 09' 'f0 d8')" "$(of array)"
# 2048, -2048, 1024, -4096.
same 'PID, high ids' "$(session 65 69 6e 6f 70 71 05 06 04 01 03 '28 23 00 00' '00 00 00 00' \
  '00 f8' '00 08' '00 04' '00 f0')" "$(of high-ids)"
