"""Energies and gradients by a calculator of ASE (--calculator), in the place of xtb's.

It is named as MODULE:CALLABLE(ARGUMENTS), or it is what the function calculator(charge, uhf) of a file in Python returns. Many
compute with 32 bits: a relative rounding of 1e-7 of an energy of 1e4 hartree is more than a step downhill gains. So the noise is
measured once, and what the searches compare with it (optimise.py) respects it.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import inspect
import os
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.cli import UsageError
from hapgrid.apps.common.files import Failed, digest

from . import xtb
from .elements import MASSES
from .xtb import BOHR, XtbError

EV, ANGSTROM = 1 / 27.211386245988, 1 / BOHR  # hartree, bohr
# Shapes at which the noise is measured, and how far the last ones are from the middle, bohr: nearer ones would be rounded to
# the same energy.
TRIES, AWAY, DEGREE = 24, 0.06, 6
QUIET = 1e-8, 1e-7  # what is rougher than libxtb is noise, hartree and hartree/bohr
SHORTEST, LONGEST = 0.005, 0.05  # bohr: steps of differences
FORM = "MODULE:CALLABLE(KEY=VALUE, ...), such as 'ase.calculators.lj:LennardJones(sigma=3.4)', or a file calculator.py"
# batch(calculator, [Atoms, ...]) of a file calculator.py: (energies in eV, forces in eV/angstrom), arrays of as many rows.
Batch: TypeAlias = Callable[[Any, Sequence[Any]], tuple[Any, Any]]


@dataclass(frozen=True)
class Source:
    """make(charge, uhf): a calculator, and the batch() beside it; name: as titles have it; said: in words."""
    make: Callable[[int, int], tuple[Any, Batch | None]]
    name: str
    said: str


def source(text: str) -> Source:
    """What --calculator names. Errors: UsageError, Failed."""
    if text.endswith(".py"):
        return _file(text)
    found = re.fullmatch(r"([A-Za-z_][\w.]*):([A-Za-z_][\w.]*)(?:\((.*)\))?", text, re.S)
    module, callable_, words = found.groups() if found else ("", "", "")
    try:
        call = ast.parse(f"f({words or ''})" if found else "", mode="eval").body
        assert isinstance(call, ast.Call)
        arguments = [ast.literal_eval(a) for a in call.args]
        keys = {k.arg: ast.literal_eval(k.value) for k in call.keywords if k.arg}
        assert len(keys) == len(call.keywords)
    except (SyntaxError, ValueError, AssertionError):
        raise UsageError(f"--calculator {text}: is not {FORM}") from None

    def make(charge: int, uhf: int) -> tuple[Any, Batch | None]:
        one: Any = _imported(lambda: importlib.import_module(module), text)
        for part in callable_.split("."):
            one = getattr(one, part, None)
        if not callable(one):
            raise Failed(f"--calculator: the module {module} has no {callable_}")
        return one(*arguments, **{**_charge_of(one, charge, uhf, keys), **keys}), None
    return Source(make, re.sub(r"[^A-Za-z0-9.+-]+", "_", text).strip("_"), text)


def _file(path: str) -> Source:
    content = digest(path)
    if content is None:
        raise Failed(f"{path}: No such file or directory")
    name = os.path.splitext(os.path.basename(path))[0]

    def make(charge: int, uhf: int) -> tuple[Any, Batch | None]:
        spec = importlib.util.spec_from_file_location("hapgrid_calculator", path)
        assert spec and spec.loader
        loader = spec.loader
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        _imported(lambda: loader.exec_module(module), path)
        function = getattr(module, "calculator", None)
        if not callable(function):
            raise Failed(f"{path}: has no function calculator(charge, uhf)")
        return function(charge, uhf), getattr(module, "batch", None)
    # Another text is another method.
    return Source(make, re.sub(r"[^A-Za-z0-9.+-]+", "_", name) + "-" + content[:8], os.path.basename(path))


def _imported(load: Callable[[], Any], text: str) -> Any:
    try:
        return load()
    except Exception as why:  # it is somebody's program
        raise Failed(f"--calculator {text}: {type(why).__name__}: {why}") from None


# What calculators call charge, unpaired electrons, and multiplicity.
CHARGES, UNPAIRED, MULTIPLICITIES = ("charge", "total_charge"), ("uhf", "unpaired"), ("multiplicity", "mult", "spin_multiplicity")


def _charge_of(one: Callable[..., Any], charge: int, uhf: int, given: dict[str, Any]) -> dict[str, Any]:
    """The keywords for charge and spin. Errors: Failed, where it has none for what is not 0."""
    try:
        known = set(inspect.signature(one).parameters)
    except (TypeError, ValueError):
        known = set()
    known |= set(getattr(one, "default_parameters", None) or {})
    out = {}
    for what, value, ways in (("charge", charge, [(k, charge) for k in CHARGES]),
                              ("unpaired electrons", uhf, [(k, uhf) for k in UNPAIRED] + [(k, uhf + 1) for k in MULTIPLICITIES])):
        if any(key in given for key, _ in ways):
            continue
        key = next(((key, v) for key, v in ways if key in known), None)
        if key:
            out[key[0]] = key[1]
        elif value:
            raise Failed(f"--calculator: has no keyword for {value} {what}: give a file with calculator(charge, uhf)")
    return out


def one_by_one(calculator: Any, some: Sequence[Any]) -> tuple[Any, Any]:
    """What a Batch gives, where there is none."""
    forces, energies = [], []
    for atoms in some:
        atoms.calc = calculator
        forces.append(atoms.get_forces())
        energies.append(atoms.get_potential_energy())
    return energies, forces


class CalculatorSurface(xtb.Potential):
    """As xtb.Surface. Errors: XtbError, of whatever the calculator says."""

    renewal = 12

    def __init__(self, numbers: Sequence[int], positions: Array, calculator: tuple[Any, Batch | None],
                 tree: Any = None) -> None:
        try:
            from ase import Atoms
        except ImportError:
            raise Failed("--calculator: install the Debian package python3-ase") from None
        self.tree = tree
        self.masses = np.array([MASSES[z] for z in numbers])
        self._atoms = Atoms(numbers=list(numbers), positions=np.asarray(positions) * BOHR)
        self._calculator, self._batch = calculator
        self.noise = self._measured(np.asarray(positions, float))

    def __call__(self, positions: Array) -> tuple[float, Array]:
        return self.many([positions])[0]

    def many(self, shapes: Sequence[Array]) -> list[tuple[float, Array]]:
        if not all(np.isfinite(x).all() for x in shapes):
            raise XtbError("a position is not finite")
        some = [self._atoms.copy() for _ in shapes]
        for atoms, x in zip(some, shapes):
            atoms.positions = np.asarray(x, float) * BOHR
        try:
            energies, forces = (np.asarray(v, float) for v in (self._batch or one_by_one)(self._calculator, some))
        except Exception as why:  # it is somebody's program
            raise XtbError(f"the calculator: {type(why).__name__}: {' '.join(str(why).split()) or 'failed'}") from None
        if energies.shape != (len(some),) or forces.shape != (len(some), len(self.masses), 3):
            raise XtbError(f"the calculator: energies and forces of {len(some)} shapes have {energies.shape} and {forces.shape} numbers")
        if not np.isfinite(energies).all() or not np.isfinite(forces).all():
            raise XtbError("the calculator: an energy or a force is not finite")
        return list(zip((energies * EV).tolist(), -forces * EV / ANGSTROM))

    def _measured(self, x: Array) -> tuple[float, float]:
        """(of an energy, of a component of the gradient): what is left of values at near shapes when a smooth
        curve is taken off."""
        random = np.random.default_rng(1)
        way = random.normal(size=x.shape)
        way /= np.linalg.norm(way)
        steps = np.linspace(-AWAY, AWAY, TRIES)
        energies, gradients = zip(*self.many([x + step * way for step in steps]))

        def rough(values: Array) -> float:
            flat = np.asarray(values).reshape(TRIES, -1)
            curve = np.vander(steps / AWAY, DEGREE + 1)
            return float(np.abs(flat - curve @ np.linalg.lstsq(curve, flat, rcond=None)[0]).max())
        found = rough(np.array(energies)), rough(np.array(gradients))
        return found if found[0] > QUIET[0] or found[1] > QUIET[1] else (0.0, 0.0)

    @property
    def step(self) -> float:
        """Of differences: the longer, the less noise; errors grow with its square."""
        return float(np.clip(self.noise[1]**(1 / 3), SHORTEST, LONGEST))
