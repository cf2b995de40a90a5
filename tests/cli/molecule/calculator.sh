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
# So are all nodes of the path. Where xtb's SCF converges less, each way to a minimum has other steps, and nodes between differ.
profile() { sed -n 's/.*dE=\([^ ]*\) .*/\1/p' "$1"; }
paste <(profile ours/C1-C2-O3-H9.xyz) <(profile gfn2/C1-C2-O3-H9.xyz) | awk 'NF != 2 || ($1 - $2)^2 > 1e-4 { exit 1 } END { exit NR < 60 }' ||
  fail "the nodes differ"
# In 32 bits, beside an energy of 1e4 eV, the noise is measured, and changes no barrier by more than four times as much.
made mmff && made mmff32
grep -q 'energies by calculator.py; its noise is 0\.0[0-9]* kJ/mol' said || fail "$(cat said)"
paste <(rises mmff) <(rises mmff32) | awk -F'\t' 'NR > 1 && ($1 != $4 || ($3 - $6)^2 > 0.12^2) { exit 1 }' || fail "$(rises mmff; rises mmff32)"
# A batch has all shapes of a Hessian, twice 27, and gives the same bytes as one shape after the other.
mv mmff alone
HAPGRID_TEST_BATCHES=$PWD/batches made mmff
cmp mmff/C1-C2-O3-H9.xyz alone/C1-C2-O3-H9.xyz && cmp mmff/report.tsv alone/report.tsv || fail "batches make another path"
(($(grep -cx 54 batches) > 20)) || fail "no batches: $(sort batches | uniq -c)"

# Clusters along a path: an atom goes through a triangle of three others, from one tetrahedron to its mirror image. Each frame is
# at rest but for its height. Of argon that has a closed form: pairs have 4 e ((s/r)^12 - (s/r)^6), whose cut-off is far away.
cat >cluster.py <<'END'
import sys
import numpy as np
from ase import Atoms
from ase.calculators.emt import EMT
from scipy.optimize import minimize_scalar

argon = sys.argv[1] == "argon"

def placed(side, height):
    angles = np.radians([0, 120, 240])
    base = side / np.sqrt(3) * np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    return np.vstack([base, [0, 0, height]])

def energy(side, height):
    if argon:
        pair = lambda r: 4 * 0.208 * ((3.4 / r)**12 - (3.4 / r)**6)
        return 3 * pair(side) + 3 * pair(np.sqrt(side**2 / 3 + height**2))
    return Atoms("Cu3Au", placed(side, height), calculator=EMT()).get_potential_energy()

low, high = (3.4, 7.0) if argon else (2.0, 5.0)
at_rest = lambda height: minimize_scalar(lambda side: energy(side, height), bounds=(low, high), method="bounded", options={"xatol": 1e-7})
top = minimize_scalar(lambda height: at_rest(height).fun, bounds=(1.2, 4.0), method="bounded", options={"xatol": 1e-7}).x
heights = np.linspace(-top, top, 21)
symbols = ["Ar"] * 4 if argon else ["Cu"] * 3 + ["Au"]
for height in heights:
    print(4, "title", sep="\n")
    for symbol, x in zip(symbols, placed(at_rest(height).x, height)):
        print(symbol, *("%.8f" % v for v in x))
found = np.array([at_rest(height).fun for height in heights])
print(*("%.5f" % v for v in (found - found[0]) * 96.48533212), sep="\n", file=sys.stderr)
END
for one in "argon ase.calculators.lj:LennardJones(sigma=3.4,epsilon=0.208,rc=1000)" "gold ase.calculators.emt:EMT()"; do
  name=${one%% *}
  /usr/bin/python3 cluster.py "$name" >"$name.xyz" 2>"$name.rises"
  hapgrid molecule "$name.xyz" --path --calculator "${one#* }" -o "$name" --quiet >line 2>said || fail "$name: $(cat said)"
  paste <(profile "$name/$name.xyz") "$name.rises" | awk '($1 - $2)^2 > 1e-4 { exit 1 } END { exit NR != 21 }' ||
    fail "$name: $(paste <(profile "$name/$name.xyz") "$name.rises")"
  over "$name" 0 1
done
# Without two frames in a row the steps are uneven. Those that are put between have the calculator's energies: the closed form.
awk '{ frame = int((NR - 1) / 6) } frame != 8 && frame != 9' argon.xyz >gap.xyz
lennard_jones='ase.calculators.lj:LennardJones(sigma=3.4,epsilon=0.208,rc=1000)'
hapgrid molecule gap.xyz --path --calculator "$lennard_jones" -o gap --until structures >line 2>said || fail "$(cat said)"
grep -Eq 'gap: 19 frames, in steps that are uneven or many, become [0-9]+ in even ones, with energies by ase' said || fail "$(cat said)"
/usr/bin/python3 - gap/gap.xyz <<'END' || fail "not the closed form"
import itertools
import re
import sys
import numpy as np
lines = open(sys.argv[1]).read().split("\n")
rises = []
for n in range(0, len(lines) - 5, 6):
    x = np.array([line.split()[1:4] for line in lines[n + 2:n + 6]], float)
    pairs = [np.linalg.norm(a - b) for a, b in itertools.combinations(x, 2)]
    rises.append((float(re.search(r"dE=(\S+)", lines[n + 1])[1]), sum(4 * 0.208 * ((3.4 / r)**12 - (3.4 / r)**6) for r in pairs) * 96.48533212))
told, known = np.array(rises).T
# Titles have three decimals, and the conformation's own energy is what others are above.
assert len(told) > 15 and np.ptp(told - known) < 0.01, (told, known - known[0])
END
grep -q 'barriers are often off' argon/index.html gold/index.html && fail 'the page judges a method that was not used'
# Energies in the titles are another method's.
sed "s/title/energy=-1.0/" gold.xyz >titled.xyz
hapgrid molecule titled.xyz --path --calculator 'ase.calculators.emt:EMT()' -o titled --until structures >line 2>said || fail "$(cat said)"
grep -q 'the energies in the titles are not taken: --calculator computes them' said || fail "$(cat said)"
same "profile" "$(profile gold/gold.xyz)" "$(profile titled/titled.xyz)"
refusals "$here/calculator.tsv"
