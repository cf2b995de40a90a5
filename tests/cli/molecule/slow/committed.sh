# The structures of the committed molecules: xtb itself finds the same energies and saddles. molecules.sh makes others.
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
