# What the model of molecules refuses: in one line that names the text, frame and atoms.
source "$(dirname "$0")/../lib.sh"

cp "$here"/{peroxide,trans}.xyz .
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
