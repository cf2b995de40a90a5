# The page of a molecule with two bonds that turn has a map of both, whose energies are those of the model.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"
needs chromium chromium

hapgrid molecule --push --smiles CCO --method gfnff --spacing 0.7 -o ethanol --quiet >line 2>said || fail "$(cat said)"
in_time words /usr/bin/python3 "$here/page.py" ethanol 2> >(tee words >&2)
