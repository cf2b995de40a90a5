"""faults.py [--table | WORDS...]: plants faults into grids, one at a time, and asks verify; called
by faults.sh in its directory, where the good grids are.

The faults are in faults_in_*.py: functions that change a grid, and answer what the report must say
of the place, if anything. Rows of the report are exactly those that are broken, the first is the one
whose business it is. Everything is sealed again with right checksums, and digests: only what
the fault is about is wrong, but for those of the last part.
"""

import concurrent.futures
import os
import re
import subprocess
import sys

import planting
# Each registers its faults, in this order.
import faults_in_links  # noqa: F401
import faults_in_records  # noqa: F401
import faults_in_numbers  # noqa: F401
import faults_in_headers  # noqa: F401
import faults_in_streams  # noqa: F401
import no_faults  # noqa: F401

TABLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "FAULTS.md")
INTRODUCTION = """# Faults that `verify` was shown

Each is planted into a good grid, alone, and `verify` (with `--recompute all` where nothing else is said) must find it by just
these rows of its report, the first being the one whose business it is; or refuse the grid, exit code 1, with the line
*in italics*. `faults.sh` does it and compares this page with what it did; `faults.sh --table` writes it. *ball* is a hung
ball of 14 x 3 x 2 points, *stored* the same with force, energy and shape in the grid, *fine* has half of the spacing,
*middle* waits for its second round, *chunks* has five large states of a toy.
What is wrong in the switch rule of play and not in a grid is planted in `tests/unit/check/switch_rule_test.cpp`.
"""


def table():
    lines = [INTRODUCTION]
    for title in dict.fromkeys(f.part for f in planting.FAULTS):
        lines += ["## " + title, "", "| fault | in | found by |", "|---|---|---|"]
        for f in planting.FAULTS:
            if f.part == title:
                options = " `%s`" % " ".join(f.arguments) if f.arguments else ""
                lines.append("| %s | %s%s | %s |" % (f.name, f.grid, options, f.found_by()))
        lines.append("")
    return "\n".join(lines).rstrip("\n") + "\n"


def examine(number, fault, shows):
    """Plants one, and says what is wrong with what verify says of it."""
    data, where = fault.make()
    if data == planting.read(fault.grid):
        return "nothing was changed"
    name = "bad.%d" % number
    with open(name, "wb") as file:
        file.write(data)
    options = fault.arguments if "--recompute" in fault.arguments else ["--recompute", "all"] + fault.arguments
    done = subprocess.run(["verify", name, *options], capture_output=True, text=True)
    os.unlink(name)
    if shows:
        print(done.stdout, done.stderr, where)
    if fault.refused:
        if done.returncode != 1 or done.stdout or not fault.is_refusal(done.stderr):
            return "exit code %d: %s" % (done.returncode, done.stderr)
        return ""
    rows = re.findall("^([a-z-]+) .*  broken$", done.stdout, re.M)
    code, verdict = (3, "broken: ") if fault.rows else (0, "fine: ")
    if done.returncode != code or not done.stderr.startswith("verify: " + verdict) or sorted(rows) != sorted(fault.rows):
        return "exit code %d, rows %s: %s" % (done.returncode, rows, done.stderr)
    # The place is named where its row lists offenders.
    if where:
        listed = re.search("^%s: .*\n((?:  .*\n)+)" % fault.rows[0], done.stdout, re.M)
        if not listed or where not in listed[1]:
            return "%s is not named in\n%s" % (where, listed and listed[1])
    return ""


def main(words):
    if words == ["--table"]:
        sys.stdout.write(table())
        return
    faults = [f for f in planting.FAULTS if not words or " ".join(words) in f.name]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        said = list(pool.map(lambda f: examine(*f, bool(words)), enumerate(faults)))
    bad = ["%s (%s): %s" % (f.name, f.grid, s) for f, s in zip(faults, said) if s]
    names = [(f.name, f.grid, *f.arguments) for f in planting.FAULTS]
    if len(set(names)) < len(names):
        bad.append("a fault has another's name: %s" % [n for n in names if names.count(n) > 1])
    found = sum(bool(f.rows or f.refused) for f in faults)
    if not words and found < 100:
        bad.append("only %d faults" % found)
    if not words and planting.read(TABLE).decode() != table():
        bad.append("FAULTS.md is not what was done: faults.sh --table writes it")
    print("%d faults found, %d grids that are no fault" % (found, len(faults) - found))
    if bad:
        sys.exit("\n".join(bad))


main(sys.argv[1:])
