"""Whether the sum of paths is right where minima of several of them are combined.

Along one path the energy is xtb's own. Where two torsions are both behind a saddle, the model adds
their energies, and nobody has computed the shape: atoms may have run into each other. So each such shape
is computed, a single point, by what gave the other energies.
"""

from hapgrid_command import files

from . import choice, xyz
from .xtb import BOHR, HARTREE

MISSED = 4.0  # kJ/mol: what the sum may miss


def missed(folder, definition, x, energy, method):
    """What speaks against the paths of a definition, or nothing. x: the conformation, bohr; energy(x): hartree, by a
    method."""
    name = ".combined.toml"
    folder.write(name, definition.text())
    try:
        minima = choice.checked(folder, name)["minima"]
        combined = [(m["energy_kJ_mol"], m["t"]) for m in minima if sum(t != 0 for t in m["t"]) > 1]
        if not combined:
            return ""
        rest = energy(x)
        worst = (0.0, "")
        for expected, t in combined:
            text = folder.run("molecule-check", name, "--xyz=" + ",".join(map(repr, t))).out
            off = (energy(xyz.frames_of(text, name)[0].x / BOHR) - rest) * HARTREE - expected
            at = ",".join(f"{v:.9g}" for v in t)
            worst = max(worst, (abs(off), f"the minima at t = {at} together are {expected + off:.1f} kJ/mol by {method}, "
                                          f"{expected:.1f} by the sum"))
    finally:
        files.remove(folder.path(name))
    return worst[1] if worst[0] > MISSED else ""
