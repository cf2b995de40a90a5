# `hapgrid dock`: energies against those of autodock4 and vina, a small grid of formamide in calix[4]arene, and what is
# refused.
source "$(dirname "$0")/../lib.sh"

needs autodock4 autodock
needs autogrid4 autogrid
needs obabel openbabel
needs vina autodock-vina
needs node nodejs
needs_python "jinja2, scipy" "python3-jinja2, python3-scipy"
refused() { refuses "dock: $1" -- timeout 60 hapgrid dock "${@:2}" -o out -q; } # REGEX HOST LIGAND OPTION...
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
refused '.*4 torsions are asked for, and 3 of its bonds turn.*' \
  "$host" glycol.mol2 --torsions 4 --centre 0,0,4.4 --size 0.8,0.8,0.8

# The same command again does nothing.
before=$(stat -c %Y.%i small/small.grid)
hapgrid dock "$host" "$ligand" -o small --centre 0,0,4 --size 1.6,1.6,1.6 --spacing 0.8 -q >line
same 'the same grid' "$before" "$(stat -c %Y.%i small/small.grid)"
# So it does in a folder that was copied or has another name now.
cp -a small renamed
hapgrid dock "$host" "$ligand" -o renamed --centre 0,0,4 --size 1.6,1.6,1.6 --spacing 0.8 -q >line
same 'the line to feel it' 'hapgrid feel renamed/small.grid' "$(cat line)"
same 'the same definition' "$(stat -c %Y small/small.toml)" "$(stat -c %Y renamed/small.toml)"

# The maps that autogrid4 made for `usual`, as maps that a user has: the same energies at its places. The second box
# reaches beyond them, where the energy of an atom grows.
hapgrid dock usual/host.maps.fld usual/ligand.pdbqt -o own --centre 0,0,3 --size 2,2,3 --until definition -q
/usr/bin/python3 "$here/energies.py" own on usual
refused 'the box is not inside the maps, which go from .*' usual/host.maps.fld usual/ligand.pdbqt --centre 0,0,9 --size 2,2,3
mkdir cut && cp usual/host.* cut && head -n 100 usual/host.C.map >cut/host.C.map
refused 'cut/host.C.map: its header speaks of [0-9,]+ values, and it has 94' cut/host.maps.fld usual/ligand.pdbqt
sed -E '/^ATOM      1/s/(.{30}).{24}/\1 -30.000 -30.000 -30.000/' usual/ligand.pdbqt >long.pdbqt
refused 'long.pdbqt: atoms [0-9.]+ angstrom from the .* it is larger than the maps' usual/host.maps.fld long.pdbqt
sed 's/OA-affinity/F-affinity/' usual/host.maps.fld >usual/less.fld
refused 'usual/less.fld: there is no map OA, which an atom of the ligand needs' usual/less.fld usual/ligand.pdbqt
sed '/^label/d' usual/host.maps.fld >usual/none.fld
refused 'usual/none.fld: no .fld file of AutoGrid: .*' usual/none.fld usual/ligand.pdbqt

# A host atom by atom. Where it can make no hydrogen bond, whose direction only maps know, its energies are AutoDock's.
sed 's/ OA$/ N /; s/ HD$/ H /' usual/host.pdbqt >plain.pdbqt
hapgrid dock plain.pdbqt "$ligand" -o plain "${small_box[@]}" --until definition -q
finer plain
hapgrid dock plain.pdbqt "$ligand" -o atoms "${small_box[@]}" --atoms --until definition -q
[[ ! -e atoms/host.gpf ]] || fail 'AutoGrid was called'
/usr/bin/python3 "$here/energies.py" atoms atoms plain
refused 'usual/host.maps.fld: --atoms needs the file of the .*' usual/host.maps.fld "$ligand" --atoms
refused 'the ligand overlaps with the host everywhere in the box: .*' \
  "$host" "$ligand" --centre 0.17,-2.29,-1.97 --size 0.5,0.5,0.5 --atoms
[[ ! -e out/out.toml ]] || fail 'the definition of a refused run stays'
sed 's/ HD$/ Zn/' usual/host.pdbqt >zinc.pdbqt
refused '.*there are no parameters for atoms of type Zn' zinc.pdbqt "$ligand" "${small_box[@]}" --atoms
for ((n = 0; n < 501; ++n)); do grep '^ATOM      1' small/ligand.pdbqt; done >crowd.pdbqt
refused 'crowd.pdbqt: 501 atoms, at most 500 are possible' crowd.pdbqt "$ligand" --atoms

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
sed 's/^ATOM 8 HE2 HIE A 2 0.000 2.300/ATOM 8 HE2 HIE A 2 0.000 9.000/' pair.pqr >far.pqr
refused 'far.pqr: a hydrogen has no neighbour within 1.45 angstrom' far.pqr "$ligand"
sed 's/0.6000/x/' pair.pqr >word.pqr
refused 'word.pqr: no PQR: an atom has no place or charge' word.pqr "$ligand"

