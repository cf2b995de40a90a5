"""Shards that are sealed again after a fault was put in: checksums are right, content is not."""

import copy
import json
import os
import re
import shutil
import subprocess

from filters import *


def crafted(name, kind, message, change, commands=None, may_pass=False, **options):
    """`change` changes the messages; checksums, digests and what the footer says of chunks are right."""
    def work():
        messages = shard.decode(READERS[kind][0])
        change(messages)
        try:
            bad = shard.seal(messages, **options)
        except subprocess.CalledProcessError as error:
            failures.append("%s: %s: the fault was not made: %s" % (name, kind, error))
            return
        for command in commands or READERS[kind][1]:
            # A part of expand does not read a chunk that says it has no frontier.
            refused(name, command, bad, message, may_pass and command == "expand BAD")
    if ONLY in name:
        later(work)


def header(box={}, **changes):
    return lambda messages: messages[0]["header"].update(changes, box={**messages[0]["header"]["box"], **box})


# Sealed without a fault they are what they were (but for the compressor's level): else the faults
# below would prove nothing.
for kind, (whole, commands) in READERS.items():
    again, before = shard.decode(shard.seal(shard.decode(whole))), shard.decode(whole)
    for messages in (again, before):
        messages[-1]["footer"].pop("headerSize")
        for chunk in messages[-1]["footer"]["chunks"]:
            chunk.pop("size")
    assert again == before, kind

BEYOND = 12  # points of the ball's box
SEED_COMMANDS = {"both": None, "model": ["expand BAD", "expand --complete BAD", "merge BAD", "verify BAD"], "expand": ["expand BAD"]}
for row in read(os.path.join(os.path.dirname(os.path.abspath(__file__)), "headers.tsv")).decode().splitlines():
    if row[0] != "#":
        kinds, name, message, changes = row.split("\t")
        for kind in ("seeds", "requests")[:1 + (kinds == "both")]:
            crafted(name, kind, message, header(**json.loads(changes)), SEED_COMMANDS[kinds])
for kind in ("seeds", "requests"):
    crafted("no header", kind, "no header where", lambda m: m.__setitem__(0, copy.deepcopy(m[1])))
crafted("model name", "seeds", "a plug-in's name has only letters", header(model="x" * 100000), SEED_COMMANDS["model"])


def parameters(*list):
    return header(parameters=list)


crafted("many parameters", "seeds", "parameter|message of", parameters(*({"key": "k%d" % i, "value": {"numbers": [0] * 100}} for i in range(2000))), ["expand BAD"])


def column(kind, **changes):
    """Each change gets the column's list, or replaces it."""
    def edit(messages):
        rows = messages[1]["requests" if kind.endswith("requests") else "records"]
        for name, change in changes.items():
            rows[name] = change(rows.get(name, [])) if callable(change) else change
    return edit


def put(row, value):
    def change(values):
        values = list(values)
        values[row] = value
        return values
    return change


def swap_rows(messages):
    rows = messages[1]["requests" if "requests" in messages[1] else "records"]
    size = len(rows["point"])
    for name, values in rows.items():
        width = len(values) // size
        rows[name] = values[width : 2 * width] + values[:width] + values[2 * width :]


