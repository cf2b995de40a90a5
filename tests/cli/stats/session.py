"""Sessions by the stock tools alone (zstd, capnp, xxhsum), without hapgrid's reader or writer.

session.py text FILE: prints a session as stats --export has to.
session.py make FILE: writes a small session whose numbers are known.
session.py bad FILE: feeds damaged and hostile relatives of a session to stats --log.
"""

import copy
import json
import math
import os
import resource
import struct
import subprocess
import sys

sys.path.insert(0, os.path.join(os.environ["HAPGRID_SOURCE"], "tests", "cli"))
import shard

SCHEMA = os.path.join(os.environ["HAPGRID_SOURCE"], "schemas", "session.capnp")
MASK = (1 << 64) - 1
LOCATOR = 24


def decode(data):
    """Its messages as JSON."""
    text = shard.run(
        ["capnp", "convert", "binary:json", "--short", SCHEMA, "Message"], shard.decompress(data)
    )
    return [json.loads(line) for line in text.splitlines()]


def seal(messages, edit=None, footer_frame=None, locator=None):
    """The bytes of a session whose footer has the right index; `edit` changes the footer."""
    messages = copy.deepcopy(messages)
    body = shard.encode(messages[:-1], SCHEMA)
    frames = [shard.frame(m) for m in body]
    footer = messages[-1]["footer"]
    footer["chunks"] = []
    digests = b""
    at = 0
    for message, content, frame in zip(messages, body, frames):
        low, high = shard.xxh3_128(content)
        digests += struct.pack("<QQ", low, high)
        if "ticks" in message:
            skipped = [int(s) for s in message["ticks"]["skipped"]]
            first = int(message["ticks"].get("first", 0))
            entry = {"offset": at, "size": len(frame), "first": first}
            entry["last"] = first + sum(skipped) + len(skipped) - 1
            entry.update(ticks=len(skipped), digestLow=low, digestHigh=high)
            footer["chunks"].append(entry)
        at += len(frame)
    footer["ticks"] = sum(c["ticks"] for c in footer["chunks"])
    low, high = shard.xxh3_128(digests)
    footer.update(digestLow=low, digestHigh=high)
    if edit:
        edit(footer)
    for where in [footer, *footer["chunks"]]:
        for key, value in where.items():
            if key not in ("chunks", ) and not (where is not footer and key == "ticks"):
                where[key] = str(value)
    last = footer_frame or shard.frame(shard.encode([{"footer": footer}], SCHEMA)[0])
    end = struct.pack("<IIQQ", 0x184D2A5E, 16, locator or len(last), shard.xxh3_64(last))
    return b"".join(frames) + last + end


def numbers(column, n):
    """The 64-bit numbers of a column."""
    return [int.from_bytes(bytes(column[b * n + i] for b in range(8)), "little") for i in range(n)]


def double(bits):
    return struct.unpack("<d", struct.pack("<Q", bits))[0]


def bits_of(x):
    return struct.unpack("<Q", struct.pack("<d", x))[0]