# Files of strangers: one at which Open Babel crashes, and names of what never ends.
cp "$HAPGRID_SOURCE/tests/python/molecules/crash-v3000.sdf" crash.sdf
refused 'crash.sdf: obabel: ended by SIGSEGV' "$host" crash.sdf
mkfifo pipe.mol2 usual/pipe
sed 's|file=host.C.map|file=pipe|' usual/host.maps.fld >usual/pipe.fld
sed 's|file=host.C.map|file=/dev/zero|' usual/host.maps.fld >usual/zero.fld
for name in pipe.mol2 /dev/zero; do
  refused "$name: is no regular file" "$name" "$ligand"
  refused "$name: is no regular file" "$host" "$name"
done
refused 'usual/pipe: is no regular file' usual/pipe.fld usual/ligand.pdbqt
refused "usual/zero.fld: names the file '/dev/zero': only files beside it are used, with plain names" \
  usual/zero.fld usual/ligand.pdbqt
sed '/^ENDROOT/a BRANCH' usual/ligand.pdbqt >bare.pdbqt
refused '.*' "$host" bare.pdbqt --torsions 2
! grep -q Traceback "$work/got/err" || fail "$(cat "$work/got/err")"
gzip -c "$host" >host.mol2.gz
hapgrid dock host.mol2.gz "$ligand" -o packed --centre 0,0,3 --size 0.5,0.5,0.5 --atoms --until definition -q
cmp usual/host.pdbqt packed/host.pdbqt

refused 'gone.mol2: No such file or directory' gone.mol2 "$ligand"
echo nothing >nothing.pdbqt
refused 'nothing.pdbqt: no atoms are found in it: .*' nothing.pdbqt "$ligand"
obabel -:NC=O -O flat.mol2 >/dev/null 2>&1
refused 'flat.mol2: all atoms lie at one place: .*' "$host" flat.mol2
refused 'the box has 1,030,301 points, at most 200,000 are possible: .*' "$host" "$ligand" --size 50,50,50 --atoms
grep -v '^ATOM.*  [234]  ' small/ligand.pdbqt | sed '/^ATOM      5/d' >one.pdbqt
refused 'one.pdbqt: one atom cannot turn: .*' "$host" one.pdbqt
for ((n = 0; n < 201; ++n)); do grep '^ATOM      1' small/ligand.pdbqt; done >many.pdbqt
refused 'many.pdbqt: 201 atoms, at most 200 are possible' "$host" many.pdbqt
sed 's/ OA$/ Xx/' small/ligand.pdbqt >strange.pdbqt
refused 'strange.pdbqt: AutoDock has no parameters of the type Xx: .*' "$host" strange.pdbqt
{ sed '/ATOM>/q' "$host"; seq 200000 | sed 's/$/ C 0 0 0 C.3 1 UNL1 0.1/'; } >huge.mol2
refused 'huge.mol2: it has more than 20,000 atoms' huge.mol2 "$ligand"
seq 200000 | sed 's/.*/ATOM & CA ALA 1 0 0 0 0.1 1.9/' >huge.pqr
refused 'huge.pqr: it has more than 20,000 atoms' huge.pqr "$ligand"
refused 'box and ligand need maps 0\.5[0-9] angstrom apart, .*' "$host" "$ligand" --size 60,4,4
hapgrid dock "$host" "$ligand" -o wide --size 36,4,4 --spacing 2 --until definition 2>said
grep -q ' maps .*, 0\.3[0-9] angstrom apart$' said || fail "$(cat said)"
refuses 'dock: the ligand overlaps with the host everywhere in the box: .*' -- \
  hapgrid dock "$host" "$ligand" -o inside --centre 0.17,-2.29,-1.97 --size 0.5,0.5,0.5 --spacing 0.5 -q
[[ ! -e inside/inside.grid ]] || fail 'the search ran before the box was refused'
expect 2 '' '~dock: argument --size: must be three numbers from 0.5 to 60 .*' -- hapgrid dock a b -o out --size 1,2
expect 2 '' '~dock: argument --size: must be three numbers from 0.5 to 60 .*' -- hapgrid dock a b -o out --size 1,2,x

# Of several poses, as vina writes them, the first is taken. A number below zero is a centre, not an option.
sed 's/^ATOM.*  2  .*/REMARK/' small/ligand.pdbqt >other.pdbqt
{ echo 'MODEL 1'; cat small/ligand.pdbqt; printf 'ENDMDL\nMODEL 2\n'; cat other.pdbqt; echo ENDMDL; } >poses.pdbqt
hapgrid dock "$host" poses.pdbqt -o poses --centre -0.1,0,3 --size 0.5,0.5,0.5 \
  --until definition 2>said
grep -q 'poses.pdbqt has several molecules or poses: the first is taken' said || fail "$(cat said)"
cmp small/ligand.pdbqt poses/ligand.pdbqt
