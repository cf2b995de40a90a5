"""The shards of streams.sh, the filters that read them, and how one refuses a bad one; jobs run in threads.

Arguments of the program: some|all|sanitized [CASES], see __main__.py.
"""

import concurrent.futures
import itertools
import os
import re
import resource
import signal
import subprocess
import sys
import threading

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "cli"))
import shard

ALL = sys.argv[1] == "all"
SLOW = sys.argv[1] == "sanitized"
ONLY = sys.argv[2] if len(sys.argv) > 2 else ""
MEMORY_MB = 100  # an honest shard of this size takes some 10 MB
SECONDS = 60 if SLOW else 10
numbers, peaks = itertools.count(), itertools.count()
failures = []


def read(name):
    with open(name, "rb") as file:
        return file.read()


if not SLOW:  # so that a wrong size ends a filter and not the machine
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))


def run(command, stdin=b""):
    """(exit code, 128 + signal or -9 after too long a time, stdout, stderr, peak memory in MB)"""
    # The kernel counts this process's memory, too, for a child that it starts itself. GNU time has little.
    peak = "peak.%d" % next(peaks)
    process = subprocess.Popen(["time", "-q", "-f", "%M", "-o", peak, *command], stdin=subprocess.PIPE,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
    timer = threading.Timer(SECONDS, lambda: os.killpg(process.pid, signal.SIGKILL))
    timer.start()
    try:
        process.stdin.write(stdin)
        process.stdin.close()
    except BrokenPipeError:
        pass
    out = process.stdout.read()
    err = process.stderr.read()
    process.wait()
    timer.cancel()
    memory = int(read(peak) or 0) / 1000
    os.unlink(peak)
    return process.returncode, out, err.decode(errors="replace"), memory


def refused(name, command, bad, message, may_pass=False):
    """The command, in which BAD stands for the bad shard, must refuse it with this message (a
    regular expression that is found in the one line)."""
    if ONLY not in name:
        return
    file = "bad.%d" % next(numbers)
    out = file + ".out"
    with open(file, "wb") as stream:
        stream.write(bad)
    words = [file if w == "BAD" else w for w in command.split()] + ["-o", out]
    code, stdout, stderr, memory = run(words)
    line = stderr.replace(file, "BAD")
    problems = []
    if may_pass and code == 0 and not stderr:
        os.unlink(out)
        return
    if code != 1:
        problems.append("exit code %d" % code)
    if stdout:
        problems.append("writes to standard output")
    if os.path.exists(out):
        problems.append("leaves half a file")
        os.unlink(out)
    if not re.fullmatch("%s: [^\n]+\n" % words[0], line):
        problems.append("not one line of the tool")
    elif not re.search(message, line):
        problems.append("another message than /%s/" % message)
    if memory > MEMORY_MB and not SLOW:
        problems.append("%d MB of memory" % memory)
    if problems:
        failures.append("%s: %s: %s\n  %s" % (name, command, "; ".join(problems), line[:400]))
    os.unlink(file)


pool = concurrent.futures.ThreadPoolExecutor(4)
# Few shards wait at a time, for they are large together.
waiting = threading.BoundedSemaphore(8)
jobs = []


def later(function, *arguments):
    waiting.acquire()
    jobs.append(pool.submit(function, *arguments))
    jobs[-1].add_done_callback(lambda _: waiting.release())


def later_refused(*arguments):
    later(refused, *arguments)


SEEDS, REQUESTS, GRID, NEXT, SMALL = map(read, ("seeds", "requests", "grid", "next", "small"))
TOY_SEEDS, TOY_REQUESTS = map(read, ("toy.seeds", "toy.requests"))

# The commands that read each kind of shard; unless it is all, one of them each.
READERS = {
    "seeds": (SEEDS, ["expand BAD", "expand --complete BAD", "merge BAD requests", "stats BAD", "verify BAD"]),
    "requests": (REQUESTS, ["merge seeds BAD"]),
    "next": (NEXT, ["merge BAD next.requests", "stats BAD"]),
    "grid": (GRID, ["merge BAD", "expand BAD", "verify BAD", "stats BAD"]),
    "small": (SMALL, ["merge --small BAD", "stats BAD"]),
    "toy.seeds": (TOY_SEEDS, ["expand BAD", "merge toy.requests BAD"]),
    "toy.requests": (TOY_REQUESTS, ["merge toy.seeds BAD"]),
}
if not ALL:
    READERS = {kind: (whole, commands[:1]) for kind, (whole, commands) in READERS.items()}


def finish():
    """Waits for all jobs; the end of the program, with what was wrong."""
    for job in concurrent.futures.as_completed(jobs):
        job.result()
    pool.shutdown()
    print("%d shards" % next(numbers))
    if failures:
        failures.sort()
        sys.exit("\n".join(failures[:40]) + "\n%d faults" % len(failures))
