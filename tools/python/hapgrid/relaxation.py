"""relax(): downhill in energy to the next minimum.

A conversion function moves the HIP in small steps and lets the model fall into the next minimum after each. The
minimisers of SciPy and ASE are made to find a minimum fast, wherever it is: their first steps are as long as they please,
so they can end behind a barrier, and where they end depends on the last bit of the gradient. This descent is bounded. A
trial is taken only where
  1. no component of the state moves by more than `step`,
  2. the energy falls as the slope at the beginning promises (Armijo's rule),
  3. it does not fall twice as steeply there as at the beginning, and the fall is what the two slopes explain. Behind a
     barrier that lies in between, one of the two fails.
Otherwise a shorter trial follows. A trial that is so short that nothing can lie in between may fall as steeply as it
pleases: so the descent passes a kink. Where the promised fall is less than the noise of the energy, the slopes alone
decide. The noise is measured: what the slopes do not explain of a fall becomes less in a shorter trial, noise does not.
The directions are those of L-BFGS (Nocedal and Wright, Numerical Optimization, 2006, algorithm 7.4), where they lead
downhill; far from a minimum they stay near the gradient, which leads to the minimum of the basin.
"""
from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from operator import mul
from typing import Any, TypeAlias

Known: TypeAlias = list[tuple[list[float], list[float], float]]  # w, H w and 1 / (w H w) of directions
REMEMBERED = 10  # steps that tell of the curvature
ARMIJO = 1e-4
ROUNDING = 1e-14  # of the energy: differences below this say nothing
SHORTEST = 1e-12  # of a first trial
NEAR = 1e-2  # of a step: in a trial as short as that, slopes at its ends that agree explain the fall
SMALL = 1e-5  # of a step: there is no barrier to leap over
FLAT = 1e-9  # of the noise of the energy: falls for which slopes of its exactness, too, are noise
PLAIN = 7  # plain trials, half as long as the one before, that tell a wrong gradient from noise
STALE = 20  # such steps, one after the other, without a smaller gradient
PROBES = 8  # directions in which an end is tried for being a top
CLOSE = 0.5  # cosine of the angle to the steepest way: a step that is cut short at a larger angle leads to other basins
GOLDEN = 0.6180339887498949  # its multiples, modulo 1, are in no pattern that a symmetric model could have


def relax(energy_and_gradient: Callable[[Any], tuple[float, Any]] | Any, s: Any = None, *, step: float = 0.1,
          tolerance: float = 1e-6, most: int = 10000, rounding: float | None = None) -> Any:
    """The minimum that is reached downhill from the state `s`, without a leap over a barrier.

    energy_and_gradient(s) returns the energy of a state and its gradient, a number for each component of s. It gets a
    list of floats, or an array where `s` is an array. It can also be an ASE Atoms object with a calculator: its energy
    and forces are used then, with its constraints, `s` is its positions if it is left out, and the atoms stay at the
    minimum.

    step        how far a component moves at most in one step, in the unit of s: less than the width of the barriers.
                0.1 suits atoms and angstroms.
    tolerance   of the gradient: no component is larger in the end, unless the energy and its gradient are less exact
                than that. The state is then off by about this, divided by the smallest stiffness of the model, which
                must be well below the tolerance of the model.
    most        evaluations
    rounding    differences of energies below this are noise, in the unit of the energy. It is measured where it is left
                out, which takes some evaluations. A network that computes in float32 has some 1e-7 of its energy.

    A state whose gradient is within the tolerance, but which is no minimum, such as the top of a barrier, is left: always
    to the same side. Of more than a few components, not every top is found; check-model and verify look for them.

    Returns a list, or an array of the shape of `s`. The same s gives the same bits.
    Raises ArithmeticError where the descent cannot go on: the gradient is not that of the energy, or the energy has a
    crease. Raises ValueError for numbers that make no sense.
    """
    atoms: Any = energy_and_gradient if hasattr(energy_and_gradient, "get_potential_energy") else None
    if atoms is not None:
        energy_and_gradient, s = _of_atoms(atoms, s)
    if not (step > 0 and tolerance > 0 and (rounding is None or rounding >= 0)):
        raise ValueError("relax(): step and tolerance must be positive, and rounding must not be negative")
    shaped, place = _shaped(s)
    descent = _Descent(energy_and_gradient, shaped, place, step, tolerance, most)
    descent.noise = rounding or 0.0
    end = shaped(descent.end())
    if atoms is None:
        return end
    atoms.set_positions(end)  # the last evaluation was beside it
    return atoms.get_positions().reshape(end.shape)


