# play with a device behind the stand-in for hidapi: what it is told last, however play ends; and what
# the haptic thread asks of the system.
source "$(dirname "$0")/../lib.sh"
if sanitized; then skip "the stand-in for hidapi takes no sanitizer"; fi
plugins=$HAPGRID_BUILD/tests/plugins
for crash in 0 1; do
  cat >stuck.toml <<TOML
[model]
plugin = "stuck"
[model.parameters]
crash = $crash
[grid]
origin = [-1, -1, -1]
spacing = 0.5
counts = [5, 5, 5]
TOML
  seed stuck.toml --model-path "$plugins" | expand --complete --model-path "$plugins" -o stuck.$crash
done
python3 "$here/device.py" "$plugins"
