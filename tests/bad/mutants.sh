# Mutants of each kind of input, drawn anew in each run: HAPGRID_MUTANTS of them (1000), from HAPGRID_MUTANTS_SEED if it is set.
source "$(dirname "$0")/../cli/lib.sh"
number=${HAPGRID_MUTANTS:-1000} seed=${HAPGRID_MUTANTS_SEED:-$(od -An -N4 -tu4 /dev/urandom | tr -d ' ')}
if sanitized; then number=$((number / 40)) SANITIZED=1 && export SANITIZED; fi
echo "HAPGRID_MUTANTS_SEED=$seed"

sed 's/^counts = .*/counts = [6, 3, 2]/; s/^spacing = .*/spacing = 0.25/' "$ball" >small.toml
seed small.toml | expand --complete -o grid
printf '%s\n' '-0.7 0 0' '0 0.1 0' '0.5 0.2 0.1' >path
cat >play.toml <<'TOML'
[play]
axes = "-z,x,y"
gain = 0.5
max-force = 1.5
scale = 2
[play.safety]
ramp = 800
reserve = 0.1
encoder = 1e-4
delay = 3
[play.mapping]
offset = [0.1, 0, 0]
TOML
printf 'model = {name = "ball", process = ["cat", "answers"]}\ngrid = {origin = [0, 0, 0], spacing = 1, counts = [3, 3, 3]}\n' >process.toml
code=0
python3 "$here/mutants.py" filters "$seed" "$number" &
filters=$!

/usr/bin/python3 -c 'import numpy' 2>/dev/null || { wait $filters; missing "numpy for Python (Debian: python3-numpy)"; exit; }
printf '%s\n' 'GRID_PARAMETER_FILE x' 'GRID_DATA_FILE x' 'MACROMOLECULE x' 'SPACING 0.5' 'NELEMENTS 4 4 4' 'CENTER 1 2 3' >good.map
seq 125 >>good.map
{
  echo 'object 1 class gridpositions counts 4 4 4'
  printf '%s\n' 'origin 0 0 0' 'delta 1 0 0' 'delta 0 1 0' 'delta 0 0 1'
  echo 'object 3 class array type double rank 0 items 64 data follows'
  seq 64
  echo 'attribute "dep" string "positions"'
} >good.dx
{ printf '%s\n' title title '1 0 0 0' '4 1 0 0' '4 0 1 0' '4 0 0 1' '8 8 0 0 0'; seq 64; } >good.cube
{ printf '%s\n' title title '-1 0 0 0' '4 1 0 0' '4 0 1 0' '4 0 0 1' '8 8 0 0 0' '1 7'; seq 64; } >good-orbital.cube
image='<VTKFile type="ImageData" byte_order="LittleEndian" header_type="UInt64"><ImageData WholeExtent="0 3 0 3 0 3" Origin="0 0 0" Spacing="1 1 1">
<Piece Extent="0 3 0 3 0 3"><PointData Scalars="e"><DataArray type="Float64" Name="e"'
{ echo "$image" 'format="ascii">'; seq 64; echo '</DataArray></PointData></Piece></ImageData></VTKFile>'; } >good.vti
/usr/bin/python3 - "$image" <<'PY'
import base64, struct, sys, zlib
data = struct.pack("<64d", *range(64))
packed = zlib.compress(data)
end = "</PointData></Piece></ImageData>"
open("good-64.vti", "w").write(f'{sys.argv[1]} format="binary">{base64.b64encode(struct.pack("<Q", 512) + data).decode()}</DataArray>{end}</VTKFile>')
open("good-raw.vti", "wb").write((sys.argv[1] + f' format="appended" offset="0"/>{end}<AppendedData encoding="raw">_').replace("<VTKFile", '<VTKFile compressor='
    '"vtkZLibDataCompressor"', 1).encode() + struct.pack("<4Q", 1, 512, 0, len(packed)) + packed + b"</AppendedData></VTKFile>")
PY
printf '%s\n' '# AVS' label={C-affinity,Electrostatics,Desolvation} 'variable '{1,2,3}' file=good.map filetype=ascii skip=6' >good.maps.fld
cat >good.pdbqt <<'PDBQT'
REMARK  a ligand
ROOT
ATOM      1  C1  LIG A   1       0.000   0.000   0.000  0.00  0.00     0.100 C 
ATOM      2  O1  LIG A   1       1.400   0.000   0.000  0.00  0.00    -0.300 OA
ENDROOT
BRANCH   1   3
ATOM      3  C2  LIG A   1      -0.700   1.300   0.000  0.00  0.00     0.100 C 
ATOM      4  N1  LIG A   1      -2.100   1.300   0.000  0.00  0.00     0.100 N 
ENDBRANCH   1   3
TORSDOF 1
PDBQT
cat >good.pqr <<'PQR'
ATOM      1  N   GLY     1       0.000   0.000   0.000  0.1000 1.5000
ATOM      2  H   GLY     1       1.000   0.000   0.000  0.2000 1.0000
ATOM      3  CA  GLY     1      -0.700   1.300   0.000 -0.3000 1.7000
ATOM      4  HA  GLY     1      -0.700   1.300   1.090  0.1000 1.0000
PQR
cp "$HAPGRID_SOURCE/examples/docking/formamide.mol2" good.mol2
PYTHONPATH=$HAPGRID_BUILD/python OPENBLAS_NUM_THREADS=1 /usr/bin/python3 "$here/mutants.py" apps "$seed" "$number" || code=$?
wait $filters || code=$?
exit $code
