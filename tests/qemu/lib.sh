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
hid_profile() { sed "s/^low = .*/low = [$1]/; s/^high = .*/high = [$2]/" "$HAPGRID_SOURCE/tests/qemu/profile.toml"; }
