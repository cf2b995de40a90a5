#!/usr/bin/env python3
"""The device process behind the stand-in for hidapi (hidapi.c), for scripts.

    device.py SOCKET LOG [INFO]     INFO: the line that hid_enumerate gives, its tabs as they are

takes commands, a line each, on its standard input, and appends what is written to the device to LOG,
a report a line in hex behind "w " or "f " (feature). It prints "ready" when SOCKET is there.

    input HEX          an input report, sent once to each handle
    repeat HZ HEX      the same report, HZ times a second from now on; 0: no more
    error TEXT         hid_read fails
    hold, release      writes are not answered, or are again
    fail N             the next N writes fail
    vanish             every handle is closed, and no new one is taken
    quit               as does the end of its input
"""

import os
import selectors
import socket
import struct
import sys
import time


def main():
    path, log_name = sys.argv[1:3]
    info = sys.argv[3] + "\n" if len(sys.argv) > 3 else ""
    log = open(log_name, "a", buffering=1)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    listener.bind(path)
    listener.listen(16)
    select = selectors.DefaultSelector()
    select.register(listener, selectors.EVENT_READ)
    select.register(sys.stdin.fileno(), selectors.EVENT_READ)
    kinds, held = {}, []
    holding, failing, period, report, due = False, 0, 0.0, b"", 0.0
    text = b""

    def send(connection, message):
        try:
            connection.send(message, socket.MSG_DONTWAIT)
        except OSError:
            pass  # no room, or gone: as hidraw

    def to_inputs(message):
        for connection, kind in kinds.items():
            if kind == "I":
                send(connection, message)

    def answer(connection, n, rest=b""):
        send(connection, b"r" + struct.pack("=i", n) + rest)

    def drop(connection):
        select.unregister(connection)
        kinds.pop(connection, None)
        held[:] = [h for h in held if h[0] is not connection]
        connection.close()

    print("ready", flush=True)
    while True:
        left = max(0.0, due - time.monotonic()) if period else None
        for key, _ in select.select(left):
            if key.fileobj is listener:
                connection, _ = listener.accept()
                kinds[connection] = ""
                select.register(connection, selectors.EVENT_READ)
            elif key.fd == 0:
                got = os.read(0, 65536)
                if not got:
                    return
                text += got
                *lines, text = text.split(b"\n")
                for line in lines:
                    word, _, rest = line.decode().partition(" ")
                    if word == "input":
                        to_inputs(b"i" + bytes.fromhex(rest))
                    elif word == "repeat":
                        rate, _, digits = rest.partition(" ")
                        period = 1 / float(rate) if float(rate) else 0.0
                        report, due = bytes.fromhex(digits), time.monotonic()
                    elif word == "error":
                        to_inputs(b"e" + rest.encode())
                    elif word == "hold":
                        holding = True
                    elif word == "release":
                        holding = False
                        for connection, n in held:
                            answer(connection, n)
                        held.clear()
                    elif word == "fail":
                        failing = int(rest)
                    elif word == "vanish":
                        if listener in select.get_map():
                            select.unregister(listener)
                            listener.close()
                        for connection in list(kinds):
                            drop(connection)
                    elif word == "quit":
                        return
                    else:
                        sys.exit(f"device.py: unknown command {word}")
            elif key.fileobj in kinds:
                connection = key.fileobj
                try:
                    message = connection.recv(8192)
                except OSError:
                    message = b""
                if not message:
                    drop(connection)
                elif not kinds[connection]:
                    kinds[connection] = chr(message[0])
                    if message[:1] == b"C":
                        send(connection, b"k")
                    elif message[:1] == b"L":
                        send(connection, info.encode() or b"\n")
                elif message[:1] == b"g":
                    answer(connection, -1, b"no such report")
                else:
                    log.write(f"{chr(message[0])} {message[1:].hex(' ')}\n")
                    if holding:
                        held.append((connection, len(message) - 1))
                    elif failing:
                        failing -= 1
                        answer(connection, -1, b"failed")
                    else:
                        answer(connection, len(message) - 1)
        if period and time.monotonic() >= due:
            to_inputs(b"i" + report)
            due = max(due + period, time.monotonic())


main()
