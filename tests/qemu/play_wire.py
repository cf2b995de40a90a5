"""What went over the wire at 5,000 ticks against the session's text, EXPORTED: GOT, POSITIONS, EXPORTED."""
import re
import sys

got, positions, exported = sys.argv[1:]
text = open(got).read().replace("\r", "")
wire = [tuple(map(int, line.split())) for line in
        re.search(r"== record\n(.*?)== session", text, re.S).group(1).splitlines()]
ticks = [line.split("\t") for line in open(exported) if not line.startswith("#")]
hips = [tuple(map(float, t[1:4])) for t in ticks]
forces = [tuple(map(float, t[7:10])) for t in ticks]

# Positions: 0.2 m of reach fill 1.9 along x, so 9.5 units a metre, from the box's middle, which is at
# (-0.025, -0.025, -0.025). Each HIP is one that the device sent, in their order, none older than the
# third newest (a report a tick, and both at 5 kHz).
sent = [9.5e-6 * float(line.split()[0]) - 0.025 for line in open(positions)]
at = 0
for tick, (x, y, z) in enumerate(hips):
    while at < len(sent) and abs(sent[at] - x) > 1e-9:
        at += 1
    assert at < len(sent), f"tick {tick}: {x} is no position of the device after the one before"
    assert abs(y + 0.025) < 1e-9 and abs(z + 0.025) < 1e-9, (y, z)
assert at > 4900, at

def is_of(force, report):
    """Whether a report has this force in whole millinewtons, rounded towards zero."""
    return all(abs(w) <= abs(1000 * f) + 1e-6 and abs(1000 * f - w) < 1 + 1e-6 for f, w in zip(force, report))


# Forces: each report is what a tick had, in their order; what was replaced before it was written is
# left out, and that are few.
tick = 0
for number, report in enumerate(wire[:-1]):  # the last one is the stop's zero
    while tick < len(forces) and not is_of(forces[tick], report):
        tick += 1
    if tick == len(forces):
        rest = wire[number:]
        assert len(rest) <= 3 and all(w == (0, 0, 0) for w in rest), (number, rest[:5])
        break
assert len(wire) > 4500, len(wire)
print(f"{len(hips)} positions and {len(wire)} forces are the device's and the session's")
