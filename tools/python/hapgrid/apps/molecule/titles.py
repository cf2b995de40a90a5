"""Energies that the titles of frames give, in the units of the programs that wrote them.

    dE=         kJ/mol above the conformation: hapgrid
    Gtot, G=    hartree: CENSO, whose G counts and not the energy beside it
    energy=     eV: ASE and extended XYZ; so are free_energy= and a calculator's results in a trajectory of ASE
    all others  hartree: E= (hapgrid), energy: (xtb), E (ORCA), SCF Done, and a number alone (CREST)

A unit that follows the number, or --unit, says otherwise.
"""

from __future__ import annotations

import re

from .xtb import HARTREE

EV = 96.48533212331  # kJ/mol, CODATA 2018
UNITS = {"hartree": HARTREE, "ev": EV, "kj/mol": 1.0, "kcal/mol": 4.184}
_NUMBER = r"([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)"
_UNIT = r"[ \t\"]*\(?(kcal/mol|kj/mol|ev|hartrees?|eh|a\.?u\.?)?(?![\w/])"
_PATTERNS = [(re.compile(rf"(?:^|[\s,;(]){key}{_NUMBER}{_UNIT}", re.I if loose else re.NOFLAG), unit) for key, unit, loose in (
    (r"dE\s*=\s*", "kj/mol", False),
    (r"G[ _]?(?:\(?tot\)?)?\s*[:=]\s*", "hartree", True),
    (r"(?:free_)?energy\s*=\s*\"?", "ev", True), (r"E\s*=\s*", "hartree", False),
    (r"(?:total\s+)?energy\s*:?\s+", "hartree", True), (r"energy:", "hartree", True),
    (r"SCF\s+Done:?\s+(?:E\S*\s*=)?\s*", "hartree", True), (r"E\s+", "hartree", False))]
_ALONE = re.compile(rf"\s*{_NUMBER}{_UNIT}(?:\s*!.*|(?:\s+[^\s=]+=\S*)*\s*)")  # CREST, CENSO, and GOAT of ORCA


def energy(title: str, unit: str | None) -> tuple[float, str] | None:
    """(energy in kJ/mol, name of its unit), or None where a title has none. unit: of UNITS, that of all titles, or None."""
    for pattern, usual in _PATTERNS:
        if found := pattern.search(title):
            return _value(found, usual, unit)
    found = _ALONE.fullmatch(title)
    return _value(found, "hartree", unit) if found and ("." in found[1] or unit) else None


def _value(found: re.Match[str], usual: str, unit: str | None) -> tuple[float, str]:
    said = (found[2] or "").lower().replace(".", "")
    said = "hartree" if said in ("eh", "au") or said.startswith("hartree") else said
    name = unit or said or usual
    return float(found[1]) * UNITS[name], name
