"""What AutoGrid makes of a host and a ligand, by Debian's obabel and autogrid4."""

import os

import numpy as np
from hapgrid_table import course, readers
from hapgrid_table.work import Failed

MOST_HOST, MOST_LIGAND = 20_000, 200  # atoms
MOST_REMARKS = 2000  # lines
MOST_BYTES = 64 << 20
MOST_CELLS = 126  # of a map along an axis: AutoGrid has no more


def pdbqt(work, given, name, most):
    """Writes NAME.pdbqt from a file that Open Babel reads."""
    if os.path.getsize(given) > MOST_BYTES:
        raise Failed(f"{given}: it has more than 64 MiB")
    with open(given, encoding="utf-8", errors="replace") as file:
        text = file.read()
    if given.lower().endswith(".pdbqt"):
        work.write(f"{name}.pdbqt", text)
    else:
        lines = text.splitlines()
        counted = sum(line.startswith(("ATOM", "HETATM")) for line in lines) or len(lines) - MOST_REMARKS
        if counted > 4 * most:  # Open Babel would need minutes to say so; hydrogens of carbon go into their atoms
            raise Failed(f"{given}: it has more than {most:,} atoms")
        charges = [] if given.lower().endswith(".mol2") else ["--partialcharge", "gasteiger"]
        rigid = ["-xr"] if name == "host" else []
        out = work.path(f"{name}.pdbqt")
        _run(work, "obabel", "openbabel", os.path.abspath(given), "-O", os.path.abspath(out), *rigid, *charges)
    found = atoms(work.read(f"{name}.pdbqt"), given)
    if not found:
        raise Failed(f"{given}: Open Babel finds no atoms in it")
    if len(found) > most:
        raise Failed(f"{given}: {len(found):,} atoms, at most {most:,} are possible")
    if all(charge == 0 for _, _, charge in found):
        raise Failed(f"{given}: no atom has a charge")
    return found


def _run(work, program, package, *arguments):
    try:
        work.run([program], *arguments)
    except Failed as why:
        if "is not there" in str(why):
            raise Failed(f"{program} is not there: install the Debian package {package}") from None
        raise


def atoms(text, given):
    """[(type, place, charge)] of a PDBQT text."""
    found = []
    try:
        for line in text.splitlines():
            if line.startswith(("ATOM", "HETATM")):
                place = np.array([float(line[c:c + 8]) for c in (30, 38, 46)])
                found.append((line[77:79].strip(), place, float(line[70:76])))
            elif line.startswith("ENDMDL"):
                break
    except ValueError:
        raise Failed(f"{given}: an atom of the PDBQT has no place or charge") from None
    if any(not kind or not kind.isalnum() or not np.isfinite(place).all() for kind, place, _ in found):
        raise Failed(f"{given}: an atom of the PDBQT has no type or place")
    return found


def element(kind):
    """The symbol of the element of one of AutoDock's types."""
    if kind in ("Cl", "CL", "Ca", "CA", "Br", "BR", "Zn", "ZN", "Mg", "MG", "Mn", "MN", "Fe", "FE"):
        return kind.capitalize()
    return "C" if kind in ("A", "G", "J", "Q") else kind[0]


def compute(work, host, ligand, low, high, spacing):
    """Runs autogrid4 for a box with room for the ligand around low … high, and writes a table of each map.
    Returns the maps' names, and those of the tables."""
    centre = np.mean([place for _, place, _ in ligand], axis=0)
    reach = max(np.linalg.norm(place - centre) for _, place, _ in ligand) + spacing
    cells = np.ceil((high - low + 2 * reach) / spacing / 2).astype(int) * 2
    if cells.max() > MOST_CELLS:
        raise Failed(f"box and ligand need maps of {cells.max()} cells {spacing:g} angstrom wide, AutoGrid has at most "
                     f"{MOST_CELLS}: make --size smaller or --map-spacing larger")
    kinds = sorted({kind for kind, _, _ in ligand})
    middle = (low + high) / 2
    work.write("host.gpf", "\n".join([
        f"npts {cells[0]} {cells[1]} {cells[2]}", "gridfld host.maps.fld", f"spacing {spacing:g}",
        "receptor_types " + " ".join(sorted({kind for kind, _, _ in host})), "ligand_types " + " ".join(kinds),
        "receptor host.pdbqt", "gridcenter " + " ".join(f"{c:.3f}" for c in middle), "smooth 0.5",
        *(f"map host.{kind}.map" for kind in kinds), "elecmap host.e.map", "dsolvmap host.d.map",
        "dielectric -0.1465"]) + "\n")
    try:
        _run(work, "autogrid4", "autogrid", "-p", "host.gpf", "-l", "host.glg")
    except Failed as why:
        if not os.path.exists(work.path("host.glg")):
            raise
        with open(work.path("host.glg"), encoding="utf-8", errors="replace") as file:
            wrong = [line.strip() for line in file if "ERROR" in line]
        raise Failed("autogrid4: " + (wrong[0].removeprefix("autogrid4: ") if wrong else str(why))) from None
    names, tables = [*kinds, "e", "d"], []
    for name in names:
        with open(work.path(f"host.{name}.map"), encoding="ascii") as file:
            table = readers.read_map(file.read())
        table.values = np.nan_to_num(table.values, nan=readers.CAPPED)
        if not tables:  # the first map carries the host's atoms for pictures
            table.atoms = [(element(kind), place) for kind, place, _ in host
                           if (np.abs(place - middle) < (high - low) / 2 + reach + 4).all()]
        tables.append(f"host.{name}.table")
        work.write(tables[-1], course.table_text(table))
    return names, tables, ["host.gpf", "host.glg", *(f"host.{name}.map" for name in names)]
