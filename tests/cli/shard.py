"""Shards for the tests, read and made by the stock tools alone: zstd, capnp, xxhsum.

A section is a list of messages as `capnp convert` prints them in JSON: the header, chunks, the
footer. Nothing here knows hapgrid's own reader or writer; a test that damages a shard edits a
message and seals the section again, so that only what it damaged is wrong.
"""

import copy
import functools
import json
import os
import struct
import subprocess

SCHEMA = os.path.join(os.environ["HAPGRID_SOURCE"], "schemas", "shard.capnp")


def output(command, data):
    return subprocess.run(command, input=data, stdout=subprocess.PIPE, check=True).stdout


kept = functools.cache(output)


def run(command, data):
    """What a program makes of its input. Shards of which one message is damaged have the others in common, so
    what is small is kept."""
    return (kept if len(data) < 1 << 14 else output)(tuple(command), bytes(data))


def decompress(shard):
    return run(["zstd", "-dqc"], shard)


def split(stream):
    """The messages of a Cap'n Proto stream, by their segment tables."""
    messages = []
    at = 0
    while at < len(stream):
        segments = struct.unpack_from("<I", stream, at)[0] + 1
        sizes = struct.unpack_from("<%dI" % segments, stream, at + 4)
        table = (4 + 4 * segments + 7) // 8 * 8
        end = at + table + 8 * sum(sizes)
        messages.append(stream[at:end])
        at = end
    assert at == len(stream)
    return messages


def frames(shard):
    """The zstd frames (RFC 8878, 3.1.1), each of which must have a checksum and its content's size. A
    skippable one must be the locator of the one before it."""
    found = []
    at = 0
    while at < len(shard):
        begin = at
        magic, flags = struct.unpack_from("<IB", shard, at)
        if magic == 0x184D2A5E:
            at += 16
            assert shard[begin:at] == locator(found[-1]), "another locator at byte %d" % begin
            continue
        assert magic == 0xFD2FB528 and flags & 4, "a frame without checksum at byte %d" % at
        single = flags >> 5 & 1
        size_bytes = (single, 2, 4, 8)[flags >> 6]
        assert size_bytes, "a frame without its content's size at byte %d" % at
        at += 5 + (not single) + (0, 1, 2, 4)[flags & 3] + size_bytes
        last = 0
        while not last:
            block = int.from_bytes(shard[at : at + 3], "little")
            last, kind = block & 1, block >> 1 & 3
            at += 3 + (1 if kind == 1 else block >> 3)
        at += 4
        found.append(shard[begin:at])
    assert at == len(shard)
    return found


def decode(shard):
    text = run(["capnp", "convert", "binary:json", "--short", SCHEMA, "Message"], decompress(shard))
    return [json.loads(line) for line in text.splitlines()]


def encode(messages, schema=SCHEMA):
    """Messages in JSON as Cap'n Proto messages."""
    command = ["capnp", "convert", "json:binary", schema, "Message"]
    return [run(command, json.dumps(m).encode()) for m in messages]


def frame(content, *options):
    return run(["zstd", "-qc", "--check", "--stream-size=%d" % len(content), *options], content)


def xxh3_128(content):
    """As (low, high), by the program of Debian's package xxhash."""
    value = int(run(["xxhsum", "-H2", "-"], content).split()[0], 16)
    return value & (1 << 64) - 1, value >> 64


def locator(footer):
    """What stands behind a footer's zstd frame."""
    return struct.pack("<IIQ", 0x184D2A5E, 8, len(footer))


def joined(parts):
    """Zstd frames as a section; the last one is the footer's."""
    return b"".join(parts) + locator(parts[-1])


def section_digest(header, chunk_digests):
    """Of the digests of the header's message and of the chunks."""
    return xxh3_128(b"".join(struct.pack("<QQ", *d) for d in [xxh3_128(header), *chunk_digests]))


def requests(rows):
    """Of a chunk of requests: (source point, level, direction), in order."""
    for point, level, directions in zip(rows["point"], rows["level"], rows["directions"]):
        for q in range(32):
            if directions >> q & 1:
                yield point, level, q


def chunk_info(header, message, content, stored):
    """What a footer says of a chunk: of its JSON, its message and its zstd frame."""
    kind, rows = next(iter(message.items()))
    point = rows["point"]
    generations = rows.get("generation", [])
    young = [int(p or 0) for p, g in zip(point, generations) if g == header["generation"]]
    if kind == "requests":
        asked = sum((directions or 0).bit_count() for directions in rows["directions"])
    else:
        asked = sum(neighbours(header.get("box"), p) for p in young)
    low, high = xxh3_128(content)
    return {
        "size": len(stored),
        "rows": len(point),
        "frontier": generations.count(header["generation"]),
        "conversions": asked,
        "firstPoint": int(point[0] or 0) if point else 0,
        "lastPoint": int(point[-1] or 0) if point else 0,
        "digestLow": str(low),
        "digestHigh": str(high),
    }


def seal(messages, edit=None, edit_last=None, schema=SCHEMA):
    """The bytes of a section with the footer that its messages need. `edit` changes the footer before
    its digest is computed, `edit_last` after that."""
    messages = copy.deepcopy(messages)
    body = encode(messages[:-1], schema)
    stored = [frame(m) for m in body]
    header = messages[0].get("header", {"generation": 0})
    footer = messages[-1]["footer"]
    footer["headerSize"] = len(stored[0])
    footer["chunks"] = [
        chunk_info(header, *chunk) for chunk in zip(messages[1:-1], body[1:], stored[1:])
    ]
    if edit:
        edit(footer)
    digests = [(int(c["digestLow"]), int(c["digestHigh"])) for c in footer["chunks"]]
    low, high = section_digest(body[0], digests)
    footer.update(digestLow=str(low), digestHigh=str(high))
    if edit_last:
        edit_last(footer)
    return joined(stored + [frame(m) for m in encode(messages[-1:])])


def rearranged(data, order):
    """The bytes of a section with these of its chunks, in this order, and the footer for them."""
    parts = frames(data)
    header, footer = decompress(parts[0]), decode(parts[-1])[0]["footer"]
    footer["chunks"] = [footer["chunks"][c] for c in order]
    low, high = section_digest(header, [(int(c["digestLow"]), int(c["digestHigh"])) for c in footer["chunks"]])
    footer.update(digestLow=str(low), digestHigh=str(high))
    chunks = [parts[1 + c] for c in order]
    return joined([parts[0], *chunks, frame(encode([{"footer": footer}])[0])])


STEPS = [(a, b, c) for c in (-1, 0, 1) for b in (-1, 0, 1) for a in (-1, 0, 1) if (a, b, c) != (0, 0, 0)]


def counts(box):
    return box["countX"], box["countY"], box["countZ"]


def coordinates(box, p):
    nx, ny, _ = counts(box)
    return p % nx, p // nx % ny, p // nx // ny


def neighbours(box, p):
    """How many directions from a point stay in the box, if that is one."""
    if not box or not all(counts(box)):
        return 0
    per_axis = [1 + (a > 0) + (a + 1 < n) for a, n in zip(coordinates(box, p), counts(box))]
    return per_axis[0] * per_axis[1] * per_axis[2] - 1


def neighbour(box, p, q):
    """The point in direction q, None outside the box."""
    at = [a + d for a, d in zip(coordinates(box, p), STEPS[q])]
    if any(a < 0 or a >= n for a, n in zip(at, counts(box))):
        return None
    return at[0] + box["countX"] * (at[1] + box["countY"] * at[2])
