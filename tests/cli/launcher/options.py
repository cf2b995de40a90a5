"""Goes through all pairs of the options of each filter, as its --help has them. Beside another option, each one changes what
is written or the exit code, or the two are refused: exit code 2.

usage: options.py [FILTER...]       in the folder with the inputs of options.sh
"""
import itertools
import os
import re
import shlex
import signal
import socket
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

IN = os.getcwd()


class Option:
    """value: of the option, None for a flag. sets: {other option: value} that it needs, of which all are tried; "" is what
    has no name, and ... takes away what is given anyway. telling: value, and {other option: value} beside it, by which it shows that it is used."""

    def __init__(self, value=None, *sets, telling=None, beside=None):
        self.value, self.sets, self.telling, self.beside = value, sets or ({},), telling or value, beside


def merged(*sets):
    return {name: value for one in sets for name, value in one.items()}


# slow.toml has a process that says what it is, and ends without an answer.
SMALL = {"--png": "a.png", "--size": "60x40"}
PICTURES = SMALL, {"--html": "a.html"}, {"--web": None}, {"--terminal": "symbols"}
OUTPUT = {"--output": Option("out")}
OF_DEFINITION = {
    **OUTPUT, "--set": Option("model.parameters.tolerance=1"),
    "--allow-process": Option(None, beside={"": "slow.toml"})}


def of_model(shard, **more):
    return {
        "--allow-process": Option("slow.toml", telling="none.toml", beside={"": f"process.{shard}", **more})}


# Of each filter: what it is given anyway, and its options.
FILTERS = {
    "seed": ({"": "ball.toml"}, OF_DEFINITION),
    "expand": ({"": "ball.seeds"}, {
        **of_model("seeds"), **OUTPUT, "--part": Option("1/2"), "--complete": Option(), "--threads": Option("2"),
        "--cost": Option("new.cost")}),
    "merge": ({"": "ball.grid"}, {
        **OUTPUT, "--small": Option(), "--cost": Option("new.cost")}),
    "verify": ({"": "ball.grid"}, {
        **of_model("grid", **{"--recompute": "1", "--walks": "1"}), **OUTPUT, "--threads": Option("2"), "--format": Option("json"), "--verbose": Option(),
        "--recompute": Option("none"), "--walks": Option("2"), "--accuracy": Option("1e-9")}),
    "stats": ({"": "ball.grid"}, {
        **OUTPUT, "--cost": Option("cost"), "--get": Option("records"),
        "--format": Option("json"), "--npy": Option("a.npy")}),
    "check-model": ({"": "ball.toml", "--steps": "20", "--format": "json"}, {
        **OF_DEFINITION, "--steps": Option("30"), "--seconds": Option("9", telling="1e-9"), "--format": Option("text")}),
    "play": ({"": "ball.grid", "--device": "path:path", "--log": "out.log"}, {
        **of_model("grid"),
        "--device": Option("path:back"), "--traversal": Option("paper"), "--beside": Option("7"),
        "--list-devices": Option(None, {"": ..., "--device": ..., "--log": ...}),
        "--rate": Option("2000"), "--duration": Option("0.03"), "--realtime": Option("off", {"--rate": "2000"}),
        "--selftest": Option(None, {"": ..., "--device": ..., "--log": ..., "--rate": "1000", "--duration": "0.1"}),
        "--log": Option("other.log"), "--frames": Option("out.frames"), "--report": Option("out.json"),
        "--config": Option("play.toml"), "--gain": Option("2"),
        "--max-force": Option("0.001", telling="0"), "--scale": Option("5")}),
    "view": ({"": "one.frames"}, {
        "--xyz": Option("a.xyz"), "--hip-label": Option("He", {"--xyz": "a.xyz"}), "--png": Option("a.png", SMALL),
        "--at": Option("0", {**SMALL, "": "frames"}), "--html": Option("a.html"), "--web": Option(),
        "--terminal": Option("symbols"), "--imd": Option("198.51.100.1:0"), "--style": Option("sticks", *PICTURES),
        "--size": Option("40x30", SMALL), "--from": Option("50,30", *PICTURES)}),
}
# What need not show: (option, the other one), "" for all, and why.
SILENT = {
    ("--threads", ""): "the result is the same",
    ("--verbose", "--format"): "JSON has all figures",
}


