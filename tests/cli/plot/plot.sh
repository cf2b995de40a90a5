# Plots, looked at from outside: the texts and curves of SVGs against the files that were drawn, the pixels of PNGs, and
# what each format's files begin with. The same data give the same bytes.
source "$(dirname "$0")/../lib.sh"
python3=/usr/bin/python3
needs_python matplotlib python3-matplotlib

seed "$ball" --set grid.spacing=0.1 --set 'grid.counts=[20,10,10]' | expand --complete -o grid
$python3 -c 'for k in range(-90, 91): print(k / 100, 0, 0)
for k in range(90, -91, -1): print(k / 100, 0, 0)' >path
play grid --device path:path --log a.log --frames a.frames 2>/dev/null
play grid --device path:path --log a.session 2>/dev/null

expect 0 '' '' -- plot columns a.log --x x --y s0 --grid grid -o loop.svg
expect 0 '' '' -- plot columns a.log a.session a.frames --y sent_x -o three.svg
expect 0 '' '' -- plot session a.session -o session.svg
plot slice grid --at y=0 -o - >levels.png
expect 0 '' '' -- plot field grid --at y=0 -o field.svg
seed "$ball" --set grid.spacing=0.2 --set 'grid.counts=[10,5,5]' | expand --complete -o coarse
expect 0 '' '' -- plot error coarse grid -o error.svg
# The module, as a notebook uses it, makes the same: a user's own settings do not matter.
PYTHONPATH=$(realpath "$HAPGRID_BIN/../python") $python3 - <<'PYTHON'
import hapgrid
import matplotlib

plot = hapgrid.plot
matplotlib.rcParams.update({"font.size": 30, "lines.linewidth": 9})
loop = lambda: plot.columns("a.log", "x", "s0", grid="grid")
for name in "again.svg", "loop.pdf", "again.pdf", "loop.png":
    plot.save(loop(), name)
assert loop()._repr_png_() == open("loop.png", "rb").read()
plot.save(plot.session("a.session"), "module.svg")
plot.save(plot.slice("grid", "y=0"), "levels.svg")
plot.save(plot.slice("grid", "y=0"), "module.png")
plot.save(plot.columns("a.log", "x", "force_x", grid="grid"), "force.svg")
plot.save(plot.columns("a.log", "t", "x", labels=["a", "b / c"]), "words.svg")
plot.save(plot.session("a.session", grid="grid"), "energies.svg")
plot.save(plot.session("a.frames"), "frames.png")
assert matplotlib.rcParams["font.size"] == 30
PYTHON
cmp loop.svg again.svg
cmp loop.pdf again.pdf
cmp session.svg module.svg
cmp levels.png module.png
same 'a PDF' '%PDF' "$(head -c 4 loop.pdf)"
same 'a PNG' PNG "$(head -c 4 loop.png | tail -c 3)"
$python3 "$here/look.py"
view a.frames --html a.html
$python3 "$here/contrast.py" a.html ./*.svg
