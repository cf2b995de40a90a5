"""faults.py MODEL.toml some|all: runs the tools with faults put in by strace; called by faults.sh in
a directory of inputs.

Each command is run once as it is, to see its system calls and its results. Then it is run again for
each of those calls, and that one call is refused, or the tool is killed in it. Whatever happens, the
inputs stay, and what is found in the place of a result is the whole result, or nothing. A call that
is refused is said in one line with exit code 1, or the tool can do without it and all is as it was.
"""

import collections
import concurrent.futures
import itertools
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys

MODEL, ALL = sys.argv[1], sys.argv[2] == "all"

# A command and what it writes into OUT. Those that write to standard output are given a file.
COMMANDS = {
    "seed": ["seed", MODEL, "--set", "grid.counts=[4,3,2]", "-o", "OUT/grid"],
    "expand": ["expand", "grid", "-o", "OUT/requests", "--cost", "OUT/cost"],
    "piped": ["expand", "-", "-o", "OUT/requests"],
    "threads": ["expand", "grid", "-j", "3", "-o", "OUT/requests"],
    "shards": ["merge", "grid", *(f"r.{k}" for k in range(1, 9)), "-o", "OUT/grid"],
    "complete": ["expand", "--complete", "grid", "-o", "OUT/grid"],
    "merge": ["merge", "grid", "requests", "-o", "OUT/grid"],
    "small": ["merge", "--small", "complete", "-o", "OUT/grid"],
    "stdout": ["expand", "grid"],
    "stats": ["stats", "complete"],
    "replaced": ["merge", "grid", "requests", "-o", "OUT/grid"],
    "verify": ["verify", "complete", "--recompute", "all", "-j", "2"],
    "check": ["check-model", MODEL, "--steps", "20", "--format", "json", "-o", "OUT/report"],
    "play": ["play", "complete", "--device", "path:path", "--log", "OUT/log", "--frames", "OUT/frames"],
    "session": ["play", "complete", "--device", "path:path", "--log", "OUT/log.session"],
    "text": ["stats", "log.session"],
    "view": ["view", "frames", "--png", "OUT/png", "--xyz", "OUT/xyz", "--size", "40x30"],
}
PIPED = {"piped": "grid"}  # what comes through standard input
OLD = {"replaced": "grid"}  # what is there before
# One after the other, some of them appear before others, and none is taken back: whole, and harmless.
SEVERAL = {"play", "view", "expand"}
# What is left on purpose: what was felt cannot be made again.
UNFINISHED = {"session": "log.session"}

# Calls that change files, and the errors of each. The kill comes when the call is entered, so killing
# at each of them gives all the states that the files ever have.
CHANGING = {
    "write": "ENOSPC", "pwrite64": "ENOSPC", "fsync": "EIO", "linkat": "ENOSPC", "rename": "EACCES",
    "unlink": "EACCES", "ftruncate": "ENOSPC", "fchmod": "EPERM",
}
# And what else a tool does. Not brk(), whose errors are no errors for the C library.
OTHER = {
    "openat": "EMFILE", "read": "EIO", "pread64": "EIO", "newfstatat": "EIO", "lseek": "EINVAL",
    "mmap": "ENOMEM", "close": "EIO", "poll": "ENOMEM", "clone3": "EAGAIN", "readlink": "EIO",
    "getcwd": "ENOENT", "fcntl": "EINVAL", "flock": "ENOLCK",
}
INTERRUPTED = ["write", "read", "pread64", "poll"]  # those that Linux does interrupt
TRIED = {**CHANGING, **OTHER}
MAIN = "fcntl(0, F_GETFD)"  # the first call of run_tool(); what comes before is the loader's


def read_all(directory):
    result = {}
    for name in os.listdir(directory):
        with open(os.path.join(directory, name), "rb") as file:
            result[name] = file.read()
    return result


class Run:
    """A command with an own OUT, traced by strace, or within a resource's limit."""

    numbers = itertools.count()

    def __init__(self, name, strace=(), limit=None):
        self.name = name
        self.out = f"../out.{next(Run.numbers)}"
        self.trace = self.out + ".trace"
        os.mkdir(self.out)
        if name in OLD:
            shutil.copy(OLD[name], self.out)
        command = [word.replace("OUT", self.out) for word in COMMANDS[name]]
        if limit is None:
            command = ["strace", "-f", "-o", self.trace, *strace, *command]
        prepare = limit and (lambda: (signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
                                      resource.setrlimit(limit[0], (limit[1], limit[1]))))
        with open(os.path.join(self.out, "stdout"), "wb") as stdout:
            stdin = {"input": inputs[PIPED[name]]} if name in PIPED else {"stdin": subprocess.DEVNULL}
            process = subprocess.run(command, **stdin, stdout=stdout, stderr=subprocess.PIPE,
                                     timeout=120, preexec_fn=prepare, restore_signals=False)
        self.code, self.err = process.returncode, process.stderr.decode()
        self.files = read_all(self.out)

    def close(self):
        shutil.rmtree(self.out)
        if os.path.exists(self.trace):
            os.remove(self.trace)


