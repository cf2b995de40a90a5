#!/bin/bash
# `hapgrid molecule`: from SMILES or a file to a verified grid, with GFN-FF and a coarse grid. What cannot be felt is
# refused in one line.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"

bad() { refuses "molecule: $1" -- hapgrid molecule "${@:2}" -o bad; }
bad "SMILES '\[CH3\]': 9 electrons with charge 0: a radical needs --uhf 1; otherwise give the right --charge" \
  --smiles '[CH3]'
bad "SMILES 'C\[Zn\]C': Zn2: a metal, .*: take the part without it" --smiles 'C[Zn]C'
bad "SMILES 'CCC\(': not understood" --smiles 'CCC('
bad 'none\.sdf: No such file or directory' none.sdf
printf '3\n\nC 0 0 0\nC 0 0 0\nH 0 0 0\n' >nowhere.xyz
bad 'nowhere\.xyz: no coordinates and no bonds: give a file that has them, or --smiles' nowhere.xyz
head -c 2000 /dev/urandom | base64 >noise.sdf
bad 'noise\.sdf: not understood as SDF' noise.sdf
obabel -:"$(printf 'C%.0s' {1..66})" -osdf -h -O big.sdf 2>obabel.log
bad 'big\.sdf: 200 atoms, at most 100 are feasible: cut out the part that matters, and close it with hydrogen' big.sdf
rm -- *.sdf *.xyz obabel.log
expect 2 '' 'molecule: give either FILE or --smiles (see --help)' -- hapgrid molecule -o bad
nothing_left .

# A flat SDF of a salt: the larger ion is taken, without hydrogens and coordinates as it is.
obabel -:'CC[O-].[Na+]' -osdf -O salt.sdf 2>obabel.log
play='hapgrid play salt/salt\.grid --device path:salt/path-H4-C1-C2-O3\.txt --rate 1000 --frames - | hapgrid view --window'
expect 0 "~${play//|/\\|}" '~.*2 molecules: the largest is taken, C2H5O- with charge -1; left out: Na\+.*' -- \
  hapgrid molecule salt.sdf -o salt --method gfnff --spacing 1.2
same "number of paths" 1 "$(ls salt/path-*.txt | wc -l)"

# Ethanol. The committed files' rules hold for it, the energies are those of the program xtb, and the grid is fine.
line=$(hapgrid molecule --smiles CCO -o ethanol --method gfnff --spacing 1 2>first.err) || fail "$(cat first.err)"
python3 "$here/prepared_data.py" ethanol || fail "prepared data"
METHOD=(--gfnff)
for name in H4-C1-C2-O3 C1-C2-O3-H9-plus C1-C2-O3-H9-minus; do
  energies "ethanol/$name.xyz" 6 11
  grep -qP "^$name\t.*\tyes\t-$" ethanol/rotors.tsv || fail "$name is not taken: $(cat ethanol/rotors.tsv)"
done
verify ethanol/ethanol.grid --recompute 30 >report 2>verdict || fail "$(cat verdict)"

# The way that it prints turns what it says, and back: the last state is at rest.
read -r -a words <<<"${line% | hapgrid view --window}"
same "the line" "hapgrid play ethanol/ethanol.grid --device path:ethanol/path-" "${line%%path-*}path-"
"${words[@]:0:5}" --log log
awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) { if ($i == "s0") first = i; if ($i == "force_x") force = i } next }
  { for (i = first; i < first + 3; i++) if ($i > most) most = $i; at = $first + $(first + 1) + $(first + 2); last = $force }
  END { exit !(most > 0.5 && at < 0.01 && last == 0) }' log || fail "the way turns nothing, or not back"
for file in index.html played.html turned.png turned-sticks.png course.png force.png energy.png ethanol.toml verify.txt; do
  [[ -s ethanol/$file ]] || fail "no $file"
done

# The molecule's own energy reaches the barrier, and no more than all barriers together.
awk -F'\t' -v least="$(word ethanol/C1-C2-O3-H9-plus.xyz 11 dE)" '
  !/^#/ && $3 > most { most = $3 } END { exit !(most > 0.5 * least && most < 25) }' ethanol/energies.tsv ||
  fail "the molecule's energy: $(cat ethanol/energies.tsv)"

# The trajectories of what was played open in MDAnalysis, with the same atoms in the same places and the same torsions.
if /usr/bin/python3 -c 'import MDAnalysis' 2>/dev/null; then
  /usr/bin/python3 -W ignore - <<'END' || fail "MDAnalysis reads the trajectories otherwise"
import base64
import json
import re
import MDAnalysis
import numpy
from MDAnalysis.lib.distances import calc_dihedrals
one, two = MDAnalysis.Universe("ethanol/played.pdb"), MDAnalysis.Universe("ethanol/played.xyz")
torsions = numpy.loadtxt("ethanol/torsions.tsv")  # t, H4-C1-C2-O3, C1-C2-O3-H9
assert list(one.atoms.elements) == ["C", "C", "O"] + 6 * ["H"] == list(two.atoms.names), one.atoms.elements
assert len(one.trajectory) == len(two.trajectory) > 10
for a, b, row in zip(one.trajectory, two.trajectory, torsions):
    assert numpy.abs(a.positions - b.positions).max() < 6e-4  # three decimals
    for atoms, angle in (((3, 0, 1, 2), row[1]), ((0, 1, 2, 8), row[2])):
        off = numpy.degrees(calc_dihedrals(*(b.positions[n] for n in atoms))) - angle
        assert abs((off + 180) % 360 - 180) < 0.01, (row, off)
# The page names the same torsions, and has turned them as far.
data = json.loads(re.search(r"const data = (.*);\n", open("ethanol/played.html").read())[1])
assert data["torsions"] == [["H4-C1-C2-O3", 0, 1], ["C1-C2-O3-H9", 1, 2]], data["torsions"]
turned = numpy.frombuffer(base64.b64decode(data["turned"]), "float32").reshape(-1, 2)
off = turned - (torsions[:, 1:] - torsions[0, 1:])
assert numpy.abs(turned).max() > 20 and numpy.abs((off + 180) % 360 - 180).max() < 0.01, off
start = MDAnalysis.Universe("ethanol/conformation.xyz").atoms.positions  # before the probe touches anything
one.trajectory[0]
assert numpy.abs(one.atoms.positions - start).max() < 6e-4
END
fi

# Again: nothing is computed. A definition that was changed by hand is kept, and its grid computed.
salt=(hapgrid molecule salt.sdf -o salt --method gfnff --spacing 1.2)
before=$(stat -c '%n %Y' salt/* | md5sum)
expect 0 "~${play//|/\\|}" '' -- "${salt[@]}" --quiet
same "files" "$before" "$(stat -c '%n %Y' salt/* | md5sum)"
sed -i 's/^penalty = 100 /penalty = 60 /' salt/salt.toml
expect 0 "~hapgrid play .*" '~.*salt\.toml was changed by hand: it is kept.*' -- "${salt[@]}"
same "penalty" 60.0 "$(stats salt/salt.grid --get parameters.penalty)"

# What has no torsion is felt as well: 6 numbers.
expect 0 '~hapgrid play .*path-past\.txt.*' '' -- \
  hapgrid molecule --smiles C#N -o cyanide --method gfnff --spacing 1.2 --quiet
same "state" 6 "$(stats cyanide/cyanide.grid --get state.size 2>/dev/null || stats cyanide/cyanide.grid --get state_size)"
