"""faults.py [--table | WORDS...]: plants faults into grids, one at a time, and asks verify; called
by faults.sh in its directory, where the good grids are.

The faults are in faults_in_*.py: each is a function that changes a grid, and may return the place
that the report must name. --table lists all of them with the rows of the report that must be
broken: exactly these, and the first is the check for this kind of fault. A text between asterisks is
the end of the error message with which verify refuses the grid (exit code 1). Where no row is broken,
those that could prove nothing are listed as "(not proved)". verify runs with --recompute all unless the
options say otherwise.
Checksums, digests and sums are made right again after each change, except in the part "not sealed".

The grids (faults.sh): ball is a hung ball of 14 x 3 x 2 points; stored is the same with force, energy
and shape; fine has half of the spacing; middle waits for its second round; chunks has five large
states of a toy model.
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


def table():
    """A line a fault: its part, what was changed, the grid, options of verify, and what finds it."""
    lines = ["part\tfault\tgrid\toptions\tfound by"]
    for f in planting.FAULTS:
        lines.append("\t".join((f.part, f.name, f.grid, " ".join(f.arguments), f.found_by())))
    return "\n".join(lines) + "\n"


def examine(number, fault, shows):
    """Plants one, and says what is wrong with what verify says of it."""
    data, where = fault.make()
    if data == planting.read(fault.grid):
        return "nothing was changed"
    name = "bad.%d" % number
    with open(name, "wb") as file:
        file.write(data)
    options = fault.arguments if "--recompute" in fault.arguments else ["--recompute", "all"] + fault.arguments
    done = subprocess.run(["verify", name, "-v", *options], capture_output=True, text=True)
    os.unlink(name)
    if shows:
        print(done.stdout, done.stderr, where)
    if fault.refused:
        if done.returncode != 1 or done.stdout or not fault.is_refusal(done.stderr):
            return "exit code %d: %s" % (done.returncode, done.stderr)
        return ""
    rows = re.findall("^([a-z-]+) .*  broken$", done.stdout, re.M)
    if not rows:
        rows = [name + " (not proved)" for name in re.findall("^([a-z-]+) .*  not proved$", done.stdout, re.M)]
    code, verdict = (3, "broken: ") if fault.rows else (0, "fine: ")
    if any("(not proved)" in row for row in fault.rows):
        code, verdict = (4, "not proved: ")
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
    print("%d faults found, %d grids that are no fault" % (found, len(faults) - found))
    if bad:
        sys.exit("\n".join(bad))


main(sys.argv[1:])
