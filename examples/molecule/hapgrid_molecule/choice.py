"""The softest paths that are sane together.

One path is as good as quantum chemistry made it. Where several are combined nobody has computed the
shape, and atoms may run into each other. So paths are taken from the softest on, and one is left
out when `molecule-check` finds that it clashes with those that were taken before.
"""

import json

from hapgrid_command import files

from .definition import Definition
from .molecule import BadInput
from .rotors import label
from .xtb import HARTREE

ROTORS = ("path", "atoms", "barrier_kJ_mol", "taken", "why")  # the heads of rotors.tsv


def choose(folder, molecule, result, most, unwanted, basins=False, missed=lambda definition: ""):
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
        fault = clash(folder, one) or missed(one)
        if fault:
            left[found.name] = fault
        else:
            taken.append(found.name)
    return taken, left


def rows(folder, name, heads):
    """A table of the folder, [{head: cell}], without remarks. Errors: BadInput, where it lacks heads or cells."""
    lines = [line.split("\t") for line in folder.read(name).splitlines() if not line.startswith("#")]
    if not lines or not set(heads) <= set(lines[0]) or any(len(line) != len(lines[0]) for line in lines):
        raise BadInput(f"{folder.path(name)}: is no table as it was written: remove it")
    return [dict(zip(lines[0], line)) for line in lines[1:]]


def left_out(rotors):
    """What rotors.tsv says of all that is not taken, one line for each reason."""
    names = {}
    for row in rotors:
        if row["taken"] == "no":
            names.setdefault(row["why"], []).append(row["path"])
    return [f"left out: {', '.join(them)}: {why}" for why, them in names.items()]


def clash(folder, definition):
    """What molecule-check says against a set of paths, or nothing."""
    name = ".choice.toml"
    folder.write(name, definition.text())
    ran = folder.run("molecule-check", name, "--format", "json", good=(0, 1, 3))
    files.remove(folder.path(name))
    if ran.code == 1:
        return ran.said
    problems = json.loads(ran.out)["problems"]
    if not problems:
        return ""
    names = [definition.paths[n] for n in problems[0]["paths"]]
    where = {0: "", 1: f"{names[0]}: " if names else "", 2: " and ".join(names) + " combined: "}
    return where.get(len(names), "all paths combined: ") + problems[0]["what"]


def checked(folder, definition):
    """What molecule-check reports of a definition's file, sane or not."""
    return json.loads(folder.run("molecule-check", definition, "--format", "json", good=(0, 3)).out)


def table(result, rotors, stay, taken, left):
    """rotors.tsv: what was tried, taken and left out, and why."""
    atoms = {t.name: "-".join(label(result.numbers, a) for a in t.atoms) for t in rotors}
    found, dropped = {f.name: f for f in result.found}, dict(result.dropped)
    known = {**found, **dropped}
    tried = [(name, atoms[t.name]) for t in rotors for name in ([t.name] if t.name in known else t.file_names())]
    # Between minima of an ensemble no single bond may turn.
    tried += [(name, "-") for name in known if name not in dict(tried)]
    lines = ["\t".join(ROTORS)]
    for name, turns in tried:
        barrier = f"{(found[name].barrier - result.energy) * HARTREE:.2f}" if name in found else "-"
        why = "-" if name in taken else left.get(name) or dropped.get(name, "not found")
        lines.append("\t".join((name, turns, barrier, "yes" if name in taken else "no", why or "-")))
    lines += ["\t".join((one.name, one.name, "-", "no", one.why)) for one in stay]
    return "\n".join(lines) + "\n"
