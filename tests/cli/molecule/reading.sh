# What `hapgrid molecule` reads: each of inputs/ is read as read.tsv says, SMILES get sound shapes, and damaged files one line.
source "$(dirname "$0")/../lib.sh"
/usr/bin/python3 -c 'from openbabel import openbabel; import numpy, rdkit' 2>/dev/null ||
  { missing "python3-openbabel, python3-rdkit or python3-numpy"; exit 77; }
export work
for part in read build hostile; do
  /usr/bin/python3 "$here/reading.py" "$HAPGRID_SOURCE/examples/molecule" "$part" || fail "$part: see above"
done
