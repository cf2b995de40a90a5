"""The steps from a molecule to the paths around its conformation. Each is kept as a file, so that a run that was
stopped continues where it was."""

import os
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from hapgrid_command.files import Failed
from hapgrid_command.work import Kept

from . import geometry, naming, optimise, path, torsions, xyz
from .molecule import conformers
from .xtb import BOHR, HARTREE, SYMBOLS, Surface, XtbError

SAME_SHAPE = 0.1  # bohr, root mean square: minima closer than this are one
SAME_ENERGY = 0.02  # kJ/mol
ROUNDED = 1e-7  # angstrom; files have eight decimals
CONFORMERS = 4  # of the lowest by the force field, which xtb relaxes
SEED = 1  # of random torsions, where there are too many combinations for all


@dataclass
class Found:
    """A saddle and its path to the conformation. nodes: aligned to the conformation; energies: hartree; nu1: None where the
    last node is no saddle of xtb, but the highest by other energies; far: the minimum on the other side, None where nobody
    has looked for it; far_is_equal: whether that is the conformation with equal atoms exchanged."""
    name: str
    torsion: str
    nodes: list
    energies: list
    nu1: float
    far: np.ndarray
    far_energy: float
    far_nu1: float
    far_is_equal: bool
    start: int = 0  # the node that is the conformation
    goes_on: ClassVar = False  # behind its saddle, as a beyond.Beyond does


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
        everything so that it lies as the reference does. Once more, that changes no digit."""
        if _equal(self.x, reference):
            return
        heavy = np.array(self.numbers) > 1
        x = geometry.aligned(self.x, reference, np.where(heavy, self.masses, 0.0))
        if geometry.rms(x[heavy], reference[heavy]) < SAME_SHAPE:
            x = np.round(geometry.centred(x, self.masses) * BOHR, 8) / BOHR
            self.x = reference if _equal(x, reference) else x
            for found in self.found:
                found.nodes = [geometry.aligned(y, self.x, self.masses) for y in found.nodes]
                found.nodes[found.start] = self.x

    def lie_as_before(self, directory):
        """Turns everything as the conformation lies that an earlier run left in this folder, if it is the same one:
        a box that was changed by hand then fits the new shapes, too."""
        old = os.path.join(directory, "conformation.xyz")
        if os.path.exists(old):
            _, symbols, x = xyz.frames(old)[0]
            if symbols == [SYMBOLS[z] for z in self.numbers]:
                self.lie_like(x / BOHR)


def _equal(x, y):
    """Whether two shapes are the same but for the rounding in files."""
    return np.abs(x - y).max() * BOHR < ROUNDED


# What is kept of a step, by its name; another form, of a stranger's folder, is computed anew.
FORMS = {"conformation": ("x", "hessian"), "minimum": ("x", "energy", "hessian"), "saddle": ("x", "energy", "hessian", "nu1"),
         "ends": ("sign", "near", "near_energy", "far", "far_energy", "far_nu1", "far_is_equal"),
         "path": ("nodes", "energies", "far", "far_energy", "far_nu1", "far_is_equal"),
         "beyond": ("nodes", "energies", "start", "kinds", "why"), "between": ("nodes", "energies", "start", "kinds")}


def is_sound(step, value, atoms):
    """Whether a value that was kept has the form of what a step of a molecule with so many atoms gives."""
    if isinstance(value, dict) and set(value) == {"dropped"} and step != "conformation":
        return isinstance(value["dropped"], str)
    if not isinstance(value, dict) or set(value) != set(FORMS[step]):
        return False
    nodes = len(value["nodes"]) if isinstance(value.get("nodes"), list) else 0
    shapes = {"x": (atoms, 3), "near": (atoms, 3), "far": (atoms, 3), "hessian": (3 * atoms, 3 * atoms),
              "nodes": (nodes, atoms, 3), "energies": (nodes,), "why": str, "far_is_equal": bool}
    for name, one in value.items():
        form = shapes.get(name, ())
        if name == "kinds":
            if not (isinstance(one, list) and all(
                    isinstance(k, list) and len(k) == 2 and type(k[0]) is int and 0 <= k[0] < nodes
                    and k[1] in ("minimum", "saddle") for k in one)):
                return False
        elif isinstance(form, type):
            if not isinstance(one, form):
                return False
        elif not _is_array(one, form) or name == "start" and not (type(one) is int and 0 <= one < nodes):
            return False
    return True


def _is_array(value, shape):
    """Whether nested lists hold finite numbers in this shape."""
    try:
        array = np.array(value)
    except ValueError:
        return False
    return array.shape == shape and array.dtype.kind in "if" and bool(np.isfinite(array).all())


@dataclass
class Options:
    """method: of xtb.METHODS; charge: e; unpaired: electrons; highest: where a scan ends, kJ/mol; kept: the finished
    steps; version: of hapgrid, since what another one has kept is computed anew; solvent: or None."""
    method: str
    charge: int
    unpaired: int
    highest: float
    kept: Kept
    version: list
    solvent: str = None

    @property
    def words(self):
        """The method, as files name it."""
        return f"{self.method}-in-{self.solvent}" if self.solvent else self.method


class Work:
    """The steps for one molecule. torsions: all that could turn; driven: those that are turned. Each of these in one of
    its directions is a job."""

    def __init__(self, molecule, torsions, driven, options):
        self.molecule = molecule
        self.torsions = torsions
        self.driven = driven
        self.options = options
        self.jobs = [(torsion, sign) for torsion in driven for sign in torsion.signs]
        self.tree = geometry.Tree(molecule.neighbours, molecule.numbers)

    def result(self, found, dropped):
        return Result(self.molecule.numbers, self.surface.masses, self.options.words, self.driven, self.x,
                      self.energy, self.nu1, found, dropped)

    # The conformation

    def find_conformation(self, keep, relaxed, ensemble=()):
        """Sets x, energy, hessian and nu1. keep: relax the molecule's shape to the nearest minimum instead of looking
        for the lowest one; relaxed(starts): relax() of each; ensemble: shapes in angstrom, of which the lowest is taken."""
        o = self.options
        if o.solvent is not None:
            self._surface(self.molecule.positions / BOHR)  # a solvent that xtb does not know is an error of its own
        key = ["conformation", self.molecule.numbers, self.molecule.positions.tolist(), o.words, o.charge,
               o.unpaired, keep, [t.atoms for t in self.driven if not t.rotor and not keep], [x.tolist() for x in ensemble]]
        kept = self._take(key, lambda: self._conformation(keep, relaxed, ensemble))
        self.x = np.array(kept["x"])
        self.surface = self._surface(self.x)
        self.energy = self.surface.energy(self.x)
        self.hessian = np.array(kept["hessian"])
        self.nu1 = float(optimise.wave_numbers(self.hessian, self.x, self.surface.masses)[0])

    def _surface(self, x):
        o = self.options
        return Surface(self.molecule.numbers, x, o.method, o.charge, self.tree, o.unpaired, o.solvent)

    def _conformation(self, keep, relaxed, ensemble):
        starts = ensemble or ([self.molecule.positions] if keep else
                              conformers(self.molecule, self.driven, CONFORMERS, SEED))
        best, reason = None, ""
        tie = SAME_ENERGY / HARTREE if ensemble else 0.0  # of equal minima of an ensemble the first is taken
        for x, energy, why in relaxed(starts):
            if why:
                reason = why
            elif best is None or energy < best[0] - tie:
                best = energy, x
        if best is None:
            raise Failed(f"no conformation: none of the start structures relaxes: {reason}{self._what_to_do()}")
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

    def _what_to_do(self):
        """About a molecule that does not relax. Without water a proton goes from one end of a zwitterion to the other."""
        charges = self.molecule.formal_charges()
        if self.options.solvent is None and max(charges) > 0 > min(charges):
            return "; a zwitterion needs water: give --solvent water, or the neutral form"
        return ""

    def relax(self, start):
        """(x, energy, why it is left out) of a shape in angstrom."""
        try:
            x, energy = self._roughly(start / BOHR)
        except (optimise.NotConverged, XtbError) as why:
            return None, None, str(why)
        return x, energy, "" if self.intact(x) else "its bonds change"

    def _roughly(self, x):
        surface = self._surface(x)
        x, energy, _ = optimise.search(surface, x, surface.hessian(x), tolerance=1e-4, steps=400,
                                       renew=surface.hessian, every=50, tree=surface.tree)
        return x, energy

    def intact(self, x):
        return geometry.bonds_of(self.molecule.numbers, x * BOHR) == self.molecule.neighbours

    # Saddles and paths

    def above(self, energy):
        """kJ/mol above the conformation."""
        return (energy - self.energy) * HARTREE

    def _away(self, x):
        """Root mean square distance from the conformation, bohr."""
        return self.apart(x, self.x)

    def apart(self, x, y):
        """Root mean square distance of two shapes, bohr."""
        return geometry.rms(geometry.aligned(x, y, self.surface.masses), y)

    def same(self, x, y):
        return self.apart(x, y) < SAME_SHAPE

    def kept(self, what, inputs, compute):
        """The result of compute(), or {"dropped": the reason why there is none}; it is computed once. what: a name of
        the step; inputs: what it depends on besides the conformation."""
        o = self.options
        key = [what, self.molecule.numbers, self.x.tolist(), o.words, o.charge, o.unpaired, inputs, o.highest]
        return self._take(key, lambda: _guarded(compute))

    def _take(self, key, compute):
        return self.options.kept.take([self.options.version, key], compute,
                                      lambda value: is_sound(key[0], value, len(self.molecule.numbers)))

    def saddle(self, number):
        """(the saddle of a job, the minima that it joins, the nearer one first)."""
        torsion, sign = self.jobs[number]
        inputs = [torsion.atoms, sign]
        top = self.kept("saddle", inputs, lambda: self._saddle(torsion, sign))
        if "dropped" in top:
            return top, top
        return top, self.kept("ends", inputs, lambda: self._ends(top))

    def path(self, number):
        """The Found of a job's saddle, as far as it can be sent to another process."""
        top, ends = self.saddle(number)
        if "dropped" in ends:
            return ends
        torsion, sign = self.jobs[number]
        return self.kept("path", [torsion.atoms, sign], lambda: self._path(top, ends))

    def found(self, number, name, way):
        """The Found of a job under a name; way: of path()."""
        nodes = [np.array(x) for x in way["nodes"]]
        return Found(name, name.removesuffix("-plus").removesuffix("-minus"), nodes, way["energies"],
                     self.saddle(number)[0]["nu1"], np.array(way["far"]), way["far_energy"], way["far_nu1"],
                     way["far_is_equal"])

    def candidate(self, torsion, job, nodes, energies, whole):
        """The naming.Candidate of a path. whole: whether it goes on behind its barriers; otherwise a way from the
        conformation to one."""
        to_end, extent = torsions.turned(self.torsions, nodes)
        number = next(n for n, t in enumerate(self.torsions) if t.name == torsion.name)
        return naming.Candidate(job, number, extent if whole else to_end, max(energies))

    def named(self, tops):
        """naming.names() of saddles, by the numbers of their jobs."""
        candidates = {}
        for n, top in tops.items():
            torsion, sign = self.jobs[n]
            candidates[n] = self.candidate(torsion, torsion.file_name(sign), [self.x, np.array(top["x"])],
                                           [top["energy"]], False)
        allowed = {name for torsion in self.driven for name in torsion.file_names()}
        return naming.names(self.torsions, candidates, allowed, True)

    def one_of(self, top, tops):
        """The name of the saddle that this one is. tops: saddles by their names."""
        for name, other in tops.items():
            if (abs(top["energy"] - other["energy"]) * HARTREE <= SAME_ENERGY
                    and self.same(np.array(top["x"]), np.array(other["x"]))):
                return name
        return None

    def _saddle(self, torsion, sign):
        guess, tangent = torsions.scan(self.surface, self.x, self.hessian, torsion, sign,
                                       highest=self.options.highest / HARTREE)
        x, energy, hessian, nu1 = self.climbed(guess, tangent)
        return {"x": x.tolist(), "energy": energy, "hessian": hessian.tolist(), "nu1": nu1}

    def climbed(self, guess, tangent):
        """(x, energy, hessian, its imaginary wave number as a negative one) of the saddle near a guess. Errors:
        optimise.NoPath where that is none between two shapes of this molecule."""
        x, energy, hessian = optimise.saddle(self.surface, guess, tangent)
        waves = optimise.wave_numbers(hessian, x, self.surface.masses)
        count = int((waves < 0).sum())
        if count != 1:
            raise optimise.NoPath(f"{count} imaginary frequencies")
        if not self.intact(x):
            raise optimise.NoPath("bonds change")
        return x, energy, hessian, waves[0]

    def sides(self, x, hessian):
        """The two minima that the saddle joins, each as (sign, x, energy, hessian)."""
        masses = self.surface.masses
        _, vectors = optimise.projected(hessian, x, masses)
        mode = vectors[:, 0] / np.repeat(np.sqrt(masses), 3)
        mode = 0.15 * mode / np.linalg.norm(mode)
        return [(sign, *optimise.minimum(self.surface, x + sign * mode.reshape(-1, 3), hessian,
                                         longest=0.15)) for sign in (1, -1)]

    def _ends(self, top):
        sides = self.sides(np.array(top["x"]), np.array(top["hessian"]))
        near, far = sorted(sides, key=lambda side: self._away(side[1]))
        x = geometry.aligned(far[1], self.x, self.surface.masses)
        nu1 = optimise.wave_numbers(far[3], x, self.surface.masses)[0]
        equal = abs(self.above(far[2])) < SAME_ENERGY and self._equal_atoms_exchanged(x)
        return {"sign": near[0], "near": near[1].tolist(), "near_energy": near[2],
                "far": x.tolist(), "far_energy": far[2], "far_nu1": nu1, "far_is_equal": bool(equal)}

    def _equal_atoms_exchanged(self, x):
        """Whether this shape can be the conformation with equal atoms exchanged, or its mirror image."""
        a, b = (geometry.fingerprint(self.molecule.numbers, z) for z in (x, self.x))
        return np.abs(a - b).max() < SAME_SHAPE

    def _path(self, top, ends):
        if self._away(np.array(ends["near"])) > SAME_SHAPE:
            energies = (top["energy"], ends["near_energy"], ends["far_energy"])
            at, one, two = (f"{self.above(e):.2f} kJ/mol" for e in energies)
            raise optimise.NoPath(f"the saddle at {at} joins other minima, at {one} and {two}")
        nodes, energies = path.nodes(self.surface, self.tree, np.array(top["x"]),
                                     np.array(top["hessian"]), ends["sign"], self.x, self.energy)
        return {"nodes": [n.tolist() for n in nodes], "energies": energies, "far": ends["far"],
                **{name: ends[name] for name in ("far_energy", "far_nu1", "far_is_equal")}}


def _guarded(compute):
    """The result of compute, or the reason why there is none, in a form that can be kept."""
    try:
        return compute()
    except optimise.NotConverged as why:
        return {"dropped": f"not converged: {why}"}
    except (optimise.NoPath, XtbError) as why:
        return {"dropped": str(why)}