def run(tool, given):
    """Exit code, standard output and error, and the files that were written."""
    words = [os.environ["HAPGRID_BIN"] + "/" + tool]
    for name, value in given.items():
        if value is ...:
            continue
        words += [f"{name}={value}"] if name in ("--terminal", "--imd") else [word for word in (name, value) if word]
    if "--terminal" in given:
        words = ["script", "-qec", shlex.join(words), "/dev/null"]
    with tempfile.TemporaryDirectory(dir=IN + "/..") as folder:
        for name in os.listdir(IN):
            os.symlink(os.path.join(IN, name), os.path.join(folder, name))
        before = set(os.listdir(folder))
        with subprocess.Popen(words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            out = b""
            if "--web" in given:
                out = scene(process)
            more, err = process.communicate(timeout=60)
        files = {name: open(os.path.join(folder, name), "rb").read() for name in sorted(set(os.listdir(folder)) - before)}
    return 0 if process.returncode == -signal.SIGTERM else process.returncode, plain(out + more), plain(err), {name: plain(text) for name, text in files.items()}


def plain(text):
    """Without the times that a run took."""
    text = re.sub(rb'(?s)"(lateness|compute)": {.*\]', rb"", text)  # of a report of play
    text = re.sub(rb"[\d.]+ (ns|\xc2\xb5s|ms|s|min|h)\b", rb"", text)  # of a report of check-model
    text = re.sub(rb'("\w*seconds_range"): ?\[[^]]*\]', rb"\1", text)
    return re.sub(rb'("\w*seconds"): ?[^,}\n]*', rb"\1", text)


def scene(process):
    """What a page of view --web gets first, whose end it is; nothing when it does not serve."""
    found = re.match(rb"http://([\d.]+):(\d+)(/\w+/)", process.stdout.readline())
    if not found:
        return b""
    host, port, path = (part.decode() for part in found.groups())
    with socket.create_connection((host, int(port))) as connection:
        connection.sendall((f"GET {path}ws HTTP/1.1\r\nHost: {host}:{port}\r\nOrigin: http://{host}:{port}\r\nUpgrade: websocket\r\n"
                            "Connection: Upgrade\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n"
                            "Sec-WebSocket-Protocol: hapgrid\r\n\r\n").encode())
        stream = connection.makefile("rb")
        while stream.readline().strip():
            pass
        size = stream.read(2)[1] & 127
        process.terminate()
        return stream.read(size if size < 126 else int.from_bytes(stream.read(2 if size == 126 else 8), "big"))


def differences(tool):
    base, options = FILTERS[tool]
    help = subprocess.run([f"{os.environ['HAPGRID_BIN']}/{tool}", "--help"], capture_output=True, text=True, check=True).stdout
    there = set(re.findall(r"^  (?:-\w, )?(--[\w-]+)", help, re.M)) - {"--help", "--version"}
    if there != set(options):
        yield f"{tool}: options without a value here, or values without an option: {sorted(there ^ set(options))}"
    known = {}

    def seen(given):
        key = tuple(sorted(given.items(), key=str))
        if key not in known:
            known[key] = run(tool, given)
        return known[key]
    for name, option in options.items():
        alone = merged(base, option.sets[0], {name: option.value})
        first = seen(alone)
        if first[0] == 2:
            yield f"{tool} {name}: refused: {first[2].decode()}"
        # What is shown live depends on time.
        if name not in ("--rate", "--realtime", "--selftest", "--web", "--terminal") and run(tool, alone) != first:
            yield f"{tool} {name}: twice the same command is not the same: {first} {run(tool, alone)}"
    for (a, one), (b, other) in itertools.permutations(options.items(), 2):
        if {(a, ""), ("", b), (a, b)} & set(SILENT):
            continue
        for of_one, of_other in itertools.product(one.sets, other.sets):
            without = merged(base, of_one, of_other, {b: other.value}, one.beside or {})
            both = merged(without, {a: one.telling})
            if both == without:  # the other one needs it
                del without[a]
            result = seen(both)
            if result[0] != 2 and result == seen(without):
                yield f"{tool}: {a} does nothing in: {both} {result[0]} {result[2].decode()[:200]}"


if __name__ == "__main__":
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = [line for lines in pool.map(lambda tool: list(differences(tool)), sys.argv[1:] or FILTERS) for line in lines]
    print(*found, sep="\n", file=sys.stderr)
    sys.exit(bool(found))
