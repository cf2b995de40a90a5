# play with a device behind the stand-in for hidapi, and the adapters of such devices alone: what the device is told last,
# however play or its adapter end.
source "$(dirname "$0")/../lib.sh"
if sanitized; then skip "the stand-in for hidapi takes no sanitizer"; fi
export PYTHONPATH=$here
stuck_grid 0
settings ramp.toml 'safety.ramp = 50'
settings mouse.toml 'safety.ramp = 50' 'mapping.speed = 0.4'
python3 "$here/adapters.py"
python3 "$here/device.py"
