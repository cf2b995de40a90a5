# `hapgrid dock`: energies against those of autodock4 and vina, a small grid of formamide in calix[4]arene, and what is
# refused.
source "$(dirname "$0")/../lib.sh"

needs autodock4 autodock
needs autogrid4 autogrid
needs obabel openbabel
needs vina autodock-vina
needs node nodejs
needs_python "jinja2, scipy" "python3-jinja2, python3-scipy"
host=$HAPGRID_SOURCE/examples/docking/calix.mol2 ligand=$HAPGRID_SOURCE/examples/docking/formamide.mol2

hapgrid dock "$host" "$ligand" -o usual --centre 0,0,3 --size 2,2,3 --until definition -q
/usr/bin/python3 "$here/energies.py" usual on
# finer FOLDER: the maps in it, 0.05 angstrom apart, by autogrid4 itself.
finer() (
  cd "$1"
  sed -i 's/^npts .*/npts 126 126 126/; s/^spacing .*/spacing 0.05/' host.gpf
  autogrid4 -p host.gpf -l host.glg >said 2>&1 || fail "$(cat said)"
)
small_box=(--centre '0,0,2.5' --size '0.5,0.5,0.5')
hapgrid dock "$host" "$ligand" -o fine "${small_box[@]}" --until definition -q
finer fine
hapgrid dock fine/host.maps.fld "$ligand" -o mine "${small_box[@]}" --until definition -q
/usr/bin/python3 "$here/energies.py" mine own fine
hapgrid dock "$host" "$ligand" -o coarse "${small_box[@]}" --until definition -q
/usr/bin/python3 "$here/energies.py" coarse between fine

# Above the cavity, where few orientations are minima.
hapgrid dock "$host" "$ligand" -o small --centre 0,0,4 --size 1.6,1.6,1.6 --spacing 0.8 -q >line
same 'the line to feel it' 'hapgrid feel small/small.grid' "$(cat line)"
for made in index.html feel.html poses.tsv path.txt inside.png outside.png played.html verify.txt; do
  [[ -s small/$made ]] || fail "small/$made is not there"
done
# Its page plays it, though a state has an orientation: each number is that of play.
player=$HAPGRID_SOURCE/tests/cli/view/player.mjs turn=$RANDOM
node "$player" draw $turn small/feel.html >hand
play small/small.grid --device path:hand --beside off --log hand.log 2>/dev/null
node "$player" compare small/feel.html hand hand.log || fail "seed $turn"
check-model small/small.toml --steps 50 >report || fail "$(cat report)"

# Records that are far apart do not tell the force between them, so that verify cannot prove all.
hapgrid dock "$host" "$ligand" -o far --centre 0,0,2.5 --size 2,2,2 --spacing 2 2>said >line
grep -q 'not all can be proved: see far/verify.txt' said || fail "$(cat said)"

# At the rim, where half of the points lie inside atoms.
hapgrid dock "$host" "$ligand" -o rim --centre 0,1.2,2.6 --size 1.2,1.2,1.2 --spacing 0.4 -q >line
grep -Eq '^passive .* ok$' rim/verify.txt || fail "$(cat rim/verify.txt)"
stats rim/rim.grid --npy rim/records.npy >/dev/null
/usr/bin/python3 "$here/energies.py" rim wall
check-model rim/rim.toml --steps 50 >report || fail "$(cat report)"

# Butanediol, all of whose bonds turn: AutoDock's energy between its own atoms. Ethylene glycol with its softest bond.
obabel -:OCCCCO --gen3d -O diol.mol2 >/dev/null 2>&1
hapgrid dock "$host" diol.mol2 -o within --centre 0,0,3 --size 0.5,0.5,0.5 --until definition -q
/usr/bin/python3 "$here/energies.py" within within
obabel -:OCCO --gen3d -O glycol.mol2 >/dev/null 2>&1
# Its host is atoms, as below.
hapgrid dock "$host" glycol.mol2 -o bends --torsions 1 --centre 0,0,4.4 --size 0.8,0.8,0.8 --spacing 0.8 --atoms -q >line
same 'the line to feel it' 'hapgrid feel bends/bends.grid' "$(cat line)"
same 'a state of six numbers and an angle' 'torsion 1 / rad' "$(head -n 1 bends/poses.tsv | cut -f 11)"

