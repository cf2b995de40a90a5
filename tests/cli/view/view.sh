# What view makes of frames: report, trajectory, picture; and what it refuses.
source "$(dirname "$0")/../lib.sh"
frames=$HAPGRID_SOURCE/schemas/frame.capnp
seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
for i in {-90..90}; do echo "$(printf '%de-2' "$i") 0.01 0"; done >path
settings bare.toml 'safety.ramp = 0'
play grid --device path:path --config bare.toml --frames x.frames 2>/dev/null # 181 ticks: 6 frames

# The report.
report='model    hung-ball
spheres  49
frames   6, from 0 s to 0\.18 s
force    at most 0\.[0-9]+ N, at 0\.[0-9]+ s'
expect 0 "~$report" '' -- view x.frames
expect 0 "~$report" '' -- view <x.frames
expect 0 "~$report" '' -- view - <x.frames
# A scene alone is a stream, and so is one that ends behind any message.
size=$(capnp decode --short "$frames" Message <x.frames | sed -n 1p |
  capnp encode "$frames" Message | wc -c)
head -c "$size" x.frames >scene
expect 0 $'model    hung-ball\nspheres  49\nframes   0, from 0 s to 0 s\nforce    at most 0 N, at 0 s' '' -- view scene
expect 0 '' '' -- view scene --xyz -

# Other writers cut messages into segments.
capnp decode "$frames" Message <x.frames |
  capnp encode --segment-size=20 "$frames" Message >segments
view segments | cmp - <(view x.frames)

# The trajectory: as a file, on standard output, live through a pipe.
expect 0 '' '' -- view x.frames --xyz x.xyz
view --xyz - <x.frames | cmp - x.xyz
play grid --device path:path --config bare.toml --frames - 2>/dev/null | view --xyz - | cmp - x.xyz
same "lines" $((6 * 51)) "$(wc -l <x.xyz)"
same "first lines" $'49\ntime=0 tick=0 hip=-0.9,0.01,0 force=0,0,0 energy=0 units="time s, hip rope lengths, force N, energy N rope lengths"\nX 0.000000 0.000000 0.000000' \
  "$(head -3 x.xyz)"
view x.frames --xyz hip.xyz --hip-label Xx
same "the HIP" 'Xx -0.900000 0.010000 0.000000' "$(sed -n 52p hip.xyz)"
if command -v obabel >/dev/null; then
  for file in "x.xyz 49" "hip.xyz 50"; do
    # A molecule a frame; the fourth line of a MOL block starts with the number of its atoms.
    obabel -ixyz "${file% *}" -omol -m -O mol.mol 2>err || fail "$(cat err)"
    grep -q '^6 molecules converted' err || fail "Open Babel: $(cat err)"
    same "atoms" "${file#* }" "$(awk 'NR == 4 { print substr($0, 1, 3) + 0 }' mol6.mol)"
  done
else
  missing obabel
fi

# Pictures. png.py prints "W x H".
expect 0 '' '' -- view x.frames --png last.png
same "size" "800 x 600" "$(/usr/bin/python3 "$here/png.py" size last.png)"
view --png - <x.frames | cmp - last.png
view x.frames --at 1e6 --png - | cmp - last.png
play grid --device path:path --config bare.toml --frames - 2>/dev/null | view --png piped.png
cmp piped.png last.png
# The nearest frame, the earlier of two.
view x.frames --png at.png --at 0.12
for at in 0.101 0.13 0.1399; do view x.frames --png - --at $at | cmp - at.png; done
view x.frames --png - --at 0.02 | cmp - <(view x.frames --png - --at 0)
cmp -s at.png last.png && fail "all frames look the same"
# Pushed at x = 0.3: the ball (yellow) is right of the HIP (magenta), the arrow (teal) points to the left.
view x.frames --at 0.12 --from 0,0 --size 640x320 --png front.png
same "size" "640 x 320" "$(/usr/bin/python3 "$here/png.py" size front.png)"
/usr/bin/python3 "$here/png.py" order front.png teal magenta yellow
view x.frames --at 0.12 --from 180,-5 --size 640x320 --png back.png
/usr/bin/python3 "$here/png.py" order back.png yellow magenta teal
expect 0 '' '' -- view x.frames --png tiny.png --size 1x1 --from -30,20
same "size" "1 x 1" "$(/usr/bin/python3 "$here/png.py" size tiny.png)"

# Refused: one line, and no file is left.
mkdir empty
change() { capnp decode --short "$frames" Message <x.frames | sed -n "$1; 1,2p" | capnp encode "$frames" Message >changed; }
whole=$(stat -c %s x.frames)
refusals "$here/view.tsv"
nothing_left empty
