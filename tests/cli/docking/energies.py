"""Energies of the plug-in against autodock4's and vina's: energies.py DIR on|between|own|atoms|within|wall [MAPS]

on: 50 poses of a ligand whose atoms all lie on points of the maps, where the linear rule of autodock4 and vina and the
splines of the plug-in must agree to the last digit that is printed.
between: 50 random poses of DIR's ligand that no atom of the host repels. Between the points the linear rule is off by up
to h^2/8 times the second derivative, so autodock4 needs fine maps, MAPS.
own: the same where DIR was made of the maps in MAPS.
atoms: the same for a host without maps, all of whose types are in WELLS, with MAPS for autodock4.
within: 50 shapes of DIR's ligand, whose bonds turn: the energy between its own atoms.
wall: of DIR's records none has a force above 3 N; at the points of the grid no orientation is deeper than the wall, and
inside atoms all have its energy.
MAPS: the folder with AutoGrid's maps, when it is not DIR."""


import ctypes
import os
import subprocess
import sys
import tomllib

import numpy as np


POSES = 50
RIM = 10  # kJ/mol
# Of AutoDock's types that make no hydrogen bond with a host of C, A, N and H: distance and depth of the well, volume and
# solvation (AD4.1_bound.dat).
WELLS = {"H": (2, 0.02, 0, 0.00051), "HD": (2, 0.02, 0, 0.00051), "C": (4, 0.15, 33.5103, -0.00143),
         "A": (4, 0.15, 33.5103, -0.00052), "N": (3.5, 0.16, 22.4493, -0.00162), "OA": (3.2, 0.2, 17.1573, -0.00251)}


class Parameter(ctypes.Structure):
    _fields_ = [("key", ctypes.c_char_p), ("type", ctypes.c_int32), ("count", ctypes.c_size_t),
                ("numbers", ctypes.POINTER(ctypes.c_double)), ("texts", ctypes.POINTER(ctypes.c_char_p))]


class Table(ctypes.Structure):
    _fields_ = [("version", ctypes.c_uint32), ("summary", ctypes.c_char_p)] + [
        (name, ctypes.c_void_p) for name in ("create", "destroy", "info", "known_states", "convert", "equal", "force",
                                             "energy")]


def model(plugin, given):
    """A function energy(x, s) of the plug-in with these parameters."""
    library = ctypes.CDLL(plugin)
    library.hapgrid_model_plugin.restype = ctypes.POINTER(Table)
    table = library.hapgrid_model_plugin().contents
    entries = (Parameter * len(given))()
    keep = []
    for entry, (key, value) in zip(entries, sorted(given.items())):
        entry.key, entry.count = key.encode(), 1
        if isinstance(value, (int, float)):
            entry.type, entry.numbers = 1, (ctypes.c_double * 1)(value)
        elif isinstance(value, list) and isinstance(value[0], (int, float)):
            entry.type, entry.count, entry.numbers = 3, len(value), (ctypes.c_double * len(value))(*value)
        else:
            texts = [value] if isinstance(value, str) else value
            entry.type, entry.count = (2, 1) if isinstance(value, str) else (4, len(texts))
            entry.texts = (ctypes.c_char_p * len(texts))(*(t.encode() for t in texts))
        keep.append(entry)
    create = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.POINTER(Parameter), ctypes.c_size_t, ctypes.c_char_p,
                              ctypes.c_size_t)(table.create)
    error = ctypes.create_string_buffer(512)
    made = create(entries, len(given), error, 512)
    assert made, error.value
    numbers = ctypes.POINTER(ctypes.c_double)
    energy = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_void_p, numbers, numbers)(table.energy)
    return lambda x, s: energy(made, (ctypes.c_double * 3)(*x), (ctypes.c_double * len(s))(*s))


def definition(folder):
    name = os.path.basename(os.path.realpath(folder))
    with open(f"{folder}/{name}.toml", "rb") as file:
        return tomllib.load(file)


