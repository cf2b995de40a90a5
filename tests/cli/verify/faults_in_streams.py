"""Faults in sections, chunks and digests."""

from planting import Grid, byte_fault, message_fault, part, read, shard

part("Sections, chunks, digests: not sealed again where nothing else is said")


@byte_fault("half of a grid alone, sealed", "coverage", "links", "generations", "paths")
def _(data):
    return Grid(data).part(lambda row: row["point"] < 42).seal()


@byte_fault("a range of points twice, sealed", refused="level 0 where level 1 of at most 8 was expected")
def _(data):
    return Grid(data).part(lambda row: row["point"] < 42).seal() + data


@byte_fault("two halves of which one has another spacing, sealed", refused="another grid than...")
def _(data):
    other = Grid(data).part(lambda row: row["point"] >= 42)
    other.box["spacing"] = 0.11
    return Grid(data).part(lambda row: row["point"] < 42).seal() + other.seal()


@byte_fault("two halves of which one is a round older, sealed", refused="generation 12, but ... has generation 14")
def _(data):
    halves = [Grid(data).part(lambda row: (row["point"] < 42) == low) for low in (True, False)]
    halves[0].header["generation"] = max(row["generation"] for row in halves[0].rows)
    return b"".join(half.seal() for half in halves)


@byte_fault("two halves, their links made for halves, sealed", "links", "paths")
def _(data):
    halves = [Grid(data).part(lambda row: (row["point"] < 42) == low) for low in (True, False)]
    for half in halves:
        points = {row["point"] for row in half.rows}
        for row in half.rows:
            row["links"] = [v if shard.neighbour(half.box, row["point"], q) in points else 255
                            for q, v in enumerate(row["links"])]
    return b"".join(half.seal() for half in halves)


@byte_fault("requests instead of the grid", refused="holds requests where a shard of grid is needed")
def _(data):
    return read("requests")


@byte_fault("the chunk lost", refused="truncated: a footer counts 1 chunks, 1 messages stand before it")
def _(data):
    parts = shard.frames(data)
    return parts[0] + parts[2]


@byte_fault("the chunk of another grid", refused="damaged: a chunk does not fit the footer's hash of it")
def _(data):
    parts = shard.frames(data)
    return parts[0] + shard.frames(read("stored"))[1] + parts[2]


@byte_fault("the header of another grid", refused="damaged: the digest in the footer does not fit the content")
def _(data):
    return shard.frames(read("stored"))[0] + b"".join(shard.frames(data)[1:])


@byte_fault("chunk and footer exchanged", refused="truncated: the shard does not end with a footer")
def _(data):
    parts = shard.frames(data)
    return parts[0] + parts[2] + parts[1]


@byte_fault("the footer lost", refused="truncated: the shard does not end with a footer")
def _(data):
    return b"".join(shard.frames(data)[:2])


@byte_fault("the last byte lost", refused="truncated or damaged: a frame is cut")
def _(data):
    return data[:-1]


@byte_fault("a bit of the chunk flipped", refused="damaged: a chunk does not fit the footer's hash of it")
def _(data):
    parts = shard.frames(data)
    at = len(parts[0]) + len(parts[1]) // 2
    return data[:at] + bytes([data[at] ^ 8]) + data[at + 1 :]


def chunks(name, order, *rows, refused=None, sealed=True):
    @byte_fault(name, *rows, refused=refused, grid="chunks")
    def _(data):
        if sealed:
            return shard.rearranged(data, order)
        parts = shard.frames(data)
        return b"".join([parts[0], *(parts[1 + c] for c in order), parts[-1]])


chunks("a chunk of three lost", [0, 2], refused="truncated: a footer counts 3 chunks, 3 messages stand before it", sealed=False)
chunks("a chunk of three lost, sealed", [0, 2], "coverage", "links", "reachable", "paths")
chunks("the last chunk lost, sealed", [0, 1], "coverage", "links", "generations", "paths")
chunks("two chunks exchanged", [1, 0, 2], refused="damaged: a chunk does not fit the footer's hash of it", sealed=False)
chunks("two chunks exchanged, sealed", [1, 0, 2], refused="damaged: rows out of order at point 0")
chunks("a chunk doubled, sealed", [0, 1, 1, 2], refused="damaged: rows out of order at point 2")


def footer(name, refused, late=False, **changes):
    def edit(footer):
        footer["chunks"][0].update(changes) if not late else footer.update(changes)
    message_fault(name, refused=refused, **{"edit_last" if late else "edit": edit})(lambda messages: None)


SAYS = "a chunk does not fit what the footer says of it"
footer("a chunk's digest", "a chunk does not fit the footer's digest of it", digestLow="1")
footer("a chunk's hash", "a chunk does not fit the footer's hash of it", stored="1")
footer("a chunk's number of rows", SAYS, rows=157)
footer("a chunk's first point", SAYS, firstPoint=1)
footer("a chunk's last point", SAYS, lastPoint=82)
footer("a chunk's records in the frontier", SAYS, frontier=1)
footer("the section's digest", "the digest in the footer does not fit the content", late=True, digestHigh="1")
COUNTS = "the counts in the footer do not fit the content"
footer("the number of records", COUNTS, late=True, records="157")
footer("the number of requests", COUNTS, late=True, requests="1")
footer("the number of records in the frontier", COUNTS, late=True, frontier="1")
footer("the number of conversions", COUNTS, late=True, conversions="1")
