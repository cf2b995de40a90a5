# `hapgrid dock`: energies against those of autodock4 and vina, a small grid of formamide in calix[4]arene, and what is
# refused.
source "$(dirname "$0")/../lib.sh"

needs autodock4 autodock
needs autogrid4 autogrid
needs obabel openbabel
needs vina autodock-vina
needs node nodejs
needs_python scipy python3-scipy
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
refuses 'dock: .*4 torsions are asked for, and 3 of its bonds turn.*' -- \
  hapgrid dock "$host" glycol.mol2 -o out --torsions 4 --centre 0,0,4.4 --size 0.8,0.8,0.8 -q

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
refuses 'dock: the box is not inside the maps, which go from .*' -- \
  hapgrid dock usual/host.maps.fld usual/ligand.pdbqt -o out --centre 0,0,9 --size 2,2,3 -q
mkdir cut && cp usual/host.* cut && head -n 100 usual/host.C.map >cut/host.C.map
refuses 'dock: cut/host.C.map: its header speaks of [0-9,]+ values, and it has 94' -- \
  hapgrid dock cut/host.maps.fld usual/ligand.pdbqt -o out -q
sed -E '/^ATOM      1/s/(.{30}).{24}/\1 -30.000 -30.000 -30.000/' usual/ligand.pdbqt >long.pdbqt
refuses 'dock: long.pdbqt: atoms [0-9.]+ angstrom from the .* it is larger than the maps' -- \
  hapgrid dock usual/host.maps.fld long.pdbqt -o out -q
sed 's/OA-affinity/F-affinity/' usual/host.maps.fld >usual/less.fld
refuses 'dock: usual/less.fld: there is no map OA, which an atom of the ligand needs' -- \
  hapgrid dock usual/less.fld usual/ligand.pdbqt -o out -q
sed '/^label/d' usual/host.maps.fld >usual/none.fld
refuses 'dock: usual/none.fld: no .fld file of AutoGrid: .*' -- hapgrid dock usual/none.fld usual/ligand.pdbqt -o out -q

# A host atom by atom. Where it can make no hydrogen bond, whose direction only maps know, its energies are AutoDock's.
sed 's/ OA$/ N /; s/ HD$/ H /' usual/host.pdbqt >plain.pdbqt
hapgrid dock plain.pdbqt "$ligand" -o plain "${small_box[@]}" --until definition -q
finer plain
hapgrid dock plain.pdbqt "$ligand" -o atoms "${small_box[@]}" --atoms --until definition -q
[[ ! -e atoms/host.gpf ]] || fail 'AutoGrid was called'
/usr/bin/python3 "$here/energies.py" atoms atoms plain
refuses 'dock: usual/host.maps.fld: --atoms needs the file of the .*' -- \
  hapgrid dock usual/host.maps.fld "$ligand" -o out --atoms -q
refuses 'dock: the ligand overlaps with the host everywhere in the box: .*' -- \
  hapgrid dock "$host" "$ligand" -o out --centre 0.17,-2.29,-1.97 --size 0.5,0.5,0.5 --atoms -q
[[ ! -e out/out.toml ]] || fail 'the definition of a refused run stays'
sed 's/ HD$/ Zn/' usual/host.pdbqt >zinc.pdbqt
refuses 'dock: .*there are no parameters for atoms of type Zn' -- \
  hapgrid dock zinc.pdbqt "$ligand" -o out "${small_box[@]}" --atoms -q
for ((n = 0; n < 501; ++n)); do grep '^ATOM      1' small/ligand.pdbqt; done >crowd.pdbqt
refuses 'dock: crowd.pdbqt: 501 atoms, at most 500 are possible' -- hapgrid dock crowd.pdbqt "$ligand" -o out --atoms -q

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
refuses 'dock: far.pqr: a hydrogen has no neighbour within 1.45 angstrom' -- hapgrid dock far.pqr "$ligand" -o out -q
sed 's/0.6000/x/' pair.pqr >word.pqr
refuses 'dock: word.pqr: no PQR: an atom has no place or charge' -- hapgrid dock word.pqr "$ligand" -o out -q