def energies(folder, kinds, poses, wanted="Total Intermolecular Interaction Energy"):
    """What autodock4 says of poses, in kcal/mol."""
    maps = "".join(f"map host.{kind}.map\n" for kind in kinds)
    with open(f"{folder}/poses.dpf", "w", encoding="ascii") as file:
        file.write("autodock_parameter_version 4.2\noutlev 1\nintelec\nligand_types " + " ".join(kinds)
                   + f"\nfld host.maps.fld\n{maps}elecmap host.e.map\ndesolvmap host.d.map\n"
                   + "".join(f"move {pose}\nabout 0 0 0\nepdb\n" for pose in poses))
    subprocess.run(["autodock4", "-p", "poses.dpf", "-l", "poses.dlg"], cwd=folder, check=True, stderr=subprocess.DEVNULL)
    with open(f"{folder}/poses.dlg", encoding="ascii", errors="replace") as file:
        return [float(line.split("=")[1].split()[0]) for line in file
                if wanted in line]


def vina(folder, pose):
    said = subprocess.run(["vina", "--ligand", pose, "--maps", "host", "--scoring", "ad4", "--score_only", "--cpu", "1"],
                          cwd=folder, capture_output=True, text=True, check=True).stdout
    return float(next(line for line in said.splitlines() if "Intermolecular" in line).split(":")[1].split()[0])


def plugin_of(folder, ligand=None, wall=False):
    """energy(x, s) in kcal/mol, the text of the ligand, and the definition. AutoDock's energies have no wall."""
    defined = definition(folder)
    given = dict(defined["model"]["parameters"])
    for key, files in defined["model"]["files"].items():
        texts = []
        for one in files if isinstance(files, list) else [files]:
            with open(f"{folder}/{one}", encoding="ascii") as file:
                texts.append(file.read())
        given[key] = texts if isinstance(files, list) else texts[0]
    given["ligand"] = ligand or given["ligand"]
    if not wall:
        del given["wall"]
    energy = model(os.path.join(os.environ["HAPGRID_BIN"], "..", "models", "docking.so"), given)
    return lambda x, turn: energy(x, [*turn[:, 0], *turn[:, 1]]) / 4.184, given["ligand"], defined


def atom_line(number, kind, place, charge):
    return (f"ATOM  {number:5}  {kind[0]:<3} LIG A   1    " + "".join(f"{c:8.3f}" for c in place)
            + f"  0.00  0.00    {charge:+6.3f} {kind}")


def elsewhere(line, place):
    """The line of an atom elsewhere."""
    return line[:30] + "".join(f"{c:8.3f}" for c in place) + line[54:]


def on_points(folder, random):
    """(energy by the plug-in, text) of poses."""
    defined = definition(folder)
    lattice = {}
    with open(f"{folder}/{defined['model']['files']['maps'][0]}", encoding="ascii") as file:
        for line in file:
            word, *numbers = line.split()
            if word == "values":
                break
            lattice.setdefault(word, []).append(numbers)
    h = float(lattice["axis"][0][0])
    origin, counts = np.array(lattice["origin"][0], float), np.array(lattice["counts"][0], int)
    kinds, charges = ["C", "N", "OA", "HD"], [0.322, -0.332, -0.28, 0.29]
    shape = np.array([[0, 0, 0], [5, 0, 0], [-2, 4, 0], [1, -3, 4]])
    body = [atom_line(n + 1, kind, h * place, charge)
            for n, (kind, place, charge) in enumerate(zip(kinds, shape, charges))]
    energy, _, _ = plugin_of(folder, "\n".join(body) + "\n")
    while True:
        turn = np.zeros((3, 3))  # one of the 24 turns that carry the lattice into itself
        turn[random.permutation(3), range(3)] = random.choice([-1, 1], 3)
        if np.linalg.det(turn) < 0:
            continue
        places = shape @ turn.T + random.integers(6, counts - 6)
        if (places < 0).any() or (places >= counts).any():
            continue
        places = origin + h * places
        text = "\n".join(atom_line(n + 1, *row) for n, row in enumerate(zip(kinds, places, charges)))
        yield energy(places.mean(axis=0), turn), text


def between_points(folder, random):
    energy, ligand, defined = plugin_of(folder)
    lines = [line for line in ligand.splitlines() if line.startswith("ATOM")]
    body = atoms_of(ligand)[2]
    body -= body.mean(axis=0)
    low, size = np.array(defined["grid"]["origin"]), defined["grid"]["spacing"] * (np.array(defined["grid"]["counts"]) - 1)
    while True:
        x = low + random.random(3) * size
        turn, _ = np.linalg.qr(random.standard_normal((3, 3)))
        turn *= np.linalg.det(turn)
        yield energy(x, turn), "\n".join(map(elsewhere, lines, (body @ turn.T + x).round(3)))


