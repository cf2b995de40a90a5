# The commands of examples/guide/your-own-model.md, as a reader would type them.
source "$(dirname "$0")/../lib.sh"

page=$HAPGRID_SOURCE/examples/guide/your-own-model.md
sed -n '/^```sh$/,/^```$/p' "$page" | grep -v '^```' >commands
(($(grep -c '^```sh$' "$page") == 6)) || fail "the page has another number of blocks"
HAPGRID=$HAPGRID_SOURCE bash -euo pipefail commands >out 2>err || fail "the page failed: $(cat err)"

cd toggle
grep -q '^check-model: fine' ../err || fail "check-model: $(cat ../err)"
grep -q '^verify: fine' ../err || fail "verify: $(cat ../err)"
# The toggle has two states where nothing touches it, and a third where the HIP holds it in between.
[[ $(stats toggle.grid --get levels_histogram) =~ ^\[0,0,[0-9]+,[0-9]+\]$ ]] ||
  fail "levels: $(stats toggle.grid --get levels_histogram)"
# The toggle has gone over and has stayed there.
python3 - toggle.log <<'END'
import sys

lines = open(sys.argv[1]).read().splitlines()
angle = lines[0].lstrip("# ").split("\t").index("s0")
first, last = (float(line.split("\t")[angle]) for line in (lines[1], lines[-1]))
assert abs(first + 1) < 0.02 and abs(last - 1) < 0.02, (first, last)
END
for png in levels angle toggle; do
  [[ $(head -c 4 $png.png | tail -c 3) == PNG ]] || fail "no $png.png"
done
