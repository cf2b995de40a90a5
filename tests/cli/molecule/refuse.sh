# What the model of molecules refuses: in one line that names the text, frame and atoms.
source "$(dirname "$0")/../lib.sh"

cat >peroxide.xyz <<'XYZ'
4
E=-151.0
O 0.0000 0.7300 -0.0500
O 0.0000 -0.7300 -0.0500
H 0.8000 0.9000 0.4000
H -0.8000 -0.9000 0.4000
XYZ
cat >trans.xyz <<'XYZ'
4
E=-150.999
O 0.0000 0.7300 -0.0500
O 0.0000 -0.7300 -0.0500
H 0.9100 0.9000 -0.0500
H -0.9100 -0.9000 -0.0500
XYZ
cat >m.toml <<'TOML'
model = {plugin = "molecule", files = {conformation = "c.xyz", transition_states = ["t.xyz"]}}
grid = {origin = [-5, -5, -5], spacing = 5, counts = [3, 3, 3]}
TOML
ln -s "$HAPGRID_SOURCE"/examples/molecule/{butane,dichloroethane} .
input() {
  cp peroxide.xyz c.xyz
  cp trans.xyz t.xyz
  eval "$1"
}
refusals "$here/refuse.tsv" 'seed m.toml -o out'
