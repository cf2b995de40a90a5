"""The box of a grid and its MODEL.toml."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from hapgrid.apps.common import files
from hapgrid.apps.common.arrays import Array

from .elements import RADII
from .holding import Tie
from .molecule import BadInput, Molecule
from .results import Result
from .stiffness import Stiffness
from .torsions import Torsion
from .xtb import BOHR

PROBE = 1.2  # angstrom
PENALTY = 100  # kJ/(mol Å²)
CLEAR = 0.3  # angstrom from touching, where a push begins; and a cell more, which is then at rest
MAX_LEVELS = 64
FORCE_SCALE = 0.025  # newtons on the device for 1 kJ/(mol Å)
# The definition's comment on the stiffness.
WHY = """\
# From the Hessian at the conformation: where a torsion moves an atom farthest the anchors yield half as
# far as the torsion does. They are softer where they would have more than half the penalty, or where a
# grid broke a rule. The stabiliser leads back from the barriers.
"""
HELD_WHY = """\
# The tie is stiffer than the barriers are curved, so the hand leads the atom over their tops. The anchors
# are five times as stiff as the tie: the torsions yield, and not the place of the molecule.
"""
COARSE_POINTS = 14  # along the longest side of the first grid
LEAST_POINTS = 8


@dataclass
class Definition:
    """low, high: corners of the box, angstrom. paths: names of files without their ending; of a definition that was changed
    by hand nothing else is here. torsions: those that the paths turn; seconds: that the grid takes, about, where that is
    known."""
    title: str
    paths: Sequence[str]
    low: Array = field(default_factory=lambda: np.zeros(3))
    high: Array = field(default_factory=lambda: np.zeros(3))
    spacing: float = 1.0
    torsions: Sequence[Torsion] = ()
    basins: bool = False  # whether paths go on behind their saddles
    stiffness: Stiffness = Stiffness()
    seconds: float | None = None
    held: tuple[Sequence[int], Sequence[int], Tie] | None = None  # (atoms, fixed, tie), where the hand holds something
    bonds_change: bool = False  # on the paths
    force_scale: float = FORCE_SCALE

    @classmethod
    def around(cls, molecule: Molecule, result: Result, paths: Sequence[str], basins: bool = False, spacing: float = 0.0,
               room: Sequence[float] = (), corners: tuple[Array, Array] | None = None) -> Definition:
        """The box around all shapes of the paths that are taken, with the probe around them, and the room in which a push
        begins. spacing: of the grid, where it is known already; room: how much more each side needs, low x, y, z and high x,
        y, z, since the molecule yields when it is pushed (grids.py); corners: of the box, where it is another one."""
        radius = np.array([RADII[z] for z in molecule.numbers])[:, None]
        shapes = [result.x] + [node for f in result.found if f.name in paths for node in f.nodes]
        x = np.array(shapes) * BOHR
        low = (x - radius).min(axis=(0, 1)) - PROBE - CLEAR
        high = (x + radius).max(axis=(0, 1)) + PROBE + CLEAR
        low, high = (low, high) if corners is None else corners
        # COARSE_POINTS are of a grid that goes a cell farther on each side.
        cell = spacing or round(math.ceil(float((high - low).max()) / (COARSE_POINTS - 3) / 0.05 - 1e-9) * 0.05, 2)
        more = np.reshape(room or np.zeros(6), (2, 3))
        return cls(f"{molecule.formula}, {len(molecule.numbers)} atoms", paths, low - cell - more[0],
                   high + cell + more[1], cell, basins=basins, bonds_change=molecule.bonds_change)

    def counts(self) -> list[int]:
        cells = np.ceil((self.high - self.low) / self.spacing - 1e-9).astype(int)
        return [max(int(n) + 1, LEAST_POINTS) for n in cells]

    def text(self) -> str:
        change = "bonds_change = 1          # shapes are joined in space; the molecule is on one path at a time\n" * self.bonds_change
        why = HELD_WHY if self.held else "" if self.basins or not self.paths else WHY
        origin = (self.low + self.high - (np.array(self.counts()) - 1) * self.spacing) / 2
        paths = "".join(f'  "{name}.xyz",\n' for name in self.paths)
        if self.paths:
            kind = "that goes on behind its barriers" if self.basins else "to a barrier"
            paths = f"transition_states = [     # each the nodes of a path {kind}\n{paths}]\n"
        names = "".join(f'  "{t.name} {" ".join(str(a + 1) for a in t.atoms)}",\n' for t in self.torsions)
        if names:
            names = f"torsions = [              # what pictures name: four atoms by their numbers, from 1\n{names}]\n"
        shift, rotation = self.stiffness.shift, self.stiffness.rotation
        hand = f"""\
probe_radius = {PROBE}        # of the ball that is the HIP, Å
penalty = {PENALTY}             # of the probe's overlap with an atom, kJ/(mol Å²)
"""
        if self.held:
            atoms, fixed, tie = self.held
            force, width, shift, rotation = tie.rounded()
            hand = f"""\
hold = {_numbers(atoms)}                # atoms whose centre the hand holds, by their numbers from 1
fixed = {_numbers(fixed)}  # those that stay while the shape changes
hold_force = {force:<11g} # the most that the tie between hand and atom pulls, kJ/(mol Å)
hold_width = {width:<11g} # near the atom the tie is a spring of hold_force / hold_width, Å
"""
        return f"""\
# {self.title}: made by `hapgrid molecule`, which keeps what is changed here and computes the
# grid anew when it is run again. Lengths in Å.

[model]
plugin = "molecule"

[model.files]             # XYZ texts beside this file; the grid carries their contents
conformation = "conformation.xyz"
{paths}
[model.parameters]
{hand}{why}shift_stiffness = {f"{shift:g}":<7} # of the anchor that holds the molecule in its place, kJ/(mol Å²)
rotation_stiffness = {f"{rotation:g}":<4} # and of that which holds its orientation, kJ/(mol rad²)
morph_stiffness = {f"{self.stiffness.morph:g}":<7} # stabiliser ½ m t² of each t, kJ/mol; no part of the molecule's energy
substep = 0.05            # of the HIP between two minimisations, Å
tolerance = 0.1           # states whose atoms are no farther apart, RMS, are one; Å
force_scale = {f"{self.force_scale:g}":<11} # newtons on the device for 1 kJ/(mol Å)
{change}{names}
[grid]
origin = {[round(float(v), 4) for v in origin]}
spacing = {self.spacing:g}
counts = {self.counts()}

[search]
max_levels = {MAX_LEVELS}           # states that a grid point may have
"""


def _numbers(atoms: Sequence[int]) -> list[int]:
    return [a + 1 for a in atoms]


def paths_of(path: str) -> list[str]:
    """The paths that a definition names, changed by hand or not.
    Errors: BadInput, where it is of another model or names a file that is not beside it."""
    try:
        with open(path, "rb") as file:
            model = tomllib.load(file)["model"]
        names = model["files"].get("transition_states", [])
        texts = [model["files"]["conformation"], *names]
        if model["plugin"] != "molecule" or not all(isinstance(name, str) for name in texts):
            raise KeyError
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, KeyError, TypeError, AttributeError):
        raise BadInput(f"{path}: is no definition of a molecule") from None
    strange = next((name for name in texts if not files.is_plain(name)), None)
    if strange is not None:
        raise BadInput(f"{path}: names the file '{strange}': only files beside it are used, with plain names")
    return [name.removesuffix(".xyz") for name in names]