def repeat_row(messages):
    rows = messages[1]["requests" if "requests" in messages[1] else "records"]
    size = len(rows["point"])
    for name, values in rows.items():
        rows[name] = values[: len(values) // size] + values


# A chunk without frontier, as its footer says, is not looked at where no request leads; and then the
# source of a request is not there.
UNREAD = "asks for no such conversion"
for kind in ("seeds", "requests", "toy.requests"):
    crafted("point outside", kind, "point %s is outside the box" % ("6" if kind.startswith("toy") else BEYOND),
            column(kind, point=put(-1, 6 if kind.startswith("toy") else BEYOND)))
    crafted("point far outside", kind, "point 4294967295 is outside the box", column(kind, point=put(-1, 4294967295)))
    crafted("level beyond", kind, "level 8 at point [0-9]+, the limit is 8", column(kind, level=put(0, 8)))
    crafted("level 255", kind, "level 255 at point [0-9]+, the limit is 8", column(kind, level=put(-1, 255)))
    if not kind.startswith("toy"):  # its first rows have one point
        crafted("rows out of order", kind, "rows out of order at point", swap_rows)
    crafted("row twice", kind, "rows out of order at point", repeat_row)
    names = {"seeds": ["level", "generation", "state", "links"]}
    for name in names.get(kind, ["directions", "level", "state"]):
        crafted("column %s short" % name, kind, "column %s does not fit the chunk" % name, column(kind, **{name: lambda v: v[:-1]}))
        crafted("column %s long" % name, kind, "column %s does not fit the chunk|chunks out of order" % name, column(kind, **{name: lambda v: v + v[:1]}))
        crafted("column %s empty" % name, kind, "column %s does not fit the chunk|%s" % (name, UNREAD), column(kind, **{name: []}), may_pass=True)
    everything = {"links", "generation", "directions", "level", "state", "point"}
    crafted("no rows", kind, "a chunk without rows|" + UNREAD, lambda m, k=kind: column(k, **{n: [] for n in everything & set(next(iter(m[1].values())))})(m), may_pass=True)
    # What it says of a chunk.
    for name, value in (("rows", 1), ("frontier", 3), ("firstPoint", 7), ("lastPoint", 1), ("conversions", 5), ("digestLow", "1"), ("digestHigh", "1")):
        def edit(footer, name=name, value=value):
            footer["chunks"][0][name] = value
        message = "does not fit (what the footer says|the footer's digest)|chunks out of order"
        crafted("footer's %s" % name, kind, message, lambda m: None, edit=edit)
    crafted("footer's digest", kind, "digest in the footer does not fit", lambda m: None, edit_last=lambda f: f.update(digestLow="1"))
    crafted("footer's digest", kind, "digest in the footer does not fit", lambda m: None, edit_last=lambda f: f.update(digestHigh="1"))
    crafted("a header changed", kind, "digest in the footer does not fit",
            lambda m: m[0]["header"].update(toleranceUnit="furlong"),
            edit_last=lambda f, k=kind: f.update({n: shard.decode(READERS[k][0])[-1]["footer"][n] for n in ("digestLow", "digestHigh")}))
    crafted("more chunks", kind, "truncated: the footer's section is larger", lambda m: None, edit=lambda f: f["chunks"].append(f["chunks"][0]))
    crafted("fewer chunks", kind, "damaged|truncated", lambda m: None, edit=lambda f: f["chunks"].clear())
    crafted("100,000 chunks", kind, "truncated: the footer's section is larger", lambda m: None, edit=lambda f: f.update(chunks=f["chunks"] * 100000))
    for size in (0, 1, 4294967295):
        crafted("a chunk's size", kind, "damaged|truncated", lambda m: None, edit=lambda f, size=size: f["chunks"][0].update(size=size))
        crafted("the header's size", kind, "damaged|truncated|no zstd frame", lambda m: None, edit=lambda f, size=size: f.update(headerSize=size))
    # Content of another kind.
    content = "grid" if "requests" in kind else "requests"
    crafted("content %s" % content, kind, "holds|expected|a second grid|but no grid|damaged", header(content=content))

crafted("generation from the future", "seeds", "a record of generation 1", column("seeds", generation=put(-1, 1)))
crafted("generation from the future", "seeds", "a record of generation 4294967295", column("seeds", generation=put(0, 4294967295)))
for kind in ("requests", "toy.requests"):
    for q in (26, 27, 31):
        crafted("direction %d" % q, kind, "a request that leaves the box|column state does not fit", column(kind, directions=lambda v, q=q: [v[0] | 1 << q] + v[1:]))
    crafted("request to outside", kind, "a request that leaves the box|column state does not fit", column(kind, directions=put(-1, 1 << 25)))
    crafted("a record without requests", kind, "a record without requests|column state does not fit", column(kind, directions=put(0, 0)))
    crafted("a request less", kind, "column state does not fit the chunk", column(kind, directions=lambda v: [v[0] & (v[0] - 1)] + v[1:]))
for number in ("NaN", "Infinity", "-Infinity"):
    for row in (0, -1):
        crafted("state %s" % number, "requests", "a request's state is not finite", column("requests", state=put(row, number)))
        crafted("state %s" % number, "toy.requests", "a request's state is not finite", column("toy.requests", state=put(row, number)))

# Levels that do not start at 0, and links that were settled before their time.
crafted("level 1 alone", "seeds", "level 1 where level 0 (of at most 8 )?was expected", column("seeds", level=put(0, 1)),
        ["expand --complete BAD", "merge BAD requests", "stats BAD", "verify BAD"])
crafted("settled too early", "seeds", "the grid's frontier asks for no such conversion",
        column("seeds", links=lambda v: [0 if x == 254 else x for x in v]), ["merge BAD requests", "expand --complete BAD"])
crafted("unsettled outside", "seeds", "requests are missing|asks for no such", column("seeds", links=lambda v: [254] * len(v)), ["merge BAD requests"])

# Lists that were encoded with elements of another size: a schema that differs in one column.
SCHEMA = read(shard.SCHEMA).decode()
shutil.copy(os.path.join(os.path.dirname(shard.SCHEMA), "common.capnp"), ".")
for kind, name, old, types in (
    ("seeds", "point @0", "List(UInt32)", ("List(UInt64)", "List(UInt16)", "List(UInt8)", "List(Bool)", "List(Void)", "List(Float32)")),
    ("seeds", "generation @2", "List(UInt32)", ("List(UInt64)", "List(UInt16)", "List(Bool)", "List(Void)")),
    ("seeds", "state @3", "List(Float64)", ("List(Float32)", "List(UInt8)", "List(Void)", "List(Bool)", "List(Text)")),
    ("seeds", "links @4", "Data", ("List(UInt16)", "List(UInt32)", "List(Void)")),
    ("seeds", "level @1", "Data", ("List(UInt64)", "List(Bool)", "List(Void)")),
    ("requests", "point @0", "List(UInt32)", ("List(UInt64)", "List(UInt16)", "List(Void)")),
    ("requests", "level @1", "Data", ("List(UInt64)", "List(Bool)")),
    ("requests", "directions @2", "List(UInt32)", ("List(UInt64)", "List(UInt16)", "List(Void)")),
    ("requests", "state @3", "List(Float64)", ("List(Float32)", "List(Void)", "List(Text)")),
):
    struct_name = "RequestChunk" if kind == "requests" else "RecordChunk"
    for other in types:
        begin = SCHEMA.index("struct %s " % struct_name)
        field = SCHEMA.index("%s :%s;" % (name, old), begin)
        text = SCHEMA[:field] + "%s :%s;" % (name, other) + SCHEMA[field + len("%s :%s;" % (name, old)) :]
        file = "other.%d.capnp" % next(numbers)
        with open(file, "w") as stream:
            stream.write(text)

        def edit(messages, name=name.split()[0], other=other):
            rows = next(iter(messages[1].values()))
            convert = {"Bool": bool, "Void": lambda v: None, "UInt16": lambda v: v % 65536, "UInt8": lambda v: v % 256, "Text": lambda v: "x"}
            rows[name] = list(map(convert.get(other[5:-1], lambda v: v), rows[name]))
        # Four bytes are four bytes, whatever they are called.
        message = "damaged|does not fit|" + UNREAD
        if other == "List(Float32)" and "point" in name:
            message = "outside the box|damaged"
        crafted("%s as %s" % (name, other), kind, message, edit, schema=file, may_pass=True)

# Kinds of values that a later version may have.
future = re.sub(r"(texts @5 :List\(Text\);)", r"\1\n    complex @6 :Float64;", SCHEMA)
future = re.sub(r"(enum Content \{)", r"\1\n    beyond @2;", future)
future = re.sub(r"(enum Norm \{)", r"\1\n    median @3;", future)
future = re.sub(r"(footer @3 :Footer;)", r"\1\n    more @4 :UInt64;", future)
with open("future.capnp", "w") as stream:
    stream.write(future)
crafted("parameter of another kind", "seeds", "a parameter of a kind that this version does not know",
        parameters({"key": "radius", "value": {"complex": 1}}), schema="future.capnp")
crafted("tolerance function of another kind", "seeds", "a tolerance function of a kind that this version does not know",
        header(equality={"norm": "median"}), schema="future.capnp")
crafted("content of another kind", "seeds", "content", header(content="beyond"), schema="future.capnp")


def message_of_another_kind():
    body = shard.encode([{"more": "1"}], "future.capnp")
    parts = shard.frames(SEEDS)
    refused("message of another kind", "expand BAD", shard.joined([*parts[:2], shard.frame(body[0])]), "no footer where there must be one")


later(message_of_another_kind)
