"""The molecule that is felt, as its file or SMILES gives it, and what the steps have in common."""

import os
from dataclasses import dataclass
from functools import cached_property

from hapgrid_command.files import Failed, digest_of
from hapgrid_command.work import Work

from . import molecule as prepared
from . import reading, rotors, singles
from .pieces import signed
from .xtb import Surface

GFN2_ATOMS = 24


@dataclass
class Start:
    """options: of the command line; source: of the molecule, in words; search: whether conformers are searched; method: of
    xtb; turning: bonds (torsions.Torsion); still: those and rings that keep their place (rotors.Left)."""
    options: object
    folder: Work
    molecule: prepared.Molecule
    source: str
    charge: int
    unpaired: int
    search: bool
    method: str
    turning: list
    still: list

    @property
    def words(self):
        """The method, as files name it."""
        return f"{self.method}-in-{self.options.solvent}" if self.options.solvent else self.method

    def surface(self, x, tree=None):
        """xtb's. x: the conformation, bohr."""
        return Surface(self.molecule.numbers, x, self.method, self.charge, tree, self.unpaired, self.options.solvent)

    @cached_property
    def points(self):
        """The SinglePoints of --single-points, or None."""
        command = self.options.single_points
        return command and singles.SinglePoints(command, self.molecule.numbers, self.charge, self.unpaired, self.folder.kept)

    def turned_by(self, paths):
        """The torsions that these paths turn."""
        return [t for t in self.turning if {t.name, *t.file_names()} & set(paths)]


def read(o):
    """The Start of a command line."""
    kept = Work("molecule", o.output, o.quiet)

    def compute():
        one = reading.read(o.file, o.smiles, o.charge, o.uhf)
        for line in one.said:
            kept.say("  " + line)
        kept.enter()
        kept.write("start.sdf", one.sdf())
        return ["start.sdf"]
    text = digest_of(prepared.read_bytes(o.file)) if o.file else o.smiles
    kept.step("molecule", "", [], [text, o.charge, o.uhf], compute)
    given = reading.started(kept.path("start.sdf"))
    one, method = given.molecule, o.method
    if method == "auto":
        method = "gfn2" if len(one.numbers) <= GFN2_ATOMS else "gfnff"
    turning, still = rotors.find(one)
    rings = sum(left.why == rotors.RING for left in still)
    if o.torsions is not None:
        turning, left = only(turning, set(o.torsions.split(",")), o.basins)
        still = still + left
    kept.say(f"  {one.formula}, {len(one.numbers)} atoms, charge {signed(given.charge)}, {len(turning)} bonds turn"
             + (f"; {rings} rings stay as they are" if rings else ""))
    source = os.path.basename(o.file) if o.file else f"SMILES {o.smiles}"
    return Start(o, kept, one, source, given.charge, given.unpaired, o.search or given.built, method, turning, still)


def only(turning, wanted, basins):
    """(the torsions of --torsions, the others). With basins paths go both ways."""
    known = {t.name for t in turning}
    if not basins:
        known = known.union(*(t.file_names() for t in turning))
    unknown = sorted(wanted - known)
    if unknown:
        raise Failed(f"--torsions: no bond {unknown[0]} turns, only " + ", ".join(t.name for t in turning))
    turn = [t if t.name in wanted else t.only(wanted) for t in turning]
    left = [rotors.Left(t.name, "not among --torsions") for t, one in zip(turning, turn) if not one.signs]
    return [t for t in turn if t.signs], left
