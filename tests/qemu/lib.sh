# shellcheck shell=bash
# What the tests in the emulated machine share: a temporary directory and the checks of ../cli/lib.sh,
# `machine`, and the profile of the emulated device.
source "$(dirname "${BASH_SOURCE[0]}")/../cli/lib.sh"
qemu=$HAPGRID_BUILD/tests/qemu  # the programs for the machine

if sanitized; then skip "the emulated machine's programs are static: no sanitizer"; fi

# machine PROGRAM... -- COMMAND: run.sh; what the machine writes is in $output. A machine that cannot
# be had skips the test.
machine() {
  local code=0
  output=$(bash "$HAPGRID_SOURCE/tests/qemu/run.sh" "$@") || code=$?
  [[ $code != 77 ]] || { missing "$output"; exit 77; }
  [[ $code == 0 ]] || fail "exit code $code of the machine:"$'\n'"$output"
}

# hid_profile LOW HIGH: the profile of rawhid_device.c, whose handle reaches from LOW to HIGH, "X, Y, Z" in metres.
hid_profile() {
  cat <<TOML
name = "test device"
[match]
vid = 0x16c0
pid = 0x0486
[input]
length = 64
x = {bit = 0, bits = 32, scale = 1e-6}
y = {bit = 32, bits = 32, scale = 1e-6}
z = {bit = 64, bits = 32, scale = 1e-6}
clutch = {bit = 128}
[[output]]
length = 64
x = {bit = 0, bits = 16, newtons_per_count = 0.001}
y = {bit = 16, bits = 16, newtons_per_count = 0.001}
z = {bit = 32, bits = 16, newtons_per_count = 0.001}
[force]
max = 3.0
[timing]
stall_ms = 50
watchdog_ms = 50
[workspace]
low = [$1]
high = [$2]
TOML
}
