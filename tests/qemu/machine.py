"""What the tests of the emulated machine read: the parts of what it wrote, and sessions among them."""
import base64
import os
import subprocess
import sys


def parts(name):
    """The lines behind each heading "== HEADING"."""
    found = {}
    for line in open(name):
        line = line.rstrip("\r\n")
        if line.startswith("== "):
            part = found.setdefault(line[3:], [])
        else:
            part.append(line)
    return found


def ticks(lines):
    """The ticks of a session in base64, as numbers (cli/stats/session.py text). It stays as log.session."""
    with open("log.session", "wb") as file:
        file.write(base64.b64decode("".join(lines)))
    text = subprocess.run([sys.executable, os.environ["HAPGRID_SOURCE"] + "/tests/cli/stats/session.py", "text", "log.session"],
                          check=True, capture_output=True, text=True).stdout
    with open("there.txt", "w") as file:
        file.write(text)
    return [list(map(float, line.split("\t"))) for line in text.splitlines() if line[0] != "#"]
