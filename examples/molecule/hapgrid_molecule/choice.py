"""The softest paths that are sane together.

One path is as good as quantum chemistry made it. Where several are combined nobody has computed the
shape, and atoms may run into each other. So paths are taken from the softest on, and one is left
out when `molecule-check` finds that it clashes with those that were taken before.
"""

import json

from preparation import files

from .definition import Definition, write
from .filters import FilterFailed


def choose(filters, stages, molecule, result, most, unwanted, basins=False, missed=lambda definition: ""):
    """(names of the paths that are taken, reasons by the names of others). missed: what else may speak
    against a definition."""
    taken, left = [], {}
    for found in sorted(result.found, key=lambda f: f.barrier):
        if found.name in unwanted:
            left[found.name] = unwanted[found.name]
            continue
        if len(taken) == most:
            left[found.name] = f"stiffer than the {most} that are taken (--paths)"
            continue
        one = Definition.around(molecule, result, [*taken, found.name], basins)
        fault = clash(filters, stages, one) or missed(one)
        if fault:
            left[found.name] = fault
        else:
            taken.append(found.name)
    return taken, left


def left_out(rows):
    """What rotors.tsv says of all that is not taken, one line for each reason."""
    names = {}
    for name, _, _, taken, why in rows:
        if taken == "no":
            names.setdefault(why, []).append(name)
    return [f"left out: {', '.join(them)}: {why}" for why, them in names.items()]


def clash(filters, stages, definition):
    """What molecule-check says against a set of paths, or nothing."""
    name = ".choice.toml"
    write(stages.path(name), definition.text())
    try:
        problems = checked(filters, name)["problems"]
    except FilterFailed as why:
        return str(why)
    finally:
        files.remove(stages.path(name))
    if not problems:
        return ""
    names = [definition.paths[n] for n in problems[0]["paths"]]
    where = {0: "", 1: f"{names[0]}: " if names else "", 2: " and ".join(names) + " combined: "}
    return where.get(len(names), "all paths combined: ") + problems[0]["what"]


def checked(filters, definition):
    """What molecule-check reports of a definition's file, sane or not."""
    return json.loads(filters.run("molecule-check", definition, "--format", "json", good=(0, 3))[0])


def table(result, rotors, stay, taken, left):
    """rotors.tsv: what was tried, taken and left out, and why."""
    from preparation.xtb import HARTREE

    from .rotors import label
    rows = [("path", "atoms", "barrier_kJ_mol", "taken", "why")]
    atoms = {t.name: "-".join(label(result.numbers, a) for a in t.atoms) for t in rotors}
    dropped = dict(result.dropped)
    found = {f.name: f for f in result.found}
    for torsion in rotors:
        names = torsion.file_names()
        for name in [torsion.name] if torsion.name in {**found, **dropped} else names:
            one = found.get(name)
            barrier = "-" if one is None else f"{(one.barrier - result.energy) * HARTREE:.2f}"
            why = "" if name in taken else left.get(name) or dropped.get(name, "not found")
            rows.append((name, atoms[torsion.name], barrier, "yes" if name in taken else "no", why or "-"))
    listed = {row[0] for row in rows}
    for name in [*found, *dropped]:  # between minima of an ensemble, where no single bond turns
        if name not in listed:
            barrier = f"{(found[name].barrier - result.energy) * HARTREE:.2f}" if name in found else "-"
            why = "" if name in taken else left.get(name) or dropped.get(name, "not found")
            rows.append((name, "-", barrier, "yes" if name in taken else "no", why or "-"))
    rows += [(one.name, one.name, "-", "no", one.why) for one in stay]
    return "\n".join("\t".join(row) for row in rows) + "\n"
