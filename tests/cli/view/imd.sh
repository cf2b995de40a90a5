# view --imd: an independent client compares the bytes.
source "$(dirname "$0")/../lib.sh"
frames=$HAPGRID_SOURCE/schemas/frame.capnp
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90} {90..-90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
play grid --device path:path --frames x.frames 2>/dev/null
for i in {1..60}; do cat path; done >long
play grid --device path:long --frames long.frames 2>/dev/null
python3 "$here/imd.py" ball "$frames" x.frames long.frames

# Lengths that are converted: mm.
seed "$HAPGRID_SOURCE/examples/spring-c/spring-c.toml" --set grid.spacing=5 \
  --set 'grid.counts=[9,7,7]' | expand --complete -o spring
for i in {-80..80} {80..-80}; do echo "$(printf '%de-1' "$i") 1 0.5"; done >rail
play spring --device path:rail --frames spring.frames 2>/dev/null
python3 "$here/imd.py" spring "$frames" spring.frames

# Nobody comes: a stream does not wait, and its writer neither.
play grid --device path:path --frames - 2>/dev/null | expect 0 '' "~view: IMD on 127.0.0.1:[0-9]+
view: IMD: lengths go out in rope lengths, viewers take them for angstrom
view: IMD: energies go out in N rope lengths, viewers take them for kcal/mol
view: IMD viewers 0, frames sent 0" -- view --imd=0
# Refused.
help='\(see view --help\)'
expect 2 '' "~view: --png excludes --imd $help" -- view x.frames --imd --png a.png
# No program with a device opens the network.
expect 2 '' '~play: The following arguments were not expected: .*' -- play grid --device path:path --imd 0
