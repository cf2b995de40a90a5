# `hapgrid dock` with hosts and ligands as files of other programs have them: what is left out, said and refused.
source "$(dirname "$0")/../lib.sh"
needs obabel openbabel
needs_python "jinja2, scipy" "python3-jinja2, python3-scipy"
host=$HAPGRID_SOURCE/examples/docking/calix.mol2 ligand=$HAPGRID_SOURCE/examples/docking/formamide.mol2
near=(--centre '0,0,4' --size '1,1,1')

says() { # WORDS HOST LIGAND OPTION...
  hapgrid dock "$2" "$3" -o out --until definition --atoms "${@:4}" 2>said || fail "$(cat said)"
  grep -qE "$1" said || fail "$(cat said)"
  rm -r out
}

# Alternate locations, of which one stays, and water.
{
  while read -r n name way residue number x y z occupancy element; do
    printf 'HETATM%5d  %-3s%1s%-3s A%4d    %8.3f%8.3f%8.3f%6.2f 10.00          %2s\n' \
      "$n" "$name" "${way/-/ }" "$residue" "$number" "$x" "$y" "$z" "$occupancy" "$element"
  done <<'ATOMS'
1 C1 - LIG 1 0 0 0 1 C
2 O1 A LIG 1 1.43 0 0 0.4 O
3 O1 B LIG 1 -0.9 1.1 0 0.6 O
4 O - HOH 7 0 0 6 1 O
ATOMS
} >come.pdb
for words in 'alternate locations of residue A 1: B is kept, of highest occupancy, 0.60' '1 crystal water is left out' 'host of 2 atoms'; do
  says "$words" come.pdb "$ligand" "${near[@]}"
done
# A PQR whose columns touch.
printf 'ATOM  %5d  %-3s %-3s  %4d    %8.3f%8.3f%8.3f %7.4f %6.4f\n' 1 N ALA 1 -100.123 -200.456 -300.789 -0.4157 1.824 \
  2 H ALA 1 -100.123 -200.456 -301.789 0.4157 0.6 3 O HOH 2 -100.123 -200.456 -310.789 -0.8 1.6 >touch.pqr
says 'host of 2 atoms' touch.pqr "$ligand" --centre=-100,-200,-305 --size 1,1,1
# Hydrogens that are missing, and some that are of the wrong type.
obabel "$ligand" -O bare.mol2 -d >/dev/null 2>&1
says 'bare.mol2: it has no hydrogens, and lacks 3: .obabel -h. adds them' "$host" bare.mol2 "${near[@]}"
obabel "$ligand" -O ligand.pdbqt --partialcharge gasteiger >/dev/null 2>&1
atom() { printf 'ATOM  %5d  %-3s UNL A   1    %8.3f%8.3f%8.3f  1.00  0.00    %+6.3f %s\n' "$@"; }
{ echo ROOT; atom 1 C1 0 0 0 -0.08 C 2 H1 0.629 0.629 0.629 0.04 HD 3 H2 -0.629 -0.629 0.629 0.04 HD; echo ENDROOT; echo TORSDOF 0; } >wrong.pdbqt
says 'wrong.pdbqt: 2 hydrogens on carbon have the type HD' "$host" wrong.pdbqt "${near[@]}"

# AutoGrid's maps of two runs, and those of Vina, which have no charge.
map() { printf '%s\n' 'GRID_PARAMETER_FILE x' 'GRID_DATA_FILE x' 'MACROMOLECULE x' "SPACING $1" 'NELEMENTS 4 4 4' "CENTER $2 $2 $2"; seq 125; }
for name in C OA e d; do map 0.5 0 >p.$name.map; done
map 0.25 -0.5 >p.OA.map
field() { for name; do echo "label=$name"; done; for name; do echo "variable 1 file=p.${name%-affinity}.map"; done; }
field C-affinity OA-affinity Electrostatics Desolvation | sed 's/p.Electrostatics/p.e/; s/p.Desolvation/p.d/' >pair.maps.fld
{ echo ROOT; atom 1 C1 0 0 0 0.1 C 2 O1 1.13 0 0 -0.1 OA; echo ENDROOT; echo TORSDOF 0; } >co.pdbqt
field C-affinity OA-affinity >vina.maps.fld
atom 1 X 0 0 0.8 -0.4 OA 2 X 1 0 -0.4 0.2 HD 3 X -1 0 -0.4 0.2 HD >water.pdbqt
cat >d.toml <<'TOML'
model = {plugin = "docking", files = {ligand = "l.pdbqt", host = "h.pdbqt"}}
grid = {origin = [0, 0, 5], spacing = 0.5, counts = [2, 2, 2]}
TOML
refusals "$here/strangers.tsv"
