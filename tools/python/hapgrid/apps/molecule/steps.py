"""The steps from a molecule's file to the page. Each is a function from the results of those before it to its own;
what it computes is kept as files, which the user may change, so its result is what the files say."""

from __future__ import annotations

import itertools
import os
import time
import timeit
from argparse import Namespace
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed, digest_of, read_bytes
from hapgrid.apps.common.work import Work, about

from . import (along, calculator, files, geometry, grids, holding, molecule, optimise, page, path_selection, probe_lines, reading, rotors,
               single_points, stereo, structures)
from .cli import GFN2_ATOMS
from .molecule import signed
from .results import Result
from .torsions import Torsion
from .xtb import BOHR, HARTREE, Potential, Surface, XtbError, load

ENSEMBLE = 8  # frames of an ensemble between which paths are looked for
# Gradients of xtb in units of a Hessian, which are measured: of butane, pentane, propan-2-ol and ethanol 9 to 16 for each way
# of a bond, and 21 where it goes on behind its barriers; as many for the conformation. Of a flexible molecule some ways take
# ten times as many, to hard saddles or lower minima: on the mean of methyl argininate, with 9 bonds beside methyl groups, twice.
HESSIANS, HESSIANS_BEHIND = 15, 12
LEAST_NOISE = 1e-5  # kJ/mol
FLEXIBLE = 8  # bonds beside methyl groups with which a way takes twice as many
# What an optimiser's step takes besides its gradient, in shares of a step for each gradient: most gradients are a Hessian's.
ALGEBRA = 0.09


@dataclass
class Start:
    """The molecule that is felt, and what the steps have in common. options: of the command line; source: of the molecule, in
    words; given: paths of its own, or None; search: whether conformers are searched; method: of xtb; turning: bonds (torsions.Torsion);
    isomer: which no step may leave, told: the same in words."""
    options: Namespace
    folder: Work
    molecule: molecule.Molecule
    source: str
    search: bool
    method: str
    turning: list[Torsion]
    isomer: stereo.Isomer
    told: str
    given: dict[str, Any] | None = None  # of along.read()

    @property
    def words(self) -> str:
        return f"{self.method}-in-{self.options.solvent}" if self.options.solvent else self.method

    def surface(self, x: Array) -> Potential:
        """xtb's, or that of --calculator. x: the conformation, bohr."""
        if self.calculator is not None:
            return calculator.CalculatorSurface(self.molecule.numbers, x, self.calculator, self.tree)
        return Surface(self.molecule.numbers, x, self.method, self.molecule.charge, self.tree, self.molecule.unpaired,
                       self.options.solvent)

    @cached_property
    def tree(self) -> geometry.Tree:
        one = self.molecule
        return geometry.Tree(one.neighbours, one.numbers, geometry.straight(one.neighbours, one.positions))

    @cached_property
    def calculator(self) -> tuple[Any, calculator.Batch | None] | None:
        """A process makes its own: what one of them holds cannot be shared."""
        by = self.options.calculator
        return None if by is None else by.make(self.molecule.charge, self.molecule.unpaired)

    @cached_property
    def points(self) -> single_points.SinglePoints | None:
        """The SinglePoints of --single-points, or None."""
        command = self.options.single_points
        return None if command is None else single_points.SinglePoints(command, self.molecule, self.folder.cache)

    def turned_by(self, paths: Sequence[str]) -> list[Torsion]:
        return [t for t in self.turning if {t.name, *t.file_names()} & set(paths)]


def run(options: Namespace) -> str:
    """Everything, or all until --until; the line for standard output."""
    if not options.path and options.calculator is None:
        load()  # before all else: where xtb is missing, that is one line
    start = read_path(options) if options.path else read(options)
    shapes = find_structures(start)
    if options.until != "structures":
        definition = grids.make_grid(start, shapes)
        if options.until is None:
            return show(start, shapes, definition.paths)
    start.folder.say(f"stopped after the {options.until}: the same command without --until goes on")
    return ""


