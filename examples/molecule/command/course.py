"""The course of a molecule from its file to the page: the stages one by one."""

import json
import os
import shlex
from dataclasses import asdict

from preparation import files, work, xyz
from preparation import molecule as prepared
from preparation.xtb import Surface

from . import (choice, combined, crossing, definition, page, pushing, reading, resolution, room, rotors, singles,
               stiffness, structures)
from .filters import Failed, FilterFailed, Filters
from .stages import Stages, digest, digest_of, duration

GFN2_ATOMS = 24
ENSEMBLE = 8  # frames of an ensemble between which paths are looked for
VERIFY_SHARE = 0.15  # of the time that the grid took, about
# What expand says of a grid that it cannot compute, and what that means.
HOPELESS = {"level limit": f"with it a point has more than {definition.MAX_LEVELS} states",
            "does not converge": "with it the molecule does not come to rest"}


class BreaksRule(Failed):
    """Verify found a fault in the grid."""


def run(o):
    """Everything, or all until --until; the lines for standard output."""
    course = Course(o)
    course.read()
    course.find_structures()
    if o.until == "structures":
        return course.stopped()
    while True:
        try:
            course.decide()
            if o.until == "definition":
                return course.stopped()
            course.compute()
            break
        except BreaksRule as why:
            course.soften_anchors(why)
        except FilterFailed as why:
            course.do_without_the_stiffest(why)
        except room.TooSmall as why:
            course.widen(why)
    course.push()
    return course.summary()


