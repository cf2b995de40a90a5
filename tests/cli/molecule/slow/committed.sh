#!/bin/bash
# The structures of the committed molecules: xtb itself finds the same energies and saddles, and `hapgrid molecule`
# makes butane's once more.
source "$(dirname "$0")/../../lib.sh"
source "$here/../xtb.bash"

molecules=$HAPGRID_SOURCE/examples/molecule

# xtb_waves FILE FRAME: the wave numbers of the vibrations by xtb's own Hessian, cm^-1, ascending and
# negative where imaginary, without those of the six rigid motions.
xtb_waves() {
  rm -rf run && mkdir run && frame "$1" "$2" >run/a.xyz
  (cd run && xtb a.xyz --gfn 2 --acc 0.01 --hess >out 2>&1) || fail "xtb --hess: $1"
  awk '$2 == "a" { print $3 }' run/vibspectrum | sort -g
}

# saddle FILE: the last frame must be a first-order saddle with the wave number that its comment gives.
saddle() {
  local waves nu1
  waves=$(xtb_waves "$1" 11)
  same "imaginary frequencies of $1" 1 "$(awk '$1 < 0' <<<"$waves" | wc -l)"
  nu1=$(word "$1" 11 nu1)
  # The two Hessians are differences with other steps, and the file rounds to 1 cm^-1.
  within "nu1 of $1" "$(head -n 1 <<<"$waves")" "$((-${nu1#i} - 2))" "$((-${nu1#i} + 2))"
}

python3 "$here/../prepared_data.py" "$molecules"/{butane,alanine-dipeptide,leu-enkephalin} || fail "prepared data"
for file in butane/C1-C2-C3-C4-plus butane/H5-C1-C2-C3 \
  alanine-dipeptide/{phi-plus,psi-plus,chi1,C7-N9-C10-H20}; do
  energies "$molecules/$file.xyz" 3 7 11
  saddle "$molecules/$file.xyz"
done
same "imaginary frequencies of the conformation" 0 \
  "$(xtb_waves "$molecules/alanine-dipeptide/conformation.xyz" 1 | awk '$1 < 0' | wc -l)"

# From trans-butane to gauche (in experiments the barrier is 14 to 15 kJ/mol and gauche 2.5 to 4 above
# trans; GFN2's barriers about single bonds are a quarter too low), and a methyl group (12 to 14).
hapgrid molecule --smiles CCCC --torsions C1-C2-C3-C4-plus,H5-C1-C2-C3 --spacing 1.5 -o butane -j 2 >line 2>log ||
  fail "$(cat log)"
turn=butane/C1-C2-C3-C4-plus.xyz
within "trans" "$(word butane/conformation.xyz 1 C1-C2-C3-C4 | tr -d -)" 179 180
within "saddle" "$(word $turn 11 C1-C2-C3-C4)" -125 -115
within "barrier" "$(word $turn 11 dE)" 9 16
within "methyl" "$(word butane/H5-C1-C2-C3.xyz 11 dE)" 9 15
within "gauche" "$(awk -F'\t' '$1 == "C1-C2-C3-C4-plus:far" { print $3 }' butane/report.tsv)" 2 4

# The barriers are those of the committed files: they are printed with four digits, and at a stationary point an error
# of the shape counts in its square.
for name in C1-C2-C3-C4-plus H5-C1-C2-C3; do
  there=$(word "$molecules/butane/$name.xyz" 11 dE)
  within "barrier of $name against the committed one" \
    "$(awk -v a="$(word "butane/$name.xyz" 11 dE)" -v b="$there" 'BEGIN { print a - b }')" -0.01 0.01
done
