"""relax(): downhill in energy to the next minimum.

A conversion function moves the HIP in small steps and lets the model fall into the next minimum after each. The
minimisers of SciPy and ASE are made to find a minimum fast, wherever it is: their first steps are as long as they please,
so they can end behind a barrier, and where they end depends on the last bit of the gradient. This descent is bounded. A
trial is taken only where
  1. no component of the state moves by more than `step`,
  2. the energy falls as the slope at the beginning promises (Armijo's rule),
  3. it does not fall twice as steeply there as at the beginning, and the fall is what the two slopes explain. Behind a
     barrier that lies in between, one of the two fails.
Otherwise a shorter trial follows. The directions are those of L-BFGS (Nocedal and Wright, Numerical Optimization, 2006,
algorithm 7.4), where they lead downhill.
"""
from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from operator import mul
from typing import Any

REMEMBERED = 10  # steps that tell of the curvature
ARMIJO = 1e-4
ROUNDING = 1e-14  # of the energy: differences below this say nothing
SHORTEST = 1e-12  # of a first trial
SMALL = 1e-5  # of a step: there is no barrier to leap over, and differences of energies can be rounding


def relax(energy_and_gradient: Callable[[Any], tuple[float, Any]] | Any, s: Any = None, *, step: float = 0.1,
          tolerance: float = 1e-6, most: int = 10000) -> Any:
    """The minimum that is reached downhill from the state `s`, without a leap over a barrier.

    energy_and_gradient(s) returns the energy of a state and its gradient, a number for each component of s. It gets a
    list of floats, or an array where `s` is an array. It can also be an ASE Atoms object with a calculator: its energy
    and forces are used then, with its constraints, `s` is its positions if it is left out, and the atoms stay at the
    minimum.

    step        how far a component moves at most in one step, in the unit of s: less than the width of the barriers.
                0.1 suits atoms and angstroms.
    tolerance   of the gradient: no component is larger in the end. The state is then off by about this, divided by the
                smallest stiffness of the model, which must be well below the tolerance of the model.
    most        evaluations

    Returns a list, or an array of the shape of `s`. The same s gives the same bits.
    Raises ArithmeticError where the descent cannot go on: the gradient is not that of the energy, or less exact than
    `tolerance`. Raises ValueError for numbers that make no sense.
    """
    if hasattr(energy_and_gradient, "get_potential_energy"):
        energy_and_gradient, s = _of_atoms(energy_and_gradient, s)
    if not (step > 0 and tolerance > 0):
        raise ValueError("relax(): step and tolerance must be positive")
    shaped, place = _shaped(s)
    descent = _Descent(energy_and_gradient, shaped, place, step, most)
    while descent.largest() > tolerance:
        descent.go_on()
    return shaped(descent.place)


