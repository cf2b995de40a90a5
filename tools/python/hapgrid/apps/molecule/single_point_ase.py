r"""single-point-ase CALCULATOR [KEY=VALUE...] FILE.xyz

Prints the energy of a molecule in hartree, by ASE, for `hapgrid molecule
--single-points`. CALCULATOR is one of ASE's names, such as psi4, mopac, nwchem
or orca. KEY=VALUE is given to it as ASE describes it. Charge and unpaired
electrons are those that the title of the file gives as charge= and unpaired=.
Files of the calculator go to the working directory. It needs the Debian package
python3-ase and the calculator's own program, such as the packages psi4 and
mopac.

  hapgrid molecule --smiles CC -o ethane \
    --single-points 'single-point-ase psi4 method=mp2 basis=cc-pvtz'
"""
from __future__ import annotations

import ast
import os
import re
import sys
import sysconfig
from typing import Any

# What a calculator with a key "charge" calls the multiplicity; "" where it takes that from the atoms.
MULTIPLICITY = {"gaussian": "mult", "mopac": "", "nwchem": "", "orca": "mult", "psi4": "multiplicity", "qchem": "multiplicity"}


def value(text: str) -> Any:
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text


def keys(name: str, given: list[str], charge: int, unpaired: int) -> dict[str, Any]:
    """The arguments of a calculator: those that are given, and charge and multiplicity."""
    out = {key: value(text) for key, text in (word.split("=", 1) for word in given)}
    if name in MULTIPLICITY:
        own = {"charge": charge, MULTIPLICITY[name]: unpaired + 1}
        return {**{key: wanted for key, wanted in own.items() if key}, **out}
    if any(needed and not any(what in key for key in out) for what, needed in (("charge", charge), ("mult", unpaired))):
        sys.exit(f"single-point-ase: charge {charge}, {unpaired} unpaired electrons: tell {name} by its own KEY=VALUE")
    return out


def main(name: str, *words: str) -> None:
    *given, path = words
    # Debian's psi4 is a Python module outside of Python's own folders.
    sys.path.append("/usr/lib/" + sysconfig.get_config_var("MULTIARCH"))
    os.environ.setdefault("PSIDATADIR", "/usr/share/psi4")
    try:
        from ase.calculators.calculator import PropertyNotImplementedError, get_calculator_class
        from ase.io import read
        from ase.units import Hartree
        calculator = get_calculator_class(name)
    except ImportError as why:
        sys.exit(f"single-point-ase: {why}: install the Debian package {'python3-ase' if why.name == 'ase' else name}")
    with open(path, encoding="utf-8") as file:
        title = file.read().split("\n")[1]
    charge, unpaired = (int(re.findall(rf"\b{key}=(-?\d+)", title)[0]) for key in ("charge", "unpaired"))
    atoms = read(path)
    atoms.rotate(37, (1, 2, 3))  # psi4 1.3 fails where a shape is nearly symmetric about an axis
    if not MULTIPLICITY.get(name):
        atoms.set_initial_magnetic_moments([unpaired] + [0] * (len(atoms) - 1))
    atoms.calc = calculator(**keys(name, given, charge, unpaired))
    try:
        energy = atoms.get_potential_energy()
    except PropertyNotImplementedError:  # ASE 3.22 does not find the energy of MOPAC 22, only its heat of formation
        energy = atoms.calc.get_final_heat_of_formation()
    print(f"{energy / Hartree:.10f}")


if __name__ == "__main__":
    if len(sys.argv) < 3 or sys.argv[1] in ("-h", "--help"):
        print(__doc__.strip())
        sys.exit(0 if sys.argv[1:2] in (["-h"], ["--help"]) else 2)
    main(*sys.argv[1:])
