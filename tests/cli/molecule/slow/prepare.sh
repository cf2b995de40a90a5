#!/bin/bash
# prepare makes butane's paths from SMILES, and xtb itself finds the same energies and saddles.
source "$(dirname "$0")/../../lib.sh"
source "$here/../xtb.bash"

molecules=$HAPGRID_SOURCE/examples/molecule
prepare=$molecules/prepare

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

# Bad input: one line, and nothing is left, half or whole.
bad() { refuses "prepare: $1" -- "$prepare" "${@:2}" -o bad; }
bad "SMILES 'CCC\(': not understood" --smiles 'CCC('
bad "SMILES 'CXC': not understood" --smiles CXC
bad "SMILES '': not understood" --smiles ''
bad "SMILES 'C\.C': more than one molecule" --smiles C.C
bad 'no torsion: no bond of this molecule turns' --smiles c1ccccc1
bad 'torsion x=1-3: atoms 1 and 3 are not bonded' --smiles CCCC --torsions x=1-3
bad 'torsion 2-99: no atom 99: there are 14' --smiles CCCC --torsions 2-99
bad 'none.xyz: No such file or directory' none.xyz
echo 'no molecule' >bad.xyz
bad 'bad.xyz: not understood as XYZ' bad.xyz
rm bad.xyz
expect 2 '' 'prepare: give either --smiles or FILE (see --help)' -- "$prepare" -o bad
expect 2 '' 'prepare: the following arguments are required: -o/--output (see --help)' -- \
  "$prepare" --smiles CCCC
nothing_left .

# From trans-butane to gauche (in experiments the barrier is 14 to 15 kJ/mol and gauche 2.5 to 4 above
# trans; GFN2's barriers about single bonds are a quarter too low), and a methyl group (12 to 14).
butane=(--smiles CCCC --torsions "phi=1-2-3-4,chi=1-2")
began=$SECONDS
expect 0 $'conformation = "conformation.xyz"\ntransition_states = ["phi-plus.xyz", "chi.xyz"]' '' -- \
  "$prepare" "${butane[@]}" -o butane --quiet
echo "butane: $((SECONDS - began)) s"
nothing_left butane chi.xyz conformation.xyz phi-plus.xyz report.tsv
within "trans" "$(word butane/conformation.xyz 1 phi | tr -d -)" 179 180
within "saddle" "$(word butane/phi-plus.xyz 11 phi)" -125 -115
within "barrier" "$(word butane/phi-plus.xyz 11 dE)" 9 16
within "methyl" "$(word butane/chi.xyz 11 dE)" 9 15
within "gauche" "$(awk -F'\t' '$1 == "phi-plus:far" { print $3 }' butane/report.tsv)" 2 4
saddle butane/phi-plus.xyz
energies butane/phi-plus.xyz 4 11

# What is there already is not computed again. The barriers are those of the committed files, which the command made: they are
# printed with four digits, and at a stationary point an error of the shape counts in its square.
expect 0 '' 'prepare: butane: there already; --again computes it anew' -- \
  "$prepare" "${butane[@]}" -o butane
for pair in phi-plus:C1-C2-C3-C4-plus chi:H5-C1-C2-C3; do
  there=$(word "$molecules/butane/${pair#*:}.xyz" 11 dE)
  found=$(word "butane/${pair%:*}.xyz" 11 dE)
  within "barrier of ${pair%:*} against the committed one" "$(awk "BEGIN { print $found - $there }")" -0.01 0.01
  energies "$molecules/butane/${pair#*:}.xyz" 11
done

# The committed molecules: the files themselves, and the dipeptide's paths beside xtb.
python3 "$here/../prepared_data.py" butane "$molecules"/{butane,alanine-dipeptide,leu-enkephalin} ||
  fail "prepared data"
dipeptide=$molecules/alanine-dipeptide
for name in {phi,psi}-plus chi1 C7-N9-C10-H20; do
  energies "$dipeptide/$name.xyz" 3 7 11
  saddle "$dipeptide/$name.xyz"
done
same "imaginary frequencies of the conformation" 0 \
  "$(xtb_waves "$dipeptide/conformation.xyz" 1 | awk '$1 < 0' | wc -l)"
