# Wave numbers, names of bonds and of paths: `hapgrid molecule`'s modules against closed forms and the program xtb.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"
PYTHONPATH=$HAPGRID_BUILD/python /usr/bin/python3 "$here/chemistry.py" || fail "see above"

# A flat nitrogen becomes a pyramid to either side as its bond turns: of the two saddles the path leads over the lower one.
# The other ones have 145.9 and 113.8 kJ/mol. What the program xtb says of the saddle is within 0.01 kJ/mol of it.
while read -r smiles below; do
  hapgrid molecule --smiles "$smiles" -o a --until structures --quiet >line 2>&1 || fail "$(cat line)"
  within "$smiles" "$(awk '$2 == "path" { print $3 }' a/report.tsv)" 0 "$below"
  turning_points a/*-*.xyz a/conformation.xyz
  rm -r a
done <<END
CN(C)N=O 145
NN=O 113.7
END

# What is behind an alkyne turns against what is before it, though it bends on the way.
hapgrid molecule --smiles OC#CO -o diol --until definition --quiet >said 2>&1 || fail "$(cat said)"
grep -qP '^H5-O1-O4-H6\t.*\tyes\t' diol/rotors.tsv || fail "$(cat diol/rotors.tsv)"

# An ethyl group that turns freely beside two alkynes is no obstacle to a minimum.
hapgrid molecule --smiles 'CCC#CC#CCC' --method gfnff -o level --until structures >said 2>&1 || fail "$(cat said)"
grep -q 'C1-C2-C7-C8: .*turns freely' said || fail "$(cat said)"

# GFN2's nitrous acid is cis: that the trans one of a file turns is said.
printf '4\n\nN 0 0 0\nO 1.17 0 0\nO -0.505 1.338 0\nH -1.453 1.193 0\n' >hono.xyz
hapgrid molecule hono.xyz -o hono --until structures >said 2>&1 || fail "$(cat said)"
grep -q 'the conformation is not the shape that was given: O2-N1-O3-H4 from .* to .* degrees' said || fail "$(cat said)"
