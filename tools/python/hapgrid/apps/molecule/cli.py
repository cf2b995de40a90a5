"""The command line of `hapgrid molecule`."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence

from hapgrid.apps.common.cli import EXIT_CODES, Parser, UsageError, formatter, guarded, number
from hapgrid.apps.common.files import Failed

from . import resolution

GFN2_ATOMS = 24  # up to which GFN2-xTB is taken
# Those that both methods know. To xtb benzene is toluene.
SOLVENTS = "acetone acetonitrile ch2cl2 chcl3 cs2 dmf dmso ether hexane methanol thf toluene water".split()

ABOUT = """\
Makes a verified grid of a molecule, with pictures, from the molecule's file.
Everything goes to the folder DIR. A run that was stopped continues there.
A file in DIR that you change is kept, and the same command computes again what
depends on it. DIR can be renamed and copied. The steps are:

  molecule     The file is read; hydrogens and a shape are added if missing.
  structures   xtb finds the conformation and the barriers around the bonds.
  selection    The lowest barriers are taken whose paths can be combined
               without colliding atoms.
  resolution   A coarse grid shows the box and the spacing that are needed.
  grid         The grid is computed and verified.
  way          A way of the hand that turns one torsion, there and back.

The hand holds an atom and leads it over the barriers of the bonds that move it.
With --push it pushes at the molecule with a ball instead.
"""

AFTERWARDS = f"""\
Files in DIR, where NAME is the folder's name when it was new:
  index.html       summary, and the molecule as the hand moves it
  rotors.tsv       the bonds that were tried, taken and left out, and why
  NAME.toml        definition of the grid; NAME.grid is the grid itself
  verify.txt       report of verify
  *.xyz            conformation and paths; report.tsv has their energies
  path-*.txt       ways of the hand

Rings keep their shape, unless paths lead between the minima of an ensemble. Of
several molecules or records the largest is taken, with at most 100 atoms. The
same molecule gives the same grid on each machine.

{EXIT_CODES}

Examples:
  hapgrid molecule ibuprofen.sdf -o ibuprofen -j 2
                        a grid of the molecule in a file
  hapgrid molecule --smiles ClCCCl -o dichloroethane
                        the same from a formula
