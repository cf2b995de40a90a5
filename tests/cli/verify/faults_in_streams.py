"""Faults in sections, chunks and digests."""

from planting import Grid, byte_fault, message_fault, part, read, shard

part("Sections, chunks, digests: not sealed again where nothing else is said")


def frames(name, refused, order):
    """Zstd frames: the header's, the chunk's, the footer's; a text is that chunk of another grid."""
    def plant(data):
        parts = shard.frames(data)
        return shard.joined([shard.frames(read(i))[1] if isinstance(i, str) else parts[i] for i in order])
    byte_fault(name, refused=refused)(plant)


byte_fault("half of a grid alone, sealed", "coverage", "links", "generations", "continuous")(
    lambda data: Grid(data).part(lambda row: row["point"] < 42).seal())
byte_fault("two halves, one after the other, sealed", refused="holds 2 sections where one grid is needed")(
    lambda data: b"".join(Grid(data).part(lambda row: (row["point"] < 42) == low).seal() for low in (True, False)))
byte_fault("requests instead of the grid", refused="holds requests where a grid is needed")(lambda data: read("requests"))
frames("the chunk lost", "truncated: the footer's section is larger than what stands before it", [0, 2])
frames("the chunk of another grid", "damaged: a zstd frame is cut", [0, "stored", 2])


@byte_fault("the header of another grid", refused="damaged: the digest in the footer does not fit the content")
def _(data):
    messages, header = shard.decode(data), shard.decode(read("stored"))[0]
    footer = messages[-1]["footer"]
    old = {name: footer[name] for name in ("digestLow", "digestHigh")}
    return shard.seal([header, *messages[1:]], edit_last=lambda f: f.update(old))


frames("chunk and footer exchanged", "damaged: no footer where there must be one", [0, 2, 1])
CUT = "truncated: a shard ends with an index"
byte_fault("the footer lost", refused=CUT)(lambda data: b"".join(shard.frames(data)[:2]))
byte_fault("the last byte lost", refused=CUT)(lambda data: data[:-1])


@byte_fault("a bit of the chunk flipped", refused="damaged: Data corruption detected")
def _(data):
    parts = shard.frames(data)
    at = len(parts[0]) + len(parts[1]) // 2
    return data[:at] + bytes([data[at] ^ 8]) + data[at + 1 :]


def chunks(name, order, *rows, refused=None, sealed=True):
    def plant(data):
        parts = shard.frames(data)
        return shard.rearranged(data, order) if sealed else shard.joined([parts[0], *(parts[1 + c] for c in order), parts[-1]])
    byte_fault(name, *rows, refused=refused, grid="chunks")(plant)


chunks("a chunk of three lost", [0, 2], refused="truncated: the footer's section is larger than what stands before it", sealed=False)
chunks("a chunk of three lost, sealed", [0, 2], "coverage", "links", "reachable", "continuous")
chunks("the last chunk lost, sealed", [0, 1], "coverage", "links", "generations", "continuous")
chunks("two chunks exchanged", [1, 0, 2], refused="damaged: a zstd frame is cut", sealed=False)
chunks("two chunks exchanged, sealed", [1, 0, 2], refused="damaged: chunks out of order")
chunks("a chunk doubled, sealed", [0, 1, 1, 2], refused="damaged: chunks out of order")


def footer(name, refused, late=False, **changes):
    def edit(footer):
        footer["chunks"][0].update(changes) if not late else footer.update(changes)
    message_fault(name, refused=refused, **{"edit_last" if late else "edit": edit})(lambda messages: None)


SAYS = "a chunk does not fit what the footer says of it"
footer("a chunk's digest", "a chunk does not fit the footer's digest of it", digestLow="1")
footer("a chunk's number of rows", SAYS, rows=157)
footer("a chunk's first point", SAYS, firstPoint=1)
footer("a chunk's conversions", SAYS, conversions=1)
footer("a chunk's last point", SAYS, lastPoint=82)
footer("a chunk's records in the frontier", SAYS, frontier=1)
footer("the section's digest", "the digest in the footer does not fit the content", late=True, digestHigh="1")
