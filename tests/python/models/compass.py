"""A compass whose needle points away from the HIP: each turn around it adds 2 pi to its state."""
import math

import hapgrid


class Compass:
    def __init__(self, period=0.0):
        self.description = {"state_size": 1, "d_max": 3, "tolerance": 0.01, "tolerance_unit": "rad"}
        if period:
            self.description["period"] = [period]

    def known_states(self, x):
        return [[math.atan2(x[1], x[0])]]

    def convert(self, s, x, d):
        return [s[0] + math.remainder(math.atan2(x[1] + d[1], x[0] + d[0]) - s[0], 2 * math.pi)]

    def force(self, s, x):
        return [0.01 * math.cos(s[0]), 0.01 * math.sin(s[0]), 0]


hapgrid.serve(Compass)
