# An ensemble in an XYZ file: with --basins paths lead from the lowest of its minima to the others.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"
METHOD=(--gfnff)

# Cyclohexane's chair and the other chair, in which each axial hydrogen is equatorial; two hydrogens at one carbon are
# numbered the other way, as programs do that embed shapes. The ring flips on one path over two
# barriers and a twist-boat, whose energies are those of the program xtb.
cp "$here/cyclohexane.xyz" .
hapgrid molecule --push cyclohexane.xyz --basins --method gfnff -o ring --until structures --quiet >line 2>&1 || fail "$(cat line)"
turning_points ring/to-2.xyz ring/conformation.xyz
# Between two twist-boats it may go over the boat, a third barrier: both ways are lowest, and the processor decides.
[[ $seen == 01010 || $seen == 0101010 ]] || fail "minima and saddles: $seen"
rows=$(grep ^to-2 ring/report.tsv | cut -f 2 | sed 's/ on the path//' | xargs)
[[ $rows =~ ^path( saddle minimum){2,3}$ ]] || fail "rows: $rows"
[[ $(word ring/to-2.xyz 1 dE) == 0.0000 ]] || fail "the path does not begin in the conformation"

# The ring of proline flips: two puckers of one conformation, whose ring has the opposite sign at the end of the path.
cp "$here/proline.xyz" .
hapgrid molecule --push proline.xyz --basins --method gfnff -o pro --until structures >line 2>&1 || fail "$(cat line)"
grep -q 'frame 2: to-2, on which the ring .* turns: ' line || fail "$(cat line)"
turning_points pro/to-2.xyz pro/conformation.xyz
same "minima and saddles" 010 "$seen"
/usr/bin/python3 - <<'END' || fail "the ring has not flipped"
import numpy
lines = open("pro/to-2.xyz").read().split("\n")
count = int(lines[0])
frames = [numpy.array([line.split()[1:4] for line in lines[k + 2:k + 2 + count]], float) for k in range(0, len(lines) - 1, count + 2)]
def torsion(x, a, b, c, d):
    u, v, w = x[b] - x[a], x[c] - x[b], x[d] - x[c]
    return numpy.degrees(numpy.arctan2(numpy.linalg.norm(v) * (u @ numpy.cross(v, w)), numpy.cross(u, v) @ numpy.cross(v, w)))
first, last = (torsion(x, 4, 5, 6, 7) for x in (frames[0], frames[-1]))
assert first * last < 0 and min(abs(first), abs(last)) > 20, (first, last)
END

# Anti and both gauche shapes of dichloroethane. A path that turns one bond alone has its name, the second has a number.
turn=$HAPGRID_SOURCE/examples/molecule/dichloroethane/turn.xyz
{ frame "$turn" 11; frame "$turn" 28; frame "$turn" 45; } | sed 's/^dE=[^ ]* t=[^ ]* //' >shapes.xyz
same "frames" 3 "$(grep -c ^8 shapes.xyz)"
hapgrid molecule --push shapes.xyz --basins --method gfnff -o shapes --until structures --quiet >line 2>&1 || fail "$(cat line)"
grep -qP '^Cl1-C2-C3-Cl4\tpath\t' shapes/report.tsv || fail "$(cat shapes/report.tsv)"
same "paths" 2 "$(grep -cP '\tpath\t' shapes/report.tsv)"

# Where all frames are one minimum the bonds are turned.
{ frame "$turn" 28; frame "$turn" 28; } >same.xyz
hapgrid molecule --push same.xyz --basins --method gfnff -o same --until structures >line 2>&1 || fail "$(cat line)"
grep -q 'the ensemble has no other minimum than the conformation, so the bonds are turned' line || fail "$(cat line)"
grep -qP '^Cl1-C2-C3-Cl4\tpath\t' same/report.tsv || fail "$(cat same/report.tsv)"

# Two shapes of allyl fluoride, in which the hydrogens of =CH2 are numbered either way: one bond turns.
hapgrid molecule --push "$here/allyl-fluoride.xyz" --basins -o allyl --until structures >line 2>&1 || fail "$(cat line)"
grep -q 'frame 2: .* on which C1-C2-C3-F4 turns: saddle [0-9.]*, minimum [0-9.]* kJ/mol' line || fail "$(cat line)"