"""


def parser() -> Parser:
    p = Parser(prog="hapgrid molecule", description=ABOUT, epilog=AFTERWARDS, formatter_class=formatter,
               allow_abbrev=False, usage="hapgrid molecule (FILE | --smiles SMILES) -o DIR [OPTION...]")
    p.add_argument("file", metavar="FILE", nargs="?", help="file of the molecule: .sdf, .mol, .mol2, .pdb, .cif (of a ligand) or .xyz")
    p.add_argument("more", metavar="FILE", nargs="*", help="with --path, other paths that have an end in common with the first")
    p.add_argument("--path", action="store_true",
                   help="take the frames of FILE as a path, on which bonds may break and form: XYZ, extended XYZ, or a "
                   "trajectory of ASE")
    p.add_argument("--unit", type=str.lower, choices=("hartree", "ev", "kj/mol", "kcal/mol"),
                   help="with --path, unit of the energies in the titles (default: as the title says; energy= is in eV, and "
                   "others in hartree; without energies xtb or --calculator computes them)")
    p.add_argument("--smiles", help="molecule as SMILES, whose conformers are searched")
    p.add_output("processes and threads")
    p.add_argument("--charge", type=number(-9, 9, int), metavar="E",
                   help="total charge (default: what the file says)")
    p.add_argument("--uhf", type=number(0, 9, int), metavar="N",
                   help="number of unpaired electrons of a radical (default: what the file says); with --charge, "
                   "bonds that do not fit are taken as they are")
    p.add_argument("--method", choices=("auto", "gfn2", "gfnff"), default="auto",
                   help=f"method of xtb: gfn2 is GFN2-xTB, gfnff the force field GFN-FF, and auto (default) takes gfn2 up to "
                   f"{GFN2_ATOMS} atoms")
    p.add_argument("--solvent", type=str.lower, choices=SOLVENTS, metavar="NAME",
                   help=f"solvent around the molecule by xtb's GBSA: {', '.join(SOLVENTS)} (default: none)")
    p.add_argument("--calculator", metavar="CALCULATOR",
                   help="calculator of ASE that gives all shapes and energies instead of xtb: MODULE:CALLABLE(ARGUMENTS), such as "
                   "'mace.calculators:mace_mp(model=\"small\")', or a file in Python with a function calculator(charge, uhf)")
    p.add_argument("--single-points", metavar="COMMAND",
                   help="program that gives the energies along the paths instead of xtb: it gets the name of an XYZ file, "
                   "and its last line is the energy in hartree; single-point-ase asks ASE")
    p.add_argument("--search", action="store_true",
                   help="look for the lowest conformer instead of keeping that of FILE")
    p.add_argument("--keep-conformation", action="store_true",
                   help="do not restart from a lower minimum when a barrier leads to one")
    p.add_argument("--highest", type=number(1, 1000), default=150.0, metavar="KJ_MOL",
                   help="highest barrier that is looked for, in kJ/mol (default: 150)")
    p.add_argument("--hold", metavar="ATOM",
                   help="atom that the hand holds: its name (C4), its number, or a SMARTS; of several, with commas between, "
                   "their centre (default: an end of the torsion that parts the molecule most evenly)")
    p.add_argument("--soft", action="store_true",
                   help="tie the hand to the atom so softly that the molecule snaps over its barriers")
    p.add_argument("--push", action="store_true",
                   help="push with a ball instead of holding an atom; paths end on their barriers")
    p.add_argument("--basins", action="store_true",
                   help="with --push, continue paths beyond their barriers into the minima behind them; of an ensemble in "
                   "an XYZ file, look for paths between its minima")
    p.add_argument("--torsions", metavar="NAMES",
                   help="bonds that may turn, as rotors.tsv names them, with commas between (default: all); "
                   "with --push, NAME-plus and NAME-minus turn in one direction only")
    p.add_argument("--spacing", type=number(0.1, 3), metavar="H",
                   help="spacing of the grid in angstrom (default: that at which shapes are off by at most "
                   f"{resolution.WANTED:g} in 99 of 100 places, {resolution.COARSEST:g} at most, but at most "
                   f"{resolution.MOST_POINTS} points; with --push --basins {resolution.FINEST:g}, but at most "
                   f"{resolution.MOST_POINTS_BETWEEN_BASINS} points)")
    p.add_until("structures", "definition")
    return p


def _options(arguments: Sequence[str]) -> Namespace:
    o = parser().parse_args(arguments)
    if (o.smiles is None) == (o.file is None):
        raise UsageError("give either FILE or --smiles (see --help)")
    if o.smiles is not None and o.search:
        raise UsageError("--search: conformers of --smiles are searched anyway (see --help)")
    if o.more and not o.path or o.unit and not o.path:
        raise UsageError("several files, and --unit, go with --path alone (see --help)")
    if o.path and (o.smiles is not None or o.push or o.basins or o.search or o.torsions or o.single_points):
        raise UsageError("--path: what moves is given by FILE (see --help)")
    if o.calculator is not None and (o.method != "auto" or o.solvent is not None):
        raise UsageError("--calculator: --method and --solvent are of xtb (see --help)")
    if o.path and o.method == "gfnff":
        raise UsageError("--path: the bonds of GFN-FF cannot change (see --help)")
    if o.push and (o.hold is not None or o.soft):
        raise UsageError("--push: the hand holds no atom (see --help)")
    o.goes_on = o.basins or not o.push  # whether paths go on behind their barriers
    return o


def _run(options: Namespace) -> str:
    from . import calculator, optimise, steps, xtb  # want RDKit and more, and --help does not
    if options.calculator is not None:
        options.calculator = calculator.source(options.calculator)
    try:
        return steps.run(options)
    except (xtb.XtbError, optimise.NoPath) as why:
        raise Failed(why) from None


def main(arguments: Sequence[str]) -> int:
    return guarded("molecule", _options, _run, arguments)
