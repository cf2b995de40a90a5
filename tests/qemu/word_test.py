"""What word-test.sh's machine wrote: GOT. Prints the table of the times until zero force, and compares it with the one
that is promised."""
import re
import sys

NEVER, STAYS = "never", "stays"
WHATS = ("KILL", "TERM", "SEGV", "STOP", "120", "500")
# Milliseconds at most, in the machine's own time: what is promised, and 15 ms for starting programs and for ticks of 4 ms.
PROMISED = {
    "play":               (100, 0, 100, 100, 100, 100),
    "guard":              (10, STAYS, STAYS, STAYS, STAYS, STAYS),
    "adapter":            (20, 0, 20, 200, 120, 200),
    "play+guard":         (100, 0, 100, 100, 100, 100),
    "play+adapter":       (20, 0, 20, 200, 120, 200),
    "guard+adapter":      (20, 0, 20, 250, 120, 250),
    "play+guard+adapter": (NEVER, 0, 20, NEVER, 120, 500),
}
SLACK = 15
parts = {}
for line in open(sys.argv[1]):
    line = line.rstrip("\r\n")
    if line.startswith("== "):
        part = parts.setdefault(tuple(line[3:].split()), [])
    else:
        part.append(line)


def forces(lines):
    """(microseconds, whether there is a force) of each report."""
    (began,) = [float(line.split()[-1]) for line in lines if " end " in line]
    return [(began + float(line.split()[0]), line.split()[2] != "0") for line in lines if " out " in line]


def until_zero(lines):
    """Milliseconds from the disturbance to the first zero force behind the last force; NEVER, or STAYS."""
    (disturbed,) = [float(line.split()[1]) for line in lines if line.startswith("disturbed ")]
    all_of_it = forces(lines)
    assert any(is_force for time, is_force in all_of_it if time < disturbed), lines[-20:]
    # What comes after 0.45 s is the end of the play, or what was told to go on.
    within = [(time, is_force) for time, is_force in all_of_it if time < disturbed + 430e3]
    zeros = [time for time, is_force in within if time >= disturbed and not is_force]
    if zeros:
        # A play that goes on after a pause may get its force back.
        return max(0, (zeros[0] - disturbed) / 1000)
    return STAYS if "running yes" in lines and within[-1][0] > disturbed + 400e3 else NEVER


bad, cells = 0, 0
for who, promised in PROMISED.items():
    row = []
    for what, limit in zip(WHATS, promised):
        lines = parts.get((who, what))
        if lines is None:
            row.append("")
            continue
        assert "left alive" not in lines, (who, what, lines[:10])
        took = until_zero(lines)
        good = took == limit if limit in (NEVER, STAYS) else took not in (NEVER, STAYS) and took <= limit + SLACK
        bad += not good
        cells += 1
        row.append(f"{took if isinstance(took, str) else round(took)}{'' if good else '!!'}")
        # However it ended, the last report is a zero.
        assert not forces(lines)[-1][1], (who, what, lines[-5:])
    print(f"{who:20}" + "".join(f"{cell:>9}" for cell in row))
assert cells == 11 and not bad, f"{bad} of {cells} cells are later than promised"
