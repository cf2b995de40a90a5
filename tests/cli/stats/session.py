"""Sessions by the stock tools alone (zstd, capnp), without hapgrid's reader or writer.

session.py text FILE: prints a session, a line for each tick.
session.py make FILE: writes a small session whose numbers are known.
session.py bad FILE: feeds damaged and hostile relatives of a session to stats.
"""

import copy
import json
import math
import os
import resource
import struct
import subprocess
import sys

import numpy

sys.path.insert(0, os.path.join(os.environ["HAPGRID_SOURCE"], "tests", "cli"))
import shard

SCHEMA = os.path.join(os.environ["HAPGRID_SOURCE"], "schemas", "session.capnp")


def decode(data):
    """Its messages as JSON."""
    text = shard.run(
        ["capnp", "convert", "binary:json", "--short", SCHEMA, "Message"], shard.decompress(data)
    )
    return [json.loads(line) for line in text.splitlines()]


def seal(messages):
    """The bytes of a session."""
    return b"".join(shard.frame(m) for m in shard.encode(messages, SCHEMA))


def numbers(column, n):
    """The 64-bit numbers of a column, which has all first bytes, then all second ones: a row for each axis."""
    planes = numpy.array(column, numpy.uint8).reshape(-1, 8, n)
    return planes.transpose(0, 2, 1).copy().view("<u8")[..., 0]


def column(rows):
    """The opposite of numbers()."""
    return rows.astype("<u8").view(numpy.uint8).reshape(*rows.shape, 8).transpose(0, 2, 1).ravel().tolist()


def vectors(data, n):
    """x, y and z of the ticks as bits, from differences to the tick before: 2 d, or -2 d - 1 below 0."""
    u = numbers(data, n)
    return numpy.cumsum((u >> 1) ^ (-(u & 1)), axis=1, dtype=numpy.uint64)


def bits_of(rows):
    return numpy.array(rows, float).T.copy().view(numpy.uint64)


def code(rows):
    """The opposite of vectors()."""
    d = numpy.diff(bits_of(rows), axis=1, prepend=numpy.uint64(0)).view(numpy.int64)
    return column(((d << 1) ^ (d >> 63)).view(numpy.uint64))


def digits(x):
    return ("-" if math.copysign(1, x) < 0 else "") + "nan" if math.isnan(x) else "%.17g" % x


def text(name):
    with open(name, "rb") as file:
        messages = decode(file.read())
    rate = messages[0]["header"]["rate"]
    names = "# t x y z force_x force_y force_z sent_x sent_y sent_z l0 l1 l2 l3 l4 l5 l6 l7 flags lateness_us compute_us"
    print("# " + "\t".join(names[2:].split()))
    for message in messages[1:]:
        ticks = message["ticks"]
        n = len(ticks["skipped"])
        number = int(ticks.get("first", 0)) - 1
        raw = vectors(ticks["rawForce"], n)
        triples = [bits.view(float).T for bits in (vectors(ticks["hip"], n), raw, numbers(ticks["force"], n) ^ raw)]
        for i in range(n):
            number += int(ticks["skipped"][i]) + 1
            cells = [digits(x) for x in (number / rate, *(x for triple in triples for x in triple[i]))]
            cells += [str(ticks["levels"][c * n + i]) for c in range(8)] + [str(ticks["flags"][i])]
            print("\t".join(cells + [digits(ticks[k][i] / 1000) for k in ("lateness", "compute")]))


def make(name):
    """10 ticks a second; ticks 5, 6, 9 and 10; a force of 5 N that is cut to 2 N, a clutch."""
    nan = float("nan")
    hip = [(0, 0, 0), (-0.0, 1e-310, 0.5), (0.25, -1, 0.5), (0.25, -1, 1e300)]
    raw = [(0, 1, 0), (3, -4, 0), (nan, nan, nan), (0, 0.5, 0)]
    force = [(0, 1, 0), (1.2, -1.6, 0), (0, 0, 0), (0, 0.5, 0)]
    box = {"originX": -1, "originY": 0, "originZ": 0, "spacing": 0.5}
    box.update(countX=3, countY=2, countZ=2)
    header = {"magic": str(0x6861706772696473), "version": 2, "model": "ball", "box": box}
    header.update(rate=10, lengthUnit="m", flagNames=["clutch", "safety_clamped", "level_changed"])
    ticks = {"first": "5", "skipped": ["0", "0", "2", "0"], "flags": [0, 6, 1, 0]}
    ticks.update(lateness=[0, 1500, 100, 4294967295], compute=[1, 2, 3, 4])
    ticks.update(levels=[0] * 4 + [i % 2 for i in range(28)], hip=code(hip), rawForce=code(raw))
    ticks["force"] = column(bits_of(force) ^ bits_of(raw))
    with open(name, "wb") as file:
        file.write(seal([{"header": header}, {"ticks": ticks}]))


failures = []


def limit():
    if os.environ.get("SLOW") != "1":  # sanitizers reserve terabytes
        resource.setrlimit(resource.RLIMIT_AS, (200 << 20, 200 << 20))


def stats(data, *options):
    with open("bad.session", "wb") as file:
        file.write(data)
    return subprocess.run(
        ["stats", "bad.session", *options], capture_output=True, preexec_fn=limit, timeout=60
    )