class Course:
    def __init__(self, options):
        self.o = options
        self.name = os.path.basename(os.path.realpath(options.output))
        self.toml, self.grid = f"{self.name}.toml", f"{self.name}.grid"
        self.stages = Stages(options.output, options.quiet)
        self.filters = Filters(options.output)
        self.by_hand, self.taken = False, []
        self.unwanted = {}  # paths with which no grid could be computed, and why
        self.softer = 1  # how many times softer anchors are than the rule has them
        self.expected = None  # seconds that the grid takes, about
        self.what = options.file or f"SMILES '{options.smiles}'"

    # The molecule

    def read(self):
        o, stages = self.o, self.stages

        def compute():
            one, built = reading.read(o.file, o.smiles, lambda text: stages.say("  " + text), o.uhf)
            charge = one.charge if o.charge is None else o.charge
            reading.check_electrons(one, self.what, charge, o.uhf)
            os.makedirs(o.output, exist_ok=True)
            one.ob.SetTitle(f"charge={charge} built={int(built)}")
            files.write_whole(stages.path("start.sdf"), reading.sdf(one))
            return ["start.sdf"]
        text = _digest_of_input(o.file) if o.file else o.smiles
        stages.run("molecule", "", [], [text, o.charge, o.uhf], compute)
        self.molecule = prepared.from_file(stages.path("start.sdf"))
        words = dict(w.split("=") for w in self.molecule.ob.GetTitle().split())
        self.charge, self.search = int(words["charge"]), o.search or words["built"] == "1"
        self.rotors, self.stay = rotors.find(self.molecule)
        self._leave_still()
        self.method = o.method
        if o.method == "auto":
            self.method = "gfn2" if len(self.molecule.numbers) <= GFN2_ATOMS else "gfnff"
        rings = sum(one.why == rotors.RING for one in self.stay)
        stages.say(f"  {self.molecule.ob.GetFormula()}, {len(self.molecule.numbers)} atoms, "
                   f"charge {reading.signed(self.charge)}, {len(self.rotors)} bonds turn"
                   + (f"; {rings} rings stay as they are" if rings else ""))

    def _leave_still(self):
        """Turns only the bonds of --torsions."""
        if self.o.torsions is None:
            return
        wanted = set(self.o.torsions.split(","))
        known = {t.name for t in self.rotors}
        if not self.o.basins:  # whose paths go both ways
            known = known.union(*(t.file_names() for t in self.rotors))
        unknown = sorted(wanted - known)
        if unknown:
            raise Failed(f"--torsions: no bond {unknown[0]} turns, only " + ", ".join(t.name for t in self.rotors))
        turn = [t if t.name in wanted else t.only(wanted) for t in self.rotors]
        self.stay += [rotors.Left(t.name, "not among --torsions") for t, one in zip(self.rotors, turn) if not one.signs]
        self.rotors = [t for t in turn if t.signs]

    # The structures

    def find_structures(self):
        o, stages = self.o, self.stages

        points, shapes = self._single_points(), self._ensemble()

        def compute():
            if o.method == "auto":
                stages.say("  energies by " + ("GFN2-xTB" if self.method == "gfn2" else
                           f"GFN-FF, as for all above {GFN2_ATOMS} atoms (--method gfn2 is better, and slower)"))
            one = structures.explore(self.molecule, self.rotors, structures.Options(
                work.Options(self.method, self.charge, o.uhf, o.highest, stages.path(".work"), o.solvent), self.search,
                o.keep_conformation, o.basins, o.threads, shapes), stages)
            for name, below in one.lower:
                stages.say(f"  {name} leads to a minimum that is {below:.1f} kJ/mol lower")
            one.result.lie_as_before(stages.directory)
            if points is not None:
                points.put_into(one.result, o.threads, stages)
            source = os.path.basename(o.file) if o.file else self.what  # the report is the same wherever the file lies
            return files.write_set(stages.directory, one.result, f"hapgrid molecule: {source}, {self.method}, "
                                   f"charge {reading.signed(self.charge)}, {o.uhf} unpaired electrons")
        stages.run("structures", "looking for the conformation and the barriers around it", ["start.sdf"],
                   [self.method, o.solvent, points and points.key, self.charge, o.uhf, self.search, o.highest, o.basins, o.keep_conformation,
                    [name for t in self.rotors for name in t.file_names()], [x.tolist() for _, x in shapes]], compute)
        self.structures = structures.Structures(stages)

    # The definition

    def decide(self):
        stages = self.stages
        self.by_hand = stages.changed_by_hand("definition", self.toml)
        if self.by_hand:
            stages.say(f"{self.toml} was changed by hand: it is kept")
            return
        known = self.stages.done.get("without", {})
        if known.get("key") == digest(self.stages.path("report.tsv")):
            self.unwanted = known["paths"]
        self.taken = self._choose()
        self.definition = definition.Definition.around(self.molecule, self.structures, self.taken, self.o.basins,
                                                       self.o.spacing or 0.0, self._room()["sides"])
        self.definition.torsions = self._turned(self.taken)
        self.definition.stiffness = self._stiffness()
        self._resolve()
        stages.run("definition", f"writing {self.toml}", [], [self.definition.text()], self._write_definition)

    def do_without_the_stiffest(self, why):
        """After a grid that could not be computed, because the states of a point are too many or the
        minimiser does not arrive. Errors: raises `why` again where this is no remedy."""
        words = next((text for key, text in HOPELESS.items() if key in str(why)), None)
        if self.by_hand or not self.taken or words is None:
            raise why
        name = self.taken[-1]
        self.unwanted[name] = words
        self.stages.done["without"] = {"key": digest(self.stages.path("report.tsv")), "made": {},
                                       "paths": self.unwanted}
        self.stages.say(f"  {name} is left out: {words}")

    def _room(self):
        """How much wider the box was made for these paths, and how often."""
        key = self._taken_from()
        known = self.stages.done.get("room", {})
        return known if known.get("key") == key else {"key": key, "made": {}, "sides": [0.0] * 6, "times": 0}

    def widen(self, why):
        """After a grid at whose sides the molecule is held out of its place."""
        known = self._room()
        known["times"] += 1
        known["sides"] = [more + why.spacing * touched for more, touched in zip(known["sides"], why.sides)]
        self.stages.done["room"] = known
        self.stages.say("  the molecule is pushed as far as a side of the box, which is made wider")

    def _check_room(self, grid):
        if self._room()["times"] < room.WIDENED:
            room.check(self.filters, self.stages, grid)

    def soften_anchors(self, why):
        """After a grid that breaks a rule: where the molecule cannot yield the probe goes through it, and
        the spacing does not resolve that. Errors: raises `why` again where this is no remedy."""
        if self.by_hand or self.definition.stiffness == self.definition.stiffness.softer(2):
            raise why
        self.softer *= 2
        self.stages.done["softer"] = {"key": self._taken_from(), "made": {}, "times": self.softer}
        self.stages.say(f"  {why}: anchors half as stiff are tried")

    def _taken_from(self):
        """What a decision to soften holds for."""
        return [digest(self.stages.path("report.tsv")), self.taken, self.o.spacing]

    def _write_definition(self):
        definition.write(self.stages.path(self.toml), self.definition.text())
        return [self.toml]

    def _xyz(self):
        return ["conformation.xyz", *(f.name + ".xyz" for f in self.structures.found)]

    def _choose(self):
        stages = self.stages

        def compute():
            taken, left = choice.choose(self.filters, stages, self.molecule, self.structures, self.o.paths,
                                        self.unwanted, self.o.basins, self._missed)
            stages.say("  taken: " + (", ".join(taken) or "no path: the molecule keeps its shape"))
            table = choice.table(self.structures, self.rotors, self.stay, taken, left)
            files.write_whole(stages.path("rotors.tsv"), table)
            return ["rotors.tsv"]
        chosen = stages.run("choice", "choosing the softest paths that are sane together",
                            [*self._xyz(), "report.tsv"],
                            [self.o.paths, self.unwanted, self.o.basins, self.o.single_points], compute)
        with open(stages.path("rotors.tsv"), encoding="utf-8") as file:
            rows = [line.rstrip("\n").split("\t") for line in file][1:]
        for line in choice.left_out(rows) if chosen else ():
            stages.say("  " + line)
        taken = {row[0] for row in rows if row[3] == "yes"}
        order = sorted(self.structures.found, key=lambda f: f.barrier)
        return [f.name for f in order if f.name in taken]

    def _missed(self, one):
        if not self.o.basins:
            return ""
        points = self._single_points()
        return combined.missed(self.filters, self.stages, one, self.structures.x, (points or self._surface()).energy,
                               "single points" if points else "xtb")

    def _ensemble(self):
        """The frames of an XYZ file between whose minima paths are looked for."""
        if not self.o.basins or not self.o.file or not self.o.file.lower().endswith(".xyz"):
            return []
        shapes = xyz.ensemble(prepared.read_text(self.o.file), self.molecule.numbers) or []
        if len(shapes) > ENSEMBLE:
            self.stages.say(f"  {len(shapes)} frames: the {ENSEMBLE} lowest are taken")
        return shapes[:ENSEMBLE]

    def _surface(self):
        return Surface(self.structures.numbers, self.structures.x, self.method, self.charge, unpaired=self.o.uhf,
                       solvent=self.o.solvent)

    def _single_points(self):
        """The SinglePoints of --single-points, or None."""
        if self.o.single_points is None:
            return None
        return singles.SinglePoints(self.o.single_points, self.molecule.numbers, self.charge, self.o.uhf,
                                    work.Steps(self.stages.path(".work")))

    def _stiffness(self):
        stages = self.stages
        if not self.taken or self.o.basins:
            return stiffness.Stiffness()

        def compute():
            found = [f for f in self.structures.found if f.name in self.taken]
            one = stiffness.of_paths(self.molecule, self._surface(), self.structures.x, found, definition.PENALTY).rounded()
            files.write_whole(stages.path("stiffness.json"), json.dumps(asdict(one), indent=1) + "\n")
            return ["stiffness.json"]
        stages.run("stiffness", "computing how stiff the torsions are", ["conformation.xyz", *(
            name + ".xyz" for name in self.taken)], [self.method, self.charge, self.o.uhf, self.o.solvent], compute)
        known = stages.done.get("softer", {})
        self.softer = known["times"] if known.get("key") == self._taken_from() else 1
        with open(stages.path("stiffness.json"), encoding="utf-8") as file:
            return stiffness.Stiffness(**json.load(file)).softer(self.softer)

    def _resolve(self):
        """Sets the definition's spacing."""
        o, stages = self.o, self.stages
        if o.spacing:
            self.expected = None
            return
        coarse = self.definition.spacing
        text = self.definition.text()
        what = f"computing a coarse grid, {coarse:g} Å, from which the box and the spacing follow"

        def compute():
            definition.write(stages.path("coarse.toml"), text)
            made = resolution.compute_grid(self.filters, stages, what, "coarse.toml", "coarse.grid", o.threads,
                                           self._estimated("coarse.toml"))
            self._check_room("coarse.grid")
            report = resolution.measure(self.filters, stages, "coarse.grid", o.threads)
            files.write_whole(stages.path("coarse.json"), report)
            return ["coarse.toml", *made, "coarse.json"]
        stages.run("resolution", what, self._xyz(), [text], compute)
        with open(stages.path("coarse.json"), encoding="utf-8") as file:
            report = file.read()
        seconds = resolution.cpu_seconds(stages.path("coarse.grid.cost"))
        found = resolution.decide(report, seconds, coarse, o.threads, o.basins)
        self.definition.spacing = found.spacing
        self.expected = found.cost(found.spacing) / o.threads
        stages.say(f"  spacing {found.spacing:g} Å, about {duration(self.expected)}; " + self._finer(found))

    def _finer(self, found):
        """What a finer grid would cost."""
        wanted = f"{resolution.WANTED:g} Å in 99 of 100 places"
        if found.enough < found.spacing * 0.99:
            return (f"to be off by less than {wanted} would take --spacing {found.enough:.2g} and about "
                    f"{duration(found.cost(found.enough) / self.o.threads)}" + (", a guess" if found.guessed else ""))
        return f"off by less than {wanted}; " + self._half(found.seconds, found.coarse, found.spacing)

    def _half(self, seconds, before, spacing):
        half = resolution.scaled(seconds, before, spacing / 2) / self.o.threads
        return f"a grid twice as fine, --spacing {spacing / 2:.2g}, would take about {duration(half)}"

    def _estimated(self, toml):
        seconds = resolution.estimated(self.filters, toml)
        return seconds and seconds / self.o.threads

    # The grid

    def compute(self):
        o, stages = self.o, self.stages
        what = f"computing {self.grid}, how the molecule yields at each place of the probe"

        def compute():
            made = resolution.compute_grid(self.filters, stages, what, self.toml, self.grid, o.threads,
                                           self.expected or self._estimated(self.toml))
            if not self.by_hand:
                self._look_at(self.grid)
            return made
        stages.run("grid", what, [self.toml, *self._xyz()], [], compute)

        title = "checking that the grid is whole and that its states are the model's"

        def verify():
            share = resolution.cpu_seconds(stages.path(f"{self.grid}.cost")) * VERIFY_SHARE / o.threads
            out, code = self.filters.run("verify", self.grid, "-v", "-j", o.threads, good=(0, 3, 4),
                                         watch=lambda gone: stages.waiting(title, gone, share))
            files.write_whole(stages.path("verify.txt"), out)
            if code == 3:
                raise BreaksRule(f"{self.grid} breaks a rule: see {stages.path('verify.txt')}")
            return ["verify.txt"]
        stages.run("verify", title, [self.grid], [], verify)

    def _look_at(self, grid):
        """Whether a grid has room enough, and what a finer one would cost, where no coarse one told it."""
        try:
            self._check_room(grid)
        except room.TooSmall:
            if self.o.spacing:
                raise
            self.stages.say(f"  at a side of the box the molecule is held: change origin and counts in {self.toml} "
                            "for more room")
        if self.o.spacing:
            seconds = resolution.cpu_seconds(self.stages.path(f"{grid}.cost"))
            self.stages.say("  " + self._half(seconds, self.o.spacing, self.o.spacing))

    # The way of the probe

    def push(self):
        stages = self.stages
        stages.run("pushing", "looking for the probe's ways that turn the molecule", [self.grid], [],
                   lambda: self._ways()(self.filters, stages, self.grid, self.structures, self.o.threads).write())
        made = [n for n in stages.made("pushing") if n.endswith(".txt")]
        self.best = made[0]
        stages.run("page", "drawing pictures", [self.grid, *made, "rotors.tsv", "verify.txt"], [], self._page)

    def _ways(self):
        return crossing.Crossings if self.o.basins else pushing.Ways

    def _page(self):
        turned = self._turned(definition.paths_of(self.stages.path(self.toml)))
        return page.Page(self.filters, self.stages, self.name, self.best, self.molecule, turned,
                         self.o.threads).write()

    def _turned(self, paths):
        """The torsions that these paths turn."""
        return [t for t in self.rotors if {t.name, *t.file_names()} & set(paths)]

    def stopped(self):
        self.stages.say(f"stopped after the {self.o.until}: the same command without --until goes on")
        return ""

    def summary(self):
        out = self.o.output.rstrip("/") or "/"
        self.stages.say(f"done: {out}/index.html sums up")
        grid, way = (shlex.quote(os.path.join(out, name)) for name in (self.grid, self.best))
        return f"hapgrid play {grid} --device path:{way} --rate 1000 --frames - | hapgrid view --window"


def _digest_of_input(path):
    return digest_of(prepared.read_bytes(path))
