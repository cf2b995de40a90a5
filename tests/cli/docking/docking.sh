# `hapgrid dock`: energies against those of autodock4 and vina, a small grid of formamide in calix[4]arene, and what is
# refused.
source "$(dirname "$0")/../lib.sh"

needs autodock4 autodock
needs autogrid4 autogrid
needs obabel openbabel
needs vina autodock-vina
needs_python numpy python3-numpy
host=$HAPGRID_SOURCE/examples/docking/calix.mol2 ligand=$HAPGRID_SOURCE/examples/docking/formamide.mol2

hapgrid dock "$host" "$ligand" -o usual --centre 0,0,3 --size 2,2,3 --until definition -q
/usr/bin/python3 "$here/energies.py" usual on
hapgrid dock "$host" "$ligand" -o fine --centre 0,0,2.5 --size 0.5,0.5,0.5 --map-spacing 0.05 --until definition -q
/usr/bin/python3 "$here/energies.py" fine between

# Above the cavity, where few orientations are minima.
hapgrid dock "$host" "$ligand" -o small --centre 0,0,4 --size 1.6,1.6,1.6 --spacing 0.8 --map-spacing 0.375 -q >line
same 'the line to feel it' 'hapgrid feel small/small.grid' "$(cat line)"
for made in index.html poses.tsv path.txt inside.png outside.png energy.png force.png played.html verify.txt; do
  [[ -s small/$made ]] || fail "small/$made is not there"
done
check-model small/small.toml --steps 50 >report || fail "$(cat report)"
# The same command again does nothing.
before=$(stat -c %Y.%i small/small.grid)
hapgrid dock "$host" "$ligand" -o small --centre 0,0,4 --size 1.6,1.6,1.6 --spacing 0.8 --map-spacing 0.375 -q >line
same 'the same grid' "$before" "$(stat -c %Y.%i small/small.grid)"

refuses 'dock: gone.mol2: No such file or directory' -- hapgrid dock gone.mol2 "$ligand" -o out -q
echo nothing >nothing.pdbqt
refuses 'dock: nothing.pdbqt: Open Babel finds no atoms in it' -- hapgrid dock nothing.pdbqt "$ligand" -o out -q
grep -v '^ATOM.*  [234]  ' small/ligand.pdbqt | sed '/^ATOM      5/d' >one.pdbqt
refuses 'dock: one.pdbqt: one atom cannot turn: .*' -- hapgrid dock "$host" one.pdbqt -o out -q
for ((n = 0; n < 201; ++n)); do grep '^ATOM      1' small/ligand.pdbqt; done >many.pdbqt
refuses 'dock: many.pdbqt: 201 atoms, at most 200 are possible' -- hapgrid dock "$host" many.pdbqt -o out -q
sed 's/ OA$/ Xx/' small/ligand.pdbqt >strange.pdbqt
refuses 'dock: autogrid4: ERROR:  unknown ligand atom type Xx' -- hapgrid dock "$host" strange.pdbqt -o out -q
{ sed '/ATOM>/q' "$host"; seq 200000 | sed 's/$/ C 0 0 0 C.3 1 UNL1 0.1/'; } >huge.mol2
refuses 'dock: huge.mol2: it has more than 20,000 atoms' -- hapgrid dock huge.mol2 "$ligand" -o out -q
refuses 'dock: box and ligand need maps of [0-9]+ cells .*' -- hapgrid dock "$host" "$ligand" -o out --size 40,4,4 -q
refuses 'dock: the ligand overlaps with the host everywhere in the box: .*' -- \
  hapgrid dock "$host" "$ligand" -o inside --centre 0.17,-2.29,-1.97 --size 0.5,0.5,0.5 --spacing 0.5 --map-spacing 0.375 -q
expect 2 '' '~dock: argument --size: must be three numbers from 0.5 to 60 .*' -- hapgrid dock a b -o out --size 1,2
