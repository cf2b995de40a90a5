"""Clients of view --imd, written from the text of the protocol, with sockets and struct alone. What
must come is made of the frames of the file, which Cap'n Proto's tool has read.

usage: imd.py ball|spring SCHEMA FRAMES [LONG]

What a viewer may say is in unit/view/imd_protocol_test.cpp and fuzz/.
"""
import json
import os
import re
import socket
import struct
import subprocess
import sys

MODEL, SCHEMA, FRAMES = sys.argv[1:4]
DISCONNECT, ENERGIES, FCOORDS, GO, HANDSHAKE, KILL, MDCOMM, PAUSE, TRATE, IOERROR = range(10)
LONG = 60  # seconds for what must happen
# To angstrom: a model whose unit is not known is sent as it is.
LENGTH = {"ball": 1, "spring": 1e7}[MODEL]


def header(kind, length=0):
    return struct.pack(">ii", kind, length)


class Client:
    """Finds out the byte order."""

    def __init__(self, port, buffer=0):
        self.socket = socket.socket()
        if buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
        self.socket.settimeout(LONG)
        self.socket.connect(("127.0.0.1", port))
        kind, = struct.unpack(">i", self.take(4))
        assert kind == HANDSHAKE, kind
        raw = self.take(4)
        self.order = next(o for o in "<>" if struct.unpack(o + "i", raw)[0] == 2)
        assert self.order == {"little": "<", "big": ">"}[sys.byteorder]

    def take(self, size):
        data = b""
        while len(data) < size:
            part = self.socket.recv(size - len(data))
            assert part, "the server closed"
            data += part
        return data

    def rest(self):
        """All until the server closes."""
        data = bytearray()
        try:
            while part := self.socket.recv(1 << 16):
                data += part
        except ConnectionResetError:
            pass
        self.socket.close()
        return bytes(data)


class View:
    """view --imd of a file; `port` is the one that the system chose."""

    def __init__(self, frames):
        self.process = subprocess.Popen(["view", frames, "--imd=0"], stderr=subprocess.PIPE, text=True)
        line = self.process.stderr.readline()
        match = re.fullmatch(r"view: IMD on 127\.0\.0\.1:(\d+)\n", line)
        assert match, line + self.process.stderr.read()
        self.port = int(match[1])

    def end(self):
        """Lines on stderr after the first one; all went well."""
        err = self.process.stderr.read()  # communicate() would miss what is buffered already
        assert self.process.wait() == 0, (self.process.returncode, err)
        return err.splitlines()


def counts(lines):
    match = re.fullmatch(r"view: IMD viewers (\d+), frames sent (\d+)", lines[-1])
    assert match, lines
    return [int(n) for n in match.groups()]


def decoded(name, **options):
    """The scene of a file, and its frames."""
    with open(name, "rb") as file:
        text = subprocess.run(["capnp", "convert", "binary:json", "--short", SCHEMA, "Message"],
                              stdin=file, capture_output=True, check=True, text=True).stdout
    return [json.loads(line, **options) for line in text.splitlines()]


