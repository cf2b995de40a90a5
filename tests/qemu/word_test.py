"""What the machine of words.sh wrote: GOT, "hid" or "stick", the cells as WHO.WHAT. Prints the table of the times until zero
force, and compares it with the one that is promised."""
import re
import sys

import machine

NEVER, STAYS, LUCK = "never", "stays", "luck"
WHATS = ("KILL", "TERM", "SEGV", "STOP", "120", "500", "SPIN")
# Milliseconds at most, in the machine's own time: what is promised, and 15 ms for starting programs and for ticks of 4 ms.
PROMISED = {
    "play":               (100, 0, 100, 100, 100, 100, 100),
    "guard":              (10, STAYS, STAYS, STAYS, STAYS, STAYS, 100),
    "adapter":            (20, 0, 20, 200, 120, 200, 350),
    "play+guard":         (100, 0, 100, 100, 100, 100, 150),
    "play+adapter":       (20, 0, 20, 200, 120, 200, 350),
    "guard+adapter":      (20, 0, 20, 250, 120, 250, 500),
    "play+guard+adapter": (NEVER, 0, 20, NEVER, 120, 500, LUCK),
}
SLACK, LENGTH = 15, 250
got, device, *wanted = sys.argv[1:]
if device == "stick":  # the kernel ends an effect when its file is closed, and the device does after 250 ms
    PROMISED = {who: [0 if limit == NEVER and what == "KILL" else LENGTH if limit in (NEVER, LUCK) or
                      limit not in (STAYS,) and limit > LENGTH else limit for what, limit in zip(WHATS, row)]
                for who, row in PROMISED.items()}
parts = {tuple(heading.split()): lines for heading, lines in machine.parts(got).items()}


def hid_forces(lines):
    """(microseconds, whether there is a force) of each report."""
    (began,) = [float(line.split()[-1]) for line in lines if " end " in line]
    return [(began + float(line.split()[0]), line.split()[2] != "0") for line in lines if " out " in line]


def stick_forces(lines):
    """The same of each effect that is changed, started or stopped; one that is not started again ends."""
    found, level, plays, until = [], 0, False, 0
    for words in (line.split() for line in lines if re.match(r"\d+ (upload|play|erase) ", line)):
        time = float(words[0])
        if plays and level and time > until:
            found.append((until, False))
            plays = False
        if words[1] == "upload" and words[3] == "constant":
            level = int(words[4])
        elif words[1] == "play":
            plays, until = words[3] != "0", time + 1000 * LENGTH
        elif words[1] == "erase":
            plays = False
        found.append((time, plays and level > 0))
    return found + [(until, False)] * (plays and level > 0)


def until_zero(lines, what):
    """Milliseconds from the disturbance to the first zero force behind the last force; NEVER, or STAYS."""
    (disturbed,) = [float(line.split()[1]) for line in lines if line.startswith("disturbed ")]
    assert [is_force for time, is_force in forces(lines) if time < disturbed][-1], lines[-20:]
    # What comes 0.6 s after the disturbance is the end of the play, or what was told to go on.
    pause = 1e3 * int(what) if what.isdigit() else 0
    within = [(time, is_force) for time, is_force in forces(lines) if time < disturbed + pause + 580e3]
    zeros = [time for time, is_force in within if time >= disturbed and not is_force]
    if zeros:
        # A play that goes on after a pause may get its force back.
        return max(0, (zeros[0] - disturbed) / 1000)
    return STAYS if "running yes" in lines and within[-1][0] > disturbed + 300e3 else NEVER


def is_kept(took, limit):
    if limit in (NEVER, STAYS):
        return took == limit
    return limit == LUCK or took not in (NEVER, STAYS) and took <= limit + SLACK


forces = {"hid": hid_forces, "stick": stick_forces}[device]
bad, cells = [], set()
for who, promised in PROMISED.items():
    row = []
    for what, limit in zip(WHATS, promised):
        lines = parts.get((who, what))
        if lines is None:
            row.append("")
            continue
        assert "left alive" not in lines, (who, what, lines[:10])
        took = until_zero(lines, what)
        cells.add(f"{who}.{what}")
        if not is_kept(took, limit):
            bad.append((who, what, took, limit))
        row.append(took if isinstance(took, str) else str(round(took)))
        # However it ended, the last word is a zero, unless nobody was left.
        assert limit in (NEVER, LUCK) or not forces(lines)[-1][1], (who, what, lines[-5:])
    print(f"{who:20}" + "".join(f"{cell:>7}" for cell in row))
assert cells == set(wanted) and not bad, (bad, set(wanted) - cells)
