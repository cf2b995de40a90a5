"""What is known of chemical elements: the model's own table, and the symbols of all."""

import tomllib
from pathlib import Path

from rdkit import Chem

_TABLE = tomllib.loads((Path(__file__).parent / "elements.toml").read_text(encoding="utf-8")).values()
MASSES = {one["number"]: one["mass"] for one in _TABLE}  # amu; the elements that a molecule may have
RADII = {one["number"]: one["radius"] for one in _TABLE}  # van der Waals, angstrom
COVALENT = {one["number"]: one["covalent"] for one in _TABLE}  # angstrom
COLOURS = {one["number"]: one["colour"] for one in _TABLE}  # red, green, blue in [0, 1]
SYMBOLS = ["X", *(Chem.GetPeriodicTable().GetElementSymbol(z) for z in range(1, 119))]
NUMBERS = {symbol.upper(): z for z, symbol in enumerate(SYMBOLS) if z} | {"D": 1, "T": 1}
METALS = {13, 28, 29, 46, 47, 78, 79}  # of these; no file of a molecule tells their bonds, so they are felt by --path alone
