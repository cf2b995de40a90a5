"""Messages that are no messages, and zstd frames that claim too much."""

import os
import struct

from filters import *


def with_chunk(content):
    """SEEDS with another chunk, right digests."""
    messages = shard.decode(SEEDS)
    parts = shard.frames(SEEDS)
    info = shard.chunk_info(messages[0]["header"], messages[1], content, shard.frame(content))
    footer = messages[-1]["footer"]
    footer["chunks"] = [info]
    low, high = shard.section_digest(shard.decompress(parts[0]), [(int(info["digestLow"]), int(info["digestHigh"]))])
    footer.update(digestLow=str(low), digestHigh=str(high))
    return shard.joined([parts[0], shard.frame(content), shard.frame(shard.encode([messages[-1]])[0])])


def not_messages():
    good = shard.decompress(shard.frames(SEEDS)[1])
    refused("zeros", "expand BAD", with_chunk(bytes(4096)), "bytes behind the message")
    refused("a word of zeros", "expand BAD", with_chunk(bytes(8)), "damaged")
    refused("ones", "expand BAD", with_chunk(b"\xff" * 4096), "damaged")
    refused("text", "expand BAD", with_chunk(b"The quick brown fox.... " * 10), "damaged")
    refused("no words", "expand BAD", with_chunk(good + b"\0"), "not a shard: no Cap'n Proto message")
    refused("a word behind", "expand BAD", with_chunk(good + bytes(8)), "bytes behind the message")
    refused("a word short", "expand BAD", with_chunk(good[:-8]), "damaged")
    refused("many segments", "expand BAD", with_chunk(struct.pack("<II", 0xFFFFFFFE, 0) + good), "damaged")
    refused("a giant segment", "expand BAD", with_chunk(struct.pack("<II", 0, 0xFFFFFFFF) + good[8:]), "damaged")
    # Every pointer of the message made wild, one after the other.
    for at in range(8, min(len(good), 120), 8):
        for wild in (b"\xff" * 8, struct.pack("<Q", 0x7FFFFFFFFFFFFFF9), struct.pack("<Q", 0xFFFFFFFF00000001),
                     struct.pack("<Q", 0xFFFFFFF800000005), struct.pack("<Q", 2)):
            # In a state or in padding it means no harm.
            refused("wild word at %d" % at, "expand BAD", with_chunk(good[:at] + wild + good[at + 8 :]), "BAD: ", may_pass=True)


def with_parts(parts):
    """Zstd frames as a section; the footer of SEEDS gets their sizes."""
    if parts[-1] != shard.frames(SEEDS)[-1]:
        return shard.joined(parts)
    footer = shard.decode(parts[-1])[0]["footer"]
    footer["headerSize"] = len(parts[0])
    for chunk, part in zip(footer["chunks"], parts[1:]):
        chunk.update(size=len(part))
    return shard.joined([*parts[:-1], shard.frame(shard.encode([{"footer": footer}])[0])])


def hostile_frames():
    parts = shard.frames(SEEDS)
    # A zstd frame that says it holds 2^62 bytes, 8 TB, 80 MiB and a word; and one that does not say.
    for size in (1 << 62, 1 << 43, (80 << 20) + 8):
        claim = b"\x28\xb5\x2f\xfd\xe4" + struct.pack("<Q", size) + b"\x01\x00\x00" + b"\0\0\0\0"
        for at in range(3):
            bad = parts[:at] + [claim] + parts[at + 1 :]
            refused("a zstd frame of %d bytes" % size, "expand BAD", with_parts(bad), "a message of %d bytes, the limit is" % size)
    silent = shard.run(["zstd", "-qc", "--check"], shard.decompress(parts[0]))
    refused("a zstd frame without its size", "expand BAD", with_parts([silent, parts[1], parts[2]]), "a zstd frame without its content's size")
    # Bombs: what 80 MiB of zeros become, in each place. A header or a footer may be so large.
    bomb = shard.frame(bytes(80 << 20))
    for at in range(3):
        bad = with_parts(parts[:at] + [bomb] + parts[at + 1 :])
        refused("a bomb at %d" % at, "expand BAD", bad, "the limit is|bytes behind the message")
        refused("a bomb at %d" % at, "merge BAD requests", bad, "the limit is|bytes behind the message")
    refused("a hundred bombs", "expand BAD", bomb * 100 + SEEDS, "truncated: a shard ends with an index")
    # Long, with nothing in it.
    empty = shard.frame(b"")
    refused("empty zstd frames", "expand BAD", empty * 200000, "truncated: a shard ends with an index")
    refused("an empty footer", "expand BAD", shard.joined([*parts[:-1], empty]), "no Cap'n Proto message")
    noise = os.urandom(1 << 20)
    refused("noise", "expand BAD", noise, "not a shard: no zstd frame")
    refused("noise in a zstd frame", "expand BAD", shard.joined([shard.frame(noise)]), "damaged|bytes behind")
    endless = b"\x28\xb5\x2f\xfd\x04\x58" + b"\0\x80\0" * 1
    refused("a zstd frame that never ends", "expand BAD", shard.joined([endless]), "a zstd frame is cut")
    # Locators that lead elsewhere.
    for size in (0, 1, len(SEEDS) - 16, len(SEEDS), 1 << 62):
        locator = struct.pack("<IIQ", 0x184D2A5E, 8, size)
        refused("a footer of %d bytes" % size, "expand BAD", SEEDS[:-16] + locator, "damaged")


later(not_messages)
later(hostile_frames)
