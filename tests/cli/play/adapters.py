"""The adapters of HID devices alone: this is play, and standin/hidapi.c the device."""
import os
import re
import signal
import socket
import struct
import subprocess
import time

from hid_standin import SPACEMOUSE, TEENSY, Device, environment, force, report, wait

PROFILE = f"{os.environ['HAPGRID_SOURCE']}/examples/devices/teensy-rawhid.toml"
STALLED = 4


class Adapter:
    def __init__(self, *words, program="hapgrid-hid"):
        self.wire, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.process = subprocess.Popen([program, *words], stdin=theirs, stdout=theirs, env=environment())
        theirs.close()
        self.wire.settimeout(20)
        self.number = 0

    def greeting(self):
        """Its fields: magic, version, flags, low, high, force, rate, name."""
        message = self.wire.recv(500)
        assert len(message) == 128, message
        return struct.unpack("<8s2I8d48s", message)

    def force(self, x, number=None, flags=0):
        self.number = self.number + 1 if number is None else number
        self.wire.send(struct.pack("<3d2I", x, 0, 0, self.number, flags))

    def state(self):
        """(x, flags, number)"""
        message = self.wire.recv(500)
        assert len(message) == 40, message
        _, x, _, _, flags, number = struct.unpack("<4d2I", message)
        return round(x, 9), flags, number

    def ask(self, x):
        self.force(x)
        x, flags, number = self.state()
        assert number == self.number
        return x, flags

    def error(self):
        message = self.wire.recv(500).decode()
        assert message.startswith("error: "), message
        assert self.process.wait(20) == 1
        return message[7:]


def last(device, count=2):
    return [force(w) for w in device.written[-count:]]


def check(name):
    """A case: a device and its adapter, which has said its greeting; both are ended behind it."""
    def run(case):
        device = Device()
        adapter = Adapter(PROFILE)
        adapter.greeting()
        case(device, adapter)
        adapter.wire.close()
        adapter.process.wait(20)
        device.end()
        print(name)
    return run


@check("forces go out and positions come in")
def _(device, adapter):
    assert adapter.ask(0.25)[0] == -0.04
    assert last(device, 1) == [250]
    device.report = report(30)
    wait(lambda: adapter.ask(0.25)[0] == 0.03, "the new position")
    adapter.force(0.5, number=0)  # which wants no answer
    wait(lambda: last(device, 1) == [500], "the force without an answer")
    adapter.force(0, flags=1)
    assert adapter.state()[2] == adapter.number and last(device) == [0, "stop"]
    assert adapter.process.wait(20) == 0


@check("a silent play loses its force after watchdog_ms, and gets it back")
def _(device, adapter):
    adapter.ask(0.5)
    begin = time.monotonic()
    wait(lambda: last(device, 1) == [0], "zero force")
    assert time.monotonic() - begin > 0.04
    adapter.ask(0.5)
    assert last(device, 1) == [500]


@check("the keep-alive repeats the force")
def _(device, adapter):
    adapter.ask(0.125)
    before = len(device.written)
    wait(lambda: len(device.written) > before + 1, "more reports")
    assert force(device.written[before]) == 125


@check("silence is a stall; a cut report is no sign of life, the next whole one ends it")
def _(device, adapter):
    assert adapter.ask(0)[1] == 0
    device.is_silent = True
    wait(lambda: adapter.ask(0) == (-0.04, STALLED), "the stall")
    device.messages.append(b"i" + report(1)[:63])
    time.sleep(0.02)
    assert adapter.ask(0) == (-0.04, STALLED)
    device.messages.append(b"i" + report(1))
    wait(lambda: adapter.ask(0) == (0.001, 0), "the next report")


@check("a flood starves nobody")
def _(device, adapter):
    device.floods = True
    for number in range(200):
        adapter.ask(0.001 * number)
    assert last(device, 1) == [199]


@check("a failed write is the end, and zero force is tried")
def _(device, adapter):
    device.answer = (-1, "burnt")
    adapter.force(0.5)
    assert adapter.error() == "/dev/hidraw7: write: output report 0: burnt"
    assert last(device, 3) == [500, 0, "stop"]


