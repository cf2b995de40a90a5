# Tables as other programs write them: what is taken, what is said of it, and what the values are then.
source "$(dirname "$0")/../lib.sh"
needs_python "jinja2, mrcfile, vtkmodules" "python3-jinja2, python3-mrcfile, python3-vtk9"

/usr/bin/python3 - <<'PYTHON'
import mrcfile
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

i, j, k = np.meshgrid(np.arange(5), np.arange(6), np.arange(7), indexing="ij")
values = np.round(np.cos(i) + j * k / 7 - 3, 3)
values[-1, -1, -1] = 0


def cube(name, title, first, scale, body, steps=0.4, signs=(1, 1, 1), extra=()):
    rows = [f"{s * n} " + " ".join(f"{steps * scale if a == b else 0:.9g}" for b in range(3)) for a, (n, s) in enumerate(zip((5, 6, 7), signs))]
    atoms = [f"{z} {z} " + " ".join(f"{c * scale:.9g}" for c in x) for z, x in ((6, (1, 1, 1)), (8, (1, 1, 2.128)))]
    open(name, "w").write("\n".join(["a field", title, f"{first} 0 0 0", *rows, *atoms, *extra, body]) + "\n")


text, bohr = "\n".join(f"{v:.3f}" for v in values.ravel()), 1 / 0.529177210903
cube("good.cub", "electrostatic potential", 2, bohr, text)
cube("unmarked.cube", "electrostatic potential", 2, 1, text)
cube("signed.cube", "electrostatic potential", 2, 1, text, signs=(-1, -1, -1))
cube("density.cube", "electron density", 2, bohr, text)
cube("whole.cube", "electrostatic potential", 2, bohr, text, steps=4)
cube("orbitals.cube", "orbitals", -2, bohr, "\n".join(f"{-v:.3f} {v:.3f}" for v in values.ravel()), extra=["2 12 13"])
cube("fortran.cube", "electrostatic potential", 2, bohr, "\n".join(f"{v * 100:.1f}D-02" for v in values.ravel()[:-1]) + "\n0.33-101")
with mrcfile.new("field.mrc") as m:
    m.set_data(values.transpose(2, 1, 0).astype("f4"))
    m.voxel_size = 0.4
np.savez("placeless.npz", values=values)
np.savez("field.npz", values=values, origin=[0, 0, 0], spacing=0.4)
image = vtkImageData()
image.SetDimensions(6, 7, 8)
image.SetOrigin(-0.2, -0.2, -0.2)
image.SetSpacing(0.4, 0.4, 0.4)
for name, factor in (("field", 1), ("other", 2)):
    array = numpy_to_vtk(factor * values.ravel(order="F"), deep=True)
    array.SetName(name)
    image.GetCellData().AddArray(array)
for compressor in ("LZ4", "LZMA"):
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(compressor + ".vti")
    writer.SetInputData(image)
    getattr(writer, "SetCompressorTypeTo" + compressor)()
    writer.SetBlockSize(512)
    writer.Write()
PYTHON

# takes FILE SAYS OPTION...: DIR.table becomes that of the first file, but for the last digits.
takes() {
  hapgrid table "$1" -o "out-$1" --until definition "${@:3}" 2>said || fail "$(cat said)"
  grep -qE "$2" said || fail "$1: $(cat said)"
  /usr/bin/python3 - "$1" <<'PYTHON'
import glob
import sys
import numpy as np
numbers = []
for name in ("good.cub", sys.argv[1]):
    text = open(glob.glob(f"out-{name}/*.table")[0]).read()
    head, values = text.split("values")
    places = [line.split()[1:] for line in head.splitlines() if line.split()[:1] in (["counts"], ["origin"], ["axis"])]
    numbers.append(np.array([*sum(places, []), *values.split()], float))
assert np.allclose(*numbers, rtol=1e-6, atol=1e-6), (sys.argv[1], numbers)
PYTHON
}
unit() { sed -n 's/^energy_unit = "\(.*\)"/\1/p' "out-$1"/*.toml; }
takes good.cub 'title: a field / electrostatic potential'
same 'unit' hartree "$(unit good.cub)"
takes unmarked.cube 'C and O would be only 0\.60 angstrom apart if its lengths were in bohr: they are taken as angstrom'
takes signed.cube reading
takes density.cube 'these are no energies: their unit is not known'
same 'unit' '' "$(unit density.cube)"
sed '1s/.*/a field/; 2s/.*/of numbers/' good.cub >untitled.cube
takes untitled.cube 'its title does not say what its values are: are they energies in hartree\? .*'
same 'unit' '' "$(unit untitled.cube)"
sed '2s/.*/in kJ\/mol/' good.cub >named.cube
takes named.cube reading
same 'unit' kJ/mol "$(unit named.cube)"
takes orbitals.cube 'orbital 13 of 12, 13' --array 13
takes fortran.cube reading
takes field.mrc 'densities, no energies'
takes field.npz 'array values'
takes LZ4.vti "array field; --array takes another one: other"
takes LZMA.vti "taken at the cells' centres" --array field
refused() { expect 1 '' "~table: $2" -- hapgrid table "$1" -o out "${@:3}" -q; }
refused whole.cube 'whole.cube: its steps are 4, 4, 4 angstrom long, as if whole box vectors stood in place of steps: divide them by .*'
refused orbitals.cube 'orbitals.cube: --array 14: it has orbitals 12, 13' --array 14
refused placeless.npz 'placeless.npz: an array has no place: numpy.savez(.*) gives it one'
refused good.cub 'good.cub: --unit volt: from hartree to volt there is no factor; known are .*' --unit volt
refused good.cub 'good.cub: --length-unit miles: its lengths are in angstrom; known are .*' --length-unit miles

# What has a unit is converted: the same place and value in others.
hapgrid table good.cub -o converted --until definition -q --unit kJ/mol --length-unit nm
/usr/bin/python3 -c '
import glob
numbers = [[line.split() for line in open(name)] for name in (glob.glob("out-good.cub/*.table")[0], "converted/converted.table")]
(a, ax), (b, bx) = ((float(rows[-1][0]), float(next(r for r in rows if r[:1] == ["axis"])[1])) for rows in numbers)
assert abs(b / a - 2625.4996) < 1e-3 and abs(ax / bx - 10) < 1e-6, (a, b, ax, bx)
'
hapgrid table field.npz -o asked --until definition -q --unit kT/e:kJ/mol --factor -1
grep -q '^energy_unit = "kJ/mol"' asked/asked.toml
