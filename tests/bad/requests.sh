# Good shards that do not belong together.
source "$(dirname "$0")/../cli/lib.sh"

seed "$ball" --set 'grid.counts=[4,3,2]' -o g0
expand g0 -o r0
merge g0 r0 -o g1
expand g1 -o r1
for k in 1 2 3; do expand g0 --part $k/3 -o r0.$k; done

# Missing ones are counted: 8 corners with 7 conversions each, in parts of 19, 19 and 18.
lost() { refuses "merge: requests are missing: $1 of the 56 conversions of generation 0, the first from point [0-9]+ \(.*\) level 0; was a shard lost, or is one still to be expanded\?" "${@:2}"; }
lost 19 -- merge g0 r0.1 r0.3 -o out
lost 37 -- merge r0.1 g0 -o out
lost 37 -- merge g0 r0.1 r0.1 -o out
lost 56 -- merge g0 -o out
cat r0.2 r0.3 >cat
lost 19 -- merge g0 - -o out <cat
refuses 'merge: requests are missing: .*' -- merge g1 -o out

# Also a single one.
seed "$ball" --set 'grid.counts=[2,1,1]' -o two
expand two --part 1/2 -o two.1
refuses 'merge: requests are missing: 1 of the 2 conversions .* from point 1 \(1, 0, 0\) level 0; .*' -- merge two two.1 -o out

# Of another generation.
refuses 'merge: r0: requests of generation 0, the grid.s frontier is 1' -- merge g1 r0 -o out
refuses 'merge: r0\.2: requests of generation 0, the grid.s frontier is 1' -- merge g1 r1 r0.2 -o out
refuses 'merge: r1: requests of generation 1, the grid.s frontier is 0' -- merge g0 r0 r1 -o out
refuses 'merge: g1: a second grid, beside g0' -- merge g0 g1 r0 -o out

# Of the wrong kind.
refuses 'expand: r0: holds requests where a grid is needed' -- expand r0 -o out
refuses 'expand: r0: holds requests where a grid is needed' -- expand --complete r0 -o out
refuses 'merge: r0: requests, but no grid to merge them into' -- merge r0 -o out
refuses 'merge: r0: holds requests where a grid is needed' -- merge --small r0 -o out
refuses 'merge: g0: [0-9]+ records are still in the frontier; only a finished grid can be made small' -- merge --small g0 -o out
refuses 'stats: r0: holds requests where a grid is needed' -- stats r0
cat g0 r0 >cat
refuses 'expand: cat: holds requests where a grid is needed' -- expand cat -o out
cat r0 g0 >cat
refuses 'verify: cat: holds 2 sections where one grid is needed' -- verify cat

# Of another grid: what differs is said, and both values.
other() {
  seed "$ball" --set 'grid.counts=[4,3,2]' "${@:2}" -o other
  expand other -o other.requests
  refuses "merge: other\.requests: another grid than g0: $1" -- merge g0 r0 other.requests -o out
  refuses "merge: g0: another grid than other\.requests: .*" -- merge other.requests g0 -o out
  cat g0 other.requests >cat
  refuses "merge: cat: another grid than cat: $1" -- merge cat -o out
}
other 'count z 3 and 2' --set 'grid.counts=[4,3,3]'
other 'spacing 0\.0625 and 0\.05' --set grid.spacing=0.0625
other 'origin x -1 and -0\.9[0-9]*' --set 'grid.origin=[-1,-0.475,-0.475]'
other 'level limit 7 and 8' --set search.max_levels=7
other 'model parameter radius' --set model.parameters.radius=0.125
other 'model parameter tolerance' --set model.parameters.tolerance=0.25
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
other 'model toy and hung-ball' --set model.plugin=toy --set 'model.parameters={}'

# Two answers to one request, whichever comes first; a request that nobody asked for.
cat >spoil.py <<'END'
import sys
sys.path.insert(0, sys.argv[1])
import shard
messages = shard.decode(open("r0", "rb").read())
rows = messages[1]["requests"]
rows["state"][5] = 0.25
open("another.answer", "wb").write(shard.seal(messages))
for column in rows.values():
    del column[1:]
rows["level"][0] = 3
rows["directions"][0] &= -rows["directions"][0]
open("unasked", "wb").write(shard.seal(messages))
END
python3 spoil.py "$HAPGRID_SOURCE/tests/cli"
two='merge: requests: point [0-9]+ \(.*\) level 0, direction [0-9]+: two different answers'
refuses "$two" -- merge g0 r0 another.answer -o out
refuses "$two" -- merge another.answer r0 g0 -o out
refuses "$two" -- merge g0 r0.1 another.answer r0.2 r0.3 -o out
refuses 'merge: requests: point [0-9]+ \(.*\) level 3, direction [0-9]+: the grid.s frontier asks for no such conversion' \
  -- merge g0 r0 unasked -o out

[[ ! -e out ]] || fail "half a file"