@check("a report that was taken in part is a failure")
def _(device, adapter):
    device.answer = (64, "")
    adapter.force(0.5)
    assert adapter.error() == "/dev/hidraw7: write: output report 0: took only 64 bytes of it"


@check("play's end, and a signal, are a reason to let go")
def _(device, adapter):
    adapter.ask(0.5)
    adapter.wire.close()
    assert adapter.process.wait(20) == 0 and last(device) == [0, "stop"]
    adapter = Adapter(PROFILE)
    adapter.greeting()
    adapter.ask(0.5)
    adapter.process.send_signal(signal.SIGTERM)
    assert adapter.error() == "ended by a signal, and let go of the device"
    assert last(device) == [0, "stop"]


@check("--release sends zero force")
def _(device, adapter):
    adapter.ask(0.5)
    adapter.process.kill()
    adapter.process.wait()
    assert last(device, 1) == [500]
    subprocess.run(["hapgrid-hid", PROFILE, "--release"], env=environment(), check=True)
    assert last(device, 3) == [500, 0, "stop"], last(device, 3)


# What cannot be opened says why, in a line.
open("started.toml", "w").write(open(PROFILE).read().replace("[reports]", '[reports]\ninit = ["00 48 01"]'))
for info, refuses, silent, why in [
        (TEENSY, "busy", False, "/dev/hidraw7: cannot be opened: busy"),
        (TEENSY, "", True, "/dev/hidraw7: no input within 2 s: the device sent no report")]:
    device = Device(info)
    device.refuses, device.is_silent = refuses, silent
    error = Adapter(PROFILE).error()
    assert error == why, (error, why)
    # What the profile's init reports may have switched on is switched off.
    assert last(device) == ([0, "stop"] if silent else []), device.written
    device.end()
device = Device()
device.is_silent = True
adapter = Adapter("started.toml")
wait(lambda: device.written, "the init report")
adapter.process.terminate()
assert adapter.error() == "ended by a signal before the device's first input" and last(device) == [0, "stop"], device.written
device.end()
device = Device(SPACEMOUSE.replace("256f", "1234"))
error = Adapter(program="hapgrid-spacemouse").error()
assert error == "there is no SpaceMouse (play --list-devices shows what there is)", error
device.end()
print("refusals: done")

# The list: the exact text for --device, and the rule for who may not open a device.
open("hidraw0", "w").close()
os.chmod("hidraw0", 0o600)
device = Device("\n".join([TEENSY.replace("/dev/hidraw7", os.path.abspath("hidraw0")), SPACEMOUSE,
                            "/dev/hidraw9\t046d\tc31c\t\tLogitech\tKeyboard\t0001\t0006\t0",
                            "/dev/hidraw10\t1234\t5678\t9\x01\tOwn\tHandle\tff00\t0001\t-1"]))
listed = subprocess.run(["play", "--list-devices"], env=environment(), check=True, capture_output=True,
                        text=True).stdout.splitlines()
def row(device, feels, name):
    assert any(re.match(rf"{device} +{feels} +{name}", line) for line in listed), (device, listed)


row("--device", "feels", "name$")
row(r"hid:/\S+/devices/teensy-rawhid\.toml", "force", r"Teensy RawHID \(16c0:0486\), interface 0, usage ffab:0200, /")
row("hid:PROFILE", r"\?", r"Handle \(1234:5678\), interface -1, usage ff00:0001, /dev/hidraw10, serial 9 $")
row("spacemouse:/dev/hidraw3", "-", r"SpaceMouse Wireless \(256f:c62e\)$")
row(r"process:python3 /\S+/handle\.py", "force", "adapter handle$")
assert not any("Keyboard" in line for line in listed), listed
subprocess.run(["hapgrid-hid", "--list"], env=environment(), check=True)
if os.getuid() == 0:
    os.chmod(".", 0o755)
    os.chmod("..", 0o755)
    os.chmod("socket", 0o777)
    nobody = subprocess.run(["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups", "hapgrid-hid", "--list"],
                            env=environment(), check=True, capture_output=True, text=True).stdout
    assert 'put the line KERNEL=="hidraw*", ATTRS{idVendor}=="16c0", ATTRS{idProduct}=="0486", TAG+="uaccess" into' in nobody
device.end()
print("list: done")