# Files of strangers: one at which Open Babel crashes, and names of what never ends.
cp "$HAPGRID_SOURCE/tests/cli/molecule/inputs/crash-v3000.sdf" crash.sdf
refuses 'dock: crash.sdf: obabel: ended by SIGSEGV' -- hapgrid dock "$host" crash.sdf -o out -q
mkfifo pipe.mol2 usual/pipe
sed 's|file=host.C.map|file=pipe|' usual/host.maps.fld >usual/pipe.fld
sed 's|file=host.C.map|file=/dev/zero|' usual/host.maps.fld >usual/zero.fld
for name in pipe.mol2 /dev/zero; do
  refuses "dock: $name: is no regular file" -- timeout 20 hapgrid dock "$name" "$ligand" -o out -q
  refuses "dock: $name: is no regular file" -- timeout 20 hapgrid dock "$host" "$name" -o out -q
done
refuses 'dock: usual/pipe: is no regular file' -- timeout 20 hapgrid dock usual/pipe.fld usual/ligand.pdbqt -o out -q
refuses "dock: usual/zero.fld: names the file '/dev/zero': only files beside it are used, with plain names" -- \
  timeout 20 hapgrid dock usual/zero.fld usual/ligand.pdbqt -o out -q
sed '/^ENDROOT/a BRANCH' usual/ligand.pdbqt >bare.pdbqt
refuses 'dock: .*' -- hapgrid dock "$host" bare.pdbqt -o out --torsions 2 -q
! grep -q Traceback "$work/got/err" || fail "$(cat "$work/got/err")"
gzip -c "$host" >host.mol2.gz
hapgrid dock host.mol2.gz "$ligand" -o packed --centre 0,0,3 --size 0.5,0.5,0.5 --atoms --until definition -q
cmp usual/host.pdbqt packed/host.pdbqt

refuses 'dock: gone.mol2: No such file or directory' -- hapgrid dock gone.mol2 "$ligand" -o out -q
echo nothing >nothing.pdbqt
refuses 'dock: nothing.pdbqt: no atoms are found in it: .*' -- hapgrid dock nothing.pdbqt "$ligand" -o out -q
obabel -:NC=O -O flat.mol2 >/dev/null 2>&1
refuses 'dock: flat.mol2: all atoms lie at one place: .*' -- hapgrid dock "$host" flat.mol2 -o out -q
refuses 'dock: the box has 1,030,301 points, at most 200,000 are possible: .*' -- \
  hapgrid dock "$host" "$ligand" -o out --size 50,50,50 --atoms -q
grep -v '^ATOM.*  [234]  ' small/ligand.pdbqt | sed '/^ATOM      5/d' >one.pdbqt
refuses 'dock: one.pdbqt: one atom cannot turn: .*' -- hapgrid dock "$host" one.pdbqt -o out -q
for ((n = 0; n < 201; ++n)); do grep '^ATOM      1' small/ligand.pdbqt; done >many.pdbqt
refuses 'dock: many.pdbqt: 201 atoms, at most 200 are possible' -- hapgrid dock "$host" many.pdbqt -o out -q
sed 's/ OA$/ Xx/' small/ligand.pdbqt >strange.pdbqt
refuses 'dock: strange.pdbqt: AutoDock has no parameters of the type Xx: .*' -- hapgrid dock "$host" strange.pdbqt -o out -q
{ sed '/ATOM>/q' "$host"; seq 200000 | sed 's/$/ C 0 0 0 C.3 1 UNL1 0.1/'; } >huge.mol2
refuses 'dock: huge.mol2: it has more than 20,000 atoms' -- hapgrid dock huge.mol2 "$ligand" -o out -q
seq 200000 | sed 's/.*/ATOM & CA ALA 1 0 0 0 0.1 1.9/' >huge.pqr
refuses 'dock: huge.pqr: it has more than 20,000 atoms' -- timeout 60 hapgrid dock huge.pqr "$ligand" -o out -q
refuses 'dock: box and ligand need maps 0\.5[0-9] angstrom apart, .*' -- hapgrid dock "$host" "$ligand" -o out --size 60,4,4 -q
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
