"""The command line of prepare."""

import argparse
import os
import shlex
import sys

from . import files, molecule, torsions, work, xtb
from .optimise import NotConverged

ABOUT = """\
Makes the data of the molecule model from one molecule: a conformation (a minimum of the potential
energy), the saddles around it that are reached by turning one bond, and the path to each saddle.

  conformers   are sampled with Open Babel and relaxed with xtb; the lowest is the conformation
  guesses      each torsion is turned either way, while all else relaxes, until the energy falls
  saddles      guesses are refined, and kept if exactly one frequency is imaginary
  paths        follow the steepest descent from a saddle; a path is kept if it ends in the
               conformation and climbs without bumps from there. It has 11 shapes at equal distances

Torsions that lead to no such path are named on standard error and in the report.
"""

AFTERWARDS = """\
The program writes to DIR: conformation.xyz, a file for each path (NAME-plus.xyz and NAME-minus.xyz,
or NAME.xyz for a methyl group, for which both directions are the same), and report.tsv. Coordinates
are in angstrom, energies in comment lines (dE) in kJ/mol above the conformation, wave numbers in
cm^-1 with i for imaginary. It prints the lines for a model's TOML file on standard output.

The molecule lies along the axes of its inertia, with its centre of mass in the origin. If DIR has
the same conformation already, the new one lies as that does, so that the box of a model still fits.

A run that was stopped continues where it was: finished steps are kept in --work until all are done.
One core is used. 22 atoms with gfn2 take minutes, 77 atoms with gfnff some minutes a torsion.

exit codes: 0 done; 1 could not; 2 the command line is wrong

examples:
  prepare --smiles CCCC -o butane
  prepare --smiles 'CC(=O)N[C@@H](C)C(=O)NC' --torsions phi=2-4-5-7,psi=4-5-7-9 -o dipeptide
  prepare start.xyz --keep-conformation --method gfnff --torsions psi2=17-18+ -o peptide
"""


class UsageError(Exception):
    pass


class _Parser(argparse.ArgumentParser):
    def error(self, message):  # one line, as every other message
        raise UsageError(message + " (see --help)")


