# Energies that are not xtb's: in titles that were changed by hand, and by the program of --single-points. And a solvent.
source "$(dirname "$0")/../lib.sh"
source "$here/xtb.bash"

cp "$here/gauche.xyz" peroxide.xyz
peroxide=(peroxide.xyz --method gfnff -o one --torsions H3-O1-O2-H4-minus)
hapgrid molecule --push "${peroxide[@]}" --until definition --quiet >line 2>&1 || fail "$(cat line)"
path=one/H3-O1-O2-H4-minus.xyz
barrier=$(cut -f 3 one/rotors.tsv | sed -n 2p)

# E= alone gives the same barrier; dE= beside it must agree.
cp "$path" both.xyz
sed -i 's/^dE=[^ ]* //' "$path"
hapgrid molecule --push "${peroxide[@]}" --until definition --quiet >line 2>&1 || fail "$(cat line)"
same "barrier by E=" "$barrier" "$(cut -f 3 one/rotors.tsv | sed -n 2p)"
molecule-check one/one.toml >sane || fail "$(cat sane)"
awk '/^dE=/ && ++n == 11 { sub(/^dE=[^ ]*/, "dE=1") } 1' both.xyz >"$path"
refuses "molecule: $path frame 11: dE= gives 1 kJ/mol above the conformation, E= gives ${barrier%.*}\.[0-9]+: remove one" -- \
  hapgrid molecule --push "${peroxide[@]}" --until definition --quiet
refuses 'molecule-check: .*frame 11: dE= gives 1 kJ/mol above the conformation, E= gives [0-9.]*: remove one' -- \
  molecule-check one/one.toml
# Energies of another method in a path alone are refused. In all files they count, and the page says whose they are.
other='s/^dE=[^ ]* //; s/E=[^ ]*/E=-151.0/'
sed "$other" both.xyz >"$path"
refuses "molecule: $path: its energies and that of conformation\.xyz are not of one method: the conformation itself has .*" -- \
  hapgrid molecule --push "${peroxide[@]}" --until definition --quiet
cp both.xyz "$path"
sed -i -E 's/method=gfnff/method=gfnff hand/' "$path" one/conformation.xyz
hapgrid molecule --push "${peroxide[@]}" --quiet >line 2>&1 || fail "$(cat line)"
grep -q 'Energies<dd>the titles of the paths.* files, which were changed by hand' one/index.html || fail "the page names another method"

# A program whose energies have a closed form: -1 hartree and 20 kJ/mol times the cosine of half the torsion, or the square
# of the torsion's cosine.
cat >closed.py <<'PY'
#!/usr/bin/python3
import math
import sys
print("chatter")
lines = open(sys.argv[2]).read().splitlines()
assert lines[1] == "charge=0 unpaired=0", lines[1]
o, p, h, i = ([float(v) for v in line.split()[1:]] for line in lines[2:6])
sub = lambda a, b: [x - y for x, y in zip(a, b)]
cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
dot = lambda a, b: sum(x * y for x, y in zip(a, b))
n, m = cross(sub(o, h), sub(p, o)), cross(sub(p, o), sub(i, p))
angle = math.degrees(math.acos(max(-1, min(1, dot(n, m) / math.sqrt(dot(n, n) * dot(m, m))))))
if sys.argv[1] == "--scale=1":
    print(-1 + 20 / 2625.4996394799 * math.cos(math.radians(angle / 2)))
else:
    print(-1 + 20 / 2625.4996394799 * (math.cos(math.radians(angle)) - math.cos(math.radians(90))) ** 2)
