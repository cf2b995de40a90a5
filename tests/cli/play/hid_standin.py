"""The device process behind standin/hidapi.c, for tests of the adapters of HID devices."""
import os
import selectors
import socket
import struct
import threading
import time

TEENSY = "/dev/hidraw7\t16c0\t0486\t\tPJRC\tTeensy RawHID\tffab\t0200\t0"
SPACEMOUSE = "/dev/hidraw3\t256f\tc62e\t\t3Dconnexion\tSpaceMouse Wireless\t0001\t0008\t0"


def environment():
    return dict(os.environ, HAPGRID_STANDIN=os.path.abspath("socket"),
                LD_LIBRARY_PATH=f"{os.environ['HAPGRID_BUILD']}/tests/standin")


def report(x_mm):
    """An input report of the shipped profile: nanometres behind four bytes."""
    return struct.pack("<BBxx3i48x", 0x48, 0, int(x_mm * 1e6), 0, 0)


def force(written):
    """Millinewtons along x, or "stop"; every report has id 0, then 48."""
    assert written[0] == 0 and written[1] == 0x48 and len(written) == 65, written
    return struct.unpack("<h", written[3:5])[0] if written[2] == 1 else "stop"


def wait(until, what):
    deadline = time.monotonic() + 30
    while not until():
        assert time.monotonic() < deadline, what
        time.sleep(0.005)


class Device:
    """The device behind standin/hidapi.c, as a thread. It sends its report 500 times a second. Of the Teensy the hand
    is at x = -40 mm, where 0.08 m are half of the box."""

    def __init__(self, info=TEENSY, first=report(-40)):
        if os.path.exists("socket"):
            os.remove("socket")
        self.listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.listener.bind("socket")
        self.listener.listen(16)
        self.info, self.report = info, first
        self.messages = []  # to be sent once: "i" and a report, or "e" and why hid_read fails
        self.written = []  # reports that came, with their ids
        self.answer = None  # to a write, where it is not that all was taken: (bytes, text)
        self.refuses = ""  # why it cannot be opened
        self.is_silent = self.floods = False
        self.gone = self.over = False
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def serve(self):
        kinds, select, due = {}, selectors.DefaultSelector(), time.monotonic()
        select.register(self.listener, selectors.EVENT_READ)

        def send(connection, message):
            try:
                connection.send(message, socket.MSG_DONTWAIT)
            except OSError:
                pass  # no room, or gone: as hidraw

        def take(connection):
            try:
                message = connection.recv(8192)
            except OSError:
                message = b""
            if not message:
                select.unregister(connection)
                del kinds[connection]
                connection.close()
            elif not kinds[connection]:
                kinds[connection] = chr(message[0])
                if message[:1] in b"CL":
                    opened = b"e" + self.refuses.encode() if self.refuses else b"k"
                    send(connection, opened if message[:1] == b"C" else self.info.encode())
            else:
                if message[:1] == b"w":
                    self.written.append(message[1:])
                size, text = self.answer or (len(message) - 1, "")
                send(connection, b"r" + struct.pack("=i", size) + text.encode())

        while not self.over and not self.gone:
            for key, _ in select.select(max(0, due - time.monotonic())):
                if key.fileobj is self.listener:
                    connection, _ = self.listener.accept()
                    kinds[connection] = ""
                    select.register(connection, selectors.EVENT_READ)
                else:
                    take(key.fileobj)
            messages, self.messages = self.messages, []
            if time.monotonic() >= due:
                if not self.is_silent:
                    messages += [b"i" + self.report] * (200 if self.floods else 1)
                due = max(due + 0.002, time.monotonic())
            for message in messages:
                for connection in [c for c, kind in kinds.items() if kind == "I"]:
                    send(connection, message)
        for connection in [self.listener, *kinds]:
            connection.close()

    def end(self):
        self.over = True
        self.thread.join()
