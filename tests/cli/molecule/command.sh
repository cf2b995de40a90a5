# `hapgrid molecule`: from SMILES or a file to a verified grid, with GFN-FF and a coarse grid. What cannot be felt is
# refused in one line.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"

xyz() { printf '%d\n\n' "$(($# / 4))" && printf '%s %s %s %s\n' "$@"; }
refusals "$here/command.tsv"
rm -- *.sdf *.xyz obabel.log
nothing_left .

# A flat SDF of a salt: the larger ion is taken, without hydrogens and coordinates as it is.
obabel -:'CC[O-].[Na+]' -osdf -O salt.sdf 2>obabel.log
expect 0 'hapgrid feel salt/salt.grid' '~.*salt\.sdf: 2 molecules or shapes: the largest is taken, C2H5O- with charge -1; left out: Na\+ with charge \+1.*' -- \
  hapgrid molecule --push salt.sdf -o salt --method gfnff --spacing 1.2
same "number of paths" 1 "$(ls salt/path-*.txt | wc -l)"

# Ethanol. The committed files' rules hold for it, the energies are those of the program xtb, and the grid is fine.
line=$(hapgrid molecule --push --smiles CCO -o ethanol --method gfnff --spacing 1 2>first.err) || fail "$(cat first.err)"
python3 "$here/prepared_data.py" ethanol || fail "prepared data"
METHOD=(--gfnff)
for name in H4-C1-C2-O3 C1-C2-O3-H9-plus C1-C2-O3-H9-minus; do
  energies "ethanol/$name.xyz" 6 11
  grep -qP "^$name\t.*\tyes\t-$" ethanol/rotors.tsv || fail "$name is not taken: $(cat ethanol/rotors.tsv)"
done
verify ethanol/ethanol.grid --recompute 30 >report 2>verdict || fail "$(cat verdict)"

# The way of the page turns what it says, and back: the last state is at rest.
same "the line" "hapgrid feel ethanol/ethanol.grid" "$line"
awk -F'\t' 'NR == 1 { for (i = 1; i <= NF; i++) { if ($i == "s0") first = i; if ($i == "force_x") force = i } next }
  { for (i = first; i < first + 3; i++) if ($i > most) most = $i; at = $first + $(first + 1) + $(first + 2); last = $force }
  END { exit !(most > 0.5 && at < 0.01 && last == 0) }' ethanol/played.log || fail "the way turns nothing, or not back"
for file in index.html feel.html played.html ethanol.toml verify.txt; do
  [[ -s ethanol/$file ]] || fail "no $file"
done

# The molecule's own energy reaches the barrier, and no more than all barriers together.
awk -F'\t' -v least="$(word ethanol/C1-C2-O3-H9-plus.xyz 11 dE)" '
  NR == 1 { for (i = 1; i <= NF; i++) if ($i == "own_energy") own = i; next }
  $own > most { most = $own } END { exit !(most > 0.5 * least && most < 25) }' ethanol/played.log ||
  fail "the molecule's energy in ethanol/played.log"

# The names of the page's atoms and their bonds are read by other programs without a warning, and the trajectory with them.
if ! /usr/bin/python3 -c 'import MDAnalysis, ase' 2>/dev/null; then
  missing "python3-mdanalysis, python3-ase"
else
  /usr/bin/python3 -W error -W ignore::DeprecationWarning - <<'END' 2>said || fail "other programs read played.pdb otherwise: $(cat said)"
import ase.io
import MDAnalysis
import numpy
from rdkit import Chem
names = "C1 C2 O3 H4 H5 H6 H7 H8 H9".split()
bonds = [[0, 1], [0, 3], [0, 4], [0, 5], [1, 2], [1, 6], [1, 7], [2, 8]]
one = MDAnalysis.Universe("ethanol/played.pdb", "ethanol/played.xyz")
assert list(one.atoms.names) == names and sorted(sorted(map(int, bond.indices)) for bond in one.bonds) == bonds
rdkit = Chem.MolFromPDBFile("ethanol/played.pdb", removeHs=False)
assert [atom.GetPDBResidueInfo().GetName().strip() for atom in rdkit.GetAtoms()] == names
assert sorted(sorted((b.GetBeginAtomIdx(), b.GetEndAtomIdx())) for b in rdkit.GetBonds()) == bonds
read = ase.io.read("ethanol/played.pdb")
assert list(read.arrays["atomtypes"]) == names and read.get_chemical_formula() == "C2H6O"
assert len(one.trajectory) > 10
start = MDAnalysis.Universe("ethanol/conformation.xyz").atoms.positions  # before the probe touches anything
one.trajectory[0]
for places in (one.atoms.positions, rdkit.GetConformer().GetPositions(), read.positions):
    assert numpy.abs(places - start).max() < 6e-4  # three decimals
