"""The maps that a user has already, by their .fld file."""

from __future__ import annotations

import os

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed, read_bytes
from hapgrid.apps.table import readers
from hapgrid.apps.table.readers import Table

from . import maps
from .maps import Atoms

LABELS = {"Electrostatics": "e", "Desolvation": "d"}
OUTSIDE = 20.0  # kcal/(mol angstrom^2): an atom at a distance r from the maps has r^2 times it


def files(path: str) -> dict[str, str]:
    """{name of a map: its file}"""
    lines = _lines(path, 1 << 20)
    labels = [line.split("#")[0].partition("=")[2].strip() for line in lines if line.startswith("label=")]
    named = [word.partition("=")[2] for line in lines if line.startswith("variable")
             for word in line.split() if word.startswith("file=")]
    if not labels or len(labels) != len(named):
        raise Failed(f"{path}: no .fld file of AutoGrid: its labels and variables are not as many")
    strange = next((one for one in named if os.path.basename(one) != one), None)
    if strange is not None:
        raise Failed(f"{path}: names the file '{strange}': only files beside it are used, with plain names")
    return {LABELS.get(label, label.removesuffix("-affinity")): os.path.join(os.path.dirname(path), one)
            for label, one in zip(labels, named)}


def read(path: str, ligand: Atoms) -> tuple[list[str], list[Table]]:
    """(names, tables) of the maps for the ligand's types of atoms, of charge and of desolvation."""
    known = files(path)
    names, tables = [*maps.kinds_of(ligand), "e", "d"], []
    for name in names:
        if name not in known and not {"e", "d"} & set(known):
            raise Failed(f"{path}: it has no maps of charge and desolvation: Vina's own maps have none. AutoGrid makes what is needed, "
                         "from the host's file")
        if name not in known:
            raise Failed(f"{path}: there is no map {name}, which an atom of the ligand needs")
        tables.append(_map(known[name]))
        if tables[-1].values.shape != tables[0].values.shape or not (
                np.allclose(tables[-1].origin, tables[0].origin) and np.allclose(tables[-1].axes, tables[0].axes)):
            raise Failed(f"{path}: its maps have different points: {name} {_box(tables[-1])}, {names[0]} {_box(tables[0])}")
    return names, tables


def _box(table: Table) -> str:
    return f"{'x'.join(map(str, table.values.shape))} from {','.join(f'{v:g}' for v in table.origin)}, {table.axes[0, 0]:g} angstrom apart"


def host(path: str) -> Atoms:
    """The host's atoms, for pictures: none where its file is not there."""
    named = [line.split()[1] for line in _lines(path, 1 << 20) if line.startswith("#MACROMOLECULE ") and len(line.split()) == 2]
    beside = os.path.join(os.path.dirname(path), os.path.basename(named[0])) if named else ""
    if not beside.lower().endswith(".pdbqt") or not os.path.isfile(beside):
        return []
    return maps.atoms("\n".join(_lines(beside, maps.MOST_BYTES)), beside)


def _lines(path: str, most: int) -> list[str]:
    return read_bytes(path, most).decode("utf-8", "replace").splitlines()


def _map(path: str) -> Table:
    data = read_bytes(path, maps.MOST_BYTES)
    table = readers.behind_walls(path, lambda: readers.read_map(data.decode("utf-8", "replace")))
    table.values = np.nan_to_num(table.values, nan=readers.CAPPED)
    return table


def fitted(table: Table, low: Array, high: Array) -> Table:
    """A map from `low` to `high`, in whole steps. Beyond its edge it has the value there and an energy that grows with
    the square of the distance, so that the ligand's atoms stay inside."""
    h = table.axes[0, 0]
    begin = np.floor((low - table.origin) / h + 1e-6).astype(int)
    end = np.ceil((high - table.origin) / h - 1e-6).astype(int)
    if np.prod((end - begin + 1).astype(float)) > readers.MOST_VALUES / 4:
        raise Failed("box and ligand need maps of more than 4 million points: make --size smaller")
    at = [np.arange(a, b + 1) for a, b in zip(begin, end)]
    inside = [np.clip(k, 0, n - 1) for k, n in zip(at, table.values.shape)]
    away = [((k - i) * h)**2 for k, i in zip(at, inside)]
    values = table.values[np.ix_(*inside)] + OUTSIDE * (away[0][:, None, None] + away[1][:, None] + away[2])
    return readers.Table(values, table.origin + h * begin, table.axes, energy_unit=table.energy_unit)
