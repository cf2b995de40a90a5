"""Hosts and ligands as other programs write them: what is left out, what is refused, and what their user must know."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
from hapgrid.apps.common.arrays import Array
from hapgrid.apps.common.files import Failed
from hapgrid.apps.common.pdb import kept_locations

Atoms = list[tuple[str, Array, float]]  # as in maps.py
WATERS = {"HOH", "WAT", "H2O", "DOD", "TIP", "TIP3", "TIP4", "SOL", "SPC"}
# AutoDock's types that AutoGrid has parameters of (AD4.1_bound.dat).
KNOWN = set("H HD HS C A N NA NS OA OS F Mg MG P SA S Cl CL Ca CA Mn MN Fe FE Zn ZN Br BR I Z G GA J Q".split())
HYDROGEN_BOND = 1.25  # angstrom: from a hydrogen to its carbon
NEAR = 8.0  # angstrom: AutoGrid counts no atom that is farther away


def without_others(text: str, given: str, say: Callable[[str], object], has_alternates: bool = True) -> str:
    """A PDB or PQR text without alternate locations and crystal waters. PQR has no alternates, and its columns are not sure."""
    lines, at = text.split("\n"), [n for n, line in enumerate(text.split("\n")) if line.startswith(("ATOM", "HETATM"))]
    if has_alternates:
        kept = kept_locations([lines[n] for n in at if lines[n][16:17].strip()], lambda text: say(f"  {given}: {text}"), together=False)
        stays = [n for n in at if not lines[n][16:17].strip() or lines[n][16] == kept[lines[n][21:27]]]
        for n in stays:  # without its letter, an alternate location is a location
            lines[n] = lines[n][:16] + " " + lines[n][17:]
    else:
        stays = at
    names = {n: lines[n][17:27] if has_alternates else "".join(lines[n].split()[3:6]) for n in stays}
    waters = {name for n, name in names.items()
              if (name[:4] if has_alternates else "".join(lines[n].split()[3:4])).strip().upper() in WATERS}
    if waters and waters != set(names.values()):
        say(f"  {given}: {len(waters)} crystal water{'s are' if len(waters) > 1 else ' is'} left out")
        stays = [n for n in stays if names[n] not in waters]
    gone = set(at) - set(stays)
    return "\n".join(line for n, line in enumerate(lines) if n not in gone and not line.startswith("ANISOU"))


def require_known(found: Atoms, given: str) -> None:
    """Refuses types of atoms that AutoGrid has no parameters of."""
    kinds = {kind for kind, _, _ in found}
    glue = sorted(kind for kind in kinds if re.fullmatch("CG[0-9]?|G[0-9]", kind))
    if glue:
        raise Failed(f"{given}: atoms of the type {', '.join(glue)} are Meeko's, which opens rings for sampling: prepare it with "
                     "--rigid_macrocycles")
    strange = sorted(kinds - KNOWN)
    if strange:
        raise Failed(f"{given}: AutoDock has no parameters of the type{'s' * (len(strange) > 1)} {', '.join(strange)}: leave these "
                     "atoms out, or put a metal that it knows (Mg, Ca, Mn, Fe, Zn) in their place")


def remark_on_hydrogens(found: Atoms, given: str, say: Callable[[str], object]) -> None:
    """Hydrogens on carbon that have the type of those that make hydrogen bonds."""
    heavy = [(kind, place) for kind, place, _ in found if kind not in ("H", "HD", "HS")]
    if not heavy:
        return
    places = np.array([place for _, place in heavy])
    wrong = 0
    for kind, place, _ in found:
        if kind in ("HD", "HS"):
            away = np.linalg.norm(places - place, axis=1)
            wrong += away.min() < HYDROGEN_BOND and heavy[away.argmin()][0] in ("C", "A")
    if wrong:
        say(f"  {given}: {wrong} hydrogen{'s' * (wrong > 1)} on carbon {'have' if wrong > 1 else 'has'} the type HD, of those that make "
            "hydrogen bonds: Open Babel or Meeko would make them a part of their carbon")


def require_near(host: Atoms, low: Array, high: Array, reach: float) -> None:
    """Refuses a box in which the ligand feels nothing of the host."""
    away = [np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0)) for _, place, _ in host]
    if away and min(away) > reach + NEAR:
        raise Failed(f"nothing is near the box: the nearest atom of the host is {min(away):.0f} angstrom from it: see --centre")
