"""Plays with devices behind standin/hidapi.c: a Teensy with the shipped profile, PLUGINS has `stuck`; a SpaceMouse."""
import os
import re
import selectors
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

import system_calls

plugins = sys.argv[1]
source, build = os.environ["HAPGRID_SOURCE"], os.environ["HAPGRID_BUILD"]
TEENSY = "/dev/hidraw7\t16c0\t0486\t\tPJRC\tTeensy RawHID\tffab\t0200\t0"
SPACEMOUSE = "/dev/hidraw3\t256f\tc62e\t\t3Dconnexion\tSpaceMouse Wireless\t0001\t0008\t0"
environment = dict(os.environ, HAPGRID_STANDIN=os.path.abspath("socket"),
                   LD_LIBRARY_PATH=f"{build}/tests/standin")
PROFILE = f"{source}/examples/devices/teensy-rawhid.toml"


def report(x_mm):
    """An input report of the profile: nanometres behind four bytes."""
    return struct.pack("<BBxx3i48x", 0x48, 0, int(x_mm * 1e6), 0, 0)


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
                    send(connection, b"k" if message[:1] == b"C" else self.info.encode())
            else:
                if message[:1] == b"w":
                    self.written.append(message[1:])
                send(connection, b"r" + struct.pack("=i", len(message) - 1))

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
                messages.append(b"i" + self.report)
                due = max(due + 0.002, time.monotonic())
            for message in messages:
                for connection in [c for c, kind in kinds.items() if kind == "I"]:
                    send(connection, message)
        for connection in [self.listener, *kinds]:
            connection.close()

    def end(self):
        self.over = True
        self.thread.join()


def force(written):
    """Millinewtons along x, or "stop"; every report has id 0, then 48."""
    assert written[0] == 0 and written[1] == 0x48 and len(written) == 65, written
    return struct.unpack("<h", written[3:5])[0] if written[2] == 1 else "stop"


def play(*options, grid="stuck.0", wrapper=(), device=f"profile:{PROFILE}"):
    return subprocess.Popen([*wrapper, "play", grid, "--device", device, "--model-path", plugins, "--force",
                             "state", "--set", "safety.ramp=50", *options], env=environment,
                            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def wait(until, what):
    deadline = time.monotonic() + 30
    while not until():
        assert time.monotonic() < deadline, what
        time.sleep(0.01)


def await_force(device, process):
    """Until the whole half newton is on the device."""
    wait(lambda: process.poll() is not None or any(force(w) == 500 for w in device.written), "no force came")
    assert process.poll() is None, process.communicate()[1]


def case(name, disturb, code, line, grid="stuck.0", reachable=True):
    """A play that `disturb` ends: exit code, a line on standard error, and zero force, then the profile's
    own stop, as the last that a device hears which is still there."""
    device = Device()
    process = play(grid=grid)
    await_force(device, process)
    disturb(device, process)
    error = process.communicate(timeout=30)[1]
    assert process.returncode == code, (name, process.returncode, error)
    assert re.search(line, error, re.M), (name, error)

    def last():
        return [force(w) for w in device.written[-2:]]

    # The guard writes from another process, perhaps a moment later.
    wait(lambda: not reachable or last() == [0, "stop"], name)
    device.end()
    print(f"{name}: {len(device.written)} reports, the last {last()}")


def move(x_mm):
    return lambda device, process: setattr(device, "report", report(x_mm))


# Signals, an abort and the clutch are in process.py.
case("broken", lambda device, process: device.messages.append(b"eburnt out"), 1, r"^play: device: .*burnt out")
case("vanished", lambda device, process: setattr(device, "gone", True), 1, r"^play: device: ",
     reachable=False)
case("killed", lambda device, process: process.kill(), -signal.SIGKILL, r"")
case("hangs", move(60), 1, r"^play: the haptic loop hangs, .*zero force was sent")


def stand_still(device, process):
    """The guard lets go while the program stands still; then it goes on."""
    process.send_signal(signal.SIGSTOP)
    wait(lambda: force(device.written[-1]) == "stop", "stopped, and the force is left on the device")
    process.send_signal(signal.SIGCONT)


case("stopped", stand_still, 1, r"^play: device: .*: the program stood still, and its guard sent zero force$")

# System calls of the haptic thread: sleeping, and the semaphore that wakes the device's writer.
device = Device()
process = play("--rate", "500", "--duration", "1", "--log", "log.session", "--frames", "frames",
               wrapper=("strace", "-f", "-o", "trace"))
error = process.communicate(timeout=60)[1]
assert process.returncode == 0, error
calls = system_calls.check("trace", "futex")
assert calls["futex"] <= 2 * calls["clock_nanosleep"] + 2, calls  # one that is interrupted is two lines
device.end()
print("system calls:", dict(calls))

# A SpaceMouse: pushed half way to the left, the HIP goes half of mapping.speed that way, and nowhere else; a
# button is in the log.
device = Device(SPACEMOUSE, struct.pack("<B3h", 1, -175, 0, 0))
process = play("--rate", "500", "--duration", "1", "--set", "mapping.speed=0.4", "--log", "mouse.session",
               device="spacemouse")
wait(lambda: os.path.exists("mouse.session"), "no log")  # the device is open
device.messages.append(b"i" + struct.pack("<BH", 3, 2))
error = process.communicate(timeout=60)[1]
assert process.returncode == 0, error
assert error.startswith("play: SpaceMouse Wireless (256f:c62e) at 500 Hz; "), error
device.end()
assert not device.written, device.written
subprocess.run(["stats", "--log", "mouse.session", "--export", "mouse.txt"], check=True)
ticks = [tuple(map(float, text.split("\t")[:4])) for text in open("mouse.txt") if text[0] != "#"]
ticks = ticks[next(i for i, (_, x, _, _) in enumerate(ticks) if x):]  # from the first report on
assert len(ticks) > 10 and all(y == z == 0 for _, _, y, z in ticks), ticks
for (t0, x0, *_), (t1, x1, *_) in zip(ticks, ticks[1:]):
    assert abs(x1 - x0 + 0.2 * (t1 - t0)) < 1e-9, (t0, x0, t1, x1)  # texts have 17 digits
flags = subprocess.run(["stats", "--log", "mouse.session"], check=True, capture_output=True, text=True)
assert re.search(r"^flag reset +[1-9]", flags.stdout, re.M), flags.stdout
print("SpaceMouse:", len(ticks), "ticks, to x =", ticks[-1][1])
