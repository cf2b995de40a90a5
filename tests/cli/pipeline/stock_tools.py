"""stock_tools.py MODEL.toml SHARD...: what shards say, judged from outside.

The shards come from stock-tools.sh with its --set options.
"""

import os
import sys
import tomllib

sys.path.insert(0, os.path.join(os.path.dirname(__file__), ".."))
import shard

OVERRIDES = {
    "counts": [40, 22, 20],
    "origin": [-0.975, -0.525, -0.475],
    "max_levels": 17,
    "weight": 2.5,
}
CHUNK_BYTES = {"small.grid": 1 << 20}


def check(what, expected, got):
    if expected != got:
        sys.exit("%s: %s: expected %r, got %r" % (name, what, expected, got))


def check_header(header):
    check("magic", int.from_bytes(b"hapgrid1", "big"), int(header["magic"]))
    check("version", 1, header["version"])
    box = header["box"]
    check("origin", OVERRIDES["origin"], [box["originX"], box["originY"], box["originZ"]])
    check("counts", OVERRIDES["counts"], list(shard.counts(box)))
    check("spacing", model["grid"]["spacing"], box["spacing"])
    check("model", model["model"]["plugin"], header["model"])
    parameters = {**model["model"]["parameters"], "weight": OVERRIDES["weight"]}
    check("parameters", [{"key": k, "value": {"number": v}} for k, v in sorted(parameters.items())],
          header["parameters"])
    check("state size", 1, header["stateSize"])
    check("tolerance", parameters["tolerance"], header["tolerance"])
    check("unit", "rad", header["toleranceUnit"])
    check("level limit", OVERRIDES["max_levels"], header["maxLevels"])


def ascending(keys):
    return all(a < b for a, b in zip(keys, keys[1:]))


def check_section(messages, raw, stored):
    header = messages[0]["header"]
    footer = dict(messages[-1]["footer"])
    infos = footer.pop("chunks", [])
    footer = {k: int(v) for k, v in footer.items()}
    check("size of the header", len(stored[0]), footer["headerSize"])
    chunks = messages[1:-1]
    box = header["box"]
    points = box["countX"] * box["countY"] * box["countZ"]
    content = header["content"]
    check_header(header)
    check("chunks", [shard.chunk_info(header, *chunk) for chunk in zip(chunks, raw[1:], stored[1:])], infos)
    digests = [(int(i["digestLow"]), int(i["digestHigh"])) for i in infos]
    check("digest", shard.section_digest(raw[0], digests), (footer["digestLow"], footer["digestHigh"]))
    for message in raw[1:-1]:
        check("a chunk's size", True, len(message) < 1.1 * CHUNK_BYTES.get(os.path.basename(name), 1 << 16))

    inside = {}

    def directions(p):
        if p not in inside:
            inside[p] = [q for q in range(26) if shard.neighbour(box, p, q) is not None]
        return inside[p]

    keys = []
    frontier = conversions = 0
    for message in chunks:
        if content == "requests":
            rows = message["requests"]
            check("columns", [len(rows["point"])] * 2, [len(rows[k]) for k in ("level", "directions")])
            found = list(shard.requests(rows))
            check("a state a request", len(found), len(rows["state"]))
            for p, level, q in found:
                check("a request's target is in the box", True, q in directions(p))
            keys += found
            continue
        rows = message["records"]
        size = len(rows["point"])
        check("columns", [size] * 3, [len(rows[k]) for k in ("level", "generation", "state")])
        keys += zip(rows["point"], rows["level"])
        mine = [r for r in range(size) if rows["generation"][r] == header["generation"]]
        frontier += len(mine)
        check("links", 26 * size, len(rows["links"]))
        unsettled = set(mine)
        for r, p in enumerate(rows["point"]):
            links = rows["links"][26 * r : 26 * r + 26]
            check("255 where a direction leaves the box", [q for q in range(26) if q not in directions(p)],
                  [q for q in range(26) if links[q] == 255])
            check("254 in the frontier alone", r in unsettled, 254 in links)
            conversions += len(directions(p)) if r in unsettled else 0
    check("rows ascend", True, ascending(keys))
    check("all points are in the box", True, not keys or max(k[0] for k in keys) < points)
    sums = {k: sum(i[k] for i in infos) for k in ("rows", "frontier", "conversions")}
    check("frontier", frontier, sums["frontier"])
    check("conversions", len(keys) if content == "requests" else conversions, sums["conversions"])
    return content, sums, len(chunks), header["generation"]


with open(sys.argv[1], "rb") as file:
    model = tomllib.load(file)
facts = {}
for name in sys.argv[2:]:
    with open(name, "rb") as file:
        stored = file.read()
    frames = shard.frames(stored)
    raw = shard.split(shard.decompress(stored))
    check("a message a zstd frame", raw, [shard.decompress(f) for f in frames])
    messages = shard.decode(stored)
    sections = facts.setdefault(os.path.basename(name), [])
    begin = 0
    for i, message in enumerate(messages):
        if "footer" in message:
            sections.append(check_section(messages[begin : i + 1], raw[begin : i + 1], frames[begin : i + 1]))
            begin = i + 1
    check("ends with a footer", len(messages), begin)

# What the shards say about each other.
name = "all shards"
one = {k: v[0] for k, v in facts.items()}
check("kinds", ["grid", "requests", "requests", "grid"], [s[0] for s in facts["concatenated"]])
check("seeds", 8, one["seeds.grid"][1]["rows"])
middle, whole = one["middle.grid"], one["complete.grid"]
check("generations", (0, 11, 11, 12), tuple(one[k][3] for k in ("seeds.grid", "middle.grid", "all.requests", "next.grid")))
check("a request a conversion", middle[1]["conversions"], one["all.requests"][1]["conversions"])
# A part has a block of each of 32 turns or more.
third = middle[1]["conversions"] / 3
check("a third", True, abs(one["part.requests"][1]["conversions"] - third) <= third / 32 + 1)
check("a complete grid has no frontier", (0, 0), (whole[1]["frontier"], whole[1]["conversions"]))
check("levels", True, whole[1]["rows"] > 40 * 22 * 20)
check("several chunks were tried", True, whole[2] >= 2)
check("the small grid has the same records in fewer chunks", (whole[1], True),
      (one["small.grid"][1], one["small.grid"][2] < whole[2]))
check("an empty section", 0, one["empty.requests"][2])
