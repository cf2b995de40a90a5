#!/bin/bash
# molecule-check: the committed paths are sane together; one more of leu-enkephalin's is too many. The nearest atoms
# that it reports are as near in the shape that it prints.
source "$(dirname "$0")/../lib.sh"
molecules=$HAPGRID_SOURCE/examples/molecule

for name in butane alanine-dipeptide leu-enkephalin; do
  molecule-check "$molecules/$name/$name.toml" >sane || fail "$name: $(cat sane)"
  ! grep -q 'NOT SANE' sane || fail "$name: $(cat sane)"
done
all='["psi1-plus.xyz","psi2-plus.xyz","phi4-minus.xyz","chi4_1-minus.xyz","chi5_1-minus.xyz"]'
expect 1 '~.*NOT SANE: atoms overlap where paths 1 and 2 are combined: share below 0\.4
NOT SANE: atoms overlap where all paths are combined: share below 0\.4' '' -- \
  molecule-check "$molecules/leu-enkephalin/leu-enkephalin.toml" --set "model.files.transition_states=$all"

# Of the four that are committed: "all combined  1.16, 0.48 H48 H67, at t = 1, 1, 0.09, 0.61".
read -r _ _ distance _ one two _ _ _ t <<<"$(grep '^all combined' sane | tr -s ' ')"
molecule-check "$molecules/leu-enkephalin/leu-enkephalin.toml" --xyz "${t// /}" >shape.xyz
awk -v one="${one//[!0-9]/}" -v two="${two//[!0-9]/}" -v said="${distance%,}" '
  NR == one + 2 { x = $2; y = $3; z = $4; n++ }
  NR == two + 2 { u = $2; v = $3; w = $4; n++ }
  END { d = sqrt((x - u)^2 + (y - v)^2 + (z - w)^2); exit !(n == 2 && d > said - 0.006 && d < said + 0.006) }' shape.xyz ||
  fail "$one and $two are not $distance Å apart at t = $t"
