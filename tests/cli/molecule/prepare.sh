# prepare, from SMILES to paths, on butane; and the committed molecules, against xtb itself.
source "$(dirname "$0")/../lib.sh"
sanitized && skip "nothing in it has sanitizers"
command -v xtb >/dev/null || skip "xtb is not installed"
# The system's Python by name, as in prepare.
/usr/bin/python3 -c 'from openbabel import openbabel; import numpy' 2>/dev/null ||
  skip "python3-openbabel or python3-numpy is not installed"
/usr/bin/python3 -c 'import ctypes; ctypes.CDLL("libxtb.so.6")' 2>/dev/null ||
  skip "libxtb6 is not installed"
export OMP_NUM_THREADS=1

molecules=$HAPGRID_SOURCE/examples/molecule
prepare=$molecules/prepare

# word FILE FRAME KEY: from the comment line of a frame, counted from 1.
word() {
  awk -v frame="$2" -v key="$3=" '
    NF == 1 { n++; getline; if (n == frame) for (i = 1; i <= NF; i++)
      if (index($i, key) == 1) print substr($i, length(key) + 1) }' "$1"
}

# frame FILE FRAME: one frame as a file of its own.
frame() { awk -v frame="$2" 'NF == 1 { n++ } n == frame' "$1"; }

# within WHAT VALUE LOW HIGH
within() {
  awk -v v="$2" -v low="$3" -v high="$4" 'BEGIN { exit !(v != "" && v >= low && v <= high) }' ||
    fail "$1: '$2' is not between $3 and $4"
}

# xtb_energy FILE FRAME: GFN2 energy by the program itself, hartree.
xtb_energy() {
  rm -rf run && mkdir run && frame "$1" "$2" >run/a.xyz
  (cd run && xtb a.xyz --gfn 2 --acc 0.01 2>/dev/null) | awk '/TOTAL ENERGY/ { print $4 }'
}

# xtb_waves FILE FRAME: vibrations by the program's own Hessian, cm^-1, imaginary ones negative,
# ascending; without the six rigid motions, which it prints as 0.
xtb_waves() {
  rm -rf run && mkdir run && frame "$1" "$2" >run/a.xyz
  (cd run && xtb a.xyz --gfn 2 --acc 0.01 --hess >out 2>&1) || fail "xtb --hess: $1"
  awk '$2 == "a" { print $3 }' run/vibspectrum | sort -g
}

# saddle FILE: its last frame is a first-order saddle, with the wave number that is written there.
saddle() {
  local waves nu1
  waves=$(xtb_waves "$1" 11)
  same "imaginary frequencies of $1" 1 "$(awk '$1 < 0' <<<"$waves" | wc -l)"
  nu1=$(word "$1" 11 nu1)
  # Two step lengths of the differences, and a rounding to 1 cm^-1.
  within "nu1 of $1" "$(head -n 1 <<<"$waves")" "$((-${nu1#i} - 2))" "$((-${nu1#i} + 2))"
}

# energies FILE FRAME...: dE as xtb computes it, to 1e-3 kJ/mol: 8 decimals of the coordinates are
# worth less than 1e-5.
energies() {
  local file=$1 start frame got
  shift
  start=$(xtb_energy "$file" 1)
  for frame in "$@"; do
    got=$(xtb_energy "$file" "$frame")
    within "dE of $file, frame $frame, less xtb's" "$(
      awk -v a="$start" -v b="$got" -v dE="$(word "$file" "$frame" dE)" \
        'BEGIN { printf "%.6f", dE - (b - a) * 2625.4996394799 }')" -0.001 0.001
  done
}

# Bad input: one line, and nothing is left, half or whole.
refuses "prepare: SMILES 'CCC\(': not understood" -- "$prepare" --smiles 'CCC(' -o bad
refuses "prepare: SMILES 'CXC': not understood" -- "$prepare" --smiles CXC -o bad
refuses "prepare: SMILES '': not understood" -- "$prepare" --smiles '' -o bad
refuses "prepare: SMILES 'C\.C': more than one molecule" -- "$prepare" --smiles C.C -o bad
refuses 'prepare: no torsion: no bond of this molecule turns' -- "$prepare" --smiles c1ccccc1 -o bad
refuses 'prepare: torsion x=1-3: atoms 1 and 3 are not bonded' -- \
  "$prepare" --smiles CCCC --torsions x=1-3 -o bad
refuses 'prepare: torsion 2-99: no atom 99: there are 14' -- \
  "$prepare" --smiles CCCC --torsions 2-99 -o bad
refuses 'prepare: none.xyz: No such file or directory' -- "$prepare" none.xyz -o bad
echo 'no molecule' >bad.xyz
refuses 'prepare: bad.xyz: not understood as XYZ' -- "$prepare" bad.xyz -o bad
rm bad.xyz
expect 2 '' 'prepare: give either --smiles or FILE (see --help)' -- "$prepare" -o bad
expect 2 '' 'prepare: the following arguments are required: -o/--output (see --help)' -- \
  "$prepare" --smiles CCCC
nothing_left .

# Butane, trans: to gauche (experiment 14 to 15 kJ/mol over the barrier, gauche 2.5 to 4 above trans;
# GFN2 puts barriers about single bonds a quarter too low), and a methyl group (experiment 12 to 14).
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

# The same again is no work; it would give the same bytes.
expect 0 '' 'prepare: butane: there already; --again computes it anew' -- \
  "$prepare" "${butane[@]}" -o butane
cmp -s butane/phi-plus.xyz "$molecules/butane/phi-plus.xyz" ||
  energies "$molecules/butane/phi-plus.xyz" 11  # another numeric library; then just the energy

# The committed molecules: their files, then samples against xtb.
python3 "$here/prepared_data.py" butane "$molecules"/{butane,alanine-dipeptide,leu-enkephalin} ||
  fail "prepared data"
dipeptide=$molecules/alanine-dipeptide
for file in "$dipeptide"/{phi-plus,psi-plus}.xyz; do
  energies "$file" 3 7 11
  saddle "$file"
done
for file in "$dipeptide"/chi-{b,n}.xyz; do
  energies "$file" 11
  saddle "$file"
done
same "imaginary frequencies of the conformation" 0 \
  "$(xtb_waves "$dipeptide/conformation.xyz" 1 | awk '$1 < 0' | wc -l)"
