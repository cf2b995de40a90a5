# The five quickest molecules of tried.tsv from SMILES to a verified grid, with the defaults, and two more: energies and
# imaginary frequencies are those of the program xtb, and each way turns what it says.
source "$(dirname "$0")/../../lib.sh"
source "$here/../xtb.bash"

# feel NAME SMILES PATHS [OPTION...]: the number of paths that must be taken.
feel() {
  hapgrid molecule --push --smiles "$2" -o "$1" -j 2 "${@:4}" >line 2>log || fail "$1: $(cat log)"
  python3 "$here/../prepared_data.py" "$1" || fail "$1: prepared data"
  same "paths of $1" "$3" "$(grep -cP '\tyes\t-$' "$1/rotors.tsv" || true)"
  local path name
  while read -r name; do
    energies "$1/$name.xyz" 6 11
    path=$1/path-$name.txt
    [[ -s $path ]] || fail "there is no $path"
  done < <(grep -P '\tyes\t-$' "$1/rotors.tsv" | cut -f 1)
  verify "$1/$1.grid" --recompute 30 >report 2>verdict || fail "$1: $(cat verdict)"
}
feel cyanide C#N 0
grep -qE 'spacing 0\.[0-9]+ Å, [0-9]+ points, about' log || fail "$(cat log)"
feel peroxide OO 1
feel benzene c1ccccc1 0
METHOD=(--gfn 2 --chrg -1)
feel acetate 'CC(=O)[O-]' 0
METHOD=(--gfn 2 --uhf 1)
feel ethyl 'C[CH2]' 1 --uhf 1
METHOD=(--gfn 2)
feel ethanol CCO 3 --spacing 0.7
feel dichloroethane ClCCCl 2 --spacing 0.7

# The barriers from anti and the minimum behind them, both ways, GFN2-xTB.
for way in plus minus; do
  within "barrier" "$(word dichloroethane/Cl1-C2-C3-Cl4-$way.xyz 11 dE)" 12.4 12.8
  within "gauche" "$(awk -F'\t' -v name="Cl1-C2-C3-Cl4-$way:far" '$1 == name { print $3 }' dichloroethane/report.tsv)" 5.6 5.9
done

# What a coarse grid told is true of the grid: 99 of 100 places are off by 0.25 Å at most.
verify cyanide/cyanide.grid --recompute none --accuracy 0.25 >report 2>verdict || fail "$(cat report)"

# Glycine as a zwitterion has no minimum without water.
refuses 'molecule: no conformation: .*its bonds change; a zwitterion needs water: give --solvent water, or the neutral form' \
  -- hapgrid molecule --push --smiles '[NH3+]CC(=O)[O-]' -o zwitterion --quiet

# The dipeptide's soft torsions are found by the force field, too, whose scans snap over.
hapgrid molecule --push --smiles 'CC(=O)N[C@@H](C)C(=O)NC' --method gfnff --spacing 1.5 -o dipeptide -j 2 >line 2>log || fail "$(cat log)"
for name in phi-plus phi-minus; do
  grep -qP "^$name\t[^\t]*\t[0-9.]+\t" dipeptide/rotors.tsv || fail "$name is not found: $(cat dipeptide/rotors.tsv)"
done
! grep -q 'not converged' dipeptide/rotors.tsv || fail "$(cat dipeptide/rotors.tsv)"
