# Definitions, overrides and seeds, as they stand in the grid that seed writes.
source "$(dirname "$0")/../lib.sh"

# The grid as text: its header and its records, without the footer.
text() { zstd -dc "$1" | capnp decode --short "$schema" Message | grep -v '^( footer\|^(footer'; }
# The points and states of a grid, a line each.
seeds() {
  decode "$1" | python3 -c '
import json, sys
messages = [json.loads(line) for line in sys.stdin]
n = messages[0]["header"]["stateSize"]
for m in messages[1:-1]:
    rows = m["records"]
    size = len(rows["point"])
    for r in range(size):
        assert rows["generation"][r] == 0
        print(rows["point"][r], rows["level"][r], *(rows["state"][c * size + r] for c in range(n)))'
}

# The same grid from a file, standard input and -o.
expect 0 '' '' -- seed "$ball" -o file
seed - <"$ball" | cmp - file
seed "$ball" -o - | cmp - file
# The defaults: the corners, the ball at rest.
same "corners" '0 0 0
39 0 0
760 0 0
799 0 0
15200 0 0
15239 0 0
15960 0 0
15999 0 0' "$(seeds file)"

# --set takes numbers, arrays, texts, nested and new keys; the last one wins; the file may lack them.
cat >short.toml <<END
model.plugin = "wrong"
[grid]
origin = [0, 0, 0]
counts = [1, 1, 1]
END
seed short.toml --set model.plugin=hung-ball --set 'grid.origin=[-0.5, 1, 2e-1]' \
  --set grid.spacing=1 --set grid.spacing=0.0625 --set grid.counts='[ 3, 2, 1 ]' \
  --set search.max_levels=254 --set model.parameters.radius=0.125 --set 'model.plugin="hung-ball"' \
  -o set
same "header" '(header = (magic = 7521416442288890929, version = 1, content = grid, generation = 0, box = (originX = -0.5, originY = 1, originZ = 0.2, spacing = 0.0625, countX = 3, countY = 2, countZ = 1), model = "hung-ball", parameters = [(key = "radius", value = (number = 0.125))], stateSize = 1, tolerance = 1e-06, toleranceUnit = "rad", maxLevels = 254, stored = (force = false, energy = false, shape = false), spheres = [], equality = (norm = plugin, weights = [], periods = []), lengthUnit = "rope lengths", energyUnit = "N rope lengths", hipRadius = 0.125, forceScale = 1))' \
  "$(text set | head -n 1)"

# Corners of a box with a single point along an axis coincide.
same "corners with count 1" $'0 0 0\n2 0 0\n3 0 0\n5 0 0' "$(seeds set)"
seed short.toml --set model.plugin=hung-ball --set grid.spacing=0.05 --set 'grid.origin=[1,1,1]' -o one
same "one point" '0 0 0' "$(seeds one)"
one_box='box = (originX = 1, originY = 1, originZ = 1, spacing = 0.05, countX = 1, countY = 1, countZ = 1)'
[[ $(text one | head -n 1) == *"$one_box"* ]] || fail "box: $(text one | head -n 1)"
same "level limit" 64 "$(header one maxLevels)"

# Parameters of every kind, flattened and ascending, whatever their order in the file.
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
cat >puppet.toml <<END
[grid]
counts = [2, 1, 1]
origin = [0, 0, 0]
spacing = 0.5
[model]
plugin = "puppet"
[model.parameters]
state_size = 2
zeta.last = true
zeta.flag = false
text = "a \\"b\\" é"
numbers = [1, 2.5, -3]
none = []
texts = ["x", "y"]
whole = 9007199254740992
END
seed puppet.toml -o puppet
same "parameters" '[(key = "none", value = (numbers = [])), (key = "numbers", value = (numbers = [1, 2.5, -3])), (key = "state_size", value = (number = 2)), (key = "text", value = (text = "a \"b\" é")), (key = "texts", value = (texts = ["x", "y"])), (key = "whole", value = (number = 9007199254740992)), (key = "zeta.flag", value = (boolean = false)), (key = "zeta.last", value = (boolean = true))]' \
  "$(text puppet | head -n 1 | sed 's/.*parameters = \(\[.*\]\), stateSize.*/\1/')"
same "state size" 2 "$(header puppet stateSize)"

# Known states of the model become levels in their order.
seed puppet.toml --set model.parameters.known=3 -o known
same "known states" '0 0 0 0
0 1 1 1
0 2 2 2
1 0 0 0
1 1 1 1
1 2 2 2' "$(seeds known)"

# [seeds]: points in any order, states as they are given.
cat >>puppet.toml <<END
[seeds]
points = [[0.5, 0, 0], [0.0, 0.0, 0.0]]
states = [[[1.5, 2], [-1e-3, 4]], [[5, 6]]]
END
seed puppet.toml -o given
same "given states" '0 0 5 6
1 0 1.5 2
1 1 -0.001 4' "$(seeds given)"
# Points without states: the model's.
seed "$ball" --set 'seeds.points=[[0.975,-0.475,-0.475], [-0.975, -0.475, -0.425]]' -o points
same "given points" $'39 0 0\n800 0 0' "$(seeds points)"
# A position in decimal is the grid point within rounding.
seed "$ball" --set 'grid.spacing=0.1' --set 'grid.counts=[4,4,4]' --set 'grid.origin=[0.3,0,0.3]' \
  --set 'seeds.points=[[0.6,0.3,0.6]]' -o rounded
same "rounded" "$((3 + 4 * (3 + 4 * 3))) 0 0" "$(seeds rounded)"
