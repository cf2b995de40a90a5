"""dump.py GRID, or < GRID: a line for each record of a grid, by the stock tools alone.

i j k level, the state, and the levels of the 26 links, separated by tabs: '-' where a direction leaves the box, '?' where
it is not settled.
"""
import sys

import shard

with open(sys.argv[1] if len(sys.argv) > 1 else 0, "rb") as file:
    messages = shard.decode(file.read())
header = messages[0]["header"]
print("# " + "\t".join(["i", "j", "k", "level", *(f"s{c}" for c in range(header["stateSize"])), *(f"d{q}" for q in range(26))]))
for message in messages[1:-1]:
    rows = message["records"]
    for r, point in enumerate(rows["point"]):
        state = ["%.17g" % float(x) for x in rows["state"][r :: len(rows["point"])]]
        links = [{255: "-", 254: "?"}.get(level, str(level)) for level in rows["links"][26 * r : 26 * r + 26]]
        print(*shard.coordinates(header["box"], point), rows["level"][r], *state, *links, sep="\t")
