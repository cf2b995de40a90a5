# Of 150 random pushes of 1,2-dichloroethane none ends in no minimum, and at least 145 end where the model without a
# grid does. Its minima and barriers, and those of butane and of the dipeptide along phi, are those of the program xtb.
source "$(dirname "$0")/../../lib.sh"
source "$here/../xtb.bash"
molecules=$HAPGRID_SOURCE/examples/molecule

# Round the middle bond of 2-aminoethanol the conformation is reached again in one direction only, which is enough.
hapgrid molecule --smiles NCCO --push --basins -o amine -j 2 --until structures --quiet 2>said || fail "$(cat said)"
turning_points amine/N1-C2-C3-O4.xyz amine/conformation.xyz

basins=$HAPGRID_BUILD/bench/bench_basins
[[ -x $basins ]] || skip "bench_basins is not built"

for path in "$molecules"/dichloroethane/turn.xyz "$molecules"/basins/butane/C1-C2-C3-C4.xyz "$molecules"/basins/dipeptide-phi/phi.xyz; do
  turning_points "$path" "$(dirname "$path")/conformation.xyz"
done
for toml in "$molecules"/basins/*/*.toml; do
  molecule-check "$toml" >sane || fail "$toml: $(cat sane)"
  same "minima of $toml" 3 "$(grep -c '^minimum ' sane)"
done

seed "$molecules/dichloroethane/dichloroethane.toml" | expand --complete -j 2 -o grid
"$basins" grid "$HAPGRID_BUILD/models" 150 >ends || fail "$(cat ends)"
grep -qE '^150 pushes: 0 end in no known state, (14[5-9]|150) where the model does' ends || fail "$(cat ends)"
