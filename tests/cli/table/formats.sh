# `hapgrid table` with files that autogrid4, APBS and psi4 wrote. What the grid then stores is compared, by formats.py,
# with what readers and splines of others make of the same file.
source "$(dirname "$0")/../lib.sh"

needs autogrid4 autogrid
needs apbs apbs
needs obabel openbabel
needs_python "ase, gridData, jinja2, scipy, vtkmodules" "python3-ase, python3-jinja2, python3-mdanalysis, python3-scipy, python3-vtk9"

# AutoGrid's maps of formaldehyde.
cat >host.pdb <<'PDB'
HETATM    1  C   UNL     1       0.000   0.000   0.000  1.00  0.00           C
HETATM    2  O   UNL     1       1.210   0.000   0.000  1.00  0.00           O
HETATM    3  H   UNL     1      -0.580   0.940   0.000  1.00  0.00           H
HETATM    4  H   UNL     1      -0.580  -0.940   0.000  1.00  0.00           H
PDB
obabel host.pdb -O host.pdbqt -xr --partialcharge gasteiger >said 2>&1
cat >host.gpf <<'GPF'
npts 20 22 24
gridfld host.maps.fld
spacing 0.375
receptor_types C OA
ligand_types OA
receptor host.pdbqt
gridcenter 0.5 0 0.25
smooth 0.5
map host.OA.map
elecmap host.e.map
dsolvmap host.d.map
dielectric -0.1465
GPF
autogrid4 -p host.gpf -l host.glg || fail "$(tail -n 5 host.glg)"

# The potential around an ion, by APBS.
printf 'ATOM      1  I   ION     1       0.500  -0.250   0.000  1.00  3.00\n' >ion.pqr
cat >ion.in <<'APBS'
read
  mol pqr ion.pqr
end
elec
  mg-manual
  dime 33 33 33
  grid 0.5 0.4 0.6
  gcent 0 0 0
  mol 1
  lpbe
  bcfl sdh
  pdie 1
  sdie 78.54
  chgm spl2
  srfm smol
  srad 1.4
  swin 0.3
  sdens 10
  temp 298.15
  calcenergy no
  calcforce no
  write pot dx ion
end
quit
APBS
apbs ion.in >ion.out 2>&1 || fail "$(tail -n 5 ion.out)"
ion=$(ls ion*.dx)

/usr/bin/python3 "$here/formats.py" images  # writes *.vti with VTK, and a sheared .dx

# try FILE DIR OPTION...: a grid that stores energy and force, for formats.py.
define() {
  local file=$1 dir=$2
  hapgrid table "$file" -o "$dir" "${@:3}" --until definition --quiet
  sed -i '/^max_levels/a store = ["energy", "force"]' "$dir/$dir.toml"
}
try() {
  define "$@"
  seed "$2/$2.toml" | expand --complete -o "$2/$2.grid"
  /usr/bin/python3 "$here/formats.py" compare "$1" "$2"
}
# The same by the command alone, with its report, which is the same for all formats.
try_all() {
  local file=$1 dir=$2
  define "$@"
  hapgrid table "$file" -o "$dir" "${@:3}" --quiet >line 2>said || fail "$(cat said)"
  same "the line to feel $dir" "hapgrid feel $dir/$dir.grid" "$(cat line)"
  for made in index.html feel.html slices.png played.html path.txt verify.txt; do
    [[ -s $dir/$made ]] || fail "$dir/$made is not there"
  done
  play "$dir/$dir.grid" --device "path:$dir/path.txt" 2>said
  grep -q 'ticks outside the box 0,' said || fail "$(cat said)"
  /usr/bin/python3 "$here/formats.py" compare "$file" "$dir"
}
try_all host.OA.map map --spacing 0.31
try host.e.map charge --factor -0.4 --wall 1
try "$ion" ion --spacing 0.37 --wall 30
try_all "$here/water-esp.cube" water --spacing 0.3 --wall 0.3
try plain.vti plain
try packed.vti packed --array energy
try text.vti text
try raw.vti raw
try sheared.dx sheared --spacing 0.5
verify sheared/sheared.grid >report
grep -Eq '^passive .* ok$' report || fail "$(cat report)"
# The grid carries the table; the report has its size and digest.
large=$(find . -name '*.table' -size +64k | sort | head -n 1)
[[ $large ]] || fail 'no table is large'
grid=${large%.table}.grid
same 'digest' "$(xxh128sum <"$large" | cut -d ' ' -f 1)" "$(stats "$grid" --get parameters.table.xxh128)"
same 'size' "$(stat -c %s "$large")" "$(stats "$grid" --get parameters.table.bytes)"
cmp plain/plain.table packed/packed.table

# The same command again does nothing; a definition that was changed is kept, and the grid made anew.
before=$(stat -c %Y.%i map/map.grid)
hapgrid table host.OA.map -o map --spacing 0.31 2>said >line
same 'the same grid' "$before" "$(stat -c %Y.%i map/map.grid)"
grep -q 'map.toml was changed by hand: it is kept' said || fail "$(cat said)"
sed -i 's/^largest_force = 3 /largest_force = 2 /' map/map.toml
hapgrid table host.OA.map -o map --spacing 0.31 2>said >line
same 'largest_force' 2.0 "$(stats map/map.grid --get parameters.largest_force)"
