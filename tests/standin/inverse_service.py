#!/usr/bin/env python3
"""A stand-in for Haply's inverse service, for one client: the simulation channel of version 3.5.

    inverse_service.py RECORD [FAULT N]     FAULT: absent, deep, hang, close, at the N-th message

prints its port. As the real one it says first what there is, and then one state for each message. RECORD gets the
forces, as "force X Y Z" when they change, and "closed". When its client is gone, so is the force."""
import base64
import hashlib
import json
import socket
import struct
import sys
import time

record = open(sys.argv[1], "a", buffering=1)
fault, at = (sys.argv[2], int(sys.argv[3])) if len(sys.argv) > 3 else ("", 0)
listener = socket.create_server(("localhost", 0))
print(listener.getsockname()[1], flush=True)
client, _ = listener.accept()
lines = client.makefile("rb")
request = lines.readline()
assert request == b"GET / HTTP/1.1\r\n", request
headers = {}
while line := lines.readline().strip():
    key, value = line.decode().split(": ", 1)
    headers[key.lower()] = value
assert headers["upgrade"] == "websocket" and headers["sec-websocket-version"] == "13", headers
assert len(base64.b64decode(headers["sec-websocket-key"])) == 16, headers
accept = base64.b64encode(hashlib.sha1(
    (headers["sec-websocket-key"] + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest()).decode()
client.sendall(f"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
               f"Sec-WebSocket-Accept: {accept}\r\n\r\n".encode())


def send(world, kind=1):
    text = b"[" * 60000 if fault == "deep" else json.dumps(world).encode()
    size = struct.pack(">B", len(text)) if len(text) < 126 else struct.pack(">BH", 126, len(text))
    client.sendall(bytes([0x80 | kind]) + size + text)


def receive():
    head = lines.read(2)
    if len(head) < 2 or head[0] & 15 == 8:
        return None
    assert head[0] == 0x81 and head[1] & 0x80, head  # a whole text, masked
    size = head[1] & 0x7F
    if size == 126:
        size, = struct.unpack(">H", lines.read(2))
        assert size >= 126  # the shortest form
    mask = lines.read(4)
    return json.loads(bytes(c ^ mask[i % 4] for i, c in enumerate(lines.read(size))))


# 25 mm to the left of the place where the client starts, 10 mm away from the user, 5 mm up.
state = {"cursor_position": {"z": 0.15, "y": -0.12, "x": 0.0}}
moved = {"cursor_position": {"z": 0.155, "y": -0.11, "x": -0.025}}
grip = {"device_id": "0001", "state": {"buttons": {"a": False, "b": True}}}
devices = [] if fault == "absent" else [{"device_id": "049D", "config": {"type": "inverse3"}, "state": state}]
send({"session_id": 7, "inverse3": devices, "wireless_verse_grip": [grip]})
last, number = None, 0
while (message := receive()) is not None:
    number += 1
    command, = message["inverse3"]
    assert command["device_id"] == "049D", command
    vector = command["commands"]["set_cursor_force"]["vector"]
    force = " ".join(f"{vector[a]:.6g}" for a in "xyz")
    if force != last:
        print("force", force, file=record)
    last = force
    if fault == "hang" and number >= at:
        time.sleep(1000)
    if fault == "close" and number >= at:
        sys.exit(0)
    send({"session_id": 7, "inverse3": [{"device_id": "049D", "state": moved}], "wireless_verse_grip": [grip]})
print("closed", file=record)
