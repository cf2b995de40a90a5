"""Plays with HID devices behind standin/hidapi.c: a Teensy with the shipped profile, PLUGINS has `stuck`; a SpaceMouse.
adapters.py has the adapters alone."""
import os
import re
import signal
import struct
import subprocess
import sys
import time

from hid_standin import SPACEMOUSE, Device, environment, force, report, wait

PROFILE = f"{os.environ['HAPGRID_SOURCE']}/examples/devices/teensy-rawhid.toml"


def play(*options, grid=("stuck.0",), device=f"hid:{PROFILE}", settings="ramp.toml"):
    of_grid = ["--traversal", "paper", "--config", settings] if grid else []
    return subprocess.Popen(["play", *grid, "--device", device, *of_grid, *options], env=environment(), stdout=subprocess.DEVNULL if grid else subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def case(name, disturb, code, line, grid="stuck.0", reachable=True):
    """A play that `disturb` ends: exit code, a line on standard error, and zero force, then the profile's
    own stop, as the last that a device hears which is still there."""
    device = Device()
    process = play(grid=[grid])
    # The whole half newton is on the device.
    wait(lambda: process.poll() is not None or any(force(w) == 500 for w in device.written), "no force came")
    assert process.poll() is None, process.communicate()[1]
    disturb(device, process)
    error = process.communicate(timeout=30)[1]
    assert process.returncode == code, (name, process.returncode, error)
    assert re.search(line, error, re.M), (name, error)

    def last():
        return [force(w) for w in device.written[-2:]]

    # The adapter or its --release writes from another process, perhaps a moment later.
    wait(lambda: not reachable or last() == [0, "stop"], name)
    device.end()
    print(f"{name}: {len(device.written)} reports, the last {last()}")


def move(x_mm):
    return lambda device, process: setattr(device, "report", report(x_mm))


def end_adapter(number):
    """The adapter is a child of the guard, which is a child of play."""
    def disturb(_, process):
        def child(pid):
            return int(open(f"/proc/{pid}/task/{pid}/children").read().split()[0])
        os.kill(child(child(process.pid)), number)
    return disturb


FAILED = "^play: device: hapgrid-hid: "
case("broken", lambda device, process: device.messages.append(b"eburnt out"), 1, rf"{FAILED}/dev/hidraw7: read: burnt out")
case("vanished", lambda device, process: setattr(device, "gone", True), 1, FAILED, reachable=False)
case("killed", lambda device, process: process.kill(), -signal.SIGKILL, r"")
case("hangs", move(60), 1, r"^play: the haptic loop hangs, .*zero force was sent")
case("adapter killed", end_adapter(signal.SIGKILL), 1,
     rf"{FAILED}was killed by signal 9 \(Killed\); then --release sent zero force$")
case("adapter ended", end_adapter(signal.SIGTERM), 1, rf"{FAILED}ended by a signal, and let go of the device")
# A profile with the wrong unit.
case("far away", move(300), 1, rf"{FAILED}is at 0.3 0 0 m, and its ranges go from -0.08 -0.08 -0.08 m to 0.08 0.08 0.08 m$")

# What there is, without a grid: positions and rate are shown, and no force is sent.
device = Device()
tried = play("--duration", "1.2", grid=[])
out, error = tried.communicate(timeout=60)
assert tried.returncode == 0, error
assert re.search(r"^play: Teensy RawHID: x -80 to 80 mm, y .*, z .*; 1000 forces/s at most; it can hold 3 N, and gets none$",
                 error, re.M), error
assert re.match(r"(x  -40.00 mm  y    0.00 mm  z    0.00 mm  +\d+ answers/s\n){1,3}$", out), out
assert {force(w) for w in device.written} == {0, "stop"}, device.written
device.end()

# A SpaceMouse: pushed half way to the left, the HIP goes half of mapping.speed that way, and nowhere else;
# two buttons are in the log. When its reports stay out, the HIP stops after 0.2 s.
device = Device(SPACEMOUSE, struct.pack("<B3h", 1, -175, 0, 0))
process = play("--rate", "500", "--duration", "1.5", "--log", "mouse.session", device="spacemouse", settings="mouse.toml")
wait(lambda: os.path.exists("mouse.session"), "no log")  # the device is open
device.messages.append(b"i" + struct.pack("<BH", 3, 3))
time.sleep(0.4)
device.is_silent = True
error = process.communicate(timeout=60)[1]
assert process.returncode == 0, error
assert error.splitlines()[1].startswith("play: SpaceMouse Wireless (256f:c62e) at 500 Hz; "), error
device.end()
assert not device.written, device.written
text = subprocess.run([sys.executable, os.environ["HAPGRID_SOURCE"] + "/tests/cli/stats/session.py", "text", "mouse.session"], check=True,
                      capture_output=True, text=True).stdout
ticks = [tuple(map(float, line.split("\t")[:4])) for line in text.splitlines() if line[0] != "#"]
ticks = ticks[next(i for i, (_, x, _, _) in enumerate(ticks) if x):]  # from the first report on
end = next(i for i in range(len(ticks)) if ticks[i][1] == ticks[-1][1])
assert end > 10 and len(ticks) - end > 10 and all(y == z == 0 for _, _, y, z in ticks), (end, len(ticks))
for (t0, x0, *_), (t1, x1, *_) in zip(ticks[:end], ticks[1:end]):
    assert abs(x1 - x0 + 0.2 * (t1 - t0)) < 1e-9, (t0, x0, t1, x1)  # texts have 17 digits
flags = subprocess.run(["stats", "mouse.session"], check=True, capture_output=True, text=True)
for flag in "reset", "next":
    assert re.search(rf"^flag {flag} +[1-9]", flags.stdout, re.M), flags.stdout
print("SpaceMouse:", end, "ticks, to x =", ticks[-1][1], "then", len(ticks) - end, "at rest")
