#!/usr/bin/env python3
"""An adapter to a device that needs no hardware: a mass of 0.1 kg, which a hand draws along a slow circle
with a spring and a damper. Copy it for your own device: the lines marked HERE are all that is about it.

    play my.grid --device 'process:python3 examples/devices/handle.py'"""
import math
import os
import select
import signal
import struct
import sys
import time

GREETING = struct.Struct("<8s2I8d48s")  # the layouts of <hapgrid/device.h>
STATE, FORCE = struct.Struct("<4d2I"), struct.Struct("<3d2I")
REACH, SILENCE, RELEASES, END = 0.05, 0.1, 1, 1  # m, s, two flags
place, speed, now = [0.0] * 3, [0.0] * 3, time.monotonic()  # HERE


def move(force):  # HERE: applies the force in newtons; afterwards place and speed are what they are now
    global now
    passed, angle = min(time.monotonic() - now, 0.01), 0.5 * now
    now = time.monotonic()
    hand = REACH / 2 * math.cos(angle), REACH / 2 * math.sin(angle), 0
    for a in range(3):
        speed[a] += passed / 0.1 * (force[a] + 40 * (hand[a] - place[a]) - 4 * speed[a])
        place[a] = max(-REACH, min(REACH, place[a] + passed * speed[a]))


signal.signal(signal.SIGTERM, lambda *_: sys.exit(move((0, 0, 0))))
if sys.argv[-1] == "--release":  # an adapter was killed: no force
    sys.exit(move((0, 0, 0)))
os.write(1, GREETING.pack(b"hapgrid", 3, RELEASES, *[-REACH] * 3, *[REACH] * 3, 3.0, 1000.0, b"a handle on a spring"))
while True:
    if not select.select([0], [], [], SILENCE)[0]:  # play is silent: no force
        move((0, 0, 0))
        continue
    try:
        message = os.read(0, FORCE.size)
    except ConnectionResetError:
        message = b""
    *force, number, flags = FORCE.unpack(message or FORCE.pack(0, 0, 0, 0, END))  # play is gone: no force, and the end
    move(force)
    if number:
        os.write(1, STATE.pack(time.monotonic(), *place, 0, number))
    if flags & END:  # HERE: the force was zero; close the device
        break
