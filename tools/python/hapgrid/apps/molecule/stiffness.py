"""The stiffness of the anchors and of the stabiliser, from the Hessian at the conformation.

The hand should feel the torsions, not the anchors. A push along u against an atom that torsion k
moves by v_k = ∂b/∂t_k meets springs in a row, whose compliances are

    (u · v_k)² / κ_k                                   the torsion, κ_k = v_k · H v_k
    1 / shift_stiffness + |r × u|² / rotation_stiffness    the anchors, r the atom's place from the centre

At the atom that k moves farthest, pushed the way that it moves, both anchors have RIGID of the
torsion's compliance, half of it each. The torsion that asks for the stiffest anchors decides. No
anchor becomes stiffer than half the penalty: the probe would go through the molecule.

The stabiliser ½ m t² leads the shape back. A path is flat at the top of its barrier, whatever the
Hessian says, and there the slope m must be more than the minimiser overlooks; and m makes up what κ_k
lacks where a path is flat at its foot, too.

Where paths go on behind their saddles nothing of this holds: m must be 0, so that minima stay where they
are, and anchors that yield let a push tip over a barrier gently. There the defaults are taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from hapgrid.apps.common.arrays import Array

from . import geometry, path

RIGID = 0.5
# For the RMS displacement of the atoms. With less curvature a shape could be off by more than a tenth of
# what makes states differ, 0.1 Å, through the gradient that the minimiser overlooks between substeps,
# 0.05 kJ/(mol Å). With a slope of 1 instead of 4 more records are twisted, and the search takes longer.
LEAST_SLOPE = 4.0  # kJ/(mol Å)
LEAST_CURVATURE = 5.0  # kJ/(mol Å²)


@dataclass(frozen=True)
class Stiffness:
    """The defaults are the least: softer anchors let the molecule be pushed out of its box."""
    shift: float = 20.0  # kJ/(mol Å²)
    rotation: float = 100.0  # kJ/(mol rad²)
    morph: float = 0.0  # kJ/mol

    def softer(self, times: float) -> Stiffness:
        return Stiffness(max(self.shift / times, Stiffness.shift), max(self.rotation / times, Stiffness.rotation),
                         self.morph)

    def rounded(self) -> Stiffness:
        """What a definition says. The last digits of a Hessian depend on the machine."""
        return Stiffness(*(float(f"{v:.2g}") for v in (self.shift, self.rotation, self.morph)))


def tangent(tree: geometry.Tree, nodes: Sequence[Array], start: int, masses: Array) -> Array:
    """∂b/∂t of a path at its node `start`, which is the conformation, as the model's shapes have it.
    nodes, result: (atoms, 3) in one unit of length."""
    spline = path.spline(tree, nodes)
    at, step = start / (len(nodes) - 1), 1e-3
    one, two = (geometry.aligned(tree.build(spline(t)), nodes[start], masses) for t in (at - step, at + step))
    return (two - one) / (2 * step)


def rule(hessian: Array, x: Array, masses: Array, tangents: Sequence[Array], penalty: float) -> Stiffness:
    """The Stiffness for these tangents. hessian: kJ/(mol Å²); x: the conformation, Å."""
    from_centre = geometry.centred(x, masses)
    shift, rotation, morph = Stiffness.shift, Stiffness.rotation, Stiffness.morph
    for v in tangents:
        curvature = max(float(v.ravel() @ hessian @ v.ravel()), 0.0)
        lever = np.linalg.norm(v, axis=1)
        atom = int(lever.argmax())
        felt = min(curvature / lever[atom] ** 2 * 2 / RIGID, penalty / 2)
        arm = np.linalg.norm(np.cross(from_centre[atom], v[atom] / lever[atom]))
        shift = max(shift, felt)
        rotation = max(rotation, felt * arm**2)
        size = float(np.sqrt((v**2).sum() / len(x)))
        morph = max(morph, LEAST_SLOPE * size, LEAST_CURVATURE * size**2 - curvature)
    return Stiffness(shift, rotation, morph)
