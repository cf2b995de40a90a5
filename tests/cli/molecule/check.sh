# molecule-check: the committed paths are sane together; one more of leu-enkephalin's is too many. The nearest atoms
# that it reports are as near in the shape that it prints.
source "$(dirname "$0")/../lib.sh"
molecules=$HAPGRID_SOURCE/examples/molecule

for name in butane alanine-dipeptide leu-enkephalin; do
  molecule-check "$molecules/$name/$name.toml" >sane || fail "$name: $(cat sane)"
  ! grep -q 'NOT SANE' sane || fail "$name: $(cat sane)"
done
# phi4-minus.xyz was made like the committed paths, with --torsions phi4-minus.
cp "$molecules"/leu-enkephalin/*.xyz "$here/phi4-minus.xyz" .
sed '/"psi2-plus.xyz"/a "phi4-minus.xyz",' "$molecules/leu-enkephalin/leu-enkephalin.toml" >insane.toml
why='[A-Z][a-z]?[0-9]+ [A-Z][a-z]?[0-9]+ are nearer than 0\.4 of the sum of their radii \(0\.[0-9]+, [0-9.]+ Å, at t = .*\); leave a path out'
expect 3 "~.*NOT SANE: paths 1 and 2 combined: atoms overlap: $why
NOT SANE: all paths combined: atoms overlap: $why" '' -- molecule-check insane.toml
# For programs, the same as JSON.
expect 3 '~.*' '' -- molecule-check insane.toml --format json
python3 - "$work/got/out" <<'END' || fail "$(cat "$work/got/out")"
import json, sys
one = json.load(open(sys.argv[1]))
assert not one["sane"] and one["paths"] == 5 and one["atoms"] == 77 and one["minima"] == [{"t": [0] * 5, "energy_kJ_mol": 0}], one
assert [p["paths"] for p in one["problems"]] == [[1, 2], [0, 1, 2, 3, 4]], one
assert all(p["what"].startswith("atoms overlap: ") for p in one["problems"]), one
END
# check-model has it from the plug-in, and gives no estimate.
expect 3 "~.*
sane +[0-9]+ parameters +2  broken.*
sane: what the model itself says against its parameters
  paths 1 and 2 combined: atoms overlap: $why
  all paths combined: atoms overlap: $why
.*
whole grid +no estimate, because a check is broken" '~check-model: broken: sane \(2 of [0-9]+\)' -- \
  check-model insane.toml --steps 40

# A box of 3 Å is too small.
refuses 'seed: seed point 0 \(0, 0, 0\) at \(-1\.5, -1\.5, -1\.5\): the model knows no state there; choose a larger box or other seeds, or give their states' \
  -- seed "$molecules/butane/butane.toml" --set grid.spacing=1 --set 'grid.counts=[4,4,4]' --set 'grid.origin=[-1.5,-1.5,-1.5]'

# Of the four that are committed: "all combined  1.16, 0.48 H48 H67, at t = 1, 1, 0.09, 0.61".
read -r _ _ distance _ one two _ _ _ t <<<"$(grep '^all combined' sane | tr -s ' ')"
molecule-check "$molecules/leu-enkephalin/leu-enkephalin.toml" --xyz "${t// /}" >shape.xyz
awk -v one="${one//[!0-9]/}" -v two="${two//[!0-9]/}" -v said="${distance%,}" '
  NR == one + 2 { x = $2; y = $3; z = $4; n++ }
  NR == two + 2 { u = $2; v = $3; w = $4; n++ }
  END { d = sqrt((x - u)^2 + (y - v)^2 + (z - w)^2); exit !(n == 2 && d > said - 0.006 && d < said + 0.006) }' shape.xyz ||
  fail "$one and $two are not $distance Å apart at t = $t"
