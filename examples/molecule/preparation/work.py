"""All steps for one molecule. Each is kept until all are done, so that a run that was stopped
continues where it was."""

import hashlib
import json
import os
import sys
import time
from dataclasses import dataclass, field

import numpy as np

from . import files, geometry, optimise, path, torsions
from .molecule import conformers, from_file
from .xtb import BOHR, HARTREE, Surface, XtbError

VERSION = 2  # of the algorithm; a step that another version has kept is computed anew
SAME_SHAPE = 0.1  # bohr, root mean square: minima closer than this are one
SAME_ENERGY = 0.02  # kJ/mol


class Failed(Exception):
    """The molecule has no conformation with paths; the message says why."""


class Dropped(Exception):
    """A torsion in one direction gives no path; the message says why."""


@dataclass
class Found:
    """A saddle and its path to the conformation. nodes: aligned to the conformation; energies:
    hartree; far: the minimum on the other side; far_is_equal: whether that is the conformation with
    equal atoms exchanged."""
    name: str
    torsion: str
    nodes: list
    energies: list
    nu1: float
    far: np.ndarray
    far_energy: float
    far_nu1: float
    far_is_equal: bool


@dataclass
class Result:
    """Lengths are in bohr, energies in hartree; dropped: (path, reason)."""
    numbers: list
    masses: np.ndarray
    method: str
    torsions: list
    x: np.ndarray
    energy: float
    nu1: float
    found: list = field(default_factory=list)
    dropped: list = field(default_factory=list)

    def lie_like(self, reference):
        """If the conformation is the reference but for the numbers of its hydrogens, turns
        everything so that it lies as the reference does."""
        heavy = np.array(self.numbers) > 1
        x = geometry.aligned(self.x, reference, np.where(heavy, self.masses, 0.0))
        if geometry.rms(x[heavy], reference[heavy]) < SAME_SHAPE:
            self.x = geometry.centred(x, self.masses)
            for found in self.found:
                found.nodes = [geometry.aligned(y, self.x, self.masses) for y in found.nodes]
                found.nodes[0] = self.x

    def lie_as_before(self, directory):
        """Turns everything as the conformation lies that an earlier run left in this folder, if it is the same one:
        a box that was changed by hand then fits the new shapes, too."""
        old = os.path.join(directory, "conformation.xyz")
        if os.path.exists(old):
            before = from_file(old)
            if before.numbers == self.numbers:
                self.lie_like(before.positions / BOHR)


class Steps:
    """Results of steps, kept as JSON files that are named by a hash of the steps' inputs."""

    def __init__(self, directory, again):
        self.directory = directory
        self.again = again

    def take(self, key, compute):
        text = json.dumps([VERSION, key], sort_keys=True)
        digest = hashlib.sha256(text.encode()).hexdigest()[:20]
        name = os.path.join(self.directory, digest + ".json")
        if not self.again:
            try:
                with open(name, encoding="utf-8") as file:
                    return json.load(file)
            except (FileNotFoundError, ValueError):
                pass
        value = compute()
        os.makedirs(self.directory, exist_ok=True)
        files.write_whole(name, json.dumps(value))
        return value

    def remove(self):
        if os.path.isdir(self.directory):
            for name in os.listdir(self.directory):
                if name.endswith(".json"):
                    os.remove(os.path.join(self.directory, name))
            if not os.listdir(self.directory):
                os.rmdir(self.directory)


