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
{ grep -v '^[0-9]*$' good.dx; printf '\n%.0s' {1..100000}; seq 64; } >blank.dx
expect 0 '' '' -- soon hapgrid table blank.dx -o blank --until definition -q
cmp dx/dx.table blank/blank.table
sed '7,$s/.*/1/' good.map >same.map
expect 1 '' '~.*the energy is the same everywhere' -- hapgrid table same.map -o same -q
sed 's/<VTK/<!DOCTYPE x [<!ENTITY a "b">]><VTK/' good.vti >edited.vti
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
input() {
  if [[ $1 == '$ '* ]]; then eval "${1:2}"; else sed "${1#* }" "good.${1%% *}" >"edited.${1%% *}"; fi
}
cat >t.toml <<'TOML'
model = {plugin = "table", files = {table = "t.table"}}
grid = {origin = [0, 0, 0], spacing = 0.5, counts = [3, 3, 3]}
TOML
refusals "$here/bad.tsv"
