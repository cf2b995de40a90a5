"""The softest paths that are sane together.

One path is as good as quantum chemistry made it. Where several are combined nobody has computed the shape, and atoms may
run into each other. So paths are taken from the softest on, and one is left out when `molecule-check` finds that it clashes
with those that were taken before. Where two torsions are both behind a saddle, the model adds their energies: each such
shape is computed, a single point, by what gave the other energies.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import remove
from hapgrid.apps.common.work import Work

from . import files, xyz
from .definition import Definition
from .results import Result
from .rotors import label
from .xtb import BOHR, HARTREE

if TYPE_CHECKING:
    from .steps import Start

ROTORS = ("path", "atoms", "barrier_kJ_mol", "taken", "why")  # the heads of rotors.tsv
MISSED = 4.0  # kJ/mol: what the sum may miss
MOST_PATHS = 6  # of a grid: with two sides of each barrier a point has 64 states, as many as MAX_LEVELS


def choose(start: Start, result: Result, unwanted: dict[str, str]) -> list[str]:
    """The paths of the grid, the lowest barrier first; rotors.tsv has them all, and why others are not taken. unwanted: paths,
    and why."""
    o, folder = start.options, start.folder
    lowest_first = sorted(result.found, key=lambda f: round(f.barrier * HARTREE, 2))  # equal ones as they were found

    def compute() -> list[str]:
        rows: list[tuple[str, ...]] = []
        taken: list[str] = []
        left: dict[str, list[str]] = {}
        for f in lowest_first:
            why = unwanted.get(f.name) or (
                f"stiffer than the {MOST_PATHS} that are taken" if len(taken) == MOST_PATHS else
                _fault(start, result, Definition.around(start.molecule, result, [*taken, f.name], o.goes_on)))
            if not why:
                taken.append(f.name)
            rows.append((f.name, f"{(f.barrier - result.energy) * HARTREE:.2f}", "no" if why else "yes", why or "-"))
        rows += [(name, "-", "no", why) for name, why in result.dropped]
        # Between minima of an ensemble no single bond may turn.
        atoms = {name: "-".join(label(result.numbers, a) for a in t.atoms)
                 for t in start.turning for name in (t.name, *t.file_names())}
        table = [ROTORS, *((name, atoms.get(name, "-"), *rest) for name, *rest in rows)]
        folder.write("rotors.tsv", "".join("\t".join(row) + "\n" for row in table))
        folder.say("  taken: " + (", ".join(taken) or "no path: the molecule keeps its shape"))
        for name, _, is_taken, why in rows:
            if is_taken == "no":
                left.setdefault(why, []).append(name)
        for why, names in left.items():
            folder.say(f"  left out: {', '.join(names)}: {why}")
        return ["rotors.tsv"]
    folder.step("selection", "choosing the softest paths that are sane together", [*result.files(), "report.tsv"],
                [unwanted, o.goes_on, o.single_points], compute)
    taken = {row["path"] for row in files.rows(folder, "rotors.tsv", ROTORS) if row["taken"] == "yes"}
    return [f.name for f in lowest_first if f.name in taken]


def _fault(start: Start, result: Result, definition: Definition) -> str:
    """What speaks against a set of paths, or nothing."""
    folder, name = start.folder, ".selection.toml"
    folder.write(name, definition.text())
    try:
        ran = folder.run("molecule-check", name, "--format", "json", good=(0, 1, 3))
        if ran.code == 1:
            return ran.said
        found = json.loads(ran.out)
        for problem in found["problems"]:
            names = [definition.paths[n] for n in problem["paths"]]
            who = " and ".join(names) if len(names) < 3 else "all paths"
            return f"{who}{' combined' * (len(names) > 1)}{': ' * bool(names)}{problem['what']}"
        combined = [m for m in found["minima"] if sum(t != 0 for t in m["t"]) > 1]
        return _missed(start, result.x, name, combined) if start.options.goes_on and combined else ""
    finally:
        remove(folder.path(name))


def _missed(start: Start, x: Array, toml: str, minima: list[dict[str, Any]]) -> str:
    """What speaks against the energies that the model gives combined minima, or nothing."""
    method, by = ("single points" if start.points else "xtb"), start.points or start.surface(x)
    rest = by.energy(x)
    for one in minima:
        energy = (by.energy(shape(start.folder, toml, one["t"]) / BOHR) - rest) * HARTREE
        if abs(energy - one["energy_kJ_mol"]) > MISSED:
            at = ",".join(f"{v:.9g}" for v in one["t"])
            return (f"the minima at t = {at} together are {energy:.1f} kJ/mol by {method}, "
                    f"{one['energy_kJ_mol']:.1f} by the sum")
    return ""


def shape(folder: Work, definition: str, t: Sequence[float]) -> Array:
    """The atoms (angstrom) of the model at t."""
    text = folder.run("molecule-check", definition, "--xyz=" + ",".join(map(repr, t))).out
    return xyz.frames_of(text, definition)[0].x


def nothing_turns(folder: Work) -> str:
    """The sentence about a molecule without a path, with the reason of each."""
    why: dict[str, list[str]] = {}
    for row in files.rows(folder, "rotors.tsv", ROTORS):
        why.setdefault(row["why"], []).append(row["path"])
    if not why:
        return "NOTHING TURNS in this grid: the molecule has no bond that could"
    return "NOTHING TURNS in this grid" + "".join(f"; {', '.join(names)}: {text}" for text, names in why.items())
