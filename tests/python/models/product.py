"""A matrix product, which rounds a row otherwise when there are more or fewer beside it."""
import hapgrid
import numpy as np


class Product:
    description = {"state_size": 40, "d_max": 2, "tolerance": 1e-6}
    a, b = (np.random.default_rng(1).normal(size=shape) for shape in ((40, 40), (3, 40)))
    a = a @ a.T / 40 + np.eye(40)

    def rest(self, s, x):
        for _ in range(50):
            s = s - 0.2 * (s @ self.a - x @ self.b)
        return s

    def convert_many(self, s, x, d):
        return self.rest(0 * s, x + d)

    def known_states(self, x):
        return [self.rest(np.zeros((1, 40)), np.array([x]))[0]]


hapgrid.serve(Product)
