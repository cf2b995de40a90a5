"""Clients of view --imd, written from the text of the protocol, with sockets and struct alone. What
must come is made of the frames of the file, which Cap'n Proto's tool has read.

usage: imd.py ball|spring SCHEMA FRAMES [LONG]

Viewers that sleep, never say GO or send nonsense are in unit/scene/imd_*_test.cpp and fuzz/.
"""
import json
import re
import socket
import struct
import subprocess
import sys

MODEL, SCHEMA, FRAMES = sys.argv[1:4]
DISCONNECT, ENERGIES, FCOORDS, GO, HANDSHAKE, KILL, MDCOMM, PAUSE, TRATE, IOERROR = range(10)
SESSIONINFO, RESUME, TIME, BOX, VELOCITIES, FORCES, WAIT = range(10, 17)
LONG = 60  # seconds for what must happen
# To angstrom: a model whose unit is not known is sent as it is.
LENGTH = {"ball": 1, "spring": 1e7}[MODEL]
NEWTON = 6.02214076e10  # kJ/(mol angstrom)


def header(kind, length=0):
    return struct.pack(">ii", kind, length)


class Client:
    """Finds out version and byte order."""

    def __init__(self, port):
        self.socket = socket.socket()
        self.socket.settimeout(LONG)
        self.socket.connect(("127.0.0.1", port))
        kind, = struct.unpack(">i", self.take(4))
        assert kind == HANDSHAKE, kind
        raw = self.take(4)
        self.order = next(o for o in "<>" if struct.unpack(o + "i", raw)[0] in (2, 3))
        self.version, = struct.unpack(self.order + "i", raw)
        assert self.order == {"little": "<", "big": ">"}[sys.byteorder]
        if self.version == 3:
            assert struct.unpack(">ii", self.take(8)) == (SESSIONINFO, 7)
            # Time, energies, box, coordinates, not wrapped, no velocities, forces.
            assert self.take(7) == bytes([1, 1, 1, 1, 0, 0, 1])

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

    def __init__(self, frames, *options):
        self.process = subprocess.Popen(["view", frames, "--imd=0", *options], stderr=subprocess.PIPE, text=True)
        line = self.process.stderr.readline()
        match = re.fullmatch(r"view: IMD version ([23]) on 127\.0\.0\.1:(\d+)\n", line)
        assert match, line + self.process.stderr.read()
        self.port = int(match[2])

    def end(self):
        """Lines on stderr after the first one; all went well."""
        err = self.process.stderr.read()  # communicate() would miss what is buffered already
        assert self.process.wait() == 0, (self.process.returncode, err)
        return err.splitlines()


def counts(lines):
    match = re.fullmatch(r"view: IMD viewers (\d+), frames sent (\d+), dropped (\d+); "
                         r"closed because they did not read (\d+)", lines[-1])
    assert match, lines
    return [int(n) for n in match.groups()]


def expected(name, version, order):
    """The bytes of each frame in the file `name`."""
    with open(name, "rb") as file:
        text = subprocess.run(["capnp", "convert", "binary:json", "--short", SCHEMA, "Message"],
                              stdin=file, capture_output=True, check=True, text=True).stdout
    # As floats also where the tool writes no point: -0 is no int.
    scene, *frames = (json.loads(line, parse_int=float) for line in text.splitlines())
    box = scene["scene"]["box"]
    pack = lambda form, *values: struct.pack(order + form, *values)
    floats = lambda values: pack(f"{len(values)}f", *values)
    result = []
    begin, after = (frame["frame"] for frame in frames[:2])
    tick_s = (after["time"] - begin["time"]) / (int(after["tick"]) - int(begin["tick"]))
    for frame in frames:
        f = frame["frame"]
        tick = int(f["tick"])
        atoms = len(f["centres"]) // 3 + 1
        energy = f["energy"]
        message = b""
        if version == 3:
            message += header(TIME, 1) + pack("ddq", tick_s * 1e12, f["time"] * 1e12, tick)
        message += header(ENERGIES, 1) + pack("i9f", tick, 0, energy, energy, *[0] * 6)
        if version == 3:
            edges = [LENGTH * box["spacing"] * (box["count" + axis] - 1) for axis in "XYZ"]
            message += header(BOX, 1)
            message += floats([edges[0], 0, 0, 0, edges[1], 0, 0, 0, edges[2]])
        hip = [f["position"][axis] for axis in "xyz"]
        message += header(FCOORDS, atoms) + floats([x * LENGTH for x in f["centres"] + hip])
        if version == 3:
            force = [f["force"][axis] * NEWTON for axis in "xyz"]
            message += header(FORCES, atoms) + floats([0] * (3 * atoms - 3) + force)
        result.append(message)
    return result


def exact():
    """A file waits for its first viewer, who gets each frame, byte for byte; a viewer that comes later has the end of
    them; units that nobody knows are named, and so is what of a viewer's wishes is ignored."""
    for version in 2, 3:
        view = View(FRAMES, "--imd-version", str(version))
        first = Client(view.port)
        second = Client(view.port)
        assert first.version == second.version == version
        first.socket.sendall(header(GO, 77) + header(TRATE, 5) + header(MDCOMM, 1) + b"x" * 16)
        try:
            second.socket.sendall(header(GO))
        except OSError:
            pass  # all is over already
        got = [first.rest(), second.rest()]
        frames = expected(FRAMES, version, first.order)
        assert got[0] == b"".join(frames)
        assert got[1] in [b"".join(frames[i:]) for i in range(len(frames) + 1)]
        lines = view.end()
        viewers, sent, dropped, slow = counts(lines)
        assert viewers in (1, 2) and dropped == slow == 0, lines
        assert sent >= len(frames) > 5, lines
        lengths = "view: IMD: lengths go out in rope lengths, viewers take them for angstrom"
        energies = {"ball": "N rope lengths", "spring": "N mm"}[MODEL]
        unit = {2: "kcal/mol", 3: "kJ/mol"}[version]
        assert (lengths in lines) == (MODEL == "ball"), lines
        assert f"view: IMD: energies go out in {energies}, viewers take them for {unit}" in lines
        for words in "sends forces; they are ignored", "asks for another rate (TRATE)":
            assert sum(words in line for line in lines) == 1, lines


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
    """The port is looked at before anything else."""
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        done = subprocess.run(["view", "none", f"--imd={port}"], capture_output=True, text=True)
    assert done.returncode == 1 and done.stdout == ""
    assert done.stderr == f"view: 127.0.0.1:{port}: Address already in use\n", done.stderr


exact()
if MODEL == "ball":
    in_use()
    ninth()
