#!/usr/bin/env python3
"""An adapter to Haply's Inverse3 and MinVerse, by the inverse service of their maker (PORT: 10001), whose axes are
those of play. It needs python3-websockets: play my.grid --device 'process:python3 examples/devices/haply.py [PORT]'
The middle of the reach is where the handle is at the start."""
import asyncio
import json
import signal
import socket
import struct
import sys
import time

import websockets

play = socket.socket(fileno=0)  # it is standard output, too
RELEASES, END = 1, 1


async def exchange(service, device, force):
    """Sends a force, and reads what there is then."""
    commands = {"set_cursor_force": {"vector": dict(zip("xyz", force))}}
    await service.send(json.dumps({"inverse3": [{"device_id": device, "commands": commands}]}))
    return json.loads(await service.recv())


async def serve(service, device, end, wait):
    while not end.is_set():
        try:
            message = await asyncio.wait_for(asyncio.get_running_loop().sock_recv(play, 32), 0.1)
        except asyncio.TimeoutError:
            message = bytes(32)  # play is silent
        except ConnectionResetError:
            message = b""  # it is gone
        *force, number, flags = struct.unpack("<3d2I", message or struct.pack("<3d2I", 0, 0, 0, 0, END))
        world = await asyncio.wait_for(exchange(service, device, force), wait)
        hand = [world["inverse3"][0]["state"]["cursor_position"][a] for a in "xyz"]
        grips = world.get("wireless_verse_grip") or world.get("verse_grip") or [{"state": {"buttons": {}}}]
        pressed = sum(bit for key, bit in (("a", 1), ("b", 8)) if grips[0]["state"]["buttons"].get(key))
        if number:
            play.send(struct.pack("<4d2I", time.monotonic(), *hand, pressed, number))
        if flags & END:
            return
    await exchange(service, device, (0, 0, 0))  # told to end


async def main(words):
    play.setblocking(False)
    end = asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, end.set)
    async with websockets.connect(f"ws://localhost:{words[0] if words else 10001}", close_timeout=0.1) as service:
        first = json.loads(await service.recv())["inverse3"][0]
        if sys.argv[-1] == "--release":
            return await exchange(service, first["device_id"], (0, 0, 0))
        name, place = first["config"]["type"], [first["state"]["cursor_position"][a] for a in "xyz"]
        reach = 0.04 if name == "minverse" else 0.1
        play.send(struct.pack("<8s2I8d48s", b"hapgrid", 3, RELEASES, *[x - reach for x in place],
                              *[x + reach for x in place], 3, 1000, f"Haply {name}".encode()))
        await serve(service, first["device_id"], end, 1)

try:
    asyncio.run(main([word for word in sys.argv[1:] if word != "--release"]))
except Exception as error:
    try:
        play.send(f"error: {type(error).__name__}: {error}".encode()[:400])
    except OSError:
        print(f"haply.py: {error}", file=sys.stderr)
    sys.exit(1)
