# The bring-up of a device, with a person at a pseudo-terminal: what it finds of a device that is not as it says, and that
# every way out of it ends with zero force.
source "$(dirname "$0")/../lib.sh"
! grep -q '^HAPGRID_SANITIZE:STRING=thread' "$HAPGRID_BUILD/CMakeCache.txt" || skip "the thread sanitizer computes longer than a real-time thread may"
stuck_grid 0
in_time "$work/errors" python3 "$here/bring_up.py" "$work/errors"
