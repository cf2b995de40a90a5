"""The command line of `hapgrid table`."""

from __future__ import annotations

import argparse
import math
from argparse import Namespace
from collections.abc import Sequence

from hapgrid.apps.common.cli import EXIT_CODES, Parser, formatter, guarded, number

ABOUT = """\
Makes a verified grid of a table of energies, with pictures, so that a hand can
feel it. FILE is an AutoDock map (.map), an OpenDX table (.dx), a Gaussian cube
(.cube, .cub), a VTK image (.vti), a density of CCP4 or MRC (.ccp4, .mrc, .map)
or an array of NumPy (.npz), and may be packed (.gz). Everything goes to
the folder DIR. A run that was stopped continues there. A file in DIR that you
change is kept, and the same command computes again what depends on it.
"""

AFTERWARDS = f"""\
Files in DIR, whose name is NAME:
  index.html       summary with pictures
  NAME.toml        definition of the grid; NAME.grid is the grid itself
  NAME.table       the table as text; the grid carries it
  verify.txt       report of verify
  path.txt         a way of the HIP through the lowest minimum

Between the points of the table the energy is a tricubic spline, and the force
is its gradient. Without --wall, a wall is put at five times the height of the
median above the minimum where values are higher or missing.

{EXIT_CODES}

Examples:
  hapgrid table receptor.C.map -o carbon
                        a grid of AutoGrid's map for carbon
  hapgrid table potential.dx -o charge --unit kT/e --factor -1
                        APBS's potential, as a charge of -1 feels it
"""


def wall(text: str) -> float:
    return math.inf if text == "none" else number(-1e30, 1e30)(text)


def unit(text: str) -> str:
    if len(text.encode()) > 15 or not text.isprintable() or '"' in text or "\\" in text:
        raise argparse.ArgumentTypeError("a unit has at most 15 bytes, no quotes and no backslash")
    return text


def parser() -> Parser:
    p = Parser(prog="hapgrid table", description=ABOUT, epilog=AFTERWARDS, formatter_class=formatter,
               allow_abbrev=False, usage="hapgrid table FILE -o DIR [OPTION...]")
    p.add_argument("file", metavar="FILE", help="table, of one of the formats above")
    p.add_output("threads")
    p.add_argument("--force", type=number(0.01, 100), metavar="N", default=3.0,
                   help="force on the device where the energy is steepest, in newtons (default: 3)")
    p.add_argument("--wall", type=wall, metavar="E",
                   help="energy of the wall where values are higher or missing, after --factor, in the unit of the grid, which is TO of "
                   "--unit FROM:TO; none: no wall")
    p.add_argument("--factor", type=number(-1e30, 1e30), metavar="F", default=1.0,
                   help="number by which all values are multiplied, as a charge (default: 1)")
    p.add_argument("--spacing", type=number(1e-9, 1e9), metavar="H",
                   help="spacing of the grid in the table's unit of length (default: the smallest of the table)")
    p.add_argument("--array", metavar="NAME", help="array of a .vti (default: its scalars) or .npz; number of an orbital of a .cube")
    p.add_argument("--unit", type=unit, metavar="UNIT",
                   help="unit of the energy: values in kcal/mol (.map) or hartree (a .cube whose title says so) are converted "
                   "to it, others are taken to be in it. FROM:TO converts: kT/e:kJ/mol, with the charge as --factor")
    p.add_argument("--length-unit", type=unit, metavar="UNIT",
                   help="unit of lengths: angstroms (.map, .cube, .ccp4) are converted to it, others are taken to be in it "
                   "(default: angstrom; for .vti and arrays none)")
    p.add_until("definition")
    return p


def run(options: Namespace) -> str:
    from . import steps  # wants numpy, and --help does not
    return steps.run(options)


def main(arguments: Sequence[str]) -> int:
    return guarded("table", parser().parse_args, run, arguments)