def is_whole(run, name, good, varying):
    if name not in good:
        return False
    if name not in varying:
        return run.files[name] == good[name]
    path = os.path.join(run.out, name)
    if name.endswith(".session"):  # it tells how long each tick took
        return subprocess.run(["stats", path], capture_output=True).returncode == 0
    try:  # reports and costs, with times in them: one object, or one a line, or none of them yet
        json.loads("[" + run.files[name].decode().strip().replace("\n{", ",{") + "]")
        return True
    except ValueError:
        return False


def faults_of(run):
    """(system call, its number, whether it is a write to standard error) after main() began."""
    with open(run.trace) as file:
        lines = file.read().splitlines()
    main = lines[0].split()[0]
    count, begun, result = collections.Counter(), False, []
    for line in lines:
        match = re.match(main + r" +(\w+)\((.*)", line)
        if not match:
            continue
        call = match[1]
        count[call] += 1
        begun = begun or MAIN in line
        if begun and call in TRIED and not (call == "write" and match[2].startswith("2,")):
            is_library = "\\177ELF" in line
            result.append((call, count[call], is_library))
    assert begun, f"{run.name}: no {MAIN}"
    return result


def wrong_with(run, fault, good, varying):
    """What is wrong with a run that had a fault, or None."""
    killed = fault == "signal=KILL"
    old = {OLD[run.name]: inputs[OLD[run.name]]} if run.name in OLD else {}
    new = set()
    for file, content in run.files.items():
        if file == "stdout" and run.code != 0 or content == old.get(file):
            continue
        if run.code != 0 and file == UNFINISHED.get(run.name):
            continue
        # The temporary file, which a kill leaves beside the one that it would have become.
        if killed and re.fullmatch(r"\.hapgrid\.\w{6}", file):
            continue
        if not is_whole(run, file, good, varying):
            return f"left {file}: {len(content)} bytes of {len(good.get(file, b''))}"
        new.add(file)
    if old.keys() - run.files.keys():
        return "lost what was there before"
    if killed:
        return None if run.code in (-signal.SIGKILL, 0) else f"exit code {run.code}"
    if run.code == 0:
        return None if new == good.keys() else f"exit code 0, and only {new}"
    if run.code == 127 and "error while loading shared libraries" in run.err:
        return None  # before main()
    if fault == "error=EINTR":
        return f"exit code {run.code} when interrupted: {run.err!r}"
    if run.code != 1 or not re.fullmatch(COMMANDS[run.name][0] + ": [^\n]+\n", run.err):
        return f"exit code {run.code}: {run.err!r}"
    left = new - {"stdout"}
    return f"failed, and left {left}: {run.err!r}" if left and run.name not in SEVERAL else None


def try_fault(name, what, number, fault, good, varying):
    if isinstance(what, str):
        run = Run(name, [f"--trace={what}", f"--inject={what}:{fault}:when={number}"])
    else:
        run = Run(name, limit=(what, number))
    said = wrong_with(run, fault, good, varying)
    result = said, run.code, run.err
    run.close()
    return result


def limits(good):
    """Files that may not grow beyond a size, memory in MB, numbers of descriptors."""
    size = max(map(len, good.values()))
    for bytes_left in range(0, size + 1, 1 if ALL else max(1, size // 12)):
        yield resource.RLIMIT_FSIZE, bytes_left, "bytes in a file"
    # From a little above what the loader needs to what the tools need.
    for kilobytes in range(10000, 80000, 500 if ALL else 6000):
        yield resource.RLIMIT_AS, kilobytes << 10, "bytes of memory"
    for descriptors in range(3, 20, 1 if ALL else 2):
        yield resource.RLIMIT_NOFILE, descriptors, "descriptors"


def test(name, pool):
    clean, again = Run(name), Run(name)
    assert clean.code == 0, clean.err
    good = clean.files
    varying = {file for file in good if good[file] != again.files[file]}
    for file in good:
        assert is_whole(clean, file, good, varying), file
    calls = faults_of(clean)
    faults = [(call, n, "signal=KILL") for call, n, _ in calls if call in CHANGING]
    faults += [(call, n, f"error={TRIED[call]}") for call, n, _ in calls]
    faults += [(call, n, "error=EINTR") for call, n, is_library in calls
               if call in INTERRUPTED and not is_library]
    # An input that becomes shorter while it is read.
    faults += [(call, n, "retval=0") for call, n, _ in calls if call == "pread64"]
    faults += limits(good)
    wrong = 0
    jobs = [(fault, pool.submit(try_fault, name, *fault, good, varying)) for fault in faults]
    for fault, job in jobs:
        said, code, err = job.result()
        if said:
            wrong += 1
            print(f"{name}: {fault[0]} {fault[1]} {fault[2]}: {said}")
        elif os.environ.get("VERBOSE"):
            print(f"  {name}: {fault[0]} {fault[1]} {fault[2]}: {code} {err!r}")
    assert read_all(".") == inputs, f"{name}: the inputs changed"
    clean.close()
    again.close()
    print(f"{name}: {len(calls)} calls, {len(faults)} faults, {wrong} wrong")
    return wrong


inputs = read_all(".")
with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    names = [name for name in COMMANDS if name in sys.argv[3:] or len(sys.argv) == 3]
    sys.exit(sum(test(name, pool) for name in names) > 0)
