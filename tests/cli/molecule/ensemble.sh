# An ensemble in an XYZ file: with --basins paths lead from the lowest of its minima to the others.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"
METHOD=(--gfnff)

# Cyclohexane's chair and the other chair, in which each axial hydrogen is equatorial; two hydrogens at one carbon are
# numbered the other way, as programs do that embed shapes. The ring flips on one path over two
# barriers and a twist-boat, whose energies are those of the program xtb.
cp "$here/cyclohexane.xyz" .
hapgrid molecule cyclohexane.xyz --basins --method gfnff -o ring --until structures --quiet >line 2>&1 || fail "$(cat line)"
turning_points ring/to-2.xyz ring/conformation.xyz
same "minima and saddles" 01010 "$seen"
same "rows" 'path saddle minimum saddle minimum' "$(grep ^to-2 ring/report.tsv | cut -f 2 | sed 's/ on the path//' | xargs)"
[[ $(word ring/to-2.xyz 1 dE) == 0.0000 ]] || fail "the path does not begin in the conformation"

# Anti and both gauche shapes of dichloroethane. A path that turns one bond alone has its name, the second has a number.
turn=$HAPGRID_SOURCE/examples/molecule/dichloroethane/turn.xyz
{ frame "$turn" 11; frame "$turn" 28; frame "$turn" 45; } | sed 's/^dE=[^ ]* t=[^ ]* //' >shapes.xyz
same "frames" 3 "$(grep -c ^8 shapes.xyz)"
hapgrid molecule shapes.xyz --basins --method gfnff -o shapes --until structures --quiet >line 2>&1 || fail "$(cat line)"
grep -qP '^Cl1-C2-C3-Cl4\tpath\t' shapes/report.tsv || fail "$(cat shapes/report.tsv)"
same "paths" 2 "$(grep -cP '\tpath\t' shapes/report.tsv)"

# Where all frames are one minimum the bonds are turned.
{ frame "$turn" 28; frame "$turn" 28; } >same.xyz
hapgrid molecule same.xyz --basins --method gfnff -o same --until structures >line 2>&1 || fail "$(cat line)"
grep -q 'the ensemble has no other minimum than the conformation, so the bonds are turned' line || fail "$(cat line)"
grep -qP '^Cl1-C2-C3-Cl4\tpath\t' same/report.tsv || fail "$(cat same/report.tsv)"
