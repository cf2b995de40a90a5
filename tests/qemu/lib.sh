# shellcheck shell=bash
# What the tests in the emulated machine share: a temporary directory and the checks of ../cli/lib.sh,
# and `machine`.
source "$(dirname "${BASH_SOURCE[0]}")/../cli/lib.sh"
qemu=$HAPGRID_BUILD/tests/qemu  # the programs for the machine

if sanitized; then skip "the emulated machine's programs are static: no sanitizer"; fi

# machine PROGRAM... -- COMMAND: run.sh; what the machine writes is in $output. A machine that cannot
# be had skips the test.
machine() {
  local code=0
  output=$(bash "$here/run.sh" "$@") || code=$?
  [[ $code != 77 ]] || { missing "$output"; exit 77; }
  [[ $code == 0 ]] || fail "exit code $code of the machine:"$'\n'"$output"
}
