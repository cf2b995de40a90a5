"""What must work all the same."""

import re
import struct

from filters import *


def accepted(name, command, good, right):
    file = "good.%d" % next(numbers)
    with open(file, "wb") as stream:
        stream.write(good)
    code, out, err, memory = run([file if w == "GOOD" else w for w in command.split()])
    if code != 0 or err or (right is not None and out != right) or (memory > MEMORY_MB and not SLOW):
        failures.append("%s: %s: exit code %d, %d MB, %s output\n  %s" %
                        (name, command, code, memory, "right" if out == right else "another", err[:400]))


def segments():
    """Cap'n Proto messages of many segments; zstd frames of another compressor level."""
    for kind, command in (("seeds", "expand GOOD"), ("requests", "merge seeds GOOD")):
        whole = READERS[kind][0]
        right = run([kind if w == "GOOD" else w for w in command.split()])[1]
        text = shard.run(["capnp", "decode", shard.SCHEMA, "Message"], shard.decompress(whole))
        original = shard.encode
        body = shard.split(shard.run(["capnp", "encode", "--segment-size=1", shard.SCHEMA, "Message"], text))
        if not any(struct.unpack_from("<I", m)[0] > 0 for m in body):
            failures.append("segments: capnp made none")
        messages = shard.decode(whole)
        infos = [shard.chunk_info(messages[0]["header"], messages[1], body[1], shard.frame(body[1], "-19"))]
        low, high = shard.section_digest(body[0], [(int(i["digestLow"]), int(i["digestHigh"])) for i in infos])
        messages[-1]["footer"].update(headerSize=len(shard.frame(body[0])), chunks=infos, digestLow=str(low), digestHigh=str(high))
        footer = original([messages[-1]])[0]
        accepted("segments", command, shard.joined([shard.frame(body[0]), shard.frame(body[1], "-19"), shard.frame(footer)]), right)


def four_billion_points():
    """A header that counts 2^32 - 1 points costs no memory: expand reads it as a stream, and all else refuses it."""
    definition = (b'grid = {origin = [0, 0, 0], spacing = 1, counts = [2, 1, 1]}\n'
                  b'model = {plugin = "toy", parameters = {state_size = 1000}}\n')
    for count in (2, 4294967295):
        code, seeds, err, memory = run(["seed", "-"], definition.replace(b"[2,", b"[%d," % count))
        assert (code == 0) == (count == 2) and (memory < MEMORY_MB or SLOW), (err, memory)
        if count == 2:
            messages = shard.decode(seeds)
    too_few = "a box of 4294967295 points with 2 records"
    assert too_few in err, err
    messages[0]["header"]["box"]["countX"] = 4294967295
    huge = shard.seal(messages)
    accepted("four billion points", "expand GOOD", huge, None)
    with open("huge.requests", "wb") as stream:
        stream.write(run(["expand", "-"], huge)[1])
    for command in ("merge BAD", "merge BAD huge.requests", "expand --complete BAD"):
        refused("four billion points", command, huge, too_few)


def copied_chunks():
    """merge copies a finished grid byte by byte: what it checks all the same."""
    whole = read("toy.grid")
    parts = shard.frames(whole)
    if len(parts) < 5:
        failures.append("copied chunks: there are only %d messages" % len(parts))
    accepted("copied chunks", "merge GOOD", whole, whole)
    begin = len(parts[0])
    damaged = "damaged: (Data corruption|Restored data|a zstd frame is cut|a chunk does not fit)"
    for number, chunk in enumerate(parts[1:-1]):
        if number < 3 or number % 97 == 0:  # of hundreds
            for at in (begin + 6, begin + 40, begin + len(chunk) // 2, begin + len(chunk) - 9):
                bad = bytearray(whole)
                bad[at] ^= 4
                refused("flip in a copied chunk at %d" % at, "merge BAD", bytes(bad), damaged)
        begin += len(chunk)
    for cut in (begin - 1, begin, len(whole) - len(parts[-1]) // 2):
        refused("cut behind copied chunks", "merge BAD", whole[:cut], "truncated")
    swapped = [parts[0], parts[2], parts[1]] + parts[3:]
    refused("swapped chunks", "merge BAD", shard.joined(swapped), damaged)
    # The footer swaps them too.
    last = len(parts) - 3
    sealed = shard.rearranged(whole, [last, *range(1, last), 0])
    for command in ("merge BAD", "expand --complete BAD", "stats BAD"):
        refused("swapped chunks, sealed", command, sealed, "out of order")


def not_finite():
    """A state that is not finite is a shard's content and not a fault of the stream: verify tells."""
    for number in ("NaN", "-Infinity"):
        messages = shard.decode(GRID)
        messages[1]["records"]["state"][3] = number
        with open("not_finite", "wb") as stream:
            stream.write(shard.seal(messages))
        code, out, err, _ = run(["verify", "not_finite"])
        if code != 3 or not re.search(r"\nfinite +12 records +1 ", out.decode()):
            failures.append("state %s in a grid: verify: exit code %d, %s" % (number, code, err))


later(copied_chunks)
later(not_finite)
later(segments)
later(four_billion_points)
