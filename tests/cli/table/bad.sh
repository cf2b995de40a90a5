# What `hapgrid table` refuses is one line.
source "$(dirname "$0")/../lib.sh"
needs_python "jinja2, matplotlib" "python3-jinja2, python3-matplotlib"

printf '%s\n' 'GRID_PARAMETER_FILE x' 'GRID_DATA_FILE x' 'MACROMOLECULE x' 'SPACING 0.5' 'NELEMENTS 4 4 4' 'CENTER 1 2 3' >good.map
seq 125 >>good.map
{
  echo 'object 1 class gridpositions counts 4 4 4'
  printf '%s\n' 'origin 0 0 0' 'delta 1 0 0' 'delta 0 1 0' 'delta 0 0 1'
  echo 'object 3 class array type double rank 0 items 64 data follows'
  seq 64
} >good.dx
{ printf '%s\n' title title '1 0 0 0' '4 1 0 0' '4 0 1 0' '4 0 0 1' '8 8 0 0 0'; seq 64; } >good.cube
cat >good.vti <<'VTI'
<VTKFile type="ImageData" byte_order="LittleEndian"><ImageData WholeExtent="0 3 0 3 0 3" Origin="0 0 0" Spacing="1 1 1">
<Piece Extent="0 3 0 3 0 3"><PointData Scalars="e"><DataArray type="Float64" Name="e" format="ascii">
VTI
{ seq 64; echo '</DataArray></PointData></Piece></ImageData></VTKFile>'; } >>good.vti
for kind in map dx cube vti; do
  expect 0 '' '' -- hapgrid table good.$kind -o "$kind" --until definition -q
  [[ -s $kind/$kind.toml && -s $kind/$kind.table ]] || fail "no definition of good.$kind"
done
gzip -k good.dx
hapgrid table good.dx.gz -o packed --until definition -q
cmp dx/dx.table packed/packed.table

soon() { timeout -k 5 20 prlimit --as=$((2 << 30)) "$@"; }
# bad FILE MESSAGE: FILE is refused with one line, and leaves no folder.
bad() {
  expect 1 '' "~table: $1: $2" -- soon hapgrid table "$1" -o out -q
  [[ ! -e out ]] || fail "$1 leaves a folder"
}
while IFS='|' read -r kind edit said; do
  sed "$edit" "good.$kind" >"edited.$kind"
  bad "edited.$kind" "$said"
done <<'TABLE'
map|$d|its header speaks of 125 values, and it has 124
map|s/NELEMENTS 4/NELEMENTS 3/|its header speaks of 100 values, and it has 125
map|s/^17$/x/|'x' among the values is no number
map|/SPACING/s/.*/SPACING/|no AutoGrid map: SPACING is missing among its first 6 lines, or has not 1 numbers
map|s/NELEMENTS.*/NELEMENTS 9999 9999 9999/|1,000,000,000,000 values are too many: at most 16,777,216
map|s/NELEMENTS.*/NELEMENTS 4 4 2/;82,$d|5 x 5 x 3 values: at least 4 are needed along each axis
map|s/^[0-9]*$/nan/|it has no value that is a number
map|s/SPACING.*/SPACING 1e300/|its origin or spacing is no number below 1e\+30
dx|s/items 64/items 63/|its positions are 64, and its array has 63 items
dx|/delta 0 1/d|no OpenDX table: counts, origin, three deltas or 'data follows' is missing
dx|s/delta 0 1 0/delta 2 0 0/|its axes lie in one plane
dx|s/rank 0/rank 1 shape 3/|its array has vectors: only one number a point can be felt
cube|8,$d|its header speaks of 64 values, and it has 0
cube|3s/1/5/|its header speaks of 5 numbers of an atom, and it has 1
cube|4s/4/inf/|no cube: lines 3 to 6 need a whole number and 3 others each
vti|s/WholeExtent="0 3/WholeExtent="0 4/|only an image of one piece can be read
vti|s/format="ascii"/format="binary"/|its values in base64 are damaged or end in the middle
vti|s/^17$//|its header speaks of 64 values, and it has 63
vti|s/<VTK/<!DOCTYPE x [<!ENTITY a "b">]><VTK/|no VTK image: it defines entities of XML
TABLE
printf '\0' >zero.map
bad zero.map 'it is no text file'
head -c 100 good.dx.gz >cut.dx.gz
bad cut.dx.gz 'its compressed data are .*'
sed '7,$s/.*/1/' good.map >same.map
expect 1 '' '~.*the energy is the same everywhere' -- hapgrid table same.map -o same -q
# Nothing waits for ever, or takes time or memory that the file's size does not tell.
grep -v '^[0-9]*$' good.dx >head.dx
{ cat head.dx; printf '\n%.0s' {1..100000}; seq 64; } >blank.dx
expect 0 '' '' -- soon hapgrid table blank.dx -o blank --until definition -q
cmp dx/dx.table blank/blank.table
/usr/bin/python3 - <<'PY'
import struct
import zlib
open("tags.vti", "wb").write(b"<VTKFile>" + b"<AppendedData " * 100000)
data = zlib.compress(bytes(64 << 20), 9)
head = struct.pack("<4Q", 1, 64 << 20, 0, len(data))
open("bomb.vti", "wb").write(open("good.vti", "rb").read().split(b"<DataArray")[0].replace(b"<VTKFile", b'<VTKFile header_type="UInt64" '
    b'compressor="vtkZLibDataCompressor"') + b'<DataArray type="Float64" Name="e" format="appended" offset="0"/></PointData></Piece>'
    b'</ImageData><AppendedData encoding="raw">_' + head + data + b"</AppendedData></VTKFile>")
