"""Energies of the nodes by a program of the user (--single-points).

The command is run with the name of an XYZ file after its own words, in a folder of its own. The title of that file has
charge= and unpaired=. The last line that the command prints is the energy in hartree. Structures stay those of xtb.
"""

from __future__ import annotations

import os
import re
import shlex
import tempfile
from dataclasses import replace

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed, digest
from hapgrid.apps.common.programs import run_program
from hapgrid.apps.common.work import Cache, Work
from hapgrid.files import program

from . import files, geometry, single_point_ase, xyz
from .molecule import Molecule
from .results import Path, Result
from .xtb import HARTREE

OURS = "single-point-ase"
BELOW = 0.1  # kJ/mol that a node may lie below the conformation
DENT = 1.0  # kJ/mol: a deeper one is a minimum, and the path to a barrier has none. The model has the same limits.


class SinglePoints:
    """text: the command; cache: of a hapgrid.apps.common.work.Work, where results are kept."""

    def __init__(self, text: str, molecule: Molecule, cache: Cache) -> None:
        try:
            words = shlex.split(text)
        except ValueError as why:
            raise Failed(f"--single-points: {why}") from None
        if not words:
            raise Failed("--single-points: no command")
        # A file of this folder that is called like a program must not run in its place.
        named = program(OURS) if words[0] == OURS else os.path.abspath(words[0]) if "/" in words[0] else words[0]
        self.words = [named, *(os.path.abspath(w) if os.path.isfile(w) else w for w in words[1:])]
        self.method = re.sub(r"[^A-Za-z0-9.+-]+", "_", " ".join([os.path.basename(words[0]), *words[1:]])).strip("_")
        self.numbers, self.cache = molecule.numbers, cache
        self.title = f"charge={molecule.charge} unpaired={molecule.unpaired}"
        self.key = [words, [digest(w) for w in (*self.words, single_point_ase.__file__) if os.path.isfile(w)]]

    def energy(self, x: Array) -> float:
        """Hartree, of positions in bohr. The same shape is computed once."""
        text = files.frame(self.numbers, x, self.title)
        return self.cache.take(["single point", self.key, text], lambda: self._compute(text), xyz.finite)

    def _compute(self, text: str) -> float:
        os.makedirs(self.cache.directory, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".single-", dir=os.path.abspath(self.cache.directory)) as directory:
            with open(os.path.join(directory, "node.xyz"), "w", encoding="utf-8") as file:
                file.write(text)
            try:
                ran = run_program([*self.words, "node.xyz"], directory)
            except OSError as why:
                raise Failed(f"--single-points: {self.words[0]}: {why.strerror}") from None
        if ran.code:
            raise Failed(f"--single-points: {self.words[0]} ended with {ran.code}: {ran.said}")
        last = (ran.out.strip().splitlines() or [""])[-1]
        try:
            return xyz.finite(last)
        except ValueError:
            raise Failed(f"--single-points: the last line of {self.words[0]} is '{last}', and not an energy in "
                         "hartree") from None

    def put_into(self, result: Result, threads: int, folder: Work) -> None:
        """Puts its own energies into a results.Result in place of xtb's. A path that does not lead from the conformation
        over a barrier by these energies is left out; one that has its highest node before its end, ends there."""
        shapes = [x for one in result.found for x in (*one.nodes, *([] if one.goes_on or one.far is None else [one.far.x]))]
        folder.each("energies by " + self.words[0], self.energy, [result.x, *shapes], threads)  # from here on they are kept
        rest = self.energy(result.x)
        for one in result.found:
            own = [rest if k == one.start else self.energy(x) for k, x in enumerate(one.nodes)]
            if not one.goes_on and one.far is not None:
                one.far = replace(one.far, energy=self.energy(one.far.x))
            # Nodes that are a little lower than the conformation are left out: it is a minimum, but for the shapes of xtb.
            rises = [(energy - rest) * HARTREE for energy in own]
            left = [k for k, rise in enumerate(rises) if k == one.start or not -DENT <= rise < -BELOW]
            one.nodes, one.energies = [one.nodes[k] for k in left], [own[k] for k in left]
            one.kinds = {left.index(k): kind for k, kind in one.kinds.items() if k in left}
            one.start = left.index(one.start)
        result.energy, result.method = rest, f"{self.method}//{result.method}"
        self._root(result)
        faults = {one.name: _fault(one, result.energy) for one in result.found}
        result.found = [one for one in result.found if not faults[one.name]]
        result.dropped += [(name, f"by {self.method} {why}") for name, why in faults.items() if why]

    def _root(self, result: Result) -> None:
        """Where a node is much lower than the conformation, that one becomes the conformation, and its path leads both ways
        from there. Hydrogen peroxide is planar by GFN2-xTB, and not by better methods."""
        if not result.found:
            return
        one = min(result.found, key=lambda f: min(f.energies))
        k = int(np.argmin(one.energies))
        if (result.energy - one.energies[k]) * HARTREE <= DENT:
            return
        result.dropped += [(f.name, f"begins in the conformation of {result.method.split('//')[1]}, which is no minimum by "
                            f"{self.method}") for f in result.found if f is not one]
        result.x = geometry.as_in_file(geometry.centred(one.nodes[k], result.masses))
        result.energy, result.nu1 = one.energies[k], None
        one.nodes = [geometry.aligned(x, result.x, result.masses) for x in one.nodes]
        one.nodes[k] = result.x
        if one.goes_on:
            one.start = k
            one.kinds.pop(k, None)
            result.found = [one]
            return
        base, _, way = one.name.rpartition("-")
        other = {"plus": f"{base}-minus", "minus": f"{base}-plus"}.get(way, one.name + "-back")
        back = replace(one, name=other, nodes=one.nodes[k::-1], energies=one.energies[k::-1], nu1=None, far=None)
        one.nodes, one.energies = one.nodes[k:], one.energies[k:]
        result.found = [one, back]
        result.dropped = [(name, why) for name, why in result.dropped if name != back.name]


def _fault(one: Path, rest: float) -> str:
    """Why a path cannot be one with its energies, or nothing. One to a barrier is cut off behind its highest node."""
    if not one.goes_on:
        top = int(np.argmax(one.energies))
        if top < len(one.energies) - 1:
            one.nu1 = None  # its last node is no longer xtb's saddle
        one.nodes, one.energies = one.nodes[:top + 1], one.energies[:top + 1]
        if top < 2 or (one.barrier - rest) * HARTREE < BELOW:
            return "the energy does not climb"
    for part in (one.energies[one.start:], one.energies[one.start::-1]):
        highest = 0.0
        for rise in ((energy - rest) * HARTREE for energy in part):
            highest = max(highest, rise)
            if highest <= DENT and rise < -BELOW:
                return f"a node is {-rise:.1f} kJ/mol below the conformation"
            if not one.goes_on and highest - rise > DENT:
                return f"the energy falls by {highest - rise:.1f} kJ/mol on the way to the barrier"
    return ""
