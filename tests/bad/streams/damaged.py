"""Shards that are cut at the ends of their parts or have a bit flipped here and there, through each filter
that reads them. Every bit and every byte: bad/every-bit, which reads them in one process."""

import itertools
import os
import re
import struct

from filters import *

# Cut, at the edges of zstd frames.

for kind, (whole, commands) in READERS.items():
    ends = list(itertools.accumulate(len(f) for f in shard.frames(whole)))
    edges = {0, 1, 2, 3, 4, 5, 17, 18, len(whole) - 1}
    for end in ends[:-1]:
        edges |= {end - 5, end - 4, end - 1, end, end + 1, end + 3, end + 4, end + 10}
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
        later_refused("%s: locator twice" % kind, command, whole + whole[-24:], "damaged|truncated")
        later_refused("%s: skippable frame" % kind, command, struct.pack("<II", 0x184D2A50, 4) + b"text" + whole, "not a shard: no zstd frame")
        later_refused("%s: a zstd frame for all" % kind, command, shard.joined([shard.frame(shard.decompress(whole))]), "bytes behind the message")
        later_refused("%s: two messages in a zstd frame" % kind, command,
                      shard.joined([shard.frame(b"".join(map(shard.decompress, parts[:2]))), parts[2]]), "truncated|damaged|bytes behind")

# Flipped: a prime number of bytes apart.


def flipped(kind, command, whole, at, mask, right):
    name = "flip %s at %d by %d" % (kind, at, mask)
    if ONLY not in name:
        return
    file = "bad.%d" % next(numbers)
    bad = bytearray(whole)
    bad[at] ^= mask
    with open(file, "wb") as stream:
        stream.write(bad)
    words = [file if w == "BAD" else w for w in command.split()]
    code, stdout, stderr, _ = run(words)
    os.unlink(file)
    # A bit without meaning, in a zstd frame's header, may be overlooked.
    if code == 0 and stdout == right and not stderr:
        return
    if code != 1 or not re.fullmatch("%s: [^\n]+\n" % words[0], stderr):
        failures.append("%s: %s: exit code %d\n  %s" % (name, command, code, stderr[:400]))


for kind, command in (
    ("seeds", "expand BAD"),
    ("requests", "merge seeds BAD"),
    ("next", "merge next.requests BAD"),
    ("grid", "stats --dump BAD"),
    ("small", "stats --dump BAD"),
    ("toy.requests", "merge BAD toy.seeds"),
):
    whole = READERS[kind][0]
    code, right, stderr, _ = run([kind if w == "BAD" else w for w in command.split()])
    assert code == 0, stderr
    for at in range(0, len(whole), 23 if SLOW else 7):
        later(flipped, kind, command, whole, at, 1 << at % 8, right)