def _count(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be 1 or more")
    return value


def _energy(text):
    value = float(text)
    if not 0 < value < 1e6:
        raise argparse.ArgumentTypeError("must be between 0 and 1e6 kJ/mol")
    return value


def parser():
    p = _Parser(prog="prepare", description=ABOUT, epilog=AFTERWARDS,
                formatter_class=argparse.RawDescriptionHelpFormatter,
                usage="prepare (--smiles SMILES | FILE) -o DIR [options]")
    p.add_argument("file", metavar="FILE", nargs="?",
                   help="a molecule with coordinates: .xyz, .sdf, .mol")
    p.add_argument("--smiles", help="a molecule as SMILES; hydrogens are added after its atoms")
    p.add_argument("-o", "--output", metavar="DIR", required=True, help="directory for the files")
    p.add_argument("--method", choices=xtb.METHODS, default="gfn2",
                   help="gfn2: GFN2-xTB; gfnff: the force field GFN-FF, for molecules of more than "
                        "about 40 atoms (default: %(default)s)")
    p.add_argument("--charge", type=int, metavar="E",
                   help="total charge (default: the input's, 0 for .xyz)")
    p.add_argument("--torsions", default="auto", metavar="LIST",
                   help="torsions to turn, with commas between them: auto (every single bond that "
                        "is neither in a ring nor an amide's), [NAME=]J-K or [NAME=]I-J-K-L (atoms "
                        "counted from 1; the bond between J and K turns; + or - at the end: in this "
                        "direction only) (default: %(default)s)")
    p.add_argument("--guess", action="append", default=[], metavar="PATH=FILE",
                   help="a shape near the saddle of a path (psi-plus=psi.xyz), with the same atoms "
                        "in the same order; this path is then not scanned; may be repeated")
    p.add_argument("--paths", type=_count, metavar="N",
                   help="keep only the N lowest saddles (default: all)")
    p.add_argument("--keep-equal", action="store_true",
                   help="keep a saddle that is the mirror image of another, or equals it when "
                        "equal atoms are exchanged")
    p.add_argument("--highest", type=_energy, default=150.0, metavar="KJ_MOL",
                   help="end a scan that climbs higher than this, kJ/mol (default: %(default)g)")
    p.add_argument("--keep-conformation", action="store_true",
                   help="relax FILE to the nearest minimum instead of looking for the lowest one")
    p.add_argument("--conformers", type=_count, default=10, metavar="N",
                   help="how many of the lowest MMFF94 structures xtb relaxes (default: "
                        "%(default)s)")
    p.add_argument("--seed", type=int, default=1, metavar="N",
                   help="seed of the random torsions, which are used when there are too many "
                        "combinations for all (default: %(default)s)")
    p.add_argument("--work", metavar="DIR",
                   help="directory for finished steps (default: DIR/.prepare)")
    p.add_argument("--keep-work", action="store_true",
                   help="do not remove finished steps at the end")
    p.add_argument("--again", action="store_true", help="compute anew what is there already")
    p.add_argument("-q", "--quiet", action="store_true", help="print no progress on standard error")
    return p


def _options(arguments):
    o = parser().parse_args(arguments)
    if bool(o.smiles is not None) == bool(o.file is not None):
        raise UsageError("give either --smiles or FILE (see --help)")
    if o.keep_conformation and o.file is None:
        raise UsageError("--keep-conformation needs FILE (see --help)")
    if o.seed < 0:
        raise UsageError("--seed must be 0 or more (see --help)")
    for guess in o.guess:
        if not all(guess.partition("=")):
            raise UsageError(f"--guess {guess}: not PATH=FILE (see --help)")
    o.work = o.work or os.path.join(o.output, ".prepare")
    return o


def _command(o):
    """The command for the report, with the options that decide the result and no others."""
    out = ["prepare"]
    out += ["--smiles", o.smiles] if o.smiles is not None else [os.path.basename(o.file)]
    out += ["--method", o.method]
    if o.charge is not None:
        out += ["--charge", str(o.charge)]
    for guess in o.guess:
        name, _, path = guess.partition("=")
        out += ["--guess", f"{name}={os.path.basename(path)}"]
    out += ["--torsions", o.torsions, "--highest", f"{o.highest:g}"]
    if o.paths is not None:
        out += ["--paths", str(o.paths)]
    out += ["--keep-equal"] if o.keep_equal else []
    out += (["--keep-conformation"] if o.keep_conformation
            else ["--conformers", str(o.conformers), "--seed", str(o.seed)])
    return shlex.join(out)


def _is_current(o, command):
    """Whether there is a whole set from the same command, and no input is newer than it."""
    report = os.path.join(o.output, "report.tsv")
    try:
        with open(report, encoding="utf-8") as file:
            same = file.readline() == f"# {command}\n"
    except FileNotFoundError:
        return False
    names = ["conformation.xyz", *files.listed(report)]
    whole = all(os.path.exists(os.path.join(o.output, name)) for name in names)
    inputs = [g.partition("=")[2] for g in o.guess] + ([o.file] if o.file is not None else [])
    newer = any(os.path.getmtime(name) > os.path.getmtime(report) for name in inputs)
    return same and whole and not newer


def _silence():
    """Discards standard output from here on and returns the real one. GFN-FF prints there, whatever
    its verbosity, some of it only when the process ends."""
    sys.stdout.flush()
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)
    return out


def _guesses(o, one, driven):
    """The shapes of --guess, in angstrom, by the name of their path."""
    names = {t.file_name(sign) for t in driven for sign in t.signs}
    out = {}
    for guess in o.guess:
        name, _, path = guess.partition("=")
        if name not in names:
            raise torsions.BadTorsion(f"--guess {guess}: no such path is looked for")
        shape = molecule.from_file(path)
        if shape.numbers != one.numbers:
            raise molecule.BadInput(f"{path}: not the same atoms in the same order")
        out[name] = shape.positions
    return out


def _run(o):
    command = _command(o)
    if not o.again and _is_current(o, command):
        print(f"prepare: {o.output}: there already; --again computes it anew", file=sys.stderr)
        return
    out = _silence()
    one = molecule.from_smiles(o.smiles) if o.smiles is not None else molecule.from_file(o.file)
    driven = torsions.parse(o.torsions, one.numbers, one.neighbours, one.double)
    job = work.Work(one, driven, o, _guesses(o, one, driven))
    result = job.run()
    result.lie_as_before(o.output)
    names = files.write_set(o.output, result, command)
    if not o.keep_work:
        job.steps.remove()
    job.say(f"written to {o.output}: " + " ".join(names))
    saddles = ", ".join(f'"{found.name}.xyz"' for found in result.found)
    with out:
        print(f'conformation = "conformation.xyz"\ntransition_states = [{saddles}]', file=out)


def main(arguments):
    try:
        _run(_options(arguments))
    except UsageError as why:
        print(f"prepare: {why}", file=sys.stderr)
        return 2
    except (molecule.BadInput, torsions.BadTorsion, work.Failed, xtb.XtbError, NotConverged) as why:
        print(f"prepare: {why}", file=sys.stderr)
        return 1
    except UnicodeDecodeError:
        print(f"prepare: {arguments[0]}: not a text file", file=sys.stderr)
        return 1
    except OSError as why:
        print(f"prepare: {why.filename}: {why.strerror}" if why.filename else f"prepare: {why}",
              file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0
