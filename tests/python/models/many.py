"""A model that answers for one question, or for many in a call."""
import sys
import hapgrid
import numpy as np


class Many:
    description = {"state_size": 3, "d_max": 3, "tolerance": 1e-9}

    def __init__(self, at_once=0):
        self.largest = 0
        if at_once:
            self.convert_many = self.rows
        else:
            self.convert = lambda s, x, d: self.rows(*(np.array([a]) for a in (s, x, d)))["s"][0]
            self.force = lambda s, x: -np.array(s)

    def rows(self, s, x, d):
        assert s.shape == x.shape == d.shape and s.shape[1] == 3
        if len(s) > self.largest:
            self.largest = len(s)
            print("rows", len(s), file=sys.stderr)
        reached = np.tanh(x + d)
        return {"s": reached, "force": -reached}

    def force(self, s, x):
        return -np.array(s)

    def known_states(self, x):
        return [np.tanh(x)]


hapgrid.serve(Many)
