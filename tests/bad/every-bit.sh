# Every bit matters: of small files of each kind that the tools make, each single flipped bit and each
# cut is refused, or changes nothing of what is read. every_bit.cpp reads them in one process; what
# the tools themselves say to some of it is in streams.sh.
source "$(dirname "$0")/../cli/lib.sh"
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins

# Shards of the search: seeds, requests, two sections of these, a grid with a frontier, the finished
# grid, and a small one. With one number a record, and, in a smaller box, with force, energy and shape.
make() { # NAME OPTION...
  seed "$ball" --set grid.spacing=0.25 --set 'grid.origin=[-0.6,-0.15,-0.1]' "${@:2}" -o "seeds.$1"
  expand "seeds.$1" -o "requests.$1"
  expand --complete "seeds.$1" -o "grid.$1"
  merge --small "grid.$1" -o "small.$1"
}
make ball --set 'grid.counts=[5,2,2]'
make stored --set 'grid.counts=[5,1,1]' --set model.parameters.stored=true
merge seeds.ball requests.ball -o middle.ball
for k in 1 2; do expand --part "$k/2" middle.ball; done >parts.ball
# Three states of 24 kB, all zeros: two chunks.
cat >toy.toml <<'END'
grid = {origin = [0, 0, 0], spacing = 1, counts = [3, 1, 1]}
model = {plugin = "toy", parameters = {state_size = 3000}}
seeds = {points = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]}
END
seed toy.toml -o chunks
[[ $(od -An -v -tx1 chunks | tr -d ' \n' | grep -o 28b52ffd | wc -l) == 4 ]] || fail "chunks: not two"

# A play that passes some points, as a session and as frames.
for step in {0..40}; do
  LC_ALL=C awk -v i="$step" 'BEGIN { print -0.7 + 0.03 * i, 0.1, 0.05 }'
done >path
play grid.stored --device path:path --log play.session --frames frames 2>/dev/null

each=1
if sanitized; then each=7; fi
every_bit=$HAPGRID_BUILD/tests/every_bit
"$every_bit" shard "$each" ./*.ball ./*.stored chunks
"$every_bit" session "$each" play.session
"$every_bit" frames "$each" frames
