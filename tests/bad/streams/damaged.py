"""Shards that are cut at the ends of their parts, through each filter that reads them. Every bit and every
byte: bad/every-bit, which reads them in one process."""

import itertools
import struct

from filters import *

# Cut, at the edges of zstd frames.

for kind, (whole, commands) in READERS.items():
    ends = list(itertools.accumulate(len(f) for f in shard.frames(whole)))
    edges = {0, 3, 4, len(whole) - 1, *ends[:-1]}
    for command in commands:
        for cut in sorted(edges):
            message = (
                "empty, not a shard" if cut == 0 else
                "not a shard: no zstd frame" if cut < 4 else
                "byte %d: truncated: a shard ends with an index" % cut)
            later_refused("cut %s at %d" % (kind, cut), command, whole[:cut], message)
    # Zstd frames that are missing inside.
    parts = shard.frames(whole)
    truncated = "truncated: the footer's section is larger than what stands before it"
    no_index = "truncated: a shard ends with an index"
    for command in commands:
        later_refused("%s without header" % kind, command, shard.joined(parts[1:]), truncated)
        later_refused("%s without chunk" % kind, command, shard.joined([parts[0], parts[-1]]), truncated)
        later_refused("%s: footer alone" % kind, command, shard.joined(parts[-1:]), truncated)
        later_refused("%s: header alone" % kind, command, parts[0], no_index)
        later_refused("%s: chunk twice" % kind, command, shard.joined([parts[0], parts[1], parts[1], parts[2]]), "damaged|truncated")
        later_refused("%s: footer twice" % kind, command, whole + shard.joined(parts[-1:]), "damaged|truncated|no header")
        later_refused("%s: header twice" % kind, command, parts[0] + whole, no_index)
        later_refused("%s: bytes behind" % kind, command, whole + b"\n", no_index)
        later_refused("%s: bytes before" % kind, command, b"\n" + whole, "not a shard: no zstd frame")
        later_refused("%s: zeros behind" % kind, command, whole + bytes(4096), no_index)
        later_refused("%s: locator twice" % kind, command, whole + whole[-16:], "damaged|truncated")
        later_refused("%s: skippable frame" % kind, command, struct.pack("<II", 0x184D2A50, 4) + b"text" + whole, "not a shard: no zstd frame")
        later_refused("%s: a zstd frame for all" % kind, command, shard.joined([shard.frame(shard.decompress(whole))]), "bytes behind the message")
        later_refused("%s: two messages in a zstd frame" % kind, command,
                      shard.joined([shard.frame(b"".join(map(shard.decompress, parts[:2]))), parts[2]]), "truncated|damaged|bytes behind")
