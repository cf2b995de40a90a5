# `hapgrid molecule --calculator`: shapes and energies of a calculator of ASE in the place of xtb's.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"
/usr/bin/python3 -c 'import ase' 2>/dev/null || { missing python3-ase; exit 77; }

made() {
  HAPGRID_TEST_CALCULATOR=$1 hapgrid molecule --smiles CCO -o "$1" --until structures --calculator "$here/calculator.py" >line 2>said ||
    fail "$1: $(cat said)"
}
rises() { cut -f 1-3 "$1/report.tsv" | sed '/^#/d'; }
# libxtb behind ASE is libxtb: the same minima and saddles to 0.01 kJ/mol.
made gfn2
hapgrid molecule --smiles CCO -o ours --until structures --quiet 2>said || fail "$(cat said)"
paste <(rises ours) <(rises gfn2) | awk -F'\t' 'NR > 1 && ($1 != $4 || ($3 - $6)^2 > 1.1e-4) { exit 1 }' || fail "$(rises ours; rises gfn2)"
# In 32 bits, beside an energy of 1e4 eV, the noise is measured, and changes no barrier by more than four times as much.
made mmff && made mmff32
grep -q 'energies by calculator.py; its noise is 0\.0[0-9]* kJ/mol' said || fail "$(cat said)"
paste <(rises mmff) <(rises mmff32) | awk -F'\t' 'NR > 1 && ($1 != $4 || ($3 - $6)^2 > 0.12^2) { exit 1 }' || fail "$(rises mmff; rises mmff32)"

expect 2 '' '~molecule: --calculator no: is not MODULE:CALLABLE.*' -- hapgrid molecule --smiles C --calculator no -o bad
refuses 'molecule: --calculator none:f: ModuleNotFoundError: .*' -- hapgrid molecule --smiles CC --calculator none:f -o bad --quiet
refuses 'molecule: --calculator: has no keyword for -1 charge: give a file with calculator\(charge, uhf\)' -- \
  hapgrid molecule --smiles 'CC[O-]' --calculator 'ase.calculators.emt:EMT()' -o charged --quiet
expect 2 '' 'molecule: --calculator: --method and --solvent are of xtb (see --help)' -- \
  hapgrid molecule --smiles C --calculator ase.calculators.emt:EMT --method gfn2 -o bad
