"""The hung ball as a process: hung_ball.cpp again, line by line, so the grid has the same records."""
import math

import hapgrid


class HungBall:
    def __init__(self, radius=0.1, weight=1.0, max_force=3.0, tolerance=1e-6):
        if not 0 < radius < 0.5:
            raise ValueError(f"parameter radius is {radius:g}, it must be above 0 and below 0.5")
        self.radius, self.weight, self.max_force = radius, weight, max_force
        self.d_max = 2 * math.sqrt(radius * (radius + 1)) - 2 * radius
        self.description = {
            "state_size": 1, "d_max": self.d_max, "tolerance": tolerance, "tolerance_unit": "rad",
            "norm": "max", "length_unit": "rope lengths", "energy_unit": "N rope lengths",
            "force_scale": 1, "hip_radius": self.radius,
            "spheres": [{"radius": radius, "colour": [0.9, 0.9, 0.3], "label": "ball"}]}

    def known_states(self, x):
        return [[0.0]] if sum(a * a for a in x) >= 4 * self.radius**2 else []

    def convert(self, s, x, d):
        length = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        if length > self.d_max * (1 + 1e-9):
            raise ValueError(f"a shift of {length:g}, d_max is {self.d_max:g}")
        substeps = math.ceil(length / (self.radius / 16))
        sine, cosine = math.sin(s[0]), math.cos(s[0])
        for k in range(1, substeps + 1):
            f = k / substeps
            sine, cosine = self.settle(sine, cosine, *(a + f * b for a, b in zip(x, d)))
        return [math.atan2(sine, cosine)] if substeps else s

    def settle(self, sine, cosine, x, y, z):  # Arc::settle() of hung_ball.cpp
        w, m, e = 1 - z, (2 * self.radius - y) * (2 * self.radius + y), x * x + z * (z - 2)
        arc_squared, arc_cosine = 4 * m - (e - m) * (e - m), 2 + e - m
        if arc_squared <= 0:
            return 0.0, 1.0
        arc, ahead = math.sqrt(arc_squared), sine * w - cosine * x >= 0
        right = (x < 0 or ahead) if sine >= 0 else (x < 0 and ahead)
        side = arc if right else -arc
        contact = x * arc_cosine + w * side, w * arc_cosine - x * side
        return contact if (contact[0] > 0 if right else contact[0] < 0) else (0.0, 1.0)

    def force(self, s, x):
        sine, cosine = math.sin(s[0]), math.cos(s[0])
        u = [sine - x[0], -x[1], 1 - cosine - x[2]]
        distance = math.hypot(*u)
        along = (u[0] * cosine + u[2] * sine) / distance if distance else 0
        push = min(self.max_force, self.weight * sine / along) if along * sine > 0 else 0.0
        return [-push * a / distance for a in u] if push else [0.0, 0.0, 0.0]

    def energy(self, s, x):
        return self.weight * 2 * math.sin(s[0] / 2)**2

    def shape(self, s, x):
        return [math.sin(s[0]), 0, 1 - math.cos(s[0])]


if __name__ == "__main__":
    hapgrid.serve(HungBall)
