"""Messages that are no messages, and frames of zstd that claim too much."""

import os
import struct

from filters import *


def with_chunk(content, **options):
    """SEEDS with another chunk, right digests."""
    messages = shard.decode(SEEDS)
    parts = shard.frames(SEEDS)
    info = shard.chunk_info(messages[0]["header"], messages[1], content, shard.frame(content))
    footer = messages[-1]["footer"]
    footer["chunks"] = [info]
    low, high = shard.section_digest(shard.decompress(parts[0]), [(int(info["digestLow"]), int(info["digestHigh"]))])
    footer.update(digestLow=str(low), digestHigh=str(high))
    return parts[0] + shard.frame(content, *options.get("zstd", ())) + shard.frame(shard.encode([messages[-1]])[0])


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


def hostile_frames():
    parts = shard.frames(SEEDS)
    # A frame that says it holds 2^62 bytes, 8 TB, 64 MiB and a word; and one that does not say.
    for size in (1 << 62, 1 << 43, (64 << 20) + 8):
        claim = b"\x28\xb5\x2f\xfd\xe4" + struct.pack("<Q", size) + b"\x01\x00\x00" + b"\0\0\0\0"
        for at in range(3):
            bad = parts[:at] + [claim] + parts[at + 1 :]
            refused("a frame of %d bytes" % size, "expand BAD", b"".join(bad), "a message of %d bytes, the limit is|does not end|damaged" % size)
    silent = shard.run(["zstd", "-qc", "--check"], shard.decompress(parts[0]))
    refused("a frame without its size", "expand BAD", silent + parts[1] + parts[2], "a frame without its content's size")
    # Bombs: what 64 MiB of zeros become, in each place. Only a footer may be so large.
    bomb = shard.frame(bytes(64 << 20))
    for at in range(3):
        bad = parts[:at] + [bomb] + parts[at + 1 :]
        refused("a bomb at %d" % at, "expand BAD", b"".join(bad), "the limit is|damaged|bytes behind|does not end")
        refused("a bomb at %d" % at, "merge BAD requests", b"".join(bad), "the limit is|damaged|bytes behind|does not end")
    refused("a hundred bombs", "expand BAD", bomb * 100 + SEEDS, "bytes behind|damaged|does not end")
    # Long, with nothing in it.
    empty = shard.frame(b"")
    refused("empty frames", "expand BAD", empty * 200000, "no Cap'n Proto message")
    noise = os.urandom(1 << 20)
    refused("noise", "expand BAD", noise, "not a shard: no zstd frame")
    refused("noise in a frame", "expand BAD", shard.frame(noise), "damaged|does not end|bytes behind")
    refused("a frame that never ends", "expand BAD", b"\x28\xb5\x2f\xfd\x04\x58" + b"\0\x80\0" * 1, "a frame is cut|truncated")


later(not_messages)
later(hostile_frames)