def atoms_of(text):
    """(types, charges, places) of a PDBQT."""
    lines = [line for line in text.splitlines() if line.startswith("ATOM")]
    return ([line[77:79].strip() for line in lines], np.array([float(line[70:76]) for line in lines]),
            np.array([[float(line[c:c + 8]) for c in (30, 38, 46)] for line in lines]))


def by_formula(host, ligand, step=0.0):
    """AutoDock 4's energy in kcal/mol (Huey et al. 2007). step: of the distances in its tables; 0: no tables."""
    (kinds, charges, places), (others, q, at) = atoms_of(host), atoms_of(ligand)
    exact = np.linalg.norm(places[:, None] - at, axis=2)
    r = np.floor(exact / step) * step if step else exact
    a, b = (np.array([WELLS[kind] for kind in some]) for some in (kinds, others))
    best = (a[:, None, 0] + b[:, 0]) / 2
    smooth = np.where(r < best, np.minimum(r + 0.25, best), np.maximum(r - 0.25, best))
    well = 0.1662 * np.sqrt(a[:, None, 1] * b[:, 1]) * ((best / smooth)**12 - 2 * (best / smooth)**6)
    dielectric = -8.5525 + 86.9525 / (1 + 7.7839 * np.exp(-0.003627 * 86.9525 * r))
    charge = 0.1406 * 332.06363 * charges[:, None] * q / (exact * dielectric)
    solvation = 0.1322 * np.exp(-r**2 / (2 * 3.6**2)) * (
        (a[:, 3] + 0.01097 * abs(charges))[:, None] * b[:, 2] + (b[:, 3] + 0.01097 * abs(q)) * a[:, None, 2])
    return (well + charge + solvation).sum()


def bent(lines, places, angles):
    """Places of a PDBQT's atoms with its branches turned by the angles."""
    places, number, moved, bonds, opened = places.copy(), 0, [], [], []
    for line in lines:
        if line.startswith("BRANCH"):
            opened.append(len(moved))
            bonds.append([int(word) - 1 for word in line.split()[1:3]])
            moved.append([])
        elif line.startswith("ENDBRANCH"):
            opened.pop()
        elif line.startswith("ATOM"):
            for one in opened:
                moved[one].append(number)
            number += 1
    for (a, b), atoms, angle in zip(bonds, moved, angles):
        u = (places[b] - places[a]) / np.linalg.norm(places[b] - places[a])
        r = places[atoms] - places[a]
        places[atoms] = places[a] + r * np.cos(angle) + np.cross(u, r) * np.sin(angle) + np.outer(r @ u, u) * (1 - np.cos(angle))
    return places


def within(folder):
    """Against maps that are zero everywhere, what is left is the energy between the ligand's own atoms."""
    with open(f"{folder}/ligand.pdbqt", encoding="ascii") as file:
        text = file.read()
    lines = text.splitlines()
    atoms = [n for n, line in enumerate(lines) if line.startswith("ATOM")]
    kinds, _, places = atoms_of(text)
    turns = sum(line.startswith("BRANCH") for line in lines)
    kinds = sorted(set(kinds))
    zero = "hapgrid-table\ncounts 4 4 4\norigin -60 -60 -60\naxis 40 0 0\naxis 0 40 0\naxis 0 0 40\nvalues\n" + 64 * "0 "
    # So much softening that none of these energies is softened.
    energy = model(os.path.join(os.environ["HAPGRID_BIN"], "..", "models", "docking.so"),
                   {"ligand": text, "maps": [zero] * (len(kinds) + 2), "types": [*kinds, "e", "d"], "torsions": turns,
                    "soft": 1e6})
    random, ours, poses = np.random.default_rng(7), [], []
    while len(ours) < POSES:
        angles = random.uniform(-np.pi, np.pi, turns)
        one = energy([0, 0, 0], [1, 0, 0, 0, 1, 0, *angles]) / 4.184
        if one > 0.5:
            continue
        ours.append(one)
        new = bent(lines, places, angles)
        shape = list(lines)
        for k, place in zip(atoms, new):
            shape[k] = elsewhere(lines[k], place)
        poses.append(f"shape{len(poses)}.pdbqt")
        with open(f"{folder}/{poses[-1]}", "w", encoding="ascii") as file:
            file.write("\n".join(shape) + "\n")
    theirs = energies(folder, kinds, poses, "Final Total Internal Energy")
    assert len(theirs) == POSES, len(theirs)
    off = [abs(a - b) for a, b in zip(ours, theirs)]
    print(f"within: {min(ours):.2f} to {max(ours):.2f} kcal/mol, off from autodock4 by {max(off):.4f} kcal/mol at most")
    assert max(ours) - min(ours) > 0.3, "the shapes do not differ"
    # autodock4 prints two decimals, and takes distances at the multiple of 0.01 angstrom below them: at 2 angstrom this
    # adds 6 % to a repulsion that goes with the distance to the power of -12. The repulsion of a shape is not known; it is
    # taken to be at most the spread of the energies. obabel makes other shapes in each run.
    assert max(off) < 0.006 + 0.06 * (max(ours) - min(ours)), sorted(zip(off, ours, theirs))[-5:]


