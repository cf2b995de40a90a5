# `hapgrid molecule` holds an atom and leads it over the barriers, and back, by its defaults; with GFN-FF.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"

# Over three barriers, all round and back. The way over the top of a barrier is balanced, so nothing snaps; the tie
# and its anchors give back what they took.
hapgrid molecule --smiles ClCCCl --method gfnff -o dce >line 2>said || fail "$(cat said)"
grep -q 'the hand holds Cl4$' said || fail "$(cat said)"
grep -qx '# The hand holds Cl4 and leads it along its own way, and back: Cl1-C2-C3-Cl4 goes over all its barriers\.' \
  <(head -n 1 dce/path-Cl1-C2-C3-Cl4.txt) || fail "$(head -n 1 dce/path-*.txt)"
verify dce/dce.grid >report 2>verdict || fail "$(cat verdict)"
play dce/dce.grid --device path:dce/path-Cl1-C2-C3-Cl4.txt --log log 2>said || fail "$(cat said)"
awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
  { t = $at["s0"]; if (t < least) least = t; if (t > most) most = t; snaps += $at["snap"] }
  END { exit !(most - least > 0.95 && t < 0.01 && t > -0.01 && snaps == 0) }' log || fail "not round and back"
# The path closes: its first frame is its last one.
size=$((2 + $(head -n 1 dce/Cl1-C2-C3-Cl4.xyz)))
cmp <(head -n "$size" dce/Cl1-C2-C3-Cl4.xyz | tail -n +3) <(tail -n "$((size - 2))" dce/Cl1-C2-C3-Cl4.xyz) || fail "it does not close"
same "rows that are there twice" '' "$(grep 'saddle on the path' dce/report.tsv | cut -f 3- | sort | uniq -d)"
# feel.html has the barriers of the path: at 0 degrees that of its ends, which is the highest, and beside it two mirror images.
python3 - "$(sed -n 's/^dE=\([^ ]*\).*/\1/p' dce/Cl1-C2-C3-Cl4.xyz | head -n 1)" <<'END' || fail "barriers of feel.html"
import json, sys
profile = json.JSONDecoder().raw_decode(open("dce/feel.html", encoding="utf-8").read().split('"torsions":', 1)[1])[0][0][3]
assert abs(profile[36] - float(sys.argv[1])) < 0.01 and abs(max(profile[6:18]) - max(profile[55:67])) < 0.02, profile
END
of() { sed -n "s/^$1 = \([^#]*[^# ]\) *#.*/\1/p" dce/dce.toml; }
same "held and fixed" "[4] [1, 2, 3, 5, 6]" "$(of hold) $(of fixed)"
stiff=$(awk "BEGIN { print $(of hold_force) / $(of hold_width) }")

# When the hydrogen bond of 2-fluoroethanol breaks, the molecule goes on while both ends of its chain rest, so neither can be
# led on. The hand holds another atom, which it leads all round.
hapgrid molecule --smiles OCCF --method gfnff -o fluor --quiet >line 2>&1 || fail "$(cat line)"
play fluor/fluor.grid --device path:fluor/path-O1-C2-C3-F4.txt --log log 2>said || fail "$(cat said)"
awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
  { t = $at["s0"]; if (t < least) least = t; if (t > most) most = t; snaps += $at["snap"] }
  END { exit !(most - least > 0.95 && snaps == 0) }' log || fail "2-fluoroethanol: not round, or it snaps"

# Other atoms: by name, number and pattern; of several their centre. A softer tie is four times as soft.
again() { hapgrid molecule --smiles ClCCCl --method gfnff -o dce --until definition --quiet "$@" >line 2>&1 || fail "$(cat line)"; }
again --hold Cl1 && same "by its name" "[1] [2, 3, 4, 7, 8]" "$(of hold) $(of fixed)"
again --hold 7,8 --soft && same "two hydrogen atoms" "[7, 8] [1, 2, 3, 5, 6]" "$(of hold) $(of fixed)"
again --soft
awk "BEGIN { exit !($stiff / ($(of hold_force) / $(of hold_width)) > 3.5) }" || fail "not softer: $(of hold_force) $(of hold_width)"
bad() { expect "$1" '' "~molecule: --hold: $2" -- hapgrid molecule "${@:3}" --method gfnff -o bad --quiet; }
bad 2 'no atom C9, and no SMARTS: the atoms are Cl1, C2, C3, Cl4, H5 and 3 more.*' --smiles ClCCCl --hold C9
bad 2 'the SMARTS \[Br\] matches nothing in the molecule.*' --smiles ClCCCl --hold '[Br]'
bad 1 'no bond that turns moves the centre of Cl1, C2, C3, Cl4: .*' --smiles ClCCCl --hold '[Cl]CC[Cl]'
bad 1 'no bond that turns moves C2: hold Cl1, Cl4, H5, H6, H7 and 1 more' --smiles ClCCCl --hold C2
rm -r bad  # a folder is of one molecule
bad 1 'no bond of the molecule turns: --push pushes at it as a whole' --smiles C#N --hold 1
expect 2 '' 'molecule: --push: the hand holds no atom (see --help)' -- hapgrid molecule --smiles CC --push --hold 1 -o bad

# A bond that does not move what is held is named.
hapgrid molecule --smiles FCCCCl --method gfnff --spacing 0.7 -o chain --until definition >line 2>said || fail "$(cat said)"
grep -q 'F1-C2-C3-C4 stays as in the conformation: turned, the held atom would move by less than 0.4 angstrom\. Hold another' said || fail "$(cat said)"
