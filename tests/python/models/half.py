"""The state is half of where the HIP is, and the force leads back from it."""
import types
import hapgrid
import numpy as np

hapgrid.serve(lambda: types.SimpleNamespace(
    description={"state_size": 2, "d_max": 2, "tolerance": 1e-6, "force_scale": 1, "spheres": [{"radius": 0.1}] * 2},
    convert=lambda s, x, d: (np.array(x) + d)[:2] / 2, known_states=lambda x: [np.array(x[:2]) / 2],
    force=lambda s, x: [-s[0], -s[1], np.float32(0.5)], energy=lambda s, x: s[0]**2 + s[1]**2 - x[2] / 2,
    shape=lambda s, x: [*s, 0, *x]))
