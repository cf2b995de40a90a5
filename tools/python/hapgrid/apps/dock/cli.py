"""The command line of `hapgrid dock`."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence

from hapgrid.apps.common.cli import EXIT_CODES, Parser, formatter, guarded, number, three

ABOUT = """\
Makes a verified grid of a ligand in a rigid host, with pictures, so that a hand
can feel how it fits. The hand holds the ligand's centre, and the ligand turns
by itself, as do the bonds that --torsions frees. Energies are AutoDock 4's, by
AutoGrid's maps or atom by atom. Everything goes to the folder DIR. A run that
was stopped continues there. A file in DIR that you change is kept, and the same
command computes again what depends on it.
"""

AFTERWARDS = f"""\
HOST and LIGAND are files that Open Babel reads, as .mol2, .sdf or .pdb, with
hydrogens and coordinates; a .pdbqt is taken as it is. HOST can also be a .pqr
of PDB2PQR, which is best for proteins, or the .maps.fld of AutoGrid's maps that
you have already.

Files in DIR, whose name is NAME:
  index.html       summary with pictures, and the ligand on its way in
  NAME.toml        definition of the grid; NAME.grid is the grid itself
  host.pdbqt, ligand.pdbqt   types and charges of the atoms
  host.*.map       what AutoGrid made of them, without --atoms
  wall.table       energy of the deepest pose at each point, which is that of
                   all poses inside atoms; it stays when you change NAME.toml
  poses.tsv        the deepest poses, as energies and places
  path.txt         a way in and back

{EXIT_CODES}

Examples:
  hapgrid dock calix.mol2 formamide.mol2 -o calix --centre 0,0,3 -j 2
                        formamide in calix[4]arene, of examples/docking
  hapgrid dock host.maps.fld ligand.pdbqt -o maps
                        by maps that are there already
  pdb2pqr --ff=AMBER --with-ph=7.4 protein.pdb protein.pqr
                        hydrogens and charges for a protein, which is HOST then:
                        Open Babel gives its charged groups no charge
"""


def parser() -> Parser:
    p = Parser(prog="hapgrid dock", description=ABOUT, epilog=AFTERWARDS, formatter_class=formatter,
               allow_abbrev=False, usage="hapgrid dock HOST LIGAND -o DIR [OPTION...]")
    p.add_argument("host", metavar="HOST", help="file of the host, or .fld of its maps")
    p.add_argument("ligand", metavar="LIGAND", help="file of the ligand, of 2 to 200 atoms")
    p.add_output("threads")
    p.add_argument("--centre", type=three(-1e4, 1e4), metavar="X,Y,Z",
                   help="centre of the box in which the ligand's centre moves, in angstrom (default: the host's)")
    p.add_argument("--size", type=three(0.5, 60), metavar="X,Y,Z",
                   help="lengths of the box in angstrom (default: the host's, but at most 10)")
    p.add_argument("--spacing", type=number(0.1, 2), metavar="H", default=0.5,
                   help="spacing of the grid in angstrom (default: 0.5)")
    p.add_argument("--torsions", type=number(0, 6, int), metavar="K", default=0,
                   help="number of the ligand's bonds that turn, the softest ones (default: 0)")
    p.add_argument("--atoms", action="store_true",
                   help="no maps, but the sum over the atoms of a host of at most 500; hydrogen bonds have no direction "
                   "then, and AutoGrid is not needed")
    p.add_until("definition")
    return p


def run(options: Namespace) -> str:
    from . import steps  # wants numpy, and --help does not
    return steps.run(options)


def main(arguments: Sequence[str]) -> int:
    return guarded("dock", parser().parse_args, run, arguments)