class _Trial:
    """A place at `part` of the step p, seen from where the step begins."""

    def __init__(self, descent: _Descent, p: Sequence[float], part: float) -> None:
        self.part, self.reach = part, part * _longest(p)
        self.place = [a + part * b for a, b in zip(descent.place, p)]
        self.energy, self.gradient = descent.evaluate(self.place)
        self.slope, self.behind = _dot(p, descent.gradient), _dot(p, self.gradient)
        self.fall = self.energy - descent.energy
        self.promised = -part * self.slope
        self.unexplained = abs(self.fall - part * (self.slope + self.behind) / 2)
        # In so short a trial with slopes that agree, the energy can only do what they say.
        self.is_near = self.reach < NEAR * descent.step and math.isfinite(self.unexplained)
        self.is_plain = self.is_near and abs(self.behind - self.slope) <= 0.5 * abs(self.slope)


class _Descent:
    """Where the descent is. Lists of floats: for states of a few hundred numbers they are as fast as arrays."""

    def __init__(self, function: Callable[[Any], tuple[float, Any]], shaped: Callable[[list[float]], Any], place: list[float],
                 step: float, tolerance: float, most: int) -> None:
        self.function, self.shaped, self.step, self.tolerance, self.left = function, shaped, step, tolerance, most
        self.place = place
        self.pairs: Known = []  # of the last steps: how place and gradient changed, and 1 / their product
        self.reach = step / 8  # of a trial when nothing is known of the curvature
        self.noise = 0.0  # of the energy, as far as it is known
        self.promised = 0.0  # how far the energy was to fall in the last step
        self.energy, self.gradient = self.evaluate(place)
        if not math.isfinite(self.energy) or not all(map(math.isfinite, self.gradient)):
            raise ArithmeticError(f"relax(): energy {self.energy}, or its gradient, is not finite where it begins")

    def evaluate(self, place: list[float]) -> tuple[float, list[float]]:
        if self.left <= 0:
            raise ArithmeticError(f"relax(): the largest component of the gradient is still {self.largest():.3g} when all "
                                  "evaluations are made")
        self.left -= 1
        answer = self.function(self.shaped(place))
        try:
            energy, gradient = answer
            energy, gradient = float(energy), _flat(gradient)
        except (TypeError, ValueError):
            raise ValueError("relax(): the function must return the energy and its gradient, it returned "
                             f"{str(answer)[:80]}") from None
        if len(gradient) != len(place):
            raise ValueError(f"relax(): the gradient has {len(gradient)} numbers, the state has {len(place)}")
        return energy, gradient

    def largest(self) -> float:
        return _longest(self.gradient)

    def noise_at(self, energy: float) -> float:
        return max(self.noise, ROUNDING * max(abs(energy), abs(self.energy)))

    def end(self) -> list[float]:
        """The place where nothing leads downhill any more: that with the smallest gradient since the energy fell."""
        lowest, stale, best = self.energy, 0, (self.largest(), self.place)
        while True:
            if self.largest() <= self.tolerance:
                if not self.leaves_top():
                    return self.place
                lowest, stale, best = self.energy, 0, (self.largest(), self.place)
            if stale > STALE or not self.go_on():
                return best[1]
            falls, largest = self.energy < lowest - self.noise_at(lowest), self.largest()
            says = self.promised > FLAT * self.noise_at(lowest)
            stale = 0 if falls or says or largest < 0.9 * best[0] else stale + 1
            if falls:
                lowest = self.energy
            if falls or largest < best[0]:
                best = largest, self.place

    def direction(self) -> list[float]:
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
        longest = _longest(p)
        bound = self.step if self.pairs else self.reach
        if self.pairs and longest > bound and -slope < CLOSE * math.sqrt(_dot(p, p) * _dot(self.gradient, self.gradient)):
            p = [-stretch * a for a in self.gradient]
            longest = _longest(p)
        if longest > bound or not self.pairs:
            p = [bound / longest * a for a in p]
        return p

    def go_on(self) -> bool:
        """One step. False where none is left that the energy or its slopes can tell of."""
        p = self.direction()
        part = 1.0
        refused: list[_Trial] = []
        while part > SHORTEST:
            trial = _Trial(self, p, part)
            if trial.energy == self.energy and trial.gradient == self.gradient:
                break  # the model does not see the difference
            if self.takes(trial) or self.is_noise(trial, refused) and self.takes(trial):
                self.take(trial)
                return True
            refused.append(trial)
            self.look_for_fault(refused)
            noise = self.noise_at(trial.energy)
            if trial.promised < FLAT * noise and trial.fall <= noise and trial.behind > -0.9 * trial.slope:
                break  # neither the energy nor the slopes tell of a way down
            # Where the slope has turned, the minimum is in between.
            secant = trial.slope / (trial.slope - trial.behind) if trial.behind > 0 else 0.5
            part *= min(max(secant, 1e-3), 0.5) if math.isfinite(secant) else 0.1
        if not self.pairs:
            self.look_for_crease(refused)
            return False
        self.pairs.clear()
        self.reach = self.step / 8
        return self.go_on()

    def takes(self, trial: _Trial) -> bool:
        if not (math.isfinite(trial.energy) and math.isfinite(trial.behind)):
            return False
        slope, behind, noise = trial.slope, trial.behind, self.noise_at(trial.energy)
        if behind < 2 * slope and trial.reach >= SMALL * self.step:
            return False
        if trial.promised < noise:
            return trial.fall <= noise and behind <= -0.9 * slope
        explained = trial.unexplained <= trial.part * max(-slope, abs(behind)) / 2 + noise
        return trial.fall <= -ARMIJO * trial.promised + noise and explained

    def is_noise(self, trial: _Trial, refused: list[_Trial]) -> bool:
        """Whether what the slopes do not explain in a short trial is noise, which is then known: it does not become less in
        shorter trials, as it would if the gradient were wrong, or the energy is the same to the last bit."""
        known = [longer.unexplained for longer in refused if longer.is_plain and longer.part >= 4 * trial.part
                 and trial.is_plain and trial.unexplained > longer.unexplained / 2 > 0]
        if trial.fall == 0 and trial.is_near:
            known.append(trial.unexplained)
        before = self.noise
        if known:
            self.noise = max(self.noise, 2 * trial.unexplained, 2 * max(known))
        return self.noise > before

    def look_for_fault(self, refused: list[_Trial]) -> None:
        """Raises ArithmeticError where the energy does something else than its slopes say, and less in shorter trials."""
        plain = [trial for trial in refused if trial.is_plain and trial.unexplained > trial.promised / 2][-PLAIN:]
        wrong = [trial.unexplained / trial.part for trial in plain]
        if len(plain) == PLAIN and max(wrong) < 1.5 * min(wrong):
            raise ArithmeticError(
                f"relax(): the energy changes by {plain[0].fall:.3g} in a step for which its gradient says "
                f"{plain[0].part * (plain[0].slope + plain[0].behind) / 2:.3g}: it is not the gradient of the energy")

    def look_for_crease(self, refused: list[_Trial]) -> None:
        """Raises ArithmeticError where the slope turns at a crease, along which the energy falls."""
        for trial in refused:
            if trial.reach < SMALL * self.step and trial.behind > -0.9 * trial.slope and (
                    trial.promised > self.noise_at(trial.energy)):
                # No direction falls on both sides where a mean of their gradients is nothing.
                jump = [b - a for a, b in zip(self.gradient, trial.gradient)]
                share = min(max(-_dot(self.gradient, jump) / _dot(jump, jump), 0.0), 1.0)
                along = max(abs(a + share * b) for a, b in zip(self.gradient, jump))
                if along > self.tolerance:
                    raise ArithmeticError(f"relax(): the gradient jumps, and the energy still falls by {along:.3g} for each "
                                          "unit of the state along the crease: make the energy smooth there")

    def take(self, trial: _Trial) -> None:
        moved = [a - b for a, b in zip(trial.place, self.place)]
        turned = [a - b for a, b in zip(trial.gradient, self.gradient)]
        product = _dot(moved, turned)
        if product > 1e-10 * math.sqrt(_dot(moved, moved) * _dot(turned, turned)):
            self.pairs = [*self.pairs[1 - REMEMBERED:], (moved, turned, 1 / product)]
        else:  # curved downwards, as on a barrier: what was known of the curvature is of no use
            self.pairs = []
            self.reach = min(self.step, 2 * _longest(moved))
        self.place, self.energy, self.gradient = trial.place, trial.energy, trial.gradient
        self.promised = trial.promised

    def leaves_top(self) -> bool:
        """Whether this is no minimum: the energy is curved downwards along a direction that is always the same, and that
        the steps have not told of. The descent is then beside it."""
        known: Known = []  # directions, as the curvature makes them independent of each other: w, H w and 1 / (w H w)
        fixed = [2 * ((i + 1) * GOLDEN % 1) - 1 for i in range(len(self.place))]
        for moved, turned, _ in reversed(self.pairs):
            direction, turned = _conjugate(known, moved, turned)
            if _dot(direction, direction) > 1e-6 * _dot(moved, moved):  # not one that is known already
                _add(known, direction, turned)
        direction = fixed
        for _ in range(min(PROBES, len(self.place) - len(known))):
            direction = _conjugate(known, direction)[0]
            longest = _longest(direction)
            if not longest > 0:
                break
            size = math.copysign(NEAR * self.step / longest, _dot(direction, fixed))
            direction = [size * a for a in direction]
            trial = _Trial(self, direction, 1.0)
            turned = [a - b for a, b in zip(trial.gradient, self.gradient)]
            if trial.behind < trial.slope and self.goes_along(direction, trial):
                return True
            if not _add(known, direction, turned):
                break
            direction = turned
        return False

    def goes_along(self, direction: list[float], trial: _Trial) -> bool:
        """Whether the slope becomes larger than the tolerance along a direction in which it falls ever more steeply."""
        steepest = trial.slope
        while trial.behind < steepest and trial.reach <= self.step:
            if trial.behind < 0 and _longest(trial.gradient) > self.tolerance:
                self.pairs = []
                self.take(trial)
                return True
            steepest = trial.behind
            trial = _Trial(self, direction, 2 * trial.part)
        return False


