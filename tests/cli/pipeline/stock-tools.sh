# Every kind of shard is read by the stock tools, and says what it should.
source "$(dirname "$0")/../lib.sh"

# Several chunks of records a grid, several generations of records, requests cut in parts.
sets=(--set 'grid.counts=[40,22,20]' --set 'grid.origin=[-0.975,-0.525,-0.475]'
  --set search.max_levels=17 --set model.parameters.weight=2.5)
seed "$ball" "${sets[@]}" -o seeds.grid
cp seeds.grid middle.grid
for ((g = 0; g < 11; ++g)); do
  expand middle.grid -j 2 | merge middle.grid - -o next
  mv next middle.grid
done
expand middle.grid -o all.requests
expand middle.grid --part 2/3 -o part.requests
merge middle.grid all.requests -o next.grid
expand --complete -j 2 next.grid -o complete.grid
expand complete.grid -o empty.requests
merge --small complete.grid -o small.grid
cat seeds.grid part.requests all.requests seeds.grid >concatenated

for shard in *; do
  expect 0 '' '' -- zstd -tq "$shard"
  # One line for the whole file; stock_tools.py looks at each zstd frame.
  zstd -lv "$shard" >list 2>/dev/null
  grep -q '^Check: XXH64' list || fail "$shard: no checksums: $(cat list)"
  zstd -dc "$shard" | capnp decode "$schema" Message >text
  grep -q 'magic = 7521416442288890929' text || fail "$shard: no magic number"
  rm list text
done

python3 "$here/stock_tools.py" "$ball" ./*
