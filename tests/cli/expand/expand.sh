# Conversions of a frontier: parts, threads, where the input comes from.
source "$(dirname "$0")/../lib.sh"

# A generation with two levels at many points, and chunks without frontier.
seed "$ball" -o middle
for ((g = 0; g < 25; ++g)); do
  expand middle | merge middle - -o next
  mv next middle
done
expect 0 '' '' -- expand middle -o requests
expand <middle | cmp - requests
expand - <middle | cmp - requests
expand middle -o - | cmp - requests
expand -j 3 middle | cmp - requests
expand --threads 1024 middle | cmp - requests
same "content" requests "$(header requests content)"
same "generation of their sources" 25 "$(header requests generation)"

# The union of the parts is the whole, and no request is in two of them. That they are equal is in unit/search.
rows() {
  decode "$@" | PYTHONPATH=$HAPGRID_SOURCE/tests/cli python3 -c '
import json, sys, shard
for line in sys.stdin:
    rows = json.loads(line).get("requests")
    for row, state in zip(shard.requests(rows), rows["state"]) if rows else ():
        print(*row, state)'
}
rows requests | sort >whole
for parts in 1 2 5 13; do
  : >union
  for ((k = 1; k <= parts; ++k)); do
    expand middle --part $k/$parts -o part
    rows part >>union
  done
  sort union | cmp - whole
done

# A part reads the chunks of its part alone: what is damaged elsewhere, it does not see.
PYTHONPATH=$HAPGRID_SOURCE/tests/cli python3 - <<'END'
import shard
with open("middle", "rb") as file:
    whole = file.read()
chunks = shard.decode(shard.frames(whole)[-1])[0]["footer"]["chunks"]
at = len(shard.frames(whole)[0])
spoiled = bytearray(whole)
for chunk in chunks:
    if chunk["frontier"] == 0:
        spoiled[at + chunk["size"] // 2] ^= 1
    at += chunk["size"]
assert spoiled != whole
with open("spoiled", "wb") as file:
    file.write(spoiled)
END
expand spoiled | cmp - requests
refuses 'merge: spoiled: byte [0-9]+: damaged: .*' -- merge spoiled requests

# More parts than conversions: some are empty and are shards all the same.
seed "$ball" --set 'grid.counts=[2,1,1]' -o two
for k in 1 2 3 2147483648 4294967295; do
  expand two --part $k/4294967295 -o part
  rows part >>two.rows
done
expand two -o requests
rows requests | sort | cmp - <(sort two.rows)
same "requests of two points" 2 "$(wc -l <two.rows)"

# Nothing to do: no requests.
expand --complete two -o two.grid
expand two.grid -o none
same "requests" 0 "$(rows none | wc -l)"
expand --complete two.grid | cmp - two.grid
