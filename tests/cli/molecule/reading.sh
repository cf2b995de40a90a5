# What `hapgrid molecule` reads: each of inputs/ is read as read.tsv says, SMILES get sound shapes, and damaged files one line.
source "$(dirname "$0")/../lib.sh"
needs_python "openbabel, rdkit, scipy" "python3-openbabel, python3-rdkit, python3-scipy"
export work
for part in read groups build isomers hostile; do
  PYTHONPATH=$HAPGRID_BUILD/python /usr/bin/python3 "$here/reading.py" "$part" || fail "$part: see above"
done