def read(o: Namespace) -> Start:
    folder = Work("molecule", o.output, o.quiet, [o.file] if o.file else [])
    source = os.path.basename(o.file) if o.file else f"SMILES {o.smiles}"

    def compute() -> list[str]:
        one = reading.read(o.file, o.smiles, o.charge, o.uhf)
        of = f"{one.formula} ({source})", [one.numbers, one.neighbours, one.charge]
        folder.require(*of)
        for line in one.said:
            folder.say("  " + line)
        folder.enter()
        folder.belong(*of)
        folder.write("start.sdf", reading.sdf(one))
        return ["start.sdf"]
    text = digest_of(read_bytes(o.file, molecule.MOST_BYTES)) if o.file else o.smiles
    folder.step("molecule", "", [], [text, o.charge, o.uhf], compute)
    one, method = reading.started(folder.path("start.sdf")), o.method
    if o.calculator is not None:
        method = o.calculator.name
    elif method == "auto":
        method = "gfn2" if len(one.numbers) <= GFN2_ATOMS else "gfnff"
    turning, rings = rotors.find(one), len(one.rings())
    if o.torsions is not None:  # with basins paths go both ways
        wanted = set(o.torsions.split(","))
        unknown = sorted(wanted - {name for t in turning for name in ([t.name] if o.goes_on else [t.name, *t.file_names()])})
        if unknown:
            raise Failed(f"--torsions: no bond {unknown[0]} turns, only " + ", ".join(t.name for t in turning))
        turning = [t if t.name in wanted else replace(t, signs=tuple(s for s in t.signs if t.file_name(s) in wanted))
                   for t in turning]
        turning = [t for t in turning if t.signs]
    folder.say(f"  {one.formula}, {len(one.numbers)} atoms, charge {signed(one.charge)}, "
               f"{len(turning)} {'bond turns' if len(turning) == 1 else 'bonds turn'}"
               + (f"; {rings} rings stay as they are" if rings else ""))
    isomer = stereo.of(one.rd, one.positions)
    told = stereo.told(one.rd, one.positions, isomer)
    if told:
        folder.say(f"  isomer: {told}")
    return Start(o, folder, one, source, o.search or one.built, method, turning, isomer, told)


def read_path(o: Namespace) -> Start:
    """The same with paths of its own. They are read each time: reading is fast."""
    folder = Work("molecule", o.output, o.quiet)
    given = along.read([o.file, *o.more], o.charge, o.uhf, o.unit, o.calculator is not None)
    for line in given["said"]:
        folder.say("  " + line)
    one = along.molecule(given)
    folder.enter()
    counts = ", ".join(str(len(shapes)) for _, shapes in given["paths"])
    folder.say(f"  {one.formula}, {len(one.numbers)} atoms, charge {signed(one.charge)}, paths of {counts} frames")
    source = ", ".join(os.path.basename(f) for f in (o.file, *o.more))
    return Start(o, folder, one, source, False, o.calculator.name if o.calculator else "gfn2", [], stereo.Isomer([]), "", given)


def find_structures(start: Start) -> Result:
    o, folder = start.options, start.folder
    if start.given:
        return along.found(start)
    frames, known = reading.ensemble(o.file if o.basins else None)  # between whose minima paths are looked for
    shapes = [(n, x) for n, x in frames if len(x) == len(start.molecule.numbers)]
    if len(shapes) > ENSEMBLE:
        folder.say(f"  {len(shapes)} frames: the {ENSEMBLE} {'lowest' if known else 'first'} are taken")
    shapes = shapes[:ENSEMBLE]

    def compute() -> list[str]:
        if o.calculator is not None:
            folder.say(f"  energies by {o.calculator.said}" + noise_of(start))
        elif o.method == "auto":
            folder.say("  energies by " + ("GFN2-xTB" if start.method == "gfn2" else
                                           f"GFN-FF, as for all above {GFN2_ATOMS} atoms (--method gfn2 is better, and slower)"))
        estimate(start)
        one = structures.explore(start, shapes)
        if start.points:
            start.points.put_into(one, o.threads, folder)
        return files.write_set(folder, one, f"hapgrid molecule: {start.source}, {start.method}, "
                               f"charge {signed(start.molecule.charge)}, {start.molecule.unpaired} unpaired electrons"
                               + f"; isomer: {start.told}" * bool(start.told))
    folder.step("structures", "looking for the conformation and the barriers around it", ["start.sdf"],
                [start.method, o.solvent, start.points and start.points.key, start.molecule.charge, start.molecule.unpaired,
                 start.search, o.highest, o.basins, o.push, o.hold, o.keep_conformation,
                 [name for t in start.turning for name in t.file_names()], [x.tolist() for _, x in shapes]], compute)
    return files.read_set(folder)