def refuse(what, data, message):
    """stats gives one line and exit code 1, and takes little memory. The line starts with `message`
    behind the file's name."""
    done = stats(data)
    got = done.stderr.decode()
    wanted = "stats: bad.session: " + message
    good = done.returncode == 1 and done.stdout == b"" and got.count("\n") == 1
    if not good or not got.startswith(wanted):
        failures.append("%s: %d %s\n  wanted %s" % (what, done.returncode, got, wanted))


def end_early(what, data, ticks, at, message):
    """stats reports on the first `ticks` ticks, says that the session ends early at byte `at`, and
    takes little memory. What it says starts with `message`."""
    done = stats(data, "--format", "json")
    report = json.loads(done.stdout or "{}")
    wanted = "byte %d of %d: %s" % (at, len(data), message)
    good = done.returncode == 0 and done.stderr == b"" and report["ticks"] == ticks
    if not good or not report["ended_early"].startswith(wanted):
        failures.append("%s: %s\n  wanted %d ticks, %s" % (what, done, ticks, wanted))


def bad(name):
    with open(name, "rb") as file:
        messages = decode(file.read())
    for first in ("100", "200"):
        messages.append(copy.deepcopy(messages[1]))
        messages[-1]["ticks"]["first"] = first
    good = seal(messages)
    frames = shard.frames(good)
    at = [sum(len(f) for f in frames[:i]) for i in range(len(frames) + 1)]
    n = len(messages[1]["ticks"]["skipped"])
    done = stats(good, "--format", "json")
    assert (json.loads(done.stdout)["ticks"], json.loads(done.stdout)["ended_early"]) == (3 * n, None)

    def change(kind, place, **fields):
        changed = copy.deepcopy(messages)
        changed[place][kind].update(fields)
        return changed

    bomb = shard.frame(bytes(1 << 30))
    for what, message, fields in [
            ("version", "format version 1, this program reads version 2", {"version": 1}),
            ("rate 0", "a rate of 0 Hz; ", {"rate": 0}),
            ("box", "box: spacing is -1", {"box": dict(messages[0]["header"]["box"], spacing=-1)}),
            ("many flags", "33 flags, the limit is 32", {"flagNames": ["f"] * 33}),
            ("long model", "a model's name of 300 bytes, the limit is 255", {"model": "m" * 300}),
            ("long settings", "settings of 600000 bytes, the limit is 524288", {"settings": "s" * 600000})]:
        refuse(what, seal(change("header", 0, **fields)), "byte 0: " + message)
    # What does not begin as a session is taken for a grid.
    for what, data in [
            ("magic", seal(change("header", 0, magic="1"))),
            ("huge header", seal(change("header", 0, settings="s" * 2000000))),
            ("a bomb instead of a header", bomb),
            ("cut header", good[:40])]:
        refuse(what, data, f"byte {len(data)}: truncated: a shard ends with an index")
    refuse("nothing behind the header", good[: at[1]], "a session without a tick\n")
    refuse("no whole chunk", good[: at[1] + 9],
           "a session without a tick, which ended early at byte %d of %d: " % (at[1], at[1] + 9))

    # In the second chunk of three: the first is read.
    ticks = messages[2]["ticks"]
    columns = ("flags", "lateness", "compute", "levels", "hip", "rawForce", "force")
    for what, message, fields in [
            *((c, "column %s does not fit the chunk" % c, {c: ticks[c][1:]}) for c in columns),
            *((c, "column %s does not fit the chunk" % c, {c: []}) for c in columns),
            ("a number that wraps", "a tick's number is beyond 64 bits",
             {"skipped": ["0", str(2**64 - 1)] + ticks["skipped"][2:]}),
            ("skipped at first", "ticks skipped before", {"skipped": ["1"] + ticks["skipped"][1:]}),
            ("no tick", "a chunk of 0 ticks", {"skipped": []}),
            ("too many ticks", "a chunk of 4097 ticks", {"skipped": ["0"] * 4097}),
            # Two numbers are skipped in the first.
            *(("chunks out of order", "tick %d after tick %d" % (k, 5 + n + 1), {"first": str(k)}) for k in (0, 5 + n + 1))]:
        end_early(what, seal(change("ticks", 2, **fields)), n, at[2], "damaged: " + message)
    for what, message, frame in [
            ("a header again", "damaged: a chunk of ticks was expected", frames[0]),
            ("a bomb", "a message of 1073741824 bytes, the limit is 524288", bomb),
            ("no message", "not a session: no Cap'n Proto message", shard.frame(b"1234567")),
            ("an empty message", "damaged: ", shard.frame(bytes(8))),
            ("a frame to skip", "not a session: ", struct.pack("<II", 0x184D2A5E, 0)),
            ("no zstd frame", "a zstd frame is cut", b"x" * 1000),
            ("zeros", "a zstd frame is cut", bytes(5000))]:
        end_early(what, b"".join(frames[:2] + [frame] + frames[3:]), n, at[2], message)
    # Cuts: between zstd frames, where nothing can be seen, and in them.
    for chunks in (1, 2):
        done = stats(good[: at[chunks + 1]], "--format", "json")
        if done.returncode or done.stderr or json.loads(done.stdout)["ticks"] != chunks * n:
            failures.append("cut behind chunk %d: %s" % (chunks, done))
    for cut in (at[2] + 1, at[2] + 20, at[3] - 1):
        end_early("cut at %d" % cut, good[:cut], n, at[2], "a zstd frame is cut")
    end_early("something behind", good + b"x", 3 * n, at[4], "a zstd frame is cut")
    if failures:
        sys.exit("\n".join(failures))


{"text": text, "make": make, "bad": bad}[sys.argv[1]](sys.argv[2])
