#!/bin/bash
# Finished grids, coded: what comes back, how far it may be off, and what refuses them.
source "$(dirname "$0")/../lib.sh"
export HAPGRID_MODEL_PATH=$HAPGRID_BUILD/models:$HAPGRID_BUILD/tests/plugins

# coded NAME PRECISION...: NAME.small without loss is NAME.grid again, and NAME.PRECISION is as near
# as it says; coded.py, which knows only the format's page, agrees with the dump of each.
coded() {
  local name=$1 precision verdict='~verify: fine: .*'
  expect 0 '' '' -- merge --final "$name.grid" -o "$name.small"
  merge --final <"$name.grid" | cmp - "$name.small"
  merge --final "$name.small" | cmp - "$name.small"
  expect 0 '' '' -- merge "$name.small" -o "$name.plain"
  cmp "$name.plain" "$name.grid"
  stats --dump "$name.grid" >dump
  stats --dump "$name.small" | cmp - dump
  python3 "$here/coded.py" "$name.small" | cmp - dump
  expect 0 "~.*precision +[0-9]+ numbers +0  ok.*" "$verdict" -- verify "$name.small" --against "$name.grid"
  for precision in "${@:2}"; do
    expect 0 '' '' -- merge --final --precision "$precision" "$name.small" -o "$name.$precision"
    merge --final --precision "$precision" "$name.grid" | cmp - "$name.$precision"
    stats --dump "$name.$precision" >lossy
    python3 "$here/coded.py" "$name.$precision" | cmp - lossy
    python3 "$here/precision.py" "$precision" "$(stats "$name.grid" --get state_size)" dump lossy
    expect 0 "~.*precision +[0-9]+ columns +0  ok.*" "$verdict" -- \
      verify "$name.$precision" --recompute all
    expect 0 "~.*precision +[0-9]+ numbers +0  ok.*" "$verdict" -- \
      verify "$name.$precision" --against "$name.grid"
    same "the precision" "$precision" "$(stats "$name.$precision" --get precision)"
    (($(stat -c %s "$name.$precision") < $(stat -c %s "$name.small"))) || fail "$precision is no smaller"
  done
}

# Two levels at many points, many chunks of the plain grid.
counts=[40,22,20] spacing=0.05
# A quarter of the points, too few to be coded to half the size.
if sanitized; then counts=[26,14,13] spacing=0.078; fi
seed "$ball" --set "grid.counts=$counts" --set "grid.spacing=$spacing" --set 'grid.origin=[-0.975,-0.525,-0.475]' |
  expand --complete -j 2 -o ball.grid
coded ball 0.0001 0.01
sanitized || (($(stat -c %s ball.small) * 2 < $(stat -c %s ball.grid))) || fail "not half the size"

# Several components and levels.
cat >stored.toml <<END
grid = {origin = [0, 0, 0], spacing = 1, counts = [5, 4, 3]}
model = {plugin = "toy", parameters = {state_size = 3, amplitude = 0.5}}
seeds = {points = [[0, 0, 0]]}
END
seed stored.toml --set search.max_levels=25 | expand --complete -o toy.grid
coded toy 0.001

# Two chunks of the coded grid; the second begins in the middle of a point's levels.
seed stored.toml --set search.max_levels=25 --set model.parameters.state_size=1500 \
  --set 'grid.counts=[3,3,3]' | expand --complete -o wide.grid
coded wide
same "chunks" 2 "$(decode wide.small | grep -c '^{"coded":')"

# What stands in the footer is known without a look at the chunks; the header says how it is stored.
same "records" "$(stats ball.grid --get records)" "$(stats ball.small --get records)"
same "coded" "false true" "$(stats ball.grid --get coded) $(stats ball.small --get coded)"
same "version" "1 2" "$(header ball.grid version) $(header ball.small version)"
grep -q '^coding       nothing is lost$' <(stats ball.small) || fail "stats does not say it is coded"
grep -q '^coding       numbers may be off by 0.01 of their range$' <(stats ball.0.01) || fail "nor how far off"

# The stock tools print every message.
zstd -dc ball.small | capnp decode "$schema" Message | grep -c '^( coded = ' >/dev/null

# A piece of the coded grid and a piece of the plain one are one grid, as two pieces always are.
seed "$ball" --set 'grid.counts=[3,2,2]' --set 'grid.origin=[-0.9,-0.025,-0.025]' -o seeds
expand --complete seeds -o tiny.grid
merge --final tiny.grid -o tiny.small
expand tiny.small -o none
expand tiny.grid | cmp - none
expand --complete tiny.small | cmp - tiny.grid
merge tiny.small none | cmp - tiny.grid

# Finished grids alone.
refuses 'merge: seeds: [0-9]+ conversions are still to be done; --final takes a grid that is complete' -- merge --final seeds
refuses 'merge: none: requests; --final takes a grid alone' -- merge --final tiny.grid none
refuses 'merge: none: requests, but no grid to merge them into' -- merge --final none
# Where something was lost nothing is computed.
lossy='precision 0.01: its numbers are not the model.s; take the grid that it was made from'
refuses "merge: ball.0.01: $lossy" -- merge ball.0.01
refuses "merge: ball.0.01: $lossy" -- merge --final ball.0.01
refuses "expand: ball.0.01: $lossy" -- expand ball.0.01
refuses "expand: ball.0.01: $lossy" -- expand --complete ball.0.01
merge --final --precision 0.001 ball.grid -o finer
refuses "verify: finer: precision 0.001, but ball.0.01 has precision 0.01, or other bounds" -- verify ball.0.01 finer
refuses "verify: the original may be off itself, by 0.01 of each range" -- verify ball.grid --against ball.0.01
refuses "verify: the original is another grid: .*" -- verify ball.small --against toy.grid
for e in 0 -1 x 1 0.2 nan 1e-13; do
  expect 2 '' '~merge: .*' -- merge --final --precision "$e" tiny.grid -o out
done
expect 2 '' '~merge: --precision needs --final .*' -- merge --precision 0.1 tiny.grid -o out
expect 2 '' '~merge: --final and --frontier exclude each other .*' -- merge --final --frontier 'f{}' tiny.grid -o out
[[ ! -e out ]] || fail "an output was written"

# A number beyond its bound is seen, with the original and without.
python3 "$here/changed.py" ball.0.0001 >bad
expect 3 '~.*precision +[0-9]+ numbers +[1-9].*' '~verify: broken: .*precision.*' -- \
  verify bad --against ball.grid --recompute none
expect 3 '~.*fidelity.*' '~verify: broken: .*fidelity.*' -- verify bad --recompute all

# play feels no difference, and takes what was lost too.
for i in {-90..90} {90..-90}; do echo "${i}e-2 0.1 0.02"; done >path
play ball.grid --device path:path --log plain.log 2>/dev/null
play ball.small --device path:path --log - 2>/dev/null | cmp - plain.log
play ball.0.01 --device path:path --log lossy.log 2>/dev/null
cmp -s lossy.log plain.log && fail "the lossy grid plays as if it were exact"
same "ticks" "$(wc -l <plain.log)" "$(wc -l <lossy.log)"