# The same command again does nothing.
before=$(stat -c %Y.%i small/small.grid)
hapgrid dock "$host" "$ligand" -o small --centre 0,0,4 --size 1.6,1.6,1.6 --spacing 0.8 -q >line
same 'the same grid' "$before" "$(stat -c %Y.%i small/small.grid)"
# So it does in a folder that was copied or has another name now.
cp -a small renamed
hapgrid dock "$host" "$ligand" -o renamed --centre 0,0,4 --size 1.6,1.6,1.6 --spacing 0.8 -q >line
same 'the line to feel it' 'hapgrid feel renamed/small.grid' "$(cat line)"
same 'the same definition' "$(stat -c %Y small/small.toml)" "$(stat -c %Y renamed/small.toml)"

# The maps that autogrid4 made for `usual`, as maps that a user has: the same energies at its places.
hapgrid dock usual/host.maps.fld usual/ligand.pdbqt -o own --centre 0,0,3 --size 2,2,3 --until definition -q
/usr/bin/python3 "$here/energies.py" own on usual

# A host atom by atom. Where it can make no hydrogen bond, whose direction only maps know, its energies are AutoDock's.
sed 's/ OA$/ N /; s/ HD$/ H /' usual/host.pdbqt >plain.pdbqt
hapgrid dock plain.pdbqt "$ligand" -o plain "${small_box[@]}" --until definition -q
finer plain
hapgrid dock plain.pdbqt "$ligand" -o atoms "${small_box[@]}" --atoms --until definition -q
[[ ! -e atoms/host.gpf ]] || fail 'AutoGrid was called'
/usr/bin/python3 "$here/energies.py" atoms atoms plain

# An aspartate and a histidine as PDB2PQR has them, with the types and charges of AutoDock.
cat >pair.pqr <<'END'
ATOM 1 CB ASP 1 0.000 0.000 0.000 -0.0303 1.9080
ATOM 2 HB2 ASP 1 0.600 0.900 0.000 -0.0122 1.4870
ATOM 3 CG ASP 1 1.500 0.000 0.000 0.7994 1.9080
ATOM 4 OD1 ASP 1 2.100 1.100 0.000 -0.8014 1.6612
ATOM 5 CE1 HIE A 2 0.000 0.000 6.000 0.1635 1.9080
ATOM 6 ND1 HIE A 2 1.300 0.000 6.000 -0.5432 1.8240
ATOM 7 NE2 HIE A 2 0.000 1.300 6.000 -0.2795 1.8240
ATOM 8 HE2 HIE A 2 0.000 2.300 6.000 0.3339 0.6000
END
hapgrid dock pair.pqr "$ligand" -o pair --centre 0,0,3 --size 1,1,1 --until definition -q
same 'types and charges' '-0.043 C +0.799 C -0.801 OA +0.164 A -0.543 NA -0.280 N +0.334 HD' \
  "$(cut -c 71-79 pair/host.pdbqt | xargs)"

gzip -c "$host" >host.mol2.gz
hapgrid dock host.mol2.gz "$ligand" -o packed --centre 0,0,3 --size 0.5,0.5,0.5 --atoms --until definition -q
cmp usual/host.pdbqt packed/host.pdbqt
hapgrid dock "$host" "$ligand" -o wide --size 36,4,4 --spacing 2 --until definition 2>said
grep -q ' maps .*, 0\.3[0-9] angstrom apart$' said || fail "$(cat said)"

# Of several poses, as vina writes them, the first is taken. A number below zero is a centre, not an option.
sed 's/^ATOM.*  2  .*/REMARK/' small/ligand.pdbqt >other.pdbqt
{ echo 'MODEL 1'; cat small/ligand.pdbqt; printf 'ENDMDL\nMODEL 2\n'; cat other.pdbqt; echo ENDMDL; } >poses.pdbqt
hapgrid dock "$host" poses.pdbqt -o poses --centre -0.1,0,3 --size 0.5,0.5,0.5 \
  --until definition 2>said
grep -q 'poses.pdbqt has several molecules or poses: the first is taken' said || fail "$(cat said)"
cmp small/ligand.pdbqt poses/ligand.pdbqt

refusals "$here/docking.tsv"
[[ ! -e inside/inside.grid ]] || fail 'the search ran before the box was refused'
