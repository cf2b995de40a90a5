"""prepared_data.py DIR...: checks in the files of prepared molecules all that their readers rely on.

It uses nothing of `hapgrid molecule` and only the standard library. It prints a line for each fault and then
exits with 1.
"""

import math
import os
import re
import sys

MASS = {"H": 1.008, "C": 12.011, "N": 14.007, "O": 15.999, "Cl": 35.45}
RADIUS = {"H": 0.31, "C": 0.76, "N": 0.71, "O": 0.66, "Cl": 1.02}  # Cordero et al. 2008, angstrom
WORD = re.compile(r"[A-Za-z][\w.-]*=\S+")
ENERGY = re.compile(r"dE=(\d+\.\d{4}|-0\.0[0-4]\d\d)")

faults = 0


def fault(text):
    global faults
    faults += 1
    print(text)


def read(path):
    """[(words as a dictionary, symbols, positions in angstrom)]"""
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    out, at = [], 0
    while lines[at:] != [""]:
        count = int(lines[at])
        words = lines[at + 1].split(" ")
        if not all(WORD.fullmatch(w) for w in words) or not ENERGY.fullmatch(words[0]):
            fault(f"{path}: comment is not key=value words with dE first: {lines[at + 1]}")
        atoms = [line.split() for line in lines[at + 2:at + 2 + count]]
        if not all(re.fullmatch(r"-?\d+\.\d{6,}", v) for a in atoms for v in a[1:]):
            fault(f"{path}: coordinates have less than 6 decimals")
        out.append((dict(w.split("=", 1) for w in words), [a[0] for a in atoms],
                    [[float(v) for v in a[1:]] for a in atoms]))
        at += count + 2
    return out


def centre(symbols, x):
    total = sum(MASS[s] for s in symbols)
    return [sum(MASS[s] * p[k] for s, p in zip(symbols, x)) / total for k in range(3)]


def turn_left(symbols, x, reference):
    """How far x has still to turn to the best superposition, where the antisymmetric part of
    sum m x (x) ref is zero. It is relative to the moment of inertia and so about in radians."""
    m = [[sum(MASS[s] * p[a] * q[b] for s, p, q in zip(symbols, x, reference)) for b in range(3)]
         for a in range(3)]
    size = m[0][0] + m[1][1] + m[2][2]
    return max(abs(m[a][b] - m[b][a]) for a, b in ((0, 1), (0, 2), (1, 2))) / size


def bonds(symbols, x):
    return {(i, j) for i in range(len(x)) for j in range(i)
            if math.dist(x[i], x[j]) < 1.25 * (RADIUS[symbols[i]] + RADIUS[symbols[j]])}


def report(path):
    with open(path, encoding="utf-8") as file:
        rows = [line.rstrip("\n").split("\t") for line in file if not line.startswith("#")]
    return {row[0]: dict(zip(rows[0], row)) for row in rows[1:]}


def check_path(path, start, row):
    frames = read(path)
    if len(frames) != 11:
        return fault(f"{path}: {len(frames)} nodes, not 11")
    (_, symbols, x0), (last, _, _) = start, frames[-1]
    if max(math.dist(p, q) for p, q in zip(frames[0][2], x0)) > 1e-7:
        fault(f"{path}: the first frame is not the conformation")
    before = 0.0
    for k, (words, names, x) in enumerate(frames):
        if names != symbols:
            fault(f"{path}: node {k}: its atoms are not the conformation's")
            continue
        if words["t"] != f"{k / 10:.1f}":
            fault(f"{path}: node {k}: t={words['t']}")
        # E is rounded to 1e-9 hartree = 3e-6 kJ/mol twice, and dE to 1e-4 kJ/mol.
        above = (float(words["E"]) - float(start[0]["E"])) * 2625.4996394799
        if abs(above - float(words["dE"])) > 1e-4:
            fault(f"{path}: node {k}: dE={words['dE']}, but by E it is {above:.4f}")
        if words["method"] != start[0]["method"]:
            fault(f"{path}: node {k}: method={words['method']}")
        if float(words["dE"]) < before - 0.05:
            fault(f"{path}: node {k}: the energy falls")
        before = float(words["dE"])
        # The data were prepared with weights that differ from these by up to 1e-4 of themselves; 22 to 77 atoms
        # are a few angstrom from the centre.
        if max(map(abs, centre(symbols, x))) > 1e-4 or turn_left(symbols, x, x0) > 1e-4:
            fault(f"{path}: node {k}: not aligned to the conformation")
        if bonds(symbols, x) != bonds(symbols, x0):
            fault(f"{path}: node {k}: bonds change")
    nu1 = last.get("nu1", "")
    if last.get("nimag") != "1" or not re.fullmatch(r"i\d+", nu1) or "torsion" not in last:
        fault(f"{path}: the last frame is not marked as a saddle")
    difference = abs(float(row["energy_kJ_mol"]) - float(last["dE"]))
    if row["nu1_cm-1"] != nu1 or difference > 0.0051:
        fault(f"{path}: the report says otherwise")


for directory in sys.argv[1:]:
    rows = report(os.path.join(directory, "report.tsv"))
    start = read(os.path.join(directory, "conformation.xyz"))[0]
    if start[0]["dE"] != "0.0000" or start[0].get("nimag") != "0":
        fault(f"{directory}: the conformation is not marked as the minimum")
    if max(map(abs, centre(start[1], start[2]))) > 1e-4:
        fault(f"{directory}: the conformation is not centred")
    saddles = {name for name, row in rows.items() if row["kind"] == "saddle"}
    there = {name[:-4] for name in os.listdir(directory) if name.endswith(".xyz")}
    guesses = {name for name in there if name.startswith("guess-")}
    if there - {"conformation", "start", "played"} - guesses != saddles:
        fault(f"{directory}: the report speaks of {sorted(saddles)}")
    for name in sorted(saddles & there):
        check_path(os.path.join(directory, name + ".xyz"), start, rows[name])
sys.exit(1 if faults else 0)
