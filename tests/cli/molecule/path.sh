# `hapgrid molecule --path`: the committed paths are walked over their barriers and back; what is wrong with frames is mended, or
# refused in one line. xtb is not asked, since the titles have energies.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"
paths=$HAPGRID_SOURCE/examples/molecule/paths

for one in sn2:26.81 malonaldehyde:15.69 ammonia:25.55; do
  name=${one%:*}
  hapgrid molecule "$paths/$name.xyz" --path -o "$name" --quiet >line 2>said || fail "$(cat said)"
  within "the barrier of $name" "$(over "$name" 0 1 | cut -d ' ' -f 4)" "$(bc <<<"${one#*:} - 0.05")" "$(bc <<<"${one#*:} + 0.05")"
done
grep -q '"energies": \[' sn2/index.html || fail "the page has no profile"
# An end that two paths share makes them one; a ring closes.
take() { awk -v from="$2" -v to="$3" 'NF == 1 { n++ } n >= from && n <= to' "$paths/$1.xyz"; }
take sn2 1 8 >one.xyz && take sn2 8 21 >two.xyz
hapgrid molecule two.xyz one.xyz --path -o both --until definition --quiet >line 2>said || fail "$(cat said)"
same "nodes" 21 "$(grep -c ^dE= "both/two+one.xyz")"

# Mended, and said: the same path comes out, but for its direction.
read -r -d '' shuffle <<'END' || true
import sys
lines = open(sys.argv[1]).read().splitlines()
size = int(lines[0]) + 2
frames = [lines[k:k + size] for k in range(0, len(lines), size)]
def turned(frame, signs, order):
    rows = [line.split() for line in frame[2:]]
    return frame[:2] + [" ".join([rows[k][0], *(str(sign * float(v)) for sign, v in zip(signs, rows[k][1:]))]) for k in order]
plain = range(size - 2)
kind = sys.argv[2]
if kind == "order":
    frames = frames[1::2] + frames[0::2]
elif kind == "doubled":
    frames = frames[:5] + frames[3:]
elif kind == "mirrored":
    frames[6] = turned(frames[6], (1, 1, -1), plain)
elif kind == "numbered":
    frames[6] = turned(frames[6], (-1, -1, 1), list(plain)[::-1])
elif kind == "ev":
    for frame in frames:
        frame[1] = "energy=%.9f" % (float(frame[1].split()[0][2:]) * 27.211386245988)
elif kind == "bare":
    frames = [[frame[0], "", *frame[2:]] for frame in frames]
elif kind == "hole":
    frames = frames[:4] + frames[-4:]
elif kind == "other":
    frames[4] = [str(size - 3), *frames[4][1:-1]]
print("\n".join(line for frame in frames for line in frame))
END
profile() { sed -n 's/.*dE=\([^ ]*\) .*/\1/p' "$1/$2.xyz" | sort -n; }
# mends KIND SAID MOLECULE FOLDER: FOLDER has the same path from frames that are as they should be.
mends() {
  /usr/bin/python3 -c "$shuffle" "$paths/$3.xyz" "$1" >"$1.xyz"
  hapgrid molecule "$1.xyz" --path -o "$1" --until definition >line 2>said || fail "$1: $(cat said)"
  grep -q "$2" said || fail "$1: $(cat said)"
  same "the profile of $1" "$(profile "$4" "$4")" "$(profile "$1" "$1")"
}
mends plain 'paths of 37 frames' cyclohexane plain
mends mirrored 'frame 7: a mirror image of its neighbours, turned back' cyclohexane plain
mends order 'the frames are out of order: taken as ' malonaldehyde malonaldehyde
mends doubled 'frames 6, 7: there already, left out' malonaldehyde malonaldehyde
mends numbered 'frame 7: its atoms are numbered otherwise: put right' malonaldehyde malonaldehyde
mends ev 'paths of 19 frames' malonaldehyde malonaldehyde

bad() {
  /usr/bin/python3 -c "$shuffle" "$paths/sn2.xyz" "$1" >"$1.xyz"
  refuses "molecule: $2" -- hapgrid molecule "$1.xyz" --path "${@:3}" -o bad
}
bad hole 'hole\.xyz: frames 4 and 5 are 0\.[0-9]* angstrom apart, most others 0\.[0-9]*: frames are missing between them'
bad other 'other\.xyz: frame 5 has BrCClH2, the first one has BrCClH3: they are no path of one molecule'
bad ev 'ev\.xyz: frame [0-9]+ is 1\.04e\+03 kJ/mol above frame [0-9]+, in the units of the titles: .*\(--unit\)\?' --unit hartree
awk '/^E=/ && ++n == 3 { print "none"; next } 1' "$paths/sn2.xyz" >lacks.xyz
refuses 'molecule: lacks\.xyz: frame 3 has no energy, and others have one: remove theirs, and xtb computes all' -- hapgrid molecule lacks.xyz --path -o bad
head -n 8 "$paths/sn2.xyz" >few.xyz
refuses 'molecule: few\.xyz: 1 frames: a path needs 4 to 400' -- hapgrid molecule few.xyz --path -o bad
expect 2 '' 'molecule: --path: what moves is given by FILE (see --help)' -- hapgrid molecule few.xyz --path --push -o bad
# Without energies xtb computes them: they are those of the titles.
/usr/bin/python3 -c "$shuffle" "$paths/ammonia.xyz" bare >bare.xyz
hapgrid molecule bare.xyz --path -o bare --until definition --quiet >line 2>&1 || fail "$(cat line)"
within "ammonia's barrier" "$(profile bare bare | tail -n 1)" 25.52 25.58  # xtb may begin at another wave function
