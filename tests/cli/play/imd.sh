# play --imd: an independent client compares the bytes.
source "$(dirname "$0")/../lib.sh"
frames=$HAPGRID_SOURCE/schemas/frame.capnp
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90} {90..-90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
python3 "$here/imd.py" ball "$frames" grid path

# Lengths that are converted: mm.
seed "$HAPGRID_SOURCE/examples/spring-c/spring-c.toml" --set grid.spacing=5 \
  --set 'grid.counts=[9,7,7]' | expand --complete -o spring
for i in {-80..80} {80..-80}; do echo "$(printf '%de-1' "$i") 1 0.5"; done >rail
python3 "$here/imd.py" spring "$frames" spring rail

# Nobody comes.
expect 0 '' "~play: IMD version 3 on 127.0.0.1:[0-9]+
play: IMD: lengths go out in rope lengths, viewers take them for angstrom
play: IMD: energies go out in N rope lengths, viewers take them for kJ/mol
play: IMD: no viewer within 0.1 s
play: 362 ticks, .*
play: ticks outside .*
play: IMD viewers 0, frames sent 0, dropped 0; closed because they did not read 0" \
  -- play grid --device path:path --imd 0 --imd-version 3 --set imd.wait=0.1
if [[ -e /proc/net/if_inet6 ]] && grep -q ' lo$' /proc/net/if_inet6; then
  play grid --device path:path --imd 0 --imd-address ::1 2>err
  grep -qxE 'play: IMD version 2 on \[::1\]:[0-9]+' err || fail "$(cat err)"
fi

# Refused.
help='(see play --help)'
expect 2 '' "play: --imd: '65536' is not a port from 0 to 65535 $help" \
  -- play grid --device path:path --imd 65536
expect 2 '' "~play: --imd-version: 1 not in .*" -- play grid --device path:path --imd 0 --imd-version 1
expect 2 '' "play: --imd-address: 'localhost' is not an address in numbers $help" \
  -- play grid --device path:path --imd 0 --imd-address localhost
expect 2 '' "play: --imd-version requires --imd $help" -- play grid --device path:path --imd-version 3
