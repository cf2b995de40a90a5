# Shards that are cut, flipped, or made to do harm: one line, exit code 1, nothing written, and no
# more memory or time than an honest shard takes. The faults are in streams/. With STREAMS=all each is put
# before all filters that read such a shard.
source "$(dirname "$0")/../cli/lib.sh"
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins

seed "$ball" --set 'grid.counts=[3,2,2]' --set 'grid.origin=[-0.9,-0.025,-0.025]' -o seeds
expand seeds -o requests
merge seeds requests -o next
expand next -o next.requests
merge next next.requests -o grid
merge --small grid -o small
# Two components.
cat >toy.toml <<END
grid = {origin = [0, 0, 0], spacing = 1, counts = [3, 2, 1]}
model = {plugin = "toy", parameters = {state_size = 2, amplitude = 0.5}}
seeds = {points = [[0, 0, 0]], states = [[[0.5, 0.25], [0.1, 0.9]]]}
END
seed toy.toml --set search.max_levels=8 -o toy.seeds
expand toy.seeds -o toy.requests
# Several chunks.
seed toy.toml --set model.parameters.state_size=3000 --set search.max_levels=25 --set 'grid.counts=[5,5,5]' \
  --set 'seeds={points = [[0, 0, 0]]}' | expand --complete -o toy.grid

which=${STREAMS:-some}
if sanitized; then which=sanitized; fi
exec python3 "$here/streams" "$which" "${1:-}"
