"""Viewers of play's frames that die, sleep, or wake up late: play takes no notice in its ticks, ends
on time, and says what the viewer missed.

usage: viewers.py GRID PATH
"""
import fcntl
import os
import re
import signal
import subprocess
import sys
import time

GRID, PATH = sys.argv[1:]
PIPE = 8192  # two pages: full after a second of frames
# 1.6 s at 1 kHz: the path, forth and back again.
with open(PATH) as file:
    LINES = file.readlines()
with open("long", "w") as file:
    file.writelines((LINES * 5)[:1600])


def play(viewer, *options):
    """Runs play with `viewer`, a function of the pipe's reading end; its exit code, what it wrote to
    standard error, and how long it took. SIGPIPE is what it is for any program that a shell starts."""
    read, write = os.pipe()
    fcntl.fcntl(write, 1031, PIPE)  # F_SETPIPE_SZ
    begin = time.monotonic()
    process = subprocess.Popen(["play", GRID, "--device", "path:long", "--frames", "-", *options],
                               stdout=write, stderr=subprocess.PIPE, text=True, close_fds=True,
                               preexec_fn=lambda: signal.signal(signal.SIGPIPE, signal.SIG_DFL))
    os.close(write)
    viewer(read)
    _, err = process.communicate()
    return process.returncode, err, time.monotonic() - begin


def last_line(err):
    *_, line = err.splitlines()
    match = re.fullmatch(r"play: frames written (\d+), dropped (\d+)(.*)", line)
    assert match, err
    return int(match[1]), int(match[2]), match[3]


def dies(read):
    data = b""
    while len(data) < 1000:
        data += os.read(read, 1000 - len(data))
    os.close(read)


def sleeps(read):
    time.sleep(1)  # play ends long after this, and the pipe is open until then


def wakes(read):
    time.sleep(1.2)
    with os.fdopen(read, "rb") as stream:
        frames = stream.read()  # view itself may take longer to start than play waits for it
    view = subprocess.run(["view", "--format", "json"], input=frames, capture_output=True)
    assert view.returncode == 0, view.stderr


CLOSED = "; the viewer closed its end before the last one"
CUT = "; the viewer stopped reading, the last one is cut"

for options in [], ["--rate", "1000"]:
    code, err, seconds = play(dies, *options)
    assert code == 0, err
    assert "play: 1600 ticks, " in err, err  # all of them
    written, _, rest = last_line(err)
    assert rest == CLOSED and written >= 1, err

code, err, seconds = play(sleeps, "--rate", "1000")
assert code == 0, err
assert "play: 1600 ticks, " in err, err
written, dropped, rest = last_line(err)
assert rest == CUT and dropped > 0 and 1 <= written < 30, err
# The scripted time and the second for the viewer at the end; the rest is for slow machines.
assert 2.5 < seconds < 8, seconds

code, err, seconds = play(wakes, "--rate", "1000")
assert code == 0, err
written, dropped, rest = last_line(err)
assert rest == "" and dropped > 0, err

# Without a pace play waits for a viewer that sleeps, but not when it is told to stop.
read, write = os.pipe()
fcntl.fcntl(write, 1031, PIPE)
process = subprocess.Popen(["play", GRID, "--device", "path:long", "--frames", "-"], stdout=write,
                           stderr=subprocess.PIPE, text=True)
os.close(write)
time.sleep(1)
assert process.poll() is None
process.send_signal(signal.SIGINT)
_, err = process.communicate(timeout=60)
assert process.returncode == 128 + signal.SIGINT, err
assert last_line(err)[2] == CUT, err
