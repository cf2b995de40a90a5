# Sect. 2.2: force, energy and shape that are stored with the states and interpolated, against those
# that play evaluates, on the hung ball. Also: play needs no plug-in for what is stored.
source "$(dirname "$0")/../lib.sh"

seed "$ball" | expand --complete -o evaluated
seed "$ball" --set model.parameters.stored=true | expand --complete -o stored

# On fewer points, since the stock tools take long: the same states in the same levels, found through requests and merges, too.
plain=(--set grid.spacing=0.1 --set 'grid.counts=[20,10,10]')
seed "$ball" "${plain[@]}" | expand --complete -o few-evaluated
seed "$ball" "${plain[@]}" --set model.parameters.stored=true -o seeds
expand --complete seeds -o few-stored
dump few-evaluated >evaluated.dump
dump few-stored >stored.dump
cmp evaluated.dump stored.dump
rounds seeds rounds
cmp rounds few-stored

verify stored --recompute all >report 2>verdict
grep -q '^stored ' report || fail "no check of what is stored: $(cat report)"
[[ $(stats stored) == *"force, energy, shape of 49 spheres"* ]] || fail "stats: $(stats stored)"

path=$HAPGRID_SOURCE/examples/hung-ball/path-there-and-back.txt
play evaluated --device "path:$path" --traversal paper --log evaluated.log 2>/dev/null
# A directory without plug-ins beside a filter of its own.
mkdir -p alone/bin alone/models
cp "$HAPGRID_BUILD/bin/play" alone/bin
alone/bin/play stored --device "path:$path" --traversal paper --log stored.log 2>/dev/null
python3 "$here/stored.py" evaluated.log stored.log
