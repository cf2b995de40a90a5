"""The steps from a molecule to the paths around its conformation. Each is kept, so that a run that was stopped goes on."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from hapgrid.apps.common.arrays import Array, Shapes
from hapgrid.apps.common.files import Failed
from hapgrid.apps.common.programs import raise_if_stopped, workers

from . import geometry, optimise, path, rotors, stereo, torsions
from .holding import Hold
from .molecule import conformers
from .results import SAME_SHAPE, Dropped, Ends, Path, Point, Result, plain, restored
from .xtb import BOHR, HARTREE, XtbError

if TYPE_CHECKING:
    from .steps import Start

SAME_ENERGY = 0.02  # kJ/mol
CONFORMERS = 4  # of the lowest by the force field, which xtb relaxes
AWAY = 0.1  # bohr: how far from a saddle the ways down from it begin, and their longest step

_search: Any = None  # of this process and of those that it starts


def _ask(question: tuple[Callable[[Any, Any], Any], type | None, Any]) -> Any:
    method, kind, value = question

    def compute() -> Any:
        try:
            return method(_search, value)
        except (optimise.NoPath, XtbError) as why:
            return Dropped(str(why), isinstance(why, optimise.TurnsFreely))
    if kind is None:
        return compute()
    inputs = [method.__name__, plain(value), _search.x.tolist(), _search.start.options.highest, _search.start.options.push]
    return _search.cached([kind, Dropped], inputs, compute)


class Search:
    """torsions: all that could turn; driven: those that are turned; jobs: {name of a path: (one of these, direction, None for
    both)}. hold: its torsions alone are turned; shapes: [(number of a frame, shape in angstrom)] of an ensemble, between
    whose minima paths are looked for."""

    def __init__(self, start: Start, shapes: Sequence[tuple[int, Array]], hold: Hold | None = None) -> None:
        self.start, self.molecule, self.shapes = start, start.molecule, shapes
        self.torsions, self.driven = rotors.find(start.molecule), start.turning
        self.jobs: dict[str, tuple[torsions.Torsion, Any]] = {t.file_name(sign): (t, sign) for t in self.driven for sign in t.signs}
        if start.options.goes_on:  # behind the barrier of a rotor lies the same shape, unless one of its atoms is held
            driven = [t for t in self.driven if not t.rotor] if start.options.push else hold.torsions if hold else []
            self.jobs = {t.name: (t, None) for t in driven}

    def say(self, text: str) -> None:
        self.start.folder.say("  " + text)

    def each(self, what: str, method: Callable[[Search, Any], Any], values: Iterable[Any],
             kind: type | None = None) -> Iterator[tuple[Any, Any]]:
        """(value, method(self, value) or a Dropped) in the order of the values, computed by several processes. kind: of the
        results, where they are kept for these values and this conformation."""
        global _search
        _search, values = self, list(values)
        if not values:
            return
        tell = self.start.folder.counted(what, len(values))
        threads = min(self.start.options.threads, len(values))
        with workers(threads) as pool:
            raise_if_stopped()
            results = pool.imap(_ask, [(method, kind, value) for value in values])
            for done, value in enumerate(values):
                while True:
                    tell(done)
                    with suppress(multiprocessing.TimeoutError):
                        result = results.next(0.5)
                        break
                tell(done + 1)
                yield value, result

    def result(self, found: list[Path], dropped: list[tuple[str, str]]) -> Result:
        """dropped: without those that a path has, whose bond it turns though another one was driven."""
        have = {one.name for one in found}
        return Result(self.molecule.numbers, self.surface.masses, self.start.words, self.driven, self.x, self.energy,
                      self.rest.nu1, found, [(name, why) for name, why in dropped if name not in have])

    def cached(self, types: Sequence[type], inputs: Sequence[Any], compute: Callable[[], Any]) -> Any:
        """The result of compute(), of one of these types, which is computed once. inputs: the step's name, and what it
        depends on besides the molecule."""
        one, folder = self.molecule, self.start.folder
        key = [folder.version, one.numbers, self.start.words, one.charge, one.unpaired, *inputs]
        return folder.cache.take(key, lambda: plain(compute()), lambda value: restored(types, value, len(one.numbers)))

    # The conformation

    def find_conformation(self, keep: bool) -> None:
        """Sets rest, its x and energy, and the surface. keep: relax the molecule's shape to the nearest minimum instead of
        looking for the lowest one."""
        shapes = [] if self.start.options.keep_conformation else [x for _, x in self.shapes]
        near = self.cached([Point], ["conformer", self.molecule.positions.tolist(), keep, plain(shapes)],
                           lambda: self._conformer(keep, shapes))
        # GFN-FF must read its bonds off a shape like the conformation, not off the shape from which it was found: then
        # one run of xtb on the conformation's file gives the same energy in most cases. Not in all: at an amine's nitrogen
        # GFN-FF's terms depend on which of three bonds is the shortest, and that may change from each minimum to the next.
        # So the surface on which this is a minimum remains that of the search.
        self.surface = self.start.surface(near.x)
        self.rest = self.cached([Point], ["conformation", near.x.tolist()], lambda: self._conformation(near.x))
        self.x, self.energy = self.rest.x, self.rest.energy

    def _conformation(self, x: Array) -> Point:
        x = geometry.on_principal_axes(optimise.minimum(self.surface, x).x, self.surface.masses)
        if why := self.start.isomer.differs(x):
            raise Failed(f"no conformation: by {self.start.method} it relaxes to {why}")
        return optimise.point(self.surface, geometry.as_in_file(x))

    def _conformer(self, keep: bool, shapes: Shapes) -> Point:
        """A minimum on its own surface."""
        starts = shapes or ([self.molecule.positions] if keep else self._conformers())
        best, reason = None, ""
        tie = SAME_ENERGY / HARTREE if shapes else 0.0  # of equal minima of an ensemble the first is taken
        for n, (_, one) in enumerate(self.each("relaxing conformers", Search.relax, starts), 1):
            if isinstance(one, Dropped):
                reason = one.why
                self.say(f"conformer {n}: left out: {reason}")
            elif best is None or one[0] < best[0] - tie:
                best = one
        if best is None:
            charges = [atom.GetFormalCharge() for atom in self.molecule.rd.GetAtoms()]
            if self.start.options.solvent is None and max(charges) > 0 > min(charges):
                reason += "; a zwitterion needs water: give --solvent water, or the neutral form"
            raise Failed(f"no conformation: none of the start structures relaxes: {reason}")
        return optimise.minimum(self.start.surface(best[1]), best[1])

    def _conformers(self) -> list[Array]:
        isomer = self.start.isomer
        found = conformers(self.molecule, CONFORMERS, lambda x: not isomer.differs(x), stereo.bounds)
        if not found:
            raise Failed("no conformation: no conformer is built that is the isomer which is given: give a file with its shape, "
                         "without --search")
        return found

    def relax(self, start: Array) -> tuple[float, Array]:
        """(energy, x) of a shape in angstrom, on its own surface. Errors: optimise.NoPath"""
        surface, x = self.start.surface(start / BOHR), start / BOHR
        x, energy, _ = optimise.search(surface, x, surface.hessian(x), tolerance=1e-4, steps=400, renew=surface.hessian,
                                       every=50, noise=surface.noise)
        if not self.intact(x):
            raise optimise.NoPath("its bonds change")
        if why := self.start.isomer.differs(x):
            raise optimise.NoPath(why)
        return energy, x

    # Shapes

    def intact(self, x: Array) -> bool:
        return geometry.bonds_of(self.molecule.numbers, x * BOHR) == self.molecule.neighbours

    def above(self, energy: float) -> float:
        """kJ/mol above the conformation."""
        return (energy - self.energy) * HARTREE

    def apart(self, x: Array, y: Array) -> float:
        """Root mean square distance of two shapes."""
        return geometry.rms(geometry.aligned(x, y, self.surface.masses), y)

    def same(self, x: Array, y: Array) -> bool:
        return self.apart(x, y) < SAME_SHAPE

    # Saddles

    def driven_over(self, minimum: Point, torsion: torsions.Torsion, sign: int) -> Ends:
        """The Ends of the first saddle on the way of a torsion from a minimum, on whose side the near one is."""
        left = self.start.options.highest / HARTREE - (minimum.energy - self.energy)
        first = self.climbed(*torsions.scan(self.surface, minimum, torsion, sign, highest=left))
        lower = []
        for guess in torsions.inverted(self.surface, minimum.x, first.x, torsion, self.molecule.neighbours):
            with suppress(optimise.NoPath):
                lower.append(self.climbed(*guess))
        for one in sorted(lower, key=lambda one: one.energy):
            if (first.energy - one.energy) * HARTREE > SAME_ENERGY:
                with suppress(optimise.NoPath):
                    ends = self.ends(one, minimum.x, renumber=True)
                    if self.same(ends.near.x, minimum.x) and not self.same(ends.far.x, minimum.x):
                        return ends
        return self.ends(first, minimum.x)

    def climbed(self, guess: Array, tangent: Array) -> Point:
        """The saddle near a guess. Errors: optimise.NoPath where that is none between two shapes of this molecule."""
        one = optimise.saddle(self.surface, guess, tangent)
        modes = optimise.wave_numbers(one.hessian, one.x, self.surface.masses)
        count = int((modes[:1] < 0).sum() + (modes[1:] < -optimise.LEVEL).sum())
        if count != 1:
            raise optimise.NoPath(f"{count} imaginary frequencies")
        if not self.intact(one.x):
            raise optimise.NoPath("bonds change")
        return one

    def ends(self, saddle: Point, a: Array, b: Array | None = None, renumber: bool = False) -> Ends:
        """The Ends of a saddle, of which the near one is like shape a, and the far one like b, where that is given. renumber:
        methyl groups and the like, so that they stand as in a."""
        masses = self.surface.masses
        _, vectors = optimise.projected(saddle.hessian, saddle.x, masses)
        mode = (vectors[:, 0] / np.repeat(np.sqrt(masses), 3)).reshape(-1, 3)
        sides = []
        for sign in (AWAY, -AWAY):
            passed = [saddle.x, saddle.x + sign * mode / np.linalg.norm(mode)]
            one = optimise.minimum(self.surface, passed[1], saddle.hessian, longest=AWAY, passed=passed)
            sides.append((one, passed))
        both = [Ends(saddle, near, far, up[::-1], down) for (near, up), (far, down) in (sides, sides[::-1])]
        out = min([self.numbered_as(a, ends) for ends in both] if renumber else both,
                  key=lambda ends: self.apart(ends.near.x, a) + (0 if b is None else self.apart(ends.far.x, b)))
        out.far.x = geometry.aligned(out.far.x, self.x, masses)
        return out

    def numbered_as(self, x: Array, ends: Ends) -> Ends:
        """The same Ends, but the three equal atoms of each methyl group or the like are numbered on, so that the near side is
        nearest to a shape: where an atom becomes a pyramid to its other side, its methyl groups turn by a third."""
        order = np.arange(len(x))
        for group in rotors.threes(self.molecule):
            turns = []
            for turn in range(3):
                turns.append(order.copy())
                turns[-1][group] = np.roll(order[group], turn)
            order = min(turns, key=lambda one: self.apart(ends.near.x[one], x))
        flat = (3 * order[:, None] + np.arange(3)).ravel()
        saddle, near, far = (replace(p, x=p.x[order], hessian=p.hessian[np.ix_(flat, flat)])
                             for p in (ends.saddle, ends.near, ends.far))
        return Ends(saddle, near, far, *([y[order] for y in way] for way in (ends.up, ends.down)))

    def to_barrier(self, job: str) -> Path:
        """The Path to the first barrier of a torsion; where its `why` says that it is none, without nodes between."""
        torsion, sign = self.jobs[job]
        ends = self.driven_over(self.rest, torsion, sign)
        out = Path([self.x, ends.saddle.x], [self.energy, ends.saddle.energy], nu1=ends.saddle.nu1, near=ends.near,
                   far=ends.far)
        turns = self.turns_back(ends.near)
        if turns is None:
            at, one, two = (f"{self.above(p.energy):.2f} kJ/mol" for p in (ends.saddle, ends.near, ends.far))
            return replace(out, why=f"the saddle at {at} joins other minima, at {one} and {two}")
        try:
            out.nodes, out.energies = path.nodes(self.surface, ends.up, self.rest, turns=turns)
        except optimise.NoPath as why:
            out.why = str(why)
        return out

    def turns_back(self, near: Point) -> list[tuple[torsions.Torsion, float]] | None:
        """[(methyl group, angle)] that make the conformation of the near side of a saddle, since such groups may turn freely;
        None where that is another minimum."""
        x = near.x
        out: list[tuple[torsions.Torsion, float]] = []
        if self.same(x, self.x):
            return out
        for t in self.torsions:
            if t.rotor:
                out.append((t, geometry.torsion(self.x, *t.atoms) - geometry.torsion(x, *t.atoms)))
                x = t.turned(x, out[-1][1])
        return out if abs(self.above(near.energy)) < torsions.LEAST_BARRIER and self.same(x, self.x) else None