text = open("edited.vti").read()
open("wide.vti", "wb").write(text.encode("utf-16"))
open("named.vti", "wb").write(b"<?xml version='1.0' encoding='cp037'?>" + text.encode("cp037"))
cube = open("good.cube").read().replace("1 0 0 0", "-1 0 0 0", 1).split("\n")
for name, number in (("digits", "9" * 5000), ("large", "9" * 30), ("power", "\u00b2")):
    open(name + ".cube", "w").write("\n".join([*cube[:7], number + " 1", *cube[7:]]))
open("each.cube", "w").write("\n".join([*cube[:2], "1 0 0 0 1e300", *cube[3:]]))
PY
bad tags.vti 'no VTK image: .*'
bad bomb.vti 'its compressed data are cut off or too long'
bad wide.vti 'no VTK image: it is not written in UTF-8'
bad named.vti 'no VTK image: it is not written in UTF-8'
for name in digits large power; do bad "$name.cube" 'the list of its orbitals is not understood'; done
bad each.cube 'over 10\^15 values a point are too many'
mkfifo pipe.dx && ln -s /dev/zero zero.dx
for name in pipe zero; do bad "$name.dx" 'is no regular file'; done

# A stranger's folder names no file outside of it, and what is kept in it is no pipe.
for name in ../good.map "$PWD/good.map" /dev/zero; do
  rm -rf strange && cp -R dx strange
  sed -i "s|^table = .*|table = \"$name\"|" strange/dx.toml
  refuses "table: strange/dx.toml: names the file '$name': only files beside it are used, with plain names" -- \
    soon hapgrid table good.dx -o strange -q
done
rm strange/.work/name.json && mkfifo strange/.work/name.json
refuses 'table: strange/.work/name.json: is no regular file' -- soon hapgrid table good.dx -o strange -q

# A folder of one's own files, of another table or command, or that of the file itself is left as it is.
mkdir own && cp good.map own/good.toml
for file in good.map own/good.toml; do
  expect 2 '' 'table: own: has files that are none of hapgrid table: give a new folder' -- hapgrid table "$file" -o own -q
done
expect 2 '' 'table: dx: has other results, of good.dx, not of good.map: give another folder, or remove this one' -- \
  hapgrid table good.map -o dx -q
cp good.dx dx/good.dx
expect 2 '' 'table: dx/good.dx: lies in the folder of the results, dx: copy it, or give another folder' -- \
  hapgrid table dx/good.dx -o dx -q

echo >x.txt
bad x.txt 'only .map, .dx, .cube, .cub, .vti, .npz, .ccp4 and .mrc are known, and each with .gz behind it'
bad gone.map 'No such file or directory'
expect 1 '' 'table: good.map: no value is below the wall, -5: the lowest is 1' -- hapgrid table good.map -o out --wall -5 -q
expect 1 '' 'table: good.vti: it has no array f, only e' -- hapgrid table good.vti -o out --array f -q
expect 1 '' 'table: --spacing 3: the table has only 2 along an axis' -- hapgrid table good.map -o out --spacing 3 -q
expect 1 '' 'table: --factor 0 leaves nothing to feel' -- hapgrid table good.map -o out --factor 0 -q
expect 2 '' "table: argument -o/--output: 'good.map' is no folder (see --help)" -- hapgrid table good.map -o good.map
expect 2 '' "table: argument -o/--output: '' is no folder (see --help)" -- hapgrid table good.map -o ''
expect 2 '' 'table: argument --force: must be from 0.01 to 100 (see --help)' -- hapgrid table good.map -o out --force 0
expect 2 '' 'table: the following arguments are required: -o/--output (see --help)' -- hapgrid table good.map
expect 2 '' '~table: argument --unit: a unit has at most 15 bytes.*' -- hapgrid table good.map -o out --unit 'a"b'
