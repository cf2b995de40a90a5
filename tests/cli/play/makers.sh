# play with the adapters of examples/devices, before stand-ins for makers' kits.
source "$(dirname "$0")/../lib.sh"
stuck_grid 0
settings ramp.toml 'safety.ramp = 50'
python3 "$here/makers.py"

# The example without hardware. An adapter in Python is short, and needs no package.
devices=$HAPGRID_SOURCE/examples/devices
handle() {
  play stuck.0 --device "process:/usr/bin/python3 -I -S $devices/handle.py" --traversal paper --duration 0.5 --log handle.session >/dev/null 2>err || fail "$(cat err)"
}
in_time err handle
grep -q '^play: a handle on a spring at 1000 Hz; ' err || fail "$(cat err)"
python3 "$HAPGRID_SOURCE/tests/cli/stats/session.py" text handle.session >handle.txt
[[ $(cut -f 2-4 handle.txt | sort -u | wc -l) -gt 100 ]] || fail "it does not move"
(($(wc -l <"$devices/handle.py") <= 50)) || fail "handle.py has more than 50 lines"
