"""Plays with the adapters to makers' kits, each before a stand-in for its kit: axes and units, the last force, and
what happens when the device is not there, fails or hangs. The handle is 25 mm to the left of the middle, 10 mm away
from the user, 5 mm up; the grid's force is half a newton to the right."""
import os
import re
import signal
import subprocess
import sys
import time

from patience import Busy, patiently

source, build = os.environ["HAPGRID_SOURCE"], os.environ["HAPGRID_BUILD"]
RIGHT = {"force-dimension": "force -0 0.5 0", "openhaptics": "force 0.5 0 -0", "haply": "force 0.5 0 0"}
NONE = {"force-dimension": "force -0 0 0", "openhaptics": "force 0 0 -0", "haply": "force 0 0 0"}
numbers = iter(range(100))


class Play:
    def __init__(self, adapter, *fault, options=()):
        self.adapter, self.record, self.service = adapter, f"kit.{next(numbers)}", None
        open(self.record, "w").close()
        environment = dict(os.environ, HAPGRID_KIT=self.record, HAPGRID_KIT_FAULT=" ".join(fault),
                           ASAN_OPTIONS="detect_leaks=0")  # to look for them at its end takes an adapter too long
        command = f"{build}/tests/devices/{adapter}"
        if adapter == "haply":
            self.service = subprocess.Popen(
                ["/usr/bin/python3", f"{source}/tests/standin/inverse_service.py", self.record, *fault],
                stdout=subprocess.PIPE, text=True)
            command = f"/usr/bin/python3 {source}/examples/devices/haply.py {self.service.stdout.readline().strip()}"
        self.process = subprocess.Popen(
            ["play", "stuck.0", "--device", f"process:{command}", "--traversal", "paper",
             "--config", "ramp.toml", *options], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def heard(self):
        return open(self.record).read().splitlines()

    def await_force(self):
        deadline = time.monotonic() + 20
        while RIGHT[self.adapter] not in self.heard():
            if self.process.poll() is not None:
                self.end(0, "")
            assert time.monotonic() < deadline, (self.adapter, self.heard()[-3:])
            time.sleep(0.002)
        return self

    def end(self, code, lines):
        """Those that standard error ends with."""
        error = self.error = self.process.communicate(timeout=30)[1]
        if self.service:
            self.service.kill()
            self.service.wait()
            self.service.stdout.close()
        late = re.search("did not answer within 100 ms|its time stood still for 100 ms|the haptic loop hangs|"
                         "its guard process does not answer|it calls nobody", error)
        if late and not re.search("100 ms", lines):
            raise Busy(late[0])
        assert self.process.returncode == code, (self.adapter, self.process.returncode, error)
        assert re.search(f"(^|\n){lines}$", error.rstrip("\n")), (self.adapter, error)
        return self


def good(adapter, last):
    play = Play(adapter, options=["--duration", "1.5", "--log", f"{adapter}.session"])
    play.end(0, "play: lateness .*")
    heard = play.heard()
    if RIGHT[adapter] not in heard:
        raise Busy("1.5 s were too short")
    assert heard[-len(last):] == last, (adapter, heard[-5:])
    text = subprocess.run([sys.executable, f"{source}/tests/cli/stats/session.py", "text", f"{adapter}.session"], check=True,
                          capture_output=True, text=True).stdout.splitlines()
    x, y, z = (float(number) for number in text[-1].split("\t")[1:4])
    assert x < 0 < z < y, (adapter, x, y, z)
    assert abs(y / x + 10 / 25) < 1e-9 and abs(z / x + 5 / 25) < 1e-9, (adapter, x, y, z)
    flags = subprocess.run(["stats", f"{adapter}.session"], check=True, capture_output=True, text=True).stdout
    assert re.search(r"^flag clutch +0 (.*\n)+flag next +[1-9]", flags, re.M), flags  # the second button
    print(f"{adapter}: {len(heard)} forces that differ, the last {heard[-len(last):]}")


patiently(good, "force-dimension", [NONE["force-dimension"], "brakes", "closed"])
patiently(good, "openhaptics", [NONE["openhaptics"], "brakes", "closed"])
patiently(good, "haply", [NONE["haply"], "closed"])

# Killed, play leaves it to the guard.
for adapter, last in [("force-dimension", "closed"), ("openhaptics", "closed"), ("haply", "closed")]:
    play = patiently(lambda: Play(adapter).await_force())
    play.process.kill()
    deadline = time.monotonic() + 10
    while play.heard()[-1] != last or NONE[adapter] not in play.heard()[-3:]:
        assert time.monotonic() < deadline, (adapter, play.heard()[-3:])
        time.sleep(0.01)
    play.end(-signal.SIGKILL, ".*")
    print(f"{adapter}: killed, done")

# A device that is not there, or JSON that no parser takes: one line.
for adapter, why in [("force-dimension", "no device: no device found"),
                     ("openhaptics", "no device: communication error"),
                     ("haply", "IndexError: list index out of range"),
                     ("haply deep", "RecursionError: maximum recursion depth exceeded.*")]:
    adapter, _, fault = adapter.partition(" ")
    play = patiently(lambda: Play(adapter, fault or "absent", "0").end(1, f"play: process '[^\n]*': {why}"))
    assert play.error.count("\n") == 2, play.error  # the first says what ramp.toml sets

# One that fails while it is played; the adapter lets go by itself. And one that hangs, which is killed. Behind both,
# --release finds the device, unless its service is gone.
RELEASED, FAILED = "; then --release sent zero force", "; --release failed: the device may hold its last force"
for adapter, fault, why in [("force-dimension", "fail", f"cannot set a force: communication error{RELEASED}"),
                            ("openhaptics", "fail", f"the device failed: communication error{RELEASED}"),
                            ("haply", "close", f"ConnectionClosed.*{FAILED}")]:
    play = patiently(lambda: Play(adapter, fault, "200").end(1, f"play: device: process '.*': {why}"))
    assert adapter == "haply" or play.heard()[-2:] == ["brakes", "closed"], (adapter, play.heard()[-3:])
for adapter, why in [("force-dimension", f"did not answer within 100 ms{RELEASED}"),
                     ("openhaptics", f"its time stood still for 100 ms{RELEASED}"),
                     ("haply", f"did not answer within 100 ms{FAILED}")]:
    play = Play(adapter, "hang", "200").end(1, f"play: device: process '.*': {why}")
    assert adapter == "haply" or play.heard()[-2:] == ["brakes", "closed"], (adapter, play.heard()[-3:])
print("faults: done")