class _Descent:
    """Where the descent is. Lists of floats: for states of a few hundred numbers they are as fast as arrays."""

    def __init__(self, function, shaped, place, step, most):
        self.function, self.shaped, self.step, self.left = function, shaped, step, most
        self.place, self.pairs = place, []  # of the last steps: how place and gradient changed, and 1 / their product
        self.reach = step / 8  # of a trial when nothing is known of the curvature
        self.energy, self.gradient = self.evaluate(place)
        if not math.isfinite(self.energy) or not all(map(math.isfinite, self.gradient)):
            raise ArithmeticError(f"relax(): energy {self.energy}, or its gradient, is not finite where it begins")

    def evaluate(self, place):
        self.left -= 1
        energy, gradient = self.function(self.shaped(place))
        gradient = _flat(gradient)
        if len(gradient) != len(place):
            raise ValueError(f"relax(): the gradient has {len(gradient)} numbers, the state has {len(place)}")
        return float(energy), gradient

    def largest(self) -> float:
        return max(map(abs, self.gradient), default=0.0)

    def direction(self):
        """Downhill, and at most `step` long in each component."""
        p = [-a for a in self.gradient]
        weights = []
        for moved, turned, scale in reversed(self.pairs):
            weights.append(scale * _dot(moved, p))
            p = [a - weights[-1] * b for a, b in zip(p, turned)]
        if self.pairs:
            moved, turned, scale = self.pairs[-1]
            stretch = 1 / (scale * _dot(turned, turned))
            p = [stretch * a for a in p]
        for (moved, turned, scale), weight in zip(self.pairs, reversed(weights)):
            back = weight - scale * _dot(turned, p)
            p = [a + back * b for a, b in zip(p, moved)]
        slope = _dot(p, self.gradient)
        if self.pairs and not slope < -1e-6 * math.sqrt(_dot(p, p) * _dot(self.gradient, self.gradient)):
            self.pairs.clear()
            return self.direction()
        longest = max(map(abs, p))
        bound = self.step if self.pairs else self.reach
        if longest > bound or not self.pairs:
            p = [bound / longest * a for a in p]
        return p

    def go_on(self):
        """One step. Raises ArithmeticError where none leads downhill."""
        p = self.direction()
        slope, part, longest = _dot(p, self.gradient), 1.0, max(map(abs, p))
        while part > SHORTEST:
            if self.left <= 0:
                raise ArithmeticError(f"relax(): the largest component of the gradient is still {self.largest():.3g} when "
                                      "all evaluations are made")
            place = [a + part * b for a, b in zip(self.place, p)]
            energy, gradient = self.evaluate(place)
            behind = _dot(p, gradient)
            if self.takes(part, longest, slope, behind, energy):
                return self.take(place, energy, gradient)
            # Where the slope has turned, the minimum is in between.
            secant = slope / (slope - behind) if behind > 0 else 0.5
            part *= min(max(secant, 1e-3), 0.5) if math.isfinite(secant) else 0.1
        if not self.pairs:
            raise ArithmeticError(f"relax(): no step leads downhill where the largest component of the gradient is "
                                  f"{self.largest():.3g}: it is not the gradient of the energy, or tolerance is too small")
        self.pairs.clear()
        self.reach = self.step / 8

    def takes(self, part, longest, slope, behind, energy) -> bool:
        if not (math.isfinite(energy) and math.isfinite(behind)):
            return False
        fall, noise = energy - self.energy, ROUNDING * max(abs(energy), abs(self.energy))
        if abs(part * slope) < noise or part * longest < SMALL * self.step:
            return abs(behind) <= 0.9 * abs(slope)  # the energies say nothing any more, but their slopes do
        explained = abs(fall - part * (slope + behind) / 2) <= part * max(-slope, abs(behind)) / 2 + noise
        return fall <= ARMIJO * part * slope + noise and behind >= 2 * slope and explained

    def take(self, place, energy, gradient):
        moved = [a - b for a, b in zip(place, self.place)]
        turned = [a - b for a, b in zip(gradient, self.gradient)]
        product = _dot(moved, turned)
        if product > 1e-10 * math.sqrt(_dot(moved, moved) * _dot(turned, turned)):
            self.pairs = [*self.pairs[1 - REMEMBERED:], (moved, turned, 1 / product)]
        else:  # curved downwards, as on a barrier: what was known of the curvature is of no use
            self.pairs = []
            self.reach = min(self.step, 2 * max(map(abs, moved)))
        self.place, self.energy, self.gradient = place, energy, gradient


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(map(mul, a, b))


def _flat(numbers) -> list[float]:
    if hasattr(numbers, "ravel"):
        return numbers.ravel().astype(float).tolist()
    return [float(a) for a in numbers]


def _shaped(s):
    """A function that gives a list the form of `s`, and s as a list of floats."""
    if not hasattr(s, "ravel"):
        return list, _flat(s)
    import numpy

    return (lambda place: numpy.array(place).reshape(s.shape)), _flat(s)


def _of_atoms(atoms, s):
    """Energy and gradient of ASE's atoms as a function of their positions, and where they begin."""
    import numpy

    def energy_and_gradient(positions):
        atoms.set_positions(numpy.reshape(positions, (-1, 3)))
        return atoms.get_potential_energy(), -atoms.get_forces()

    return energy_and_gradient, atoms.get_positions() if s is None else s