def vectors(data, n):
    """x y z of each tick as bits, from differences to the tick before."""
    axes = []
    for axis in range(3):
        bits, axis_bits = 0, []
        for u in numbers(data[8 * n * axis : 8 * n * (axis + 1)], n):
            bits = (bits + (u // 2 if u % 2 == 0 else -(u + 1) // 2)) & MASK
            axis_bits.append(bits)
        axes.append(axis_bits)
    return list(zip(*axes))


def code(vectors_of_doubles):
    """The opposite of vectors()."""
    out = []
    for axis in zip(*vectors_of_doubles):
        us, before = [], 0
        for x in axis:
            d = (bits_of(x) - before) & MASK
            before = bits_of(x)
            d -= (d >> 63) << 64
            us.append(2 * d if d >= 0 else -2 * d - 1)
        out += [u >> 8 * b & 255 for b in range(8) for u in us]
    return out


def code_force(force, raw):
    out = []
    for axis, raw_axis in zip(zip(*force), zip(*raw)):
        us = [bits_of(f) ^ bits_of(r) for f, r in zip(axis, raw_axis)]
        out += [u >> 8 * b & 255 for b in range(8) for u in us]
    return out


def digits(x):
    return ("-" if math.copysign(1, x) < 0 else "") + "nan" if math.isnan(x) else "%.17g" % x


def text(name):
    with open(name, "rb") as file:
        messages = decode(file.read())
    rate = messages[0]["header"]["rate"]
    names = "# t x y z force_x force_y force_z sent_x sent_y sent_z l0 l1 l2 l3 l4 l5 l6 l7 flags lateness_us compute_us"
    lines = ["# " + "\t".join(names[2:].split())]
    for message in messages[1:-1]:
        ticks = message["ticks"]
        n = len(ticks["skipped"])
        number = int(ticks.get("first", 0)) - 1
        raws = vectors(ticks["rawForce"], n)
        force = [numbers(ticks["force"][8 * n * a : 8 * n * (a + 1)], n) for a in range(3)]
        for i, (hip, raw) in enumerate(zip(vectors(ticks["hip"], n), raws)):
            number += int(ticks["skipped"][i]) + 1
            cells = [digits(number / rate)] + [digits(double(b)) for b in hip]
            cells += [digits(double(b)) for b in raw]
            cells += [digits(double(force[a][i] ^ raw[a])) for a in range(3)]
            cells += [str(ticks["levels"][c * n + i]) for c in range(8)]
            cells += [str(ticks["flags"][i])]
            cells += [digits(ticks[k][i] / 1000) for k in ("lateness", "compute")]
            lines.append("\t".join(cells))
    print("\n".join(lines))


def make(name):
    """10 ticks a second; ticks 5, 6, 9 and 10; a force of 5 N that is cut to 2 N, a clutch."""
    nan = float("nan")
    hip = [(0, 0, 0), (-0.0, 1e-310, 0.5), (0.25, -1, 0.5), (0.25, -1, 1e300)]
    raw = [(0, 1, 0), (3, -4, 0), (nan, nan, nan), (0, 0.5, 0)]
    force = [(0, 1, 0), (1.2, -1.6, 0), (0, 0, 0), (0, 0.5, 0)]
    box = {"originX": -1, "originY": 0, "originZ": 0, "spacing": 0.5}
    box.update(countX=3, countY=2, countZ=2)
    header = {"magic": str(0x6861706772696473), "version": 1, "model": "ball", "box": box}
    header.update(rate=10, lengthUnit="m", flagNames=["clutch", "safety_clamped", "level_changed"])
    ticks = {"first": "5", "skipped": ["0", "0", "2", "0"], "flags": [0, 6, 1, 0]}
    ticks.update(lateness=[0, 1500, 100, 4294967295], compute=[1, 2, 3, 4])
    ticks.update(levels=[0] * 4 + [i % 2 for i in range(28)], hip=code(hip), rawForce=code(raw))
    ticks["force"] = code_force(force, raw)
    with open(name, "wb") as file:
        file.write(seal([{"header": header}, {"ticks": ticks}, {"footer": {"dropped": 0}}]))


failures = []


def refuse(what, data, message, option=()):
    """stats gives one line and exit code 1, and takes little memory. The line starts with `message`
    behind the file's name."""
    with open("bad.session", "wb") as file:
        file.write(data)

    def limit():
        if os.environ.get("SLOW") != "1":  # sanitizers reserve terabytes
            resource.setrlimit(resource.RLIMIT_AS, (200 << 20, 200 << 20))

    done = subprocess.run(
        ["stats", "--log", "bad.session", *option], capture_output=True, preexec_fn=limit, timeout=60
    )
    got = done.stderr.decode()
    wanted = "stats: bad.session: " + message
    good = done.returncode == 1 and done.stdout == b"" and got.count("\n") == 1
    if not good or not got.startswith(wanted):
        failures.append("%s: %d %s\n  wanted %s" % (what, done.returncode, got, wanted))


def bad(name):
    with open(name, "rb") as file:
        messages = decode(file.read())
    messages.insert(2, copy.deepcopy(messages[1]))
    messages[2]["ticks"]["first"] = "100"
    good = seal(messages)
    frames = shard.frames(good[:-LOCATOR])
    at = [sum(len(f) for f in frames[:i]) for i in range(len(frames) + 1)]
    with open("good.session", "wb") as file:
        file.write(good)
    subprocess.run(["stats", "--log", "good.session"], stdout=subprocess.DEVNULL, check=True)

    def change(kind, place=1, **fields):
        changed = copy.deepcopy(messages)
        changed[place][kind].update(fields)
        return changed

    def header(what, message, **fields):
        refuse(what, seal(change("header", 0, **fields)), "byte 0: " + message)

    header("magic", "not a session", magic="1")
    header("version", "format version 2, this program reads version 1", version=2)
    header("rate 0", "a rate of 0 Hz; ", rate=0)
    header("box", "box: spacing is -1", box=dict(messages[0]["header"]["box"], spacing=-1))
    header("many flags", "33 flags, the limit is 32", flagNames=["f"] * 33)
    header("long model", "a model's name of 300 bytes, the limit is 255", model="m" * 300)
    header("long settings", "settings of 600000 bytes, the limit is 524288", settings="s" * 600000)
    refuse("huge header", seal(change("header", 0, settings="s" * 2000000)),
           "byte 0: a message of 2000")

    def chunk(what, message, **fields):
        data = seal(change("ticks", **fields))
        size = len(shard.frame(shard.encode([messages[0]], SCHEMA)[0]))
        refuse(what, data, "byte %d: %s" % (size, message))

    ticks = messages[1]["ticks"]
    for column in ("flags", "lateness", "compute", "levels", "hip", "rawForce", "force"):
        chunk(column, "damaged: column %s does not fit the chunk" % column,
              **{column: ticks[column][1:]})
        chunk(column, "damaged: column %s does not fit the chunk" % column, **{column: []})
    wraps = change("ticks", skipped=["0", str(MASK)] + ticks["skipped"][2:])

    def last(footer):
        footer["chunks"][0]["last"] = int(messages[-1]["footer"]["chunks"][0]["last"])

    refuse("a number that wraps", seal(wraps, last), "byte %d: damaged: a tick's number" % at[1])
    early = change("ticks", skipped=["1"] + ticks["skipped"][1:])
    refuse("skipped at first", seal(early, last), "byte %d: damaged: ticks skipped before" % at[1])
    order = messages[:1] + [messages[2], messages[1]] + messages[3:]

    def index(what, edit, base=messages, message="damaged: the index does not fit the file"):
        data = seal(base, edit)
        at_footer = len(data) - LOCATOR - struct.unpack_from("<Q", data, len(data) - 16)[0]
        refuse(what, data, "byte %d: %s" % (at_footer, message))

    def set_in(entry, key, value):
        def edit(footer):
            (footer["chunks"][entry] if entry is not None else footer)[key] = value

        return edit

    index("chunks out of order", None, order)
    index("offset", set_in(1, "offset", 5))
    index("size", set_in(0, "size", 1 << 62))
    index("zero size", set_in(0, "size", 0))
    index("ticks", set_in(0, "ticks", 4097))
    index("sum", set_in(None, "ticks", 1))
    index("first above last", set_in(0, "first", 1 << 40))
    index("digest", set_in(None, "digestLow", 1),
          message="damaged: header and index do not fit the digest")
    index("a chunk twice", lambda f: f["chunks"].append(dict(f["chunks"][-1])))
    index("fewer chunks", lambda f: f["chunks"].pop())

    # A footer that claims a gigabyte, or a locator that leads elsewhere.
    bomb = shard.frame(bytes(1 << 30))
    large = "byte %d: damaged: an index larger than any can be" % at[-2]
    refuse("huge footer", seal(messages, footer_frame=bomb), large)
    large = "byte %d: a message of 4194304 bytes, the limit is " % at[-2]
    refuse("large footer", seal(messages, footer_frame=shard.frame(bytes(4 << 20))), large)
    behind = len(good) - LOCATOR
    refuse("locator outside", seal(messages, locator=1 << 63), "byte ")
    refuse("locator in a chunk", seal(messages, locator=behind - at[1] - 1), "byte ")
    refuse("locator at the header", seal(messages, locator=behind - 1), "byte ")
    refuse("a bomb instead of a header", bomb, "byte 0: a message of 1073741824 bytes")

    # Cuts: between frames, in frames, in the locator.
    hint = "truncated: no index at its end, as of a session that was interrupted (stats --salvage"
    for cut in at[1:] + [at[1] + 7, at[2] + 20, len(good) - 1, len(good) - LOCATOR]:
        refuse("cut at %d" % cut, good[:cut], "byte %d: %s" % (cut, hint))
    refuse("cut header", good[:40], "byte 0: not a session, or its header is cut")
    refuse("a cut header is beyond salvage", good[:40], "byte 0: not a session", option=["--salvage"])
    refuse("nothing behind the header", good[: at[1]], "a session without a tick",
           option=["--salvage"])
    refuse("something behind", good + b"x", "byte %d: %s" % (len(good) + 1, hint))
    if failures:
        sys.exit("\n".join(failures))


{"text": text, "make": make, "bad": bad}[sys.argv[1]](sys.argv[2])
