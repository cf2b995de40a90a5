# Verdicts on grids that are complete, incomplete, and faulty, and what verify cannot read.
source "$(dirname "$0")/../lib.sh"

seed "$ball" --set 'grid.counts=[4,3,2]' --set 'grid.origin=[-0.9,0.0,0.0]' -o seeds
expand --complete seeds -o grid

# Predictions along an axis need a point on either side: 2 * 3 * 2 + 4 * 1 * 2 forces.
# In-box directions: (3 * 4 - 2) (3 * 3 - 2) (3 * 2 - 2) - 24 = 256. 24 records in 6 cells of 8 corners each.
# Along the axes 2 (3 * 3 * 2 + 4 * 2 * 2 + 4 * 3 * 1) = 92 links.
table=$(<"$here/table.txt")
# The ball is nowhere touched.
expect 0 "$table" 'verify: fine: 11 checks' -- verify grid
expect 0 "$table"$'\n\n'"$(<"$here/details.txt")" 'verify: fine: 11 checks' -- verify --verbose <grid
expect 0 "$table" 'verify: fine: 11 checks' -- verify grid --recompute all -j 3
expect 0 '' 'verify: fine: 11 checks' -- verify grid -o report
same "the report in a file" "$table" "$(cat report)"
expect 0 "$(grep -vE '^(fidelity|stable|snaps)' report)" 'verify: fine: 9 checks' -- verify grid --recompute none

# The whole ball, all of it evaluated again; a sample is the same each time, with any -j.
seed "$ball" | expand --complete -o ball.grid
verify ball.grid --recompute all -j 2 -v >all 2>err
same "verdict" 'verify: fine: 11 checks' "$(cat err)"
same "conversions" "$(stats ball.grid --get conversions)" "$(awk '$1 == "fidelity" { print $2 }' all)"
verify ball.grid --recompute 37 --format json >one 2>err
verify ball.grid --recompute 37 --format json -j 2 2>err | cmp - one

# What the loop of the hung ball costs, and how large it must be on a device.
grep -qE '^  largest loss 0\.[0-9]+ N rope lengths: where point .* snaps$' all || fail "$(cat all)"
grep -qE '^  largest stable scale [0-9]+\.[0-9]+ rope lengths/m: K < 2 b f = 4000 N/m with b = 2 N s/m and f = 1000 Hz$' all || fail "$(cat all)"
grep -qE '^  shortest stable reach 0\.[0-9]+ m: of a device whose reach fills the box' all || fail "$(cat all)"
# The same with any -j.
verify ball.grid --recompute none -j 1 --format json >one 2>err
verify ball.grid --recompute none -j 3 --format json 2>err | cmp - one

# Incomplete: an answer, not a failure. What is found first is listed.
expect 3 '~.*
complete           8 records                  8  broken
coverage          24 points                  16  broken
.*
complete: records that no expand has looked at \(the frontier\)
  point 0 \(0, 0, 0\) level 0
.*
  and 3 more
.*' 'verify: broken: complete (8 of 8), coverage (16 of 24); not proved: passive' -- verify seeds -v

# A model that has changed since: fidelity finds it, and nothing else can. It fails on the way to
# the last plane of x, 28 times from the plane before and 28 - 6 within; of the others with d3 > 0
# (8 pairs of planes along x, 7 along y, 1 along z) it answers 0.25.
mkdir changed
"${CXX:-c++}" -std=c++20 -shared -fPIC -I"$HAPGRID_SOURCE" -o changed/hung-ball.so \
  "$HAPGRID_SOURCE/tests/cli/verify/changed_ball.cpp"
export HAPGRID_MODEL_PATH=changed
# It has no force either.
table=${table%$'\n'passive*} table=${table/gradient*steep/steep}
changed=${table/'256 conversions              0  ok'/'256 conversions            106  broken'}
expect 3 "$changed

fidelity: links to a state that C, evaluated again, does not reach: if the model was changed since, give it another version and search again
  point 0 (0, 0, 0) level 0 direction 21 (0, 0, 1): C gives 0.25, stored at level 0 is 0
  point 0 (0, 0, 0) level 0 direction 22 (1, 0, 1): C gives 0.25, stored at level 0 is 0
  point 0 (0, 0, 0) level 0 direction 24 (0, 1, 1): C gives 0.25, stored at level 0 is 0
  point 0 (0, 0, 0) level 0 direction 25 (1, 1, 1): C gives 0.25, stored at level 0 is 0
  point 1 (1, 0, 0) level 0 direction 20 (-1, 0, 1): C gives 0.25, stored at level 0 is 0
  and 101 more" 'verify: broken: fidelity (106 of 256)' -- verify grid
verify grid --recompute all --format json >found 2>err || code=$?
same "exit code" 3 "${code:-0}"
python3 - <<'PYTHON'
import json
found = json.load(open("found"))
assert found["version"] == 1 and found["verdict"] == "broken", found
first = {check["name"]: check["first"] for check in found["checks"]}["fidelity"][4]
assert first.pop("text").startswith("point 1 (1, 0, 0) level 0 direction 20 (-1, 0, 1): C gives 0.25"), first
assert first == {"point": [1, 0, 0], "level": 0, "direction": [-1, 0, 1]}, first
PYTHON
verify grid -j 2 >found 2>err || true
unset HAPGRID_MODEL_PATH
same "the same with two threads" 'verify: broken: fidelity (106 of 256)' \
  "$(cat err)"

# What cannot be read or evaluated is no verdict.
refusals "$here/refuse.tsv"
