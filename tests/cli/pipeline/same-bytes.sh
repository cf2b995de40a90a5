# The same model and grid give the same bytes, however they were computed (design section 2).
source "$(dirname "$0")/../lib.sh"

# A long box through the ball's path: many generations, points with two levels, both sides.
seed "$ball" --set 'grid.counts=[82,7,6]' --set 'grid.origin=[-2.025,-0.15,-0.125]' -o seeds
expand --complete seeds -o whole
generations=$(header whole generation)
((generations >= 40)) || fail "only $generations generations"
records=$(stats --get records whole)
((records > 82 * 7 * 6)) || fail "no point has two levels: the order of requests was not tried"

same_grid() { cmp "$1" whole || fail "$2"; }

for threads in 1 2 7; do
  expand --complete -j $threads <seeds >j
  same_grid j "--complete -j $threads"
done

rounds seeds piped
same_grid piped "rounds through a pipe"

# Rounds through files; the requests go to merge in the order that `order` makes of their names.
in_rounds() {
  local parts=$1 order=$2 g=0
  rm -f g.* r.*
  cp seeds g.0
  while :; do
    seq "$parts" | xargs -P 4 -I{} expand g.$g --part "{}/$parts" -j 2 -o r.{}
    local next=$((g + 1)) requests
    mapfile -t requests < <(ls r.* | $order)
    merge "${requests[@]:0:1}" g.$g "${requests[@]:1}" -o g.$next
    rm r.*
    cmp -s g.$g g.$next && break
    rm g.$g
    g=$next
  done
  same_grid g.$g "rounds: $*"
  same "rounds" $generations "$g"
  rm -f g.*
}
shuffled() { shuf --random-source=<(yes); }
in_rounds 3 "sort -r"
if ! sanitized; then
  in_rounds 1 cat
  in_rounds 7 shuffled
fi

# Halfway, where records of many generations and of both levels are there.
cp seeds half
for ((g = 0; g < generations / 2; ++g)); do
  expand half | merge half - -o next
  mv next half
done
expand half | merge half - -o expected
expand --complete half -o resumed
same_grid resumed "--complete from generation $((generations / 2))"
rounds half resumed
same_grid resumed "rounds from generation $((generations / 2))"

for k in 1 2 3 4 5; do expand half --part $k/5 -o r.$k; done
same_step() { cmp - expected || fail "$1"; }
merge half r.5 r.4 r.3 r.2 r.1 | same_step "requests in reverse"
merge r.3 r.1 half r.5 r.2 r.4 | same_step "the grid among the requests"
cat r.* | merge half - | same_step "requests concatenated"
cat r.4 r.1 | merge r.2 half - r.5 r.3 | same_step "requests partly concatenated"
cat half r.* | merge | same_step "grid and requests concatenated"
cat r.2 r.5 half r.1 r.4 r.3 | merge - | same_step "concatenated in another order"
merge half r.* r.* | same_step "requests given twice"
expand half -o r.all
merge half r.2 r.all r.4 | same_step "requests given in part twice"
expand half --part 2/3 -o other
merge half r.* other | same_step "requests of other parts, too"

# And whatever compiler built hapgrid and a model that needs no library's functions: other builds run this
# test, too, and slow/compilers.sh compares the shards of two.
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/tests/plugins
seed - <<TOML | expand --complete -o toy
model = {plugin = "toy", parameters = {state_size = 3, amplitude = 0.3}}
grid = {origin = [-0.375, 0, 0.0625], spacing = 0.1, counts = [6, 5, 4]}
search = {max_levels = 100}
TOML
same "what the grid has" fa7f89bfabb24860 "$(dump toy | tail -n +2 | sha256sum | cut -c 1-16)"
