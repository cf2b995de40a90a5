#!/usr/bin/python3
"""basins.py BUILD MODEL.toml GRID [PUSHES] [SEED]: where a molecule ends that was pushed at random.

GRID is that of MODEL.toml, a molecule whose paths go on behind their saddles (`hapgrid molecule
--basins`). Each push (150 of them) starts from the conformation: the probe comes from outside in a
random direction, aims near a random atom, goes up to 2 angstrom beyond it, and leaves on the same
line. It is played through the grid and by the model itself. Prints where both end, as t of the minima
(molecule-check lists them), and counts: pushes that end in no minimum, that end where the model does,
and that the model ends elsewhere than in the conformation. Exit code 1 when the grid ends in no minimum
or in fewer than 29 of 30 pushes where the model does.
"""
import collections
import os
import random
import subprocess
import sys
import tempfile

TICK = 0.02  # angstrom
NEAR = 0.02  # of a t, and angstrom or radians of shift and rotation: this is the minimum


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def direction(draw):
    while True:
        u = [draw.uniform(-1, 1) for _ in range(3)]
        length = sum(v * v for v in u) ** 0.5
        if 0.1 < length < 1:
            return [v / length for v in u]


def push(draw, atoms, low, high):
    """The places of the probe, there and back."""
    u, atom = direction(draw), draw.choice(atoms)
    aim = [a + draw.gauss(0, 0.5) for a in atom]
    out = min((high[k] - aim[k] if u[k] > 0 else low[k] - aim[k]) / u[k] for k in range(3) if u[k] != 0)
    beyond = draw.uniform(-1, 2)
    beyond = min(beyond, 0.98 * min((low[k] - aim[k] if u[k] > 0 else high[k] - aim[k]) / -u[k]
                                    for k in range(3) if u[k] != 0))
    count = max(int((0.98 * out + beyond) / TICK), 2)
    there = [[aim[k] + u[k] * (0.98 * out - (0.98 * out + beyond) * n / count) for k in range(3)]
             for n in range(count + 1)]
    return there + there[-2::-1]


def end(build, grid, path, rule, log):
    run(f"{build}/bin/play", grid, "--device", f"path:{path}", "--traversal", rule, "--log", log)
    with open(log, encoding="utf-8") as file:
        names = file.readline().lstrip("# ").rstrip("\n").split("\t")
        for line in file:
            last = line
    values = last.split("\t")
    return [float(values[n]) for n, name in enumerate(names) if name[0] == "s" and name[1:].isdigit()]


def main(build, toml, grid, pushes=150, seed=1):
    draw = random.Random(int(seed))
    rows = [line.split() for line in run(f"{build}/bin/molecule-check", toml).splitlines()
            if line.startswith("minimum ")]
    minima = [[float(t) for t in row[2].split(",")] for row in rows]
    if not minima:
        sys.exit(f"basins.py: {toml}: no minima behind saddles")
    shape = run(f"{build}/bin/molecule-check", toml, "--xyz=" + ",".join("0" for _ in minima[0])).splitlines()
    atoms = [[float(v) for v in line.split()[1:4]] for line in shape[2:]]
    low, spacing, counts = (numbers(run(f"{build}/bin/stats", grid, "--get", f"box.{key}"))
                            for key in ("origin", "spacing", "counts"))
    high = [a + spacing[0] * (n - 1) for a, n in zip(low, counts)]

    def basin(state):
        for t in minima:
            if all(abs(a - b) <= NEAR for a, b in zip(state, [*t, 0, 0, 0, 0, 0, 0])):
                return ",".join(f"{v:.3f}" for v in t)
        return "none"

    ends = collections.Counter()
    with tempfile.TemporaryDirectory() as work:
        for _ in range(int(pushes)):
            with open(f"{work}/path", "w", encoding="utf-8") as file:
                file.writelines(" ".join(f"{v:.5f}" for v in p) + "\n" for p in push(draw, atoms, low, high))
            ends[tuple(basin(end(build, grid, f"{work}/path", rule, f"{work}/log"))
                       for rule in ("branch", "model"))] += 1
    for (ours, truth), count in sorted(ends.items()):
        print(f"grid {ours:<16} model {truth:<16} {count:4d} pushes")
    nowhere = sum(n for (ours, _), n in ends.items() if ours == "none")
    same = sum(n for (ours, truth), n in ends.items() if ours == truth != "none")
    rest = basin([0] * (len(minima[0]) + 6))
    crossed = sum(n for (_, truth), n in ends.items() if truth != rest)
    print(f"{pushes} pushes: {nowhere} end in no minimum, {same} where the model does; "
          f"{crossed} leave the conformation")
    return 1 if nowhere or 30 * same < 29 * int(pushes) else 0


def numbers(text):
    return [float(v) for v in text.strip().strip("[]").split(",")]


if __name__ == "__main__":
    if not 4 <= len(sys.argv) <= 6 or not os.path.isdir(sys.argv[1]):
        sys.exit(__doc__.splitlines()[0])
    sys.exit(main(*sys.argv[1:]))
