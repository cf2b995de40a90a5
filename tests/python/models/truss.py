"""The model of check-model/mistakes.sh and python/scipy.sh: a truss of two bars, which snaps through. How it is relaxed is
a parameter: "relax" is hapgrid's relax(), which cannot leap over a barrier, as "leap" and SciPy's "BFGS" do."""
import math
import hapgrid


def leap(function, s):
    """Steepest descent whose first trial is as long as the gradient, as that of SciPy's BFGS is."""
    energy, gradient = function(s)
    for _ in range(5000):
        size = math.hypot(*gradient)
        if size < 1e-7:
            break
        length = min(1.0, size)
        while length > 1e-12:
            trial = [a - length * g / size for a, g in zip(s, gradient)]
            there, slope = function(trial)
            if there < energy - 1e-4 * length * size:
                break
            length /= 2
        else:
            break
        s, energy, gradient = trial, there, slope
    return s


class Truss:
    """Bars from (-1, 0) and (1, 0) to an apex at height 0.5, which a spring ties to the HIP. The state is the apex."""
    bars, tie, height = 50.0, 2.0, 0.5
    rest = math.hypot(1, height)
    description = {"state_size": 2, "d_max": 3.0, "tolerance": 1e-4, "force_scale": 1}

    def __init__(self, minimiser, substep):
        self.minimiser, self.substep = minimiser, substep

    def energy_and_gradient(self, s, x):
        energy = self.tie / 2 * ((s[0] - x[0])**2 + x[1]**2 + (s[1] - x[2])**2)
        gradient = [self.tie * (s[0] - x[0]), self.tie * (s[1] - x[2])]
        for end in (-1, 1):
            length = math.hypot(s[0] - end, s[1])
            pull = self.bars / self.rest * (length - self.rest)
            energy += pull * (length - self.rest) / 2
            gradient = [gradient[0] + pull * (s[0] - end) / length, gradient[1] + pull * s[1] / length]
        return energy, gradient

    def minimum(self, function, s):
        if self.minimiser == "leap":
            return leap(function, s)
        if self.minimiser == "BFGS":
            from scipy.optimize import minimize
            return list(minimize(function, s, jac=True, method="BFGS", options={"gtol": 1e-7}).x)
        return hapgrid.relax(function, s, step=0.05, tolerance=1e-7)

    def convert(self, s, x, d):
        steps = max(1, math.ceil(math.hypot(*d) / self.substep))
        for k in range(1, steps + 1):
            there = [a + k / steps * b for a, b in zip(x, d)]
            s = self.minimum(lambda p: self.energy_and_gradient(p, there), s)
        return s

    def known_states(self, x):
        up, down = (self.convert([0.0, z], x, [0, 0, 0]) for z in (0.5, -0.5))
        return [up, down] if math.dist(up, down) > 0.01 else [up]

    def force(self, s, x):
        return [self.tie * (s[0] - x[0]), -self.tie * x[1], self.tie * (s[1] - x[2])]

    def energy(self, s, x):
        return self.energy_and_gradient(s, x)[0]


if __name__ == "__main__":
    hapgrid.serve(Truss)
