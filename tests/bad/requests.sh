# Good shards that do not belong together.
source "$(dirname "$0")/../cli/lib.sh"

seed "$ball" --set 'grid.counts=[4,3,2]' -o g0
expand g0 -o r0
merge g0 r0 -o g1
expand g1 -o r1
for k in 1 2 3; do expand g0 --part $k/3 -o r0.$k; done
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
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
refusals "$here/requests.tsv"