END
fi

# Trimethylamine by GFN-FF, whose terms at the nitrogen change with the order of its bonds' lengths: the search keeps the
# terms with which the conformation is a minimum, so the path of each methyl group climbs from there.
hapgrid molecule --push --smiles 'CN(C)C' --method gfnff -o amine --until structures --quiet >line 2>&1 || fail "$(cat line)"
python3 "$here/prepared_data.py" amine || fail "prepared data"
same "paths" 3 "$(grep -cP '\tsaddle\t' amine/report.tsv)"

# Again: nothing is computed. A definition that was changed by hand is kept, and its grid computed.
salt=(hapgrid molecule --push salt.sdf -o salt --method gfnff --spacing 1.2)
before=$(stat -c '%n %Y' salt/* | md5sum)
expect 0 'hapgrid feel salt/salt.grid' '' -- "${salt[@]}" --quiet
same "files" "$before" "$(stat -c '%n %Y' salt/* | md5sum)"
sed -i 's/^penalty = 100 /penalty = 60 /' salt/salt.toml
expect 0 "~hapgrid feel .*" '~.*salt\.toml was changed by hand: it is kept.*' -- "${salt[@]}"
same "penalty" 60.0 "$(stats salt/salt.grid --get parameters.penalty)"

# Of several records, too, the largest is felt, here the second, which has no torsion: 6 numbers. Its grid is one of folder.sh.
{ obabel -:C -osdf -h --gen3d && obabel -:C#N -osdf -h --gen3d && obabel -:O -osdf -h --gen3d; } >records.sdf 2>obabel.log
expect 0 '' \
  '~.*records\.sdf: 3 molecules or shapes: the largest is taken, CHN with charge 0; left out: CH4, H2O.*' -- \
  hapgrid molecule --push records.sdf -o cyanide --method gfnff --spacing 1.2 --until definition
same "state" 6 "$(seed cyanide/cyanide.toml | stats --get state_size)"

# What has no barrier is told with the reason, on the terminal, in rotors.tsv and on the page.
hapgrid molecule --push --smiles OO -o peroxide --method gfnff --spacing 1.5 --highest 2 >line 2>log || fail "$(cat log)"
grep -q 'left out: H3-O1-O2-H4-plus, H3-O1-O2-H4-minus: still climbing at 2 kJ/mol' log || fail "$(cat log)"
grep -qx 'NOTHING TURNS in this grid; H3-O1-O2-H4-plus, H3-O1-O2-H4-minus: still climbing at 2 kJ/mol' <(head -n 1 line) ||
  fail "$(cat line)"
grep -q '<p>NOTHING TURNS in this grid; .*: still climbing at 2 kJ/mol\.' peroxide/index.html || fail "the page does not begin with it"
# Before that stands how long it takes, with the cores for which this holds.
grep -qE 'about [0-9.]+ (s|min|h) on a free core for conformation and barriers' log || fail "$(cat log)"
grep -q '<td>H3-O1-O2-H4-plus<td>.*<td>still climbing at 2 kJ/mol' peroxide/index.html || fail "the page does not say why"
# A page names the formula, the charge, the spin, the method with its version, and the energy of the conformation.
grep -qP '<dt>Formula<dd>H<sub>2</sub>O<sub>2</sub><dt>Charge<dd>0<dt>Spin<dd>singlet<dt>Made from<dd>SMILES OO<dt>Energies<dd>GFN-FF, of libxtb 6\.[0-9.]+<dt>Conformation<dd>-[0-9.]+ hartree' \
  peroxide/index.html || fail "the page lacks facts"

# Dichloroethane's gauche lies 0.6 kJ/mol below anti by GFN-FF. The search goes on there, or stays in anti.
anti=$HAPGRID_SOURCE/examples/molecule/dichloroethane/conformation.xyz
shapes=("$anti" --method gfnff --torsions Cl1-C2-C3-Cl4-plus --until structures)
expect 0 '' '~.*Cl1-C2-C3-Cl4-plus leads to a minimum that is 0\.6 kJ/mol lower: from there once more.*' -- \
  hapgrid molecule --push "${shapes[@]}" -o gauche
within "gauche" "$(word gauche/conformation.xyz 1 Cl1-C2-C3-Cl4 | tr -d -)" 60 80
expect 0 '' '~.*Cl1-C2-C3-Cl4-plus leads to a minimum that is 0\.6 kJ/mol lower.*' -- \
  hapgrid molecule --push "${shapes[@]}" --keep-conformation -o anti
within "anti" "$(word anti/conformation.xyz 1 Cl1-C2-C3-Cl4)" 180 180

# One way of one bond alone. A file says which of the two mirror images it is: of a drawing, the processor's rounding decides.
cp "$here/gauche.xyz" peroxide.xyz
peroxide=(peroxide.xyz --method gfnff --spacing 1.5)
refuses 'molecule: --torsions: no bond H3-O1-O2-H4-up turns, only H3-O1-O2-H4' -- \
  hapgrid molecule --push "${peroxide[@]}" -o oneway --torsions H3-O1-O2-H4-up
oneway=(hapgrid molecule --push "${peroxide[@]}" -o oneway --torsions H3-O1-O2-H4-minus)
expect 0 '' '~.*stopped after the structures: the same command without --until goes on' -- "${oneway[@]}" --until structures
[[ ! -e oneway/oneway.toml ]] || fail "not stopped after the structures"
expect 0 '' '~.*stopped after the definition: .*' -- "${oneway[@]}" --until definition
[[ -s oneway/oneway.toml && ! -e oneway/oneway.grid ]] || fail "not stopped after the definition"
expect 0 '~hapgrid feel .*' '' -- "${oneway[@]}" --quiet
same "paths" H3-O1-O2-H4-minus "$(awk -F'\t' '$2 == "saddle" { print $1 }' oneway/report.tsv)"

# A box that is too small is widened until nothing is held at its sides. Here it begins inside of the molecule.
PYTHONPATH=$HAPGRID_BUILD/python /usr/bin/python3 - >line 2>log <<'END' || fail "$(cat log)"
import sys
from hapgrid.apps.molecule import cli, definition
definition.CLEAR = -2.5
sys.exit(cli.main(["--push", "--smiles", "C#N", "-o", "narrow", "--method", "gfnff", "--spacing", "1"]))
END
grep -q 'pushed as far as a side of the box, which is made wider' log || fail "$(cat log)"
stats narrow/narrow.grid --npy narrow.npy
/usr/bin/python3 - <<'END' || fail "the molecule is held at a side of the box"
import numpy
of = numpy.load("narrow.npy")
side = ((of["point"] == 0) | (of["point"] == of["point"].max(axis=0))).any(axis=1)
assert side.sum() > 100 and (of["state"][side] == 0).all()
END

# Where the grid would take long, the command says with how few points it takes less. The definition of that has as many.
PYTHONPATH=$HAPGRID_BUILD/python /usr/bin/python3 - >line 2>log <<'END' || fail "$(cat log)"
import sys
from hapgrid.apps.molecule import cli, grids
grids.LONG = 0
sys.exit(cli.main(["--push", "--smiles", "C#N", "-o", "long", "--method", "gfnff", "--until", "definition"]))
END
[[ $(cat log) =~ "where that is too long: --spacing "([0-9.]+)" has "([0-9]+)" points and takes about " ]] || fail "$(cat log)"
spacing=${BASH_REMATCH[1]} points=${BASH_REMATCH[2]}
hapgrid molecule --push --smiles C#N -o long --method gfnff --until definition --spacing "$spacing" --quiet
same "points with --spacing $spacing" "$points" "$(($(sed -n 's/^counts = \[\(.*\)\]/\1/p' long/long.toml | sed 's/, /*/g')))"
