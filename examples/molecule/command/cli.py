"""The command line of `hapgrid molecule`."""

import argparse
import os
import sys

from preparation import optimise, texts, work, xtb
from preparation.molecule import BadInput

from . import course
from .filters import Failed

ABOUT = """\
From the file of a molecule to a verified grid that can be felt, with pictures: everything goes to
the folder DIR. A run that was stopped goes on where it was. What is changed by hand in DIR is kept,
and the same command computes anew what depends on it.

  molecule     is read; hydrogens and a shape are added where they are missing
  structures   its conformation, and the barriers around all bonds that turn, by xtb
  choice       the softest paths to barriers that are sane together
               (--basins: on behind them, if xtb agrees where minima are combined)
  resolution   and box, from a coarse grid: how far the molecule is pushed, and what verify finds
  grid         is computed and verified
  way          of the probe that turns one torsion, there and back, and how it feels
"""

AFTERWARDS = """\
In DIR, whose name is NAME:
  index.html       sums up, with pictures and the molecule as it is pushed, to turn and to play
  rotors.tsv       what was tried, taken and left out, and why
  NAME.toml        the definition of the grid, NAME.grid; verify.txt: what verify says of it
  *.xyz            the conformation and the paths; report.tsv: their energies
  path-*.txt       the probe's ways

Rings stay as they are. Of several molecules or records the largest is felt. At most 100 atoms.

exit codes: 0 done; 1 could not; 2 the command line is wrong

examples:
  hapgrid molecule ibuprofen.sdf -o ibuprofen -j 2
  hapgrid molecule --smiles 'CC(C)O' -o propanol
  hapgrid molecule protein-loop.pdb -o loop --keep-conformation --until definition
"""


class UsageError(Exception):
    pass


class _Parser(argparse.ArgumentParser):
    def error(self, message):  # one line, as every other message
        raise UsageError(message + " (see --help)")


def _within(kind, low, high):
    def read(text):
        value = kind(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"must be from {low} to {high}")
        return value
    read.__name__ = kind.__name__
    return read


def parser():
    p = _Parser(prog="hapgrid molecule", description=ABOUT, epilog=AFTERWARDS,
                formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, width=100),
                allow_abbrev=False,
                usage="hapgrid molecule (FILE | --smiles SMILES) -o DIR [options]")
    p.add_argument("file", metavar="FILE", nargs="?", help="the molecule: .sdf, .mol, .mol2, .pdb or .xyz")
    p.add_argument("--smiles", help="the molecule as SMILES; its conformers are searched")
    p.add_argument("-o", "--output", metavar="DIR", required=True, help="folder for all files")
    p.add_argument("-j", "--threads", type=_within(int, 1, 1024), metavar="N", default=1,
                   help="processes and threads; the result is the same (default: 1)")
    p.add_argument("--charge", type=_within(int, -9, 9), metavar="E",
                   help="total charge (default: what the file says)")
    p.add_argument("--uhf", type=_within(int, 0, 9), metavar="N", default=0,
                   help="unpaired electrons of a radical (default: 0)")
    p.add_argument("--method", choices=("auto", *xtb.METHODS), default="auto",
                   help=f"gfn2: GFN2-xTB; gfnff: the force field GFN-FF; auto: gfn2 up to {course.GFN2_ATOMS} atoms")
    p.add_argument("--search", action="store_true",
                   help="look for the lowest conformer instead of keeping that of FILE")
    p.add_argument("--keep-conformation", action="store_true",
                   help="stay at this conformation where a barrier leads to a lower minimum, instead of beginning "
                   "there once more")
    p.add_argument("--highest", type=_within(float, 1, 1000), default=150.0, metavar="KJ_MOL",
                   help="barriers above this are not looked for, kJ/mol (default: 150)")
    p.add_argument("--paths", type=_within(int, 0, 16), metavar="N", default=6,
                   help="take at most N paths (default: 6)")
    p.add_argument("--basins", action="store_true",
                   help="paths go on through their barriers into the minima behind them")
    p.add_argument("--torsions", metavar="NAMES",
                   help="turn only these bonds, as rotors.tsv names them, with commas between (default: all); "
                   "NAME-plus and NAME-minus turn one way only")
    p.add_argument("--spacing", type=_within(float, 0.1, 3), metavar="H",
                   help="of the grid, in angstrom (default: what its accuracy and ten minutes allow)")
    p.add_argument("--until", choices=("structures", "definition"),
                   help="stop when the conformation and the paths are there, or the definition of the grid")
    p.add_argument("-q", "--quiet", action="store_true", help="print no progress on standard error")
    return p


def _options(arguments):
    o = parser().parse_args(arguments)
    if (o.smiles is None) == (o.file is None):
        raise UsageError("give either FILE or --smiles (see --help)")
    if o.smiles is not None:
        o.search = True
    return o


def _silence():
    """Discards what is written to standard output from here on, and returns the real one. GFN-FF
    prints there, whatever its verbosity, some of it only when the process ends."""
    sys.stdout.flush()
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)
    return out


def main(arguments):
    try:
        o = _options(arguments)
        xtb.load()  # before all else: where it is missing, that is one line
        with _silence() as out:
            line = course.run(o)
            if line:
                print(texts.printable_text(line), file=out)
    except UsageError as why:
        print(f"molecule: {why}", file=sys.stderr)
        return 2
    except (BadInput, Failed, work.Failed, xtb.XtbError, optimise.NotConverged) as why:
        print(f"molecule: {why}", file=sys.stderr)
        return 1
    except OSError as why:
        print(f"molecule: {why.filename}: {why.strerror}" if why.filename else f"molecule: {why}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\nmolecule: stopped; the same command goes on", file=sys.stderr)
        return 130
    return 0
