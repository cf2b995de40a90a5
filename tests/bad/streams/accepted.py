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
    """A header that counts 2^32 - 2^17 + 1 points costs no memory in the filters of a round."""
    definition = (b'grid = {origin = [0, 0, 0], spacing = 1, counts = [65535, 65535, 1]}\n'
                  b'model = {plugin = "toy", parameters = {}}\n')
    code, seeds, err, memory = run(["seed", "-"], definition)
    assert code == 0 and memory < MEMORY_MB or SLOW, (err, memory)
    with open("huge.seeds", "wb") as stream:
        stream.write(seeds)
    _, requests, err, memory = run(["expand", "huge.seeds"])
    accepted("four billion points", "expand GOOD", seeds, requests)
    accepted("four billion points", "merge huge.seeds GOOD", requests, None)
    refused("four billion points", "merge BAD", seeds, "requests are missing: 12 of the 12 conversions")


def copied_chunks():
    """merge copies chunks without frontier as they are stored: what it checks of them all the same."""
    whole = read("toy.grid")
    parts = shard.frames(whole)
    if len(parts) < 5:
        failures.append("copied chunks: there are only %d messages" % len(parts))
    accepted("copied chunks", "merge GOOD", whole, whole)
    begin = len(parts[0])
    for number, chunk in enumerate(parts[1:-1]):
        if number < 3 or number % 97 == 0:  # of hundreds
            for at in (begin + 6, begin + 40, begin + len(chunk) // 2, begin + len(chunk) - 9):
                bad = bytearray(whole)
                bad[at] ^= 4
                refused("flip in a copied chunk at %d" % at, "merge BAD", bytes(bad), "a chunk does not fit the footer's hash")
        begin += len(chunk)
    for cut in (begin - 1, begin, len(whole) - len(parts[-1]) // 2):
        refused("cut behind copied chunks", "merge BAD", whole[:cut], "truncated")
    swapped = [parts[0], parts[2], parts[1]] + parts[3:]
    refused("swapped chunks", "merge BAD", shard.joined(swapped), "a chunk does not fit the footer's hash")
    # The footer swaps them too. The first two may have the same point, and then a copy cannot tell: it
    # does not look at levels. What reads them does.
    last = len(parts) - 3
    sealed = shard.rearranged(whole, [last, *range(1, last), 0])
    for command in ("merge BAD", "expand --complete BAD", "stats BAD"):
        refused("swapped chunks, sealed", command, sealed, "out of order|was expected")


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
