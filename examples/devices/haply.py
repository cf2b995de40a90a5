#!/usr/bin/env python3
"""An adapter to Haply's Inverse3 and MinVerse, by the inverse service of their maker (PORT: 10001), whose axes are
those of play: play my.grid --device 'process:python3 examples/devices/haply.py [PORT]'
The middle of the reach is where the handle is at the start."""
import json, socket, struct, sys, time
sys.excepthook = lambda kind, error, trace: print(f"haply.py: {kind.__name__}: {error}", file=sys.stderr)
service = socket.create_connection(("localhost", int(sys.argv[1]) if len(sys.argv) > 1 else 10001))
service.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n")
lines = service.makefile("rb")
list(iter(lambda: lines.readline().strip(), b""))  # the answer in HTTP


def hear():  # one text of RFC 6455
    kind, size = lines.read(2) or sys.exit("haply.py: the service is gone")
    size = size if size < 126 else int.from_bytes(lines.read(2 if size == 126 else 8), "big")
    return json.loads(lines.read(size)) if kind == 0x81 else sys.exit("haply.py: the service sent no text")


first, play, end = hear()["inverse3"][0], socket.socket(fileno=0), False  # it is standard output, too
name, place = first["config"]["type"], [first["state"]["cursor_position"][a] for a in "xyz"]
reach = 0.04 if name == "minverse" else 0.1
play.settimeout(0.1)
play.send(struct.pack("<8s2I8d48s", b"hapgrid", 1, 3, *[x - reach for x in place], *[x + reach for x in place], 3, 1000,
                      f"Haply {name}".encode()))
while not end:
    try:
        message = play.recv(32) or struct.pack("<28xI", 1)  # when play is gone
    except TimeoutError:
        message = bytes(32)  # when it is silent
    *force, number, end = struct.unpack("<3d2I", message)
    commands = {"set_cursor_force": {"vector": dict(zip("xyz", force))}}
    text = json.dumps({"inverse3": [{"device_id": first["device_id"], "commands": commands}]}).ljust(126).encode()
    service.sendall(struct.pack(">BBH4x", 0x81, 0xFE, len(text)) + text)  # masked by zeros
    world = hear()
    hand = [world["inverse3"][0]["state"][v][a] for v in ("cursor_position", "cursor_velocity") for a in "xyz"]
    grips = world.get("wireless_verse_grip") or world.get("verse_grip") or [{"state": {"buttons": {}}}]
    pressed = sum(bit for key, bit in (("a", 1), ("b", 2)) if grips[0]["state"]["buttons"].get(key))
    if number:
        play.send(struct.pack("<7d2I", time.monotonic(), *hand, pressed, number))
