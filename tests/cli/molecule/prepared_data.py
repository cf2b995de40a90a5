"""prepared_data.py DIR...: checks in the files of prepared molecules what their reader does not: the paths lie as the
conformation and climb from it to a marked saddle, and the report says the same. It uses nothing of hapgrid."""

import os
import sys

MASS = {"H": 1.008, "C": 12.011, "N": 14.007, "O": 15.999, "Cl": 35.45}


def read(path):
    """[(words as a dictionary, masses, positions in angstrom)]"""
    lines = open(path, encoding="utf-8").read().splitlines()
    out = []
    while lines:
        count, words = int(lines[0]), lines[1].split(" ")
        atoms = [line.split() for line in lines[2:2 + count]]
        out.append((dict(w.split("=", 1) for w in words), [MASS[a[0]] for a in atoms],
                    [[float(v) for v in a[1:]] for a in atoms]))
        del lines[:2 + count]
    return out


def lies_as(frame, reference):
    """Whether it is centred, and need not turn to the best superposition: there the antisymmetric part of sum m x (x) ref
    is zero. Relative to the moment of inertia that is about in radians. The data were prepared with weights that differ
    from these by up to 1e-4 of themselves; 22 to 77 atoms are a few angstrom from the centre."""
    _, masses, x = frame
    centre = [sum(m * p[k] for m, p in zip(masses, x)) / sum(masses) for k in range(3)]
    t = [[sum(m * p[a] * q[b] for m, p, q in zip(masses, x, reference[2])) for b in range(3)] for a in range(3)]
    turn = max(abs(t[a][b] - t[b][a]) for a, b in ((0, 1), (0, 2), (1, 2))) / (t[0][0] + t[1][1] + t[2][2])
    return max(map(abs, centre)) < 1e-4 and turn < 1e-4


def check(path, start, row):
    frames = read(path)
    before = 0.0
    assert len(frames) == 11, path
    for k, frame in enumerate(frames):
        words, energy = frame[0], float(frame[0]["dE"])
        assert words["t"] == f"{k / 10:.1f}" and words["method"] == start[0]["method"], (path, words)
        # E is rounded to 1e-9 hartree = 3e-6 kJ/mol twice, and dE to 1e-4 kJ/mol.
        assert abs((float(words["E"]) - float(start[0]["E"])) * 2625.4996394799 - energy) < 1e-4, (path, words)
        assert energy > before - 0.05 and lies_as(frame, start), (path, words)
        before = energy
    assert words["nimag"] == "1" and words["nu1"] == row["nu1_cm-1"], (path, words)
    assert abs(float(row["energy_kJ_mol"]) - before) < 0.0051, (path, row)


for folder in sys.argv[1:]:
    lines = [line.rstrip("\n").split("\t") for line in open(f"{folder}/report.tsv") if line[0] != "#"]
    rows = {row[0]: dict(zip(lines[0], row)) for row in lines[1:]}
    start = read(f"{folder}/conformation.xyz")[0]
    assert start[0]["dE"] == "0.0000" and start[0]["nimag"] == "0" and lies_as(start, start), folder
    saddles = {name for name, row in rows.items() if row["kind"] == "saddle"}
    files = {name[:-4] for name in os.listdir(folder) if name.endswith(".xyz") and not name.startswith("guess-")}
    assert files - {"conformation", "start", "played"} == saddles, (folder, saddles)
    for name in saddles:
        check(f"{folder}/{name}.xyz", start, rows[name])
