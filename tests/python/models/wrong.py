"""A model one of whose functions returns what it must not."""
import types
import hapgrid
import numpy as np

FAULTS = {
    "scalar": ("convert", lambda s, x, d: 0.5),
    "nothing": ("convert", lambda s, x, d: None),
    "nan": ("energy", lambda s, x: float("nan")),
    "one of three": ("force", lambda s, x: [0.0, np.nan, 1.0]),
    "short": ("shape", lambda s, x: np.zeros((1, 3))),
    "text": ("energy", lambda s, x: "1 eV"),
    "flat": ("known_states", lambda x: [0.0, 0.0]),
    "unset": ("convert", lambda s, x, d: {"state": s}),
}


def wrong(fault, atoms: int, names=("a", "b"), sizes=(1.0, 2.0), **more):
    assert isinstance(atoms, int) and isinstance(sizes[0], float) and more == {"probe.radius": 2, "many": [1, 2]}, (atoms, sizes, more)
    model = types.SimpleNamespace(
        description={"state_size": 2, "d_max": 2, "tolerance": 1e-6, "force_scale": 1,
                     "spheres": [{"radius": 1}, {"radius": 1}]},
        convert=lambda s, x, d: list(s), known_states=lambda x: [[0, 0]], force=lambda s, x: [0, 0, 0],
        energy=lambda s, x: np.zeros(1), shape=lambda s, x: np.zeros((2, 3)))
    if fault in FAULTS:
        setattr(model, *FAULTS[fault])
    if fault == "lost":
        del model.convert
    if fault == "stored":
        model.description["stored"] = ["force", "energy", "shape"]
        del model.energy
    return model


hapgrid.serve(wrong)
