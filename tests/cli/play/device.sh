# play with a device behind the stand-in for hidapi: what it is told last, however play ends; and what
# the haptic thread asks of the system.
source "$(dirname "$0")/../lib.sh"
if sanitized; then skip "the stand-in for hidapi takes no sanitizer"; fi
stuck_grid 0
python3 "$here/device.py" "$HAPGRID_BUILD/tests/plugins"
