"""Units of energy and length that tables come in."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hapgrid.apps.common.files import Failed

if TYPE_CHECKING:
    from .readers import Table

BOHR = 0.529177210903  # angstrom, CODATA 2018
# In kJ/mol. kT is that of 298.15 K, and kT/e the same for a charge of 1, which --factor changes.
ENERGIES = {"kJ/mol": 1.0, "kcal/mol": 4.184, "eV": 96.48533212331, "meV": 0.09648533212331, "hartree": 2625.4996394798,
            "Ha": 2625.4996394798, "Ry": 1312.7498197399, "kT": 2.47895684, "kT/e": 2.47895684, "K": 0.00831446261815,
            "kcal/mol/e": 4.184, "kJ/mol/e": 1.0, "hartree/e": 2625.4996394798, "V": 96.48533212331}
LENGTHS = {"angstrom": 1.0, "bohr": BOHR, "nm": 10.0, "pm": 0.01}


def convert(table: Table, path: str, unit: str | None, length_unit: str | None) -> None:
    """Converts a table to the units of --unit and --length-unit, where the file's are known, and else names them."""
    if unit is not None:
        given, colon, wanted = unit.partition(":")
        given, wanted = (given, wanted) if colon else (table.energy_unit, unit)
        if colon and table.energy_unit not in ("", given):
            raise Failed(f"{path}: --unit {unit}: its values are in {table.energy_unit}")
        if given and given != wanted:
            strange = next((one for one in (given, wanted) if one not in ENERGIES), None)
            if strange is not None:
                raise Failed(f"{path}: --unit {unit}: from {given} to {wanted} there is no factor; known are {', '.join(ENERGIES)}")
            table.values = table.values * (ENERGIES[given] / ENERGIES[wanted])
            table.notes.append(f"values in {given} become {wanted}")
        elif not given:
            table.notes.append(f"the file names no unit: its values are taken as {wanted}. --unit FROM:TO converts them")
        table.energy_unit = wanted
    elif not table.energy_unit and not any("--unit" in note for note in table.notes):
        table.notes.append("its values have no unit: --unit names it")
    if length_unit is not None:
        given = table.length_unit if table.has_unit else ""
        if given and given != length_unit:
            if length_unit not in LENGTHS:
                raise Failed(f"{path}: --length-unit {length_unit}: its lengths are in {given}; known are {', '.join(LENGTHS)}")
            factor = LENGTHS[given] / LENGTHS[length_unit]
            table.origin, table.axes = table.origin * factor, table.axes * factor
            table.atoms = [(symbol, place * factor) for symbol, place in table.atoms]
            table.notes.append(f"lengths in {given} become {length_unit}")
        table.length_unit = length_unit
