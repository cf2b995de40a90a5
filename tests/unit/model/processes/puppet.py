"""A model process that does as it is told: the states are those of a closed form, so any answer of
a process that lived can be checked, and `fault` says what it does beside answering.

  puppet.py [FAULT [AT [in_flight=N]]]    FAULT happens at each AT-th question to a process (default 1):
    die crash hang garbage id number short long nan huge close   instead of an answer
    raise      an exception that nobody catches
    fail       answers {"error": ...}
    poison     dies at the questions whose s[0] is above AT, whoever asks
  or before: import version unknown-key no-size mute dead binary late-start rms
  or always: reverse (answers all that came together last first), slow-end (stays after its input),
    chatty (answers with more keys than asked for), stderr, group (starts a process that stays in
    its group), dying-group (and dies at the AT-th question)
"""
import json
import os
import signal
import subprocess
import sys
import time

fault = sys.argv[1] if len(sys.argv) > 1 else ""
at = float(sys.argv[2]) if len(sys.argv) > 2 else 1


def say(text):
    sys.stdout.write(text)
    sys.stdout.flush()


def lines():
    """Lists of the lines that came together."""
    rest = b""
    while chunk := os.read(0, 1 << 16):
        *whole, rest = (rest + chunk).split(b"\n")
        if whole:
            yield whole


def answer(question):
    op, x = question["op"], question["x"]
    if op == "known_states":
        return {"states": [[0.5, x[0]]]}
    if op == "evaluate":
        return {}
    s, d = question["s"], question["d"]
    y = x[1] + d[1]  # a branch that is kept where 0 < y < 2
    return {"s": [0.0 if y <= 0 else 1.0 if y >= 2 else s[0], x[0] + d[0]]}


source = lines()
waiting = next(source)
hello = json.loads(waiting.pop(0))
assert hello["hapgrid"] == 1
description = {"hapgrid": 1, "state_size": 2, "d_max": 10, "tolerance": 1e-3,
               "norm": "rms" if fault == "rms" else "max"}
if sys.argv[-1].startswith("in_flight="):
    description["in_flight"] = int(sys.argv[-1].partition("=")[2])
if fault == "import":
    import no_such_module  # noqa: F401
if fault == "version":
    description["hapgrid"] = 2
elif fault == "unknown-key":
    description["tolerence"] = 1
elif fault == "no-size":
    del description["state_size"]
elif fault == "mute":
    time.sleep(1000)
elif fault == "dead":
    sys.exit(5)
elif fault == "binary":
    sys.stdout.buffer.write(b"\xff\xfe\n")
elif fault == "late-start":
    time.sleep(0.3)
elif fault in ("group", "dying-group"):
    quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    subprocess.Popen(["sleep", "1000", *sys.argv[3:]], **quiet)
elif fault == "stderr":
    print("hello from the model", file=sys.stderr)
say(json.dumps(description) + "\n")

count = 0
while True:
    answers = []
    for line in waiting:
        question = json.loads(line)
        id = question["id"]
        count += 1
        if fault == "poison" and question["op"] == "convert" and question["s"][0] > at:
            os._exit(9)
        if count % at == 0 and fault != "poison":
            if fault in ("die", "dying-group"):
                os._exit(7)
            elif fault == "raise":
                {}["gone"]
            elif fault == "crash":
                os.kill(os.getpid(), signal.SIGSEGV)
            elif fault == "hang":
                if "HANGS" in os.environ:  # a file, for those who wait until it does
                    open(os.environ["HANGS"], "w", encoding="utf-8").close()
                time.sleep(1000)
            elif fault == "close":
                os.close(1)
                time.sleep(1000)
            elif fault == "huge":
                while True:
                    say("[" * 4096)
            instead = {"garbage": "Segmentation fault (core dumped)",
                       "id": '{"id": 4000000000, "s": [1, 2]}',
                       "number": f'{{"id": {id}, "s": ["one", 2]}}',
                       "short": f'{{"id": {id}, "s": [1]}}',
                       "long": f'{{"id": {id}, "s": [1, 2, 3]}}',
                       "nan": f'{{"id": {id}, "s": [NaN, 2]}}',
                       "fail": f'{{"id": {id}, "error": "told to\\nfail"}}'}.get(fault)
            if instead:
                answers.append(instead + "\n")
                continue
        extra = {"note": [{"s": [1]}, None]} if fault == "chatty" else {}
        answers.append(json.dumps({**extra, "id": id, **answer(question)}) + "\n")
    say("".join(reversed(answers) if fault == "reverse" else answers))
    waiting = next(source, None)
    if waiting is None:
        break
if fault == "slow-end":
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    time.sleep(1000)
