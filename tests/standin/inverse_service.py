#!/usr/bin/env python3
"""A stand-in for Haply's inverse service, for one client: the simulation channel of version 3.5.

    inverse_service.py RECORD [FAULT N]     FAULT: absent, deep, hang, close, at the N-th message

prints its port. As the real one it says first what there is, and then one state for each message. RECORD gets the
forces, as "force X Y Z" when they change, and "closed"."""
import asyncio
import json
import os
import sys

import websockets

record = open(sys.argv[1], "a", buffering=1)
fault, at = (sys.argv[2], int(sys.argv[3])) if len(sys.argv) > 3 else ("", 0)
# 25 mm to the left of the place where the client starts, 10 mm away from the user, 5 mm up.
state = {"cursor_position": {"z": 0.15, "y": -0.12, "x": 0.0}}
moved = {"cursor_position": {"z": 0.155, "y": -0.11, "x": -0.025}}
grip = {"device_id": "0001", "state": {"buttons": {"a": False, "b": True}}}
devices = [] if fault == "absent" else [{"device_id": "049D", "config": {"type": "inverse3"}, "state": state}]


async def serve(client):
    async def send(inverse3, **more):
        world = {**more, "inverse3": inverse3, "wireless_verse_grip": [grip]}
        await client.send("[" * 60000 if fault == "deep" else json.dumps(world))

    try:
        await send(devices, session_id=7)
        last, number = None, 0
        while True:
            command, = json.loads(await client.recv())["inverse3"]
            number += 1
            assert command["device_id"] == "049D", command
            vector = command["commands"]["set_cursor_force"]["vector"]
            force = " ".join(f"{vector[a]:.6g}" for a in "xyz")
            if force != last:
                print("force", force, file=record)
            last = force
            if fault == "hang" and number >= at:
                await asyncio.sleep(1000)
            if fault == "close" and number >= at:
                os._exit(0)
            await send([{"device_id": "049D", "state": moved}])
    except websockets.ConnectionClosed:
        print("closed", file=record)


async def main():
    async with websockets.serve(serve, "127.0.0.1", 0, ping_interval=None) as server:
        print(server.sockets[0].getsockname()[1], flush=True)
        await asyncio.Future()

asyncio.run(main())
