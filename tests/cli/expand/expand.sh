#!/bin/bash
# Conversions of a frontier: parts, threads, reports, where the input comes from.
source "$(dirname "$0")/../lib.sh"

# A generation with two levels at many points.
seed "$ball" -o middle
for ((g = 0; g < 13; ++g)); do
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
same "generation of their sources" 13 "$(header requests generation)"

# The union of the parts is the whole, and no request is in two of them.
rows() {
  decode "$@" | PYTHONPATH=$HAPGRID_SOURCE/tests/cli python3 -c '
import json, sys, shard
for line in sys.stdin:
    rows = json.loads(line).get("reached")
    for row, state in zip(shard.requests(rows), rows["state"]) if rows else ():
        print(*row, state)'
}
rows requests | sort >whole
for parts in 1 2 5 13; do
  : >union
  for ((k = 1; k <= parts; ++k)); do
    expand middle --part $k/$parts -o part
    rows part >rows.$k
    cat rows.$k >>union
  done
  sort union | cmp - whole
  wc -l rows.* | sed '$d' | awk -v parts=$parts '
    NR == 1 { least = most = $1 }
    { if ($1 < least) least = $1; if ($1 > most) most = $1 }
    END { exit (parts > 1 && most - least > 1) }' || fail "parts are not equal: $(wc -l rows.*)"
  rm rows.*
done

# A grid of before chunks said their conversions has the same parts.
PYTHONPATH=$HAPGRID_SOURCE/tests/cli python3 - <<'END'
import shard
def forget(footer):
    assert sum(chunk.pop("conversions") > 0 for chunk in footer["chunks"]) > 5
with open("middle", "rb") as file:
    messages = shard.decode(file.read())
with open("uncounted", "wb") as file:
    file.write(shard.seal(messages, edit=forget))
END
same "conversions" "$(stats --get conversions middle)" "$(stats --get conversions uncounted)"
for k in 1 2 3 4 5; do
  expand middle --part $k/5 -o part
  expand uncounted --part $k/5 | cmp - part
done
merge middle requests -o next
merge uncounted requests | cmp - next

# More parts than conversions: some are empty and are shards all the same.
seed "$ball" --set 'grid.counts=[2,1,1]' -o two
for k in 1 2147483647 2147483648 2147483649 4294967294 4294967295; do
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

# Any stretches of the conversions, too; what is behind the last one is nothing.
count=$(stats --get conversions_left middle)
same "conversions of all" "$count" "$(wc -l <whole)"
: >union
from=0
for to in 1 30 31 $((count / 2)) $((count + 7)); do
  expand middle --conversions $from:$to -o stretch
  rows stretch >rows
  same "conversions $from:$to" $(((to < count ? to : count) - from)) "$(wc -l <rows)"
  cat rows >>union
  from=$to
done
sort union | cmp - whole
expand middle --conversions 5:5 -o none
expand middle --conversions $((count + 7)):18446744073709551615 -o none
same "requests" 0 "$(rows none | wc -l)"