def wall(folder):
    energy, _, defined = plugin_of(folder, wall=True)
    box, random = defined["grid"], np.random.default_rng(7)
    with open(f"{folder}/wall.table", encoding="ascii") as file:
        values = np.array(file.read().partition("values\n")[2].split(), float)
    values = values.reshape(np.array(box["counts"][::-1]) + 2)[1:-1, 1:-1, 1:-1].transpose(2, 1, 0)
    assert 3 < (values > 0).sum() < values.size - 3, values
    for index, value in np.ndenumerate(values):
        x = np.array(box["origin"]) + box["spacing"] * np.array(index)
        for _ in range(20):
            turn, _ = np.linalg.qr(random.standard_normal((3, 3)))
            one = 4.184 * energy(x, turn * np.linalg.det(turn))
            # The table has eight digits. Up to RIM an orientation's own energy counts, too.
            assert value - 1e-5 < one < (value if value > RIM else RIM) + 1e-5, (index, value, one)
    records = np.load(f"{folder}/records.npy")
    forces = np.linalg.norm(records["force"], axis=1)
    print(f"wall: {(values > 0).sum()} of {values.size} points, at most {values.max():.1f} kJ/mol and {forces.max():.2f} N")
    assert 1 < forces.max() < 3, forces.max()


def main():
    folder, where, *there = sys.argv[1:]
    if where in ("wall", "within"):
        return globals()[where](folder)
    made = there[0] if there else folder
    ours, poses = [], []
    if where == "atoms":
        with open(f"{folder}/host.pdbqt", encoding="ascii") as file:
            host = file.read()
    for energy, text in {"on": on_points, "between": between_points, "own": between_points, "atoms": between_points}[where](
            folder, np.random.default_rng(7)):
        if energy > -0.8:  # kcal/mol: vina prints three decimals, and atoms that the host repels are soft here
            continue
        if where == "atoms":
            # Places of three decimals: up to 0.0005 angstrom of a slope of a few kcal/mol.
            assert abs(energy - by_formula(host, text)) < 0.003, (energy, by_formula(host, text))
            # AutoGrid takes most distances at the multiple of 0.01 angstrom below them.
            energy = by_formula(host, text, 0.01)
        ours.append(energy)
        poses.append(f"pose{len(poses)}.pdbqt")
        with open(f"{made}/{poses[-1]}", "w", encoding="ascii") as file:
            file.write(f"ROOT\n{text}\nENDROOT\nTORSDOF 0\n")
        if len(ours) == POSES:
            break
    kinds = [kind for kind in definition(made)["model"]["parameters"]["types"] if kind not in ("e", "d")]
    theirs = energies(made, kinds, poses)
    assert len(theirs) == POSES, len(theirs)
    off = [abs(a - b) / abs(b) for a, b in zip(ours, theirs)]
    print(f"{where}: {min(ours):.2f} to {max(ours):.2f} kcal/mol, off from autodock4 by {100 * max(off):.3f} % at most")
    # Four decimals are printed of 0.8, and places have three; between the points, what the rules differ by.
    # The host for atoms has sharper walls: its hydrogens attract none of the ligand's oxygens.
    # The splines of maps 0.25 angstrom apart follow walls that rise by 80 kJ/mol in an angstrom.
    most = {"on": 0.0005, "between": 0.02, "own": 0.01, "atoms": 0.015}[where]
    assert max(off) < most, sorted(zip(off, ours, theirs))[-5:]
    for n in range(0, POSES, POSES // 3):
        said = vina(made, poses[n])
        assert abs(ours[n] - said) < (most + 0.0007) * abs(said), (ours[n], said)


main()
