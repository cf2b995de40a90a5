"""What is known of chemical elements: the model's own table, and the symbols of all."""

import os
import re

from rdkit import Chem

_TABLE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "../elements.inc")
_ROW = re.compile(r'^HAPGRID_ELEMENT\((\d+), "\w+", ([\d.]+), ([\d.]+), ([\d.]+), ([\d.]+)F, ([\d.]+)F, ([\d.]+)F\)', re.M)

with open(_TABLE, encoding="utf-8") as _file:
    _rows = [(int(row[0]), *map(float, row[1:])) for row in _ROW.findall(_file.read())]
MASSES = {row[0]: row[1] for row in _rows}  # amu; the elements that a molecule may have
RADII = {row[0]: row[2] for row in _rows}  # van der Waals, angstrom
COVALENT = {row[0]: row[3] for row in _rows}  # angstrom
COLOURS = {row[0]: row[4:] for row in _rows}  # red, green, blue in [0, 1]
SYMBOLS = ["X", *(Chem.GetPeriodicTable().GetElementSymbol(z) for z in range(1, 119))]
NUMBERS = {symbol.upper(): z for z, symbol in enumerate(SYMBOLS) if z} | {"D": 1, "T": 1}
