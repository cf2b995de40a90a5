# Faults planted one at a time into good grids: each is found by the check that should find it. `faults.sh --table`
# lists them, `faults.sh WORDS` plants what has these words in its name and shows what verify says.
source "$(dirname "$0")/../lib.sh"
needs xxhsum xxhash

# A box through which the ball is pushed up: 74 of 84 points have two levels.
box=(--set grid.spacing=0.1 --set 'grid.counts=[14,3,2]' --set 'grid.origin=[-0.65,-0.1,-0.05]')
seed "$ball" "${box[@]}" -o seeds
expand --complete seeds -o ball
seed "$ball" "${box[@]}" --set model.parameters.stored=true | expand --complete -o stored
fine=(--set grid.spacing=0.05 --set 'grid.counts=[40,3,2]' --set 'grid.origin=[-0.975,-0.05,-0.025]')
seed "$ball" "${fine[@]}" --set model.parameters.stored=true | expand --complete -o fine
# Three chunks: states of 24 kB, with a model that leaves them 0.
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
cat >toy.toml <<'END'
grid = {origin = [0, 0, 0], spacing = 1, counts = [5, 1, 1]}
model = {plugin = "toy", parameters = {state_size = 3000, amplitude = 0}}
seeds = {points = [[0, 0, 0]]}
END
seed toy.toml | expand --complete -o chunks
expand seeds -o requests
merge seeds requests -o middle
python3 "$here/faults.py" "$@"
