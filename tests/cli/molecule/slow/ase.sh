# Energies by ASE: psi4 and mopac give those that they give without it, and hydrogen peroxide gets its twisted minimum and
# both barriers, where GFN2-xTB has it planar.
source "$(dirname "$0")/../../lib.sh"
source "$here/../xtb.bash"
/usr/bin/python3 -c 'import ase' 2>/dev/null || skip "python3-ase is not installed"
ase=single-point-ase

printf '2\ncharge=-1 unpaired=0\nO 0 0 0\nH 0 0 0.97\n' >hydroxide.xyz
refuses 'single-point-ase: charge -1, 0 unpaired electrons: tell emt by its own KEY=VALUE' -- "$ase" emt hydroxide.xyz
if command -v mopac >mopac.path; then
  printf 'PM7 1SCF CHARGE=-1\n\n\nO 0 0 0\nH 0 0 0.97\n' >own.mop
  mopac own.mop >own.said 2>&1
  within "mopac less ASE's, kcal/mol" "$(awk -v e="$("$ase" mopac method=PM7 hydroxide.xyz | tail -n 1)" \
    '/FINAL HEAT OF FORMATION/ { print $6 - e * 627.5094740631 }' own.out)" -0.01 0.01
else
  missing mopac
fi
command -v psi4 >psi4.path || skip "psi4 is not installed"
# The same energy from an input of psi4.
printf 'molecule { -1 1\nO 0 0 0\nH 0 0 0.97\n}\nset basis cc-pvdz\nenergy("scf")\n' >own.dat
psi4 own.dat own.log >own.said 2>&1
within "psi4 less ASE's" "$(awk -v e="$("$ase" psi4 method=scf basis=cc-pvdz hydroxide.xyz | tail -n 1)" \
  '/Total Energy =/ { print $4 - e }' own.log | tail -n 1)" -0.000002 0.000002

# For these shapes psi4 itself gives 3.5 (trans) and 29.5 kJ/mol (cis) by MP2/cc-pVTZ. The smaller basis is off by less than
# 6 kJ/mol, and nodes are 18 degrees apart.
hapgrid molecule --push --smiles OO --until structures -o peroxide --single-points 'single-point-ase psi4 method=mp2 basis=cc-pvdz' \
  --quiet >line 2>&1 || fail "$(cat line)"
within "torsion" "$(word peroxide/conformation.xyz 1 H3-O1-O2-H4 | tr -d -)" 95 130
awk -F'\t' '$2 == "saddle" { print $3 }' peroxide/report.tsv | sort -g >barriers
within "trans" "$(head -n 1 barriers)" 1 9
within "cis" "$(tail -n 1 barriers)" 25 36
same "barriers" 2 "$(wc -l <barriers)"
