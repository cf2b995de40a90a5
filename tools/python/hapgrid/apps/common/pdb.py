"""Alternate locations of the atoms in a PDB file."""

import re
from collections.abc import Callable, Sequence


def kept_locations(atoms: Sequence[str], say: Callable[[str], object], together: bool) -> dict[str, str]:
    """{residue: the letter of its alternate location that has the highest occupancy, of equal ones the first}. atoms: the lines
    of those that have one; together: whether it is the highest in all residues together, since A of one residue does not go
    with B of the next."""
    found: dict[str, dict[str, list[float]]] = {}
    for line in atoms:
        occupancy = float(line[54:60]) if re.fullmatch(r"\s*\d*\.?\d+\s*", line[54:60]) else 1.0
        found.setdefault(line[21:27], {}).setdefault(line[16], []).append(occupancy)
    means = {residue: {name: sum(v) / len(v) for name, v in locations.items()} for residue, locations in found.items()}
    names = {name for locations in means.values() for name in locations}
    all_over = {name: sum(locations.get(name, 0.0) for locations in means.values()) for name in names}
    kept = {residue: min(mean, key=lambda name: (-(all_over if together else mean)[name], name)) for residue, mean in means.items()}
    several = [residue for residue in means if len(means[residue]) > 1]
    if several:
        name, more = kept[several[0]], f" and {len(several) - 1} more" if len(several) > 1 else ""
        say(f"alternate locations of residue {' '.join(several[0].split())}{more}: {name} is kept, of highest occupancy, "
            f"{means[several[0]][name]:.2f}")
    return kept
