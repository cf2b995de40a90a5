# Texts from outside reach the terminal without characters that change how the rest is shown: those that
# Python's table of Unicode has as Cc, Cf, Zl and Zp, in names of files, keys, plug-ins, units and answers.
source "$(dirname "$0")/../cli/lib.sh"

cat >good.toml <<TOML
model = {name = "said", process = ["python3", "said.py"]}
grid = {origin = [0, 0, 0], spacing = 1, counts = [3, 3, 3]}
seeds = {points = [[0, 0, 0]]}
TOML
cat >said.py <<'PYTHON'
import json, sys
hidden = open("hidden", encoding="utf-8").read()
hello = json.loads(sys.stdin.readline())
if "refuse" in hello["parameters"]:
    print(json.dumps({"error": "no" + hidden}), flush=True)
    sys.exit()
print(json.dumps({"hapgrid": 1, "state_size": 1, "d_max": 10, "tolerance": 1e-3, "tolerance_unit": "r\u202e\x9b",
                  "length_unit": "m\u2066\x85", "energy_unit": "J\u200b\ufeff", "stored": ["force", "energy", "shape"],
                  "spheres": [{"radius": 1, "label": "C\u2028\u202e"}]}), flush=True)
for line in sys.stdin:
    q = json.loads(line)
    if q["op"] == "known_states":
        print(json.dumps({"id": q["id"], "states": [[0]]}), flush=True)
    else:
        print(json.dumps({"id": q["id"], "s": [0], "force": [0, 0, 0], "energy": 0, "shape": [0, 0, 0]}), flush=True)
PYTHON
cat >look.py <<'PYTHON'
import os, subprocess, sys, unicodedata
unseen = [c for c in map(chr, range(1, 0x110000)) if unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp")]
hidden = "".join(c for c in unseen if c != "/")
open("hidden", "w", encoding="utf-8").write(hidden)

def look(*words, **more):
    """Runs a filter, and looks at what it writes. @return its exit code and texts"""
    done = subprocess.run(words, capture_output=True, timeout=60, **more)
    for stream in (done.stdout, done.stderr):
        text = stream.decode("utf-8")  # an error where it is none
        bad = {f"U+{ord(c):04X}" for c in text if c != "\n" and c in unseen}
        assert not bad, (words[0], bad, text[:400])
    assert done.stderr.count(b"\n") <= 1 or words[0] == "play" or "--imd=0" in words, done.stderr
    return done.returncode, done.stdout.decode(), done.stderr.decode()

def toml(name, text):
    open(name, "w", encoding="utf-8").write(text)
    return name

good = open("good.toml").read()
key = "".join(f"\\u{ord(c):04X}" if ord(c) < 0x10000 else f"\\U{ord(c):08X}" for c in hidden)
short = hidden[40:120]  # a file may have this name, with C1 controls among it
# Names of files, which are there or not.
for tool in ("seed", "expand", "merge", "verify", "stats", "view", "check-model"):
    for name in (hidden, short):
        code, out, err = look(tool, name)
        assert code == 1 and out == "" and "?" in err, (tool, code, out, err)
# Keys, plug-ins, commands, answers.
grid = good.split("\n", 1)[1]
for model in ('plugin = "%s"' % key, 'plugin = "hung-ball", parameters = {"%s" = 1}' % key,
              '"%s" = 1' % key, 'plugin = "hung-ball", files = {a = "%s"}' % key[:200],
              'name = "a", process = ["%s"]' % key, 'name = "a", process = ["echo", "%s"]' % key,
              'name = "said", process = ["python3", "said.py"], parameters = {refuse = true}'):
    code, out, err = look("seed", toml("bad.toml", "model = {%s}\n" % model + grid), "--allow-process", "-o", "out")
    assert code == 1 and err, (model, code, err)
# A grid with all of it, in text and JSON.
toml("said.toml", good.replace('"said.py"]', '"said.py"], parameters = {"k%s" = "v%s"}' % (key, key)))
assert look("seed", "said.toml", "--allow-process", "-o", "seeds")[0] == 0
assert look("expand", "--complete", "seeds", "--allow-process", "said.toml", "-o", "grid")[0] == 0
for form in ("text", "json"):
    for command in (("stats", "grid"), ("verify", "grid", "--recompute", "none"),
                    ("check-model", "said.toml", "--allow-process")):
        code, out, err = look(*command, "--format", form)
        assert out and code in (0, 3, 4), (command, code, err)
assert look("stats", "grid", "--get", "tolerance_unit")[1] == "r??\n"
open("path", "w").write("1 1 1\n")
for options in (["grid", "--device", "path:" + short], ["grid", "--device", "hid:" + short],
                [short, "--device", "path:path"], ["grid", "--device", "path:path", "--config", short],
                ["grid", "--device", short]):
    code, out, err = look("play", *options)
    assert code in (1, 2) and "?" in err, (options, code, err)
code, out, err = look("play", "grid", "--device", "path:path", "--frames", "frames", "--log", "a.session",
                      "--report", "-")
assert code == 0, (code, out, err)
code, out, err = look("view", "--imd=0", input=open("frames", "rb").read())
assert code == 0 and "energies go out in J??" in err, (code, out, err)
assert look("view", "frames")[0] == 0
for form in ("text", "json"):
    assert look("stats", "a.session", "--format", form)[0] == 0
# Programs in Python and in the shell. What is no letter of ASCII is a question mark in the shell's.
shell = "\x1b]0;title\x07\x9b\u202e\u2028\ufeff\\033[31m"
for words in (["hapgrid", "molecule", short + ".xyz", "-o", "none"],
              ["hapgrid", "molecule", "--smiles", "C" + short, "-o", "none"],
              ["hapgrid", "molecule", "--smiles", "C", "-o", "none", "--" + shell],
              ["hapgrid", shell], ["hapgrid", "help", shell], ["hapgrid", "init", shell], ["hapgrid", "init", "--" + shell],
              ["hapgrid", "init", "a", shell], ["hapgrid", "init", "a", "--lang", shell]):
    code, out, err = look(*words)
    assert code in (1, 2) and out == "" and "?" in err, (words, code, out, err)
PYTHON
python3 look.py