def noise_of(start: Start) -> str:
    """Of a calculator, in words, where it is more than the rounding of 64 bits."""
    try:
        energy, gradient = start.surface(start.molecule.positions / BOHR).noise
    except XtbError as why:
        raise Failed(f"--calculator: {why}") from None
    if energy * HARTREE < LEAST_NOISE:
        return ""
    return f"; its noise is {energy * HARTREE:.2g} kJ/mol, and {gradient * HARTREE / BOHR:.2g} kJ/(mol Å) of a force"


def estimate(start: Start) -> None:
    """Says how long the structures take, within a factor of 2 or so, from the CPU time of a gradient and of a step: what else
    the machine does is not known beforehand. Where xtb refuses the shape, the search itself says why."""
    o, x = start.options, start.molecule.positions / BOHR
    turning: Sequence[Torsion] = start.turning
    if not o.push:
        turning = next((hold.torsions for hold in holding.candidates(start.molecule, turning, o.hold, x)), ())
    ways, soft = sum(len(t.signs) for t in turning), sum(not t.rotor for t in turning)

    def takes(compute: Callable[[], Any]) -> float:
        return min(timeit.repeat(compute, timer=time.process_time, number=1, repeat=5))
    try:
        surface, shifts = start.surface(x), itertools.count(1)
        gradient = takes(lambda: surface.energy(x + 0.005 * next(shifts) * np.eye(len(x), 3)))
        step = takes(lambda: optimise.projected(np.eye(x.size), x))
    except XtbError:
        return
    count = HESSIANS + ways * (HESSIANS + (HESSIANS_BEHIND if o.goes_on else 0)) * (1 + soft / FLEXIBLE)
    cores = min(o.threads, max(ways, 1))
    seconds = 2 * x.size * count * (gradient + ALGEBRA * step) / cores
    start.folder.say(f"  {about(seconds, cores)} for conformation and barriers, more where a lower minimum is found")


def show(start: Start, shapes: Result, paths: Sequence[str]) -> str:
    """The line that shows the grid."""
    folder = start.folder
    grid = f"{folder.name()}.grid"
    folder.step("pushing", "looking for the hand's ways that turn the molecule", [grid], [],
                lambda: probe_lines.write(start, grid, shapes))
    made = [n for n in folder.made("pushing") if n.endswith(".txt")]
    if not made:
        raise Failed(f"{folder.path(grid)}: no way of the hand is found that moves the molecule; hapgrid feel shows the grid")
    facts = [start.source, start.molecule.charge, start.molecule.unpaired, start.method]
    folder.step("page", "writing the page", [grid, *made, "rotors.tsv", "report.tsv", "verify.txt"], facts,
                lambda: page.write(start, start.turned_by(paths), made))
    grid, me = folder.in_shell(grid), folder.launcher()
    folder.say(f"done: {folder.in_shell('index.html')} sums up")
    if "feel.html" in folder.made("page"):
        folder.say(f"{folder.in_shell('feel.html')} is a page in which the mouse is the hand")
    nothing = "" if paths else path_selection.nothing_turns(folder) + "\n"
    return nothing + f"{me} feel {grid}"