class Work:
    """The steps for one molecule. options: those of the command line, see cli.py; guesses: shapes
    near saddles (angstrom) by the name of their path."""

    def __init__(self, molecule, driven, options, guesses):
        self.molecule = molecule
        self.driven = driven
        self.options = options
        self.guesses = guesses
        self.charge = molecule.charge if options.charge is None else options.charge
        self.unpaired = getattr(options, "uhf", 0)
        self.steps = Steps(options.work, options.again)
        self.tree = geometry.Tree(molecule.neighbours, molecule.numbers)
        self.started = time.monotonic()

    def say(self, text):
        if not self.options.quiet:
            print(f"prepare: {time.monotonic() - self.started:6.1f} s  {text}", file=sys.stderr,
                  flush=True)

    def run(self):
        self._find_conformation()
        found, dropped = [], []
        for torsion in self.driven:
            for sign in torsion.signs:
                name = torsion.file_name(sign)
                try:
                    one = self._drive(name, torsion, sign, found)
                except Dropped as why:
                    dropped.append((name, str(why)))
                    self.say(f"{name}: no path: {why}")
                else:
                    found.append(one)
                    self.say(f"{name}: saddle {self._above(one.energies[-1]):.2f} kJ/mol, "
                             f"{files.imaginary(one.nu1)} cm^-1; beyond it "
                             f"{self._above(one.far_energy):.2f} kJ/mol")
        if not found:
            raise Failed("no torsion leads to a saddle of this conformation")
        order = sorted(range(len(found)), key=lambda n: found[n].energies[-1])
        if self.options.paths is not None:
            for n in order[self.options.paths:]:
                dropped.append((found[n].name, f"{self._above(found[n].energies[-1]):.2f} kJ/mol, "
                                               f"not among the {self.options.paths} lowest"))
            order = sorted(order[:self.options.paths])
            found = [found[n] for n in order]
        return Result(self.molecule.numbers, self.surface.masses, self.options.method, self.driven,
                      self.x, self.energy, self.nu1, found, dropped)

    # The conformation

    def _surface(self, x):
        return Surface(self.molecule.numbers, x, self.options.method, self.charge, self.tree,
                       self.unpaired)

    def _find_conformation(self):
        o = self.options
        start = o.smiles if o.file is None else self.molecule.positions.tolist()
        key = ["conformation", self.molecule.numbers, start, o.method, self.charge,
               self.unpaired, o.keep_conformation, o.conformers, o.seed,
               [t.atoms for t in self.driven if not t.rotor and not o.keep_conformation]]
        kept = self.steps.take(key, self._compute_conformation)
        self.x = np.array(kept["x"])
        self.surface = self._surface(self.x)
        self.energy = self.surface.energy(self.x)
        self.hessian = np.array(kept["hessian"])
        self.nu1 = float(optimise.wave_numbers(self.hessian, self.x, self.surface.masses)[0])
        self.say("conformation: " + files.words(self.driven, self.x))

    def _compute_conformation(self):
        o = self.options
        if o.keep_conformation:
            starts = [self.molecule.positions]
        else:
            starts = conformers(self.molecule, self.driven, o.conformers, o.seed)
            self.say(f"{len(starts)} conformers")
        best = None
        for n, (x, energy, why) in enumerate(self._relaxed(starts)):
            if why:
                reason = why
                self.say(f"conformer {n + 1}: left out: {why}")
            elif best is None or energy < best[0]:
                best = energy, x
        if best is None:
            raise Failed(f"no conformation: none of the start structures relaxes: {reason}")
        # GFN-FF must read its bonds off the conformation itself, not off the shape from which it
        # was found: then one run of xtb on the conformation's file gives the same energy.
        x = best[1]
        for _ in range(2):
            surface = self._surface(x)
            x, _, hessian = optimise.minimum(surface, x)
        x = geometry.on_principal_axes(x, surface.masses)
        # Rounded as in the file, since readers compare the nodes of paths with the file.
        x = np.round(x * BOHR, 8) / BOHR
        return {"x": x.tolist(), "hessian": surface.hessian(x).tolist()}

    def _relaxed(self, starts):
        """(x, energy, why it is left out) of each start."""
        out = []
        for start in starts:
            try:
                x, energy = self._roughly(start / BOHR)
                out.append((x, energy, "" if self._intact(x) else "its bonds change"))
            except (optimise.NotConverged, XtbError) as why:
                out.append((None, None, str(why)))
        return out

    def _roughly(self, x):
        surface = self._surface(x)
        x, energy, _ = optimise.search(surface, x, surface.hessian(x), tolerance=1e-4, steps=400,
                                       renew=surface.hessian, every=50, tree=surface.tree)
        return x, energy

    def _intact(self, x):
        return geometry.bonds_of(self.molecule.numbers, x * BOHR) == self.molecule.neighbours

    # Saddles and paths

    def _above(self, energy):
        return (energy - self.energy) * HARTREE

    def _away(self, x):
        """Root mean square distance from the conformation, bohr."""
        return geometry.rms(geometry.aligned(x, self.x, self.surface.masses), self.x)

    def _equal(self, x, y):
        a, b = (geometry.fingerprint(self.molecule.numbers, z) for z in (x, y))
        return np.abs(a - b).max() < SAME_SHAPE

    def _drive(self, name, torsion, sign, earlier):
        key = self._key(name, torsion, sign)
        top = self._kept_saddle(key, name, torsion, sign)
        if "dropped" in top:
            raise Dropped(top["dropped"])
        self._refuse_known(top, earlier)
        way = self._kept_path(key, top)
        if "dropped" in way:
            raise Dropped(way["dropped"])
        return self._found(name, torsion, top, way)

    def _key(self, name, torsion, sign):
        guess = self.guesses.get(name)
        return [self.molecule.numbers, self.x.tolist(), self.options.method, self.charge,
                self.unpaired, torsion.atoms, sign, self.options.highest,
                None if guess is None else guess.tolist()]

    def _kept_saddle(self, key, name, torsion, sign):
        return self.steps.take(["saddle", *key], lambda: self._guarded(
            self._saddle, torsion, sign, self.guesses.get(name)))

    def _kept_ends(self, key, top):
        return self.steps.take(["ends", *key], lambda: self._guarded(self._ends, top))

    def _kept_path(self, key, top):
        ends = self._kept_ends(key, top)
        if "dropped" in ends:
            return ends
        return self.steps.take(["path", *key], lambda: self._guarded(self._path, top, ends))

    @staticmethod
    def _found(name, torsion, top, way):
        nodes = [np.array(x) for x in way["nodes"]]
        return Found(name, torsion.name, nodes, way["energies"], top["nu1"], np.array(way["far"]),
                     way["far_energy"], way["far_nu1"], way["far_is_equal"])

    def _refuse_known(self, top, earlier):
        x = np.array(top["x"])
        for other in earlier:
            if abs(top["energy"] - other.energies[-1]) * HARTREE > SAME_ENERGY:
                continue
            y = other.nodes[-1]
            if geometry.rms(geometry.aligned(x, y, self.surface.masses), y) < SAME_SHAPE:
                raise Dropped(f"the saddle of {other.name}")
            if not self.options.keep_equal and self._equal(x, y):
                raise Dropped(f"the saddle of {other.name} by symmetry")

    def _guarded(self, compute, *arguments):
        """The result of compute, or the reason why there is none, in a form that can be kept."""
        try:
            return compute(*arguments)
        except (Dropped, torsions.NoBarrier, path.NotSane) as why:
            return {"dropped": str(why)}
        except optimise.NotConverged as why:
            return {"dropped": f"not converged: {why}"}
        except XtbError as why:
            return {"dropped": str(why)}

    def _saddle(self, torsion, sign, guess):
        if guess is None:
            guess, tangent = torsions.scan(self.surface, self.x, self.hessian, torsion, sign,
                                           highest=self.options.highest / HARTREE)
        else:
            guess = guess / BOHR
            tangent = sign * geometry.torsion_gradient(guess, *torsion.atoms).ravel()
        x, energy, hessian = optimise.saddle(self.surface, guess, tangent)
        waves = optimise.wave_numbers(hessian, x, self.surface.masses)
        count = int((waves < 0).sum())
        if count != 1:
            raise Dropped(f"{count} imaginary frequencies")
        if not self._intact(x):
            raise Dropped("bonds change")
        return {"x": x.tolist(), "energy": energy, "hessian": hessian.tolist(), "nu1": waves[0]}

    def _sides(self, x, hessian):
        """The two minima that the saddle joins, each as (sign, x, energy, hessian)."""
        masses = self.surface.masses
        _, vectors = optimise.projected(hessian, x, masses)
        mode = vectors[:, 0] / np.repeat(np.sqrt(masses), 3)
        mode = 0.15 * mode / np.linalg.norm(mode)
        return [(sign, *optimise.minimum(self.surface, x + sign * mode.reshape(-1, 3), hessian,
                                         longest=0.15)) for sign in (1, -1)]

    def _ends(self, top):
        """The minima that a saddle joins, the nearer one first."""
        sides = self._sides(np.array(top["x"]), np.array(top["hessian"]))
        near, far = sorted(sides, key=lambda side: self._away(side[1]))
        x = geometry.aligned(far[1], self.x, self.surface.masses)
        nu1 = optimise.wave_numbers(far[3], x, self.surface.masses)[0]
        equal = abs(self._above(far[2])) < SAME_ENERGY and self._equal(x, self.x)
        return {"sign": near[0], "near": near[1].tolist(), "near_energy": near[2],
                "far": x.tolist(), "far_energy": far[2], "far_nu1": nu1, "far_is_equal": bool(equal)}

    def _path(self, top, ends):
        if self._away(np.array(ends["near"])) > SAME_SHAPE:
            energies = (top["energy"], ends["near_energy"], ends["far_energy"])
            at, one, two = (f"{self._above(e):.2f} kJ/mol" for e in energies)
            raise Dropped(f"the saddle at {at} joins other minima, at {one} and {two}")
        nodes, energies = path.nodes(self.surface, self.tree, np.array(top["x"]),
                                     np.array(top["hessian"]), ends["sign"], self.x, self.energy)
        return {"nodes": [n.tolist() for n in nodes], "energies": energies, "far": ends["far"],
                **{name: ends[name] for name in ("far_energy", "far_nu1", "far_is_equal")}}