PY
chmod +x closed.py
points=(peroxide.xyz --method gfnff -o two --torsions H3-O1-O2-H4-minus --until definition --quiet)
hapgrid molecule --push "${points[@]}" --single-points './closed.py --scale=1' >line 2>&1 || fail "$(cat line)"
rm -rf work && mkdir work
for n in 1 4 8 11; do
  frame two/H3-O1-O2-H4-minus.xyz "$n" >node.xyz
  sed -i '2s/.*/charge=0 unpaired=0/' node.xyz
  own=$(./closed.py --scale=1 node.xyz | tail -n 1)
  [[ $n -gt 1 ]] || rest=$own
  within "dE of frame $n" "$(awk -v a="$own" -v b="$rest" -v d="$(word two/H3-O1-O2-H4-minus.xyz "$n" dE)" \
    'BEGIN { printf "%.6f", d - (a - b) * 2625.4996394799 }')" -0.001 0.001
done
same "method" closed.py_--scale_1//gfnff "$(word two/conformation.xyz 1 method)"
within "E" "$(word two/conformation.xyz 1 E)" -1 -0.99

# By the other energies the conformation is no minimum: the lowest node, near 90 degrees, takes its place, and from there
# the path leads both ways.
hapgrid molecule --push "${points[@]}" --single-points './closed.py --scale=2' >line 2>&1 || fail "$(cat line)"
within "torsion" "$(word two/conformation.xyz 1 H3-O1-O2-H4)" 82 98
same "paths" 'H3-O1-O2-H4-minus H3-O1-O2-H4-plus' "$(awk -F'\t' '$2 == "saddle" { print $1 }' two/report.tsv | sort | xargs)"
molecule-check two/two.toml >sane || fail "$(cat sane)"
within "cis" "$(awk -F'\t' '$1 == "H3-O1-O2-H4-minus" { print $3 }' two/report.tsv)" 19.5 20
within "the old conformation" "$(awk -F'\t' '$1 == "H3-O1-O2-H4-plus" { print $3 }' two/report.tsv)" 15 16

# A program that fails, or prints no energy. A file here that is called like one does not run.
touch false echo
refuses 'molecule: --single-points: false ended with 1: ' -- hapgrid molecule --push "${points[@]}" --single-points false
refuses "molecule: --single-points: the last line of echo is 'about node\.xyz', and not an energy in hartree" -- \
  hapgrid molecule --push "${points[@]}" --single-points 'echo about'
refuses 'molecule: --single-points: none: No such file or directory' -- hapgrid molecule --push "${points[@]}" --single-points none

# ASE's own calculator of argon and the like needs no program. With psi4 and mopac: slow/ase.sh.
if ! /usr/bin/python3 -c 'import ase' 2>/dev/null; then
  missing python3-ase
else
  printf '2\ncharge=0 unpaired=0\nAr 0 0 0\nAr 0 0 3.8163708\n' >argon.xyz  # at the minimum, 2^(1/6) sigma
  energy=$(single-point-ase lj sigma=3.4 epsilon=0.0104 rc=100 argon.xyz)
  within "argon" "$energy" -0.00038220 -0.00038218  # -0.0104 eV, with what is beyond the cut-off less than 1e-9 of it
fi

# Glycine's zwitterion is a minimum in water, by the program xtb the same. GBSA's surface is sampled coarser there, by which
# energies of some orientations differ by 1e-5 hartree.
hapgrid molecule --push --smiles '[NH3+]CC(=O)[O-]' --method gfnff --solvent water -o wet --until structures --quiet --torsions N1-C2-C3-O4-plus >line 2>&1 ||
  fail "$(cat line)"
METHOD=(--gfnff --gbsa water)
within "energy in water" "$(awk -v a="$(word wet/conformation.xyz 1 E)" -v b="$(xtb_energy wet/conformation.xyz 1)" \
  'BEGIN { print a - b }')" -0.00003 0.00003
# It is a minimum: none is imaginary, which would be written i123. The lowest one is that of a torsion, below 300 cm^-1.
within "lowest wave number" "$(awk -F'\t' '$1 == "conformation" { print $4 }' wet/report.tsv)" 1 300
expect 2 '' "~molecule: argument --solvent: invalid choice: 'beer' .choose from 'acetone', .*, 'water'. .see --help." -- \
  hapgrid molecule --push --smiles CO --solvent beer -o beer