def _conjugate(known: Known, direction: list[float], turned: list[float] | None = None) -> tuple[list[float], Any]:
    """`direction`, and `turned`, which is H times it, where that is given, without what is known already."""
    for w, hw, scale in known:
        weight = scale * _dot(hw, direction)
        direction = [a - weight * b for a, b in zip(direction, w)]
        turned = turned and [a - weight * b for a, b in zip(turned, hw)]
    return direction, turned


def _add(known: Known, direction: list[float], turned: list[float]) -> bool:
    product = _dot(direction, turned)
    if not product > 1e-10 * math.sqrt(_dot(direction, direction) * _dot(turned, turned)):
        return False
    known.append((direction, turned, 1 / product))
    return True


def _longest(vector: Sequence[float]) -> float:
    return max((abs(a) for a in vector), default=0.0)


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(map(mul, a, b))


def _flat(numbers: Any) -> list[float]:
    if hasattr(numbers, "ravel"):
        return numbers.ravel().astype(float).tolist()
    return [float(a) for a in numbers]


def _shaped(s: Any) -> tuple[Callable[[list[float]], Any], list[float]]:
    """A function that gives a list the form of `s`, and s as a list of floats."""
    try:
        place = _flat(s)
    except (TypeError, ValueError):
        raise ValueError(f"relax(): s must be a sequence of numbers, it is {str(s)[:80]}") from None
    if not hasattr(s, "ravel"):
        return list, place
    import numpy

    return (lambda place: numpy.array(place).reshape(s.shape)), place


def _of_atoms(atoms: Any, s: Any) -> tuple[Callable[[Any], tuple[float, Any]], Any]:
    """Energy and gradient of ASE's atoms as a function of their positions, and where they begin."""
    import numpy

    def energy_and_gradient(positions: Any) -> tuple[float, Any]:
        atoms.set_positions(numpy.reshape(positions, (-1, 3)))
        return atoms.get_potential_energy(), -atoms.get_forces()

    return energy_and_gradient, atoms.get_positions() if s is None else s