def expected(name, order):
    """The bytes of each frame in the file `name`."""
    _, *frames = decoded(name, parse_int=float)  # also where the tool writes no point: -0 is no int
    result = []
    for frame in frames:
        f = frame["frame"]
        places = [x * LENGTH for x in f["centres"] + [f["position"][axis] for axis in "xyz"]]
        result.append(header(ENERGIES, 1) + struct.pack(order + "i9f", int(f["tick"]), 0, f["energy"], f["energy"], *[0] * 6) +
                      header(FCOORDS, len(places) // 3) + struct.pack(f"{order}{len(places)}f", *places))
    return result


def whole(data, frames):
    """How many frames there are in the data: each is one of the frames, byte for byte, and newer than the one before.
    A busy machine may leave some out."""
    size, after, count = len(frames[0]), 0, 0
    assert len(data) % size == 0, (len(data), size)
    for at in range(0, len(data), size):
        after = frames.index(data[at:at + size], after) + 1
        count += 1
    return count


def exact():
    """A file waits for its first viewer, and is shown to all until its last frame; a pause is over at a second one; units
    that nobody knows are named, and so is what of a viewer's wishes is ignored."""
    view = View(FRAMES)
    first, second = Client(view.port), Client(view.port)
    first.socket.sendall(header(GO, 77) + header(TRATE, 5) + header(MDCOMM, 1) + b"x" * 16 + 2 * header(PAUSE))
    try:
        second.socket.sendall(header(GO))
    except OSError:
        pass  # all is over already
    got = [first.rest(), second.rest()]
    frames = expected(FRAMES, first.order)
    assert got[0].endswith(frames[-1])
    told = whole(got[0], frames) + whole(got[1], frames)
    lines = view.end()
    viewers, sent = counts(lines)
    assert viewers in (1, 2) and sent >= told >= 1, (lines, told)
    lengths = "view: IMD: lengths go out in rope lengths, viewers take them for angstrom"
    energies = {"ball": "N rope lengths", "spring": "N mm"}[MODEL]
    assert (lengths in lines) == (MODEL == "ball"), lines
    assert f"view: IMD: energies go out in {energies}, viewers take them for kcal/mol" in lines
    for words in "sends forces; they are ignored", "asks for another rate (TRATE)":
        assert sum(words in line for line in lines) == 1, lines


def rude():
    """Who says nothing, half a word or a wrong one is closed, and so is who does not read, in the middle of a frame; who
    reads gets the frames meanwhile. Frames of 20,000 balls are more than a socket takes."""
    vector = lambda x: {"x": x, "y": 0, "z": 0}
    with open("large.frames", "wb") as file:
        convert = subprocess.Popen(["capnp", "convert", "json:binary", SCHEMA, "Message"], stdin=subprocess.PIPE, stdout=file)
        scene, frame = decoded(FRAMES)[:2]
        balls = 20000
        scene["scene"]["spheres"] = scene["scene"]["spheres"][:1] * balls
        frame["frame"]["centres"] = [0] * 3 * balls
        messages = [scene]
        for k in range(36):  # 0.25 s apart, longer than view is patient
            messages.append({"frame": {**frame["frame"], "time": 0.25 * k, "tick": str(250 * k), "position": vector(k)}})
        convert.communicate("\n".join(map(json.dumps, messages)).encode())
        assert convert.returncode == 0
    view = View("large.frames")
    for words in b"", b"\0\0\0", header(ENERGIES, 1):
        client = Client(view.port)
        client.socket.sendall(words)
        assert client.rest() == b"", words
    asleep, awake = Client(view.port, 4096), Client(view.port)
    for client in asleep, awake:
        client.socket.sendall(header(GO))
    data = awake.rest()
    size = 2 * len(header(FCOORDS)) + 40 + 12 * (balls + 1)
    assert len(data) % size == 0 and len(data) > size, len(data)
    assert counts(view.end())[0] == 2
    assert len(asleep.rest()) % size != 0


def ninth():
    """Eight can watch; one more is closed, and a line says so. The file lasts long enough for them to come."""
    view = View(sys.argv[4])
    clients = [Client(view.port) for _ in range(8)]
    for client in clients[1:]:
        client.socket.sendall(header(GO))
    other = socket.create_connection(("127.0.0.1", view.port), LONG)
    try:
        assert other.recv(1) == b""
    except ConnectionResetError:
        pass
    for client in clients:
        client.socket.close()
    while line := view.process.stderr.readline():
        if "one more viewer came and was sent away: 8 can watch" in line:
            break
    else:
        raise AssertionError("no line on the ninth viewer")
    view.process.kill()
    view.process.wait()


def in_use():
    """The port is looked at before anything is read."""
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        # libwebsockets loses 72 bytes when it cannot bind.
        done = subprocess.run(["view", "/dev/null", f"--imd={port}"], capture_output=True, text=True,
                              env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"})
    assert done.returncode == 1 and done.stdout == ""
    assert done.stderr == f"view: cannot listen on port {port} of 127.0.0.1: is another program there?\n", done.stderr


exact()
if MODEL == "ball":
    in_use()
    ninth()
    rude()
