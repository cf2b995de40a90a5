"""What `hapgrid molecule` reads: each of molecules/ is read as read.tsv says; bonds and charges that a file does not say are
found; SMILES get sound shapes, whose configurations Open Babel, which did not build them, reads as it reads the SMILES; damaged
files give one line, whatever they do to the libraries.
"""
import ctypes
import os
import pathlib
import random
import re
import signal
import socket
import subprocess

import numpy as np
import pytest
from hapgrid.apps.common import sandbox
from hapgrid.apps.common.files import Failed
from hapgrid.apps.molecule import geometry, molecule, page, reading, stereo
from hapgrid.apps.molecule.elements import SYMBOLS
from openbabel import openbabel
from rdkit import Chem

HERE = pathlib.Path(__file__).parent
INPUTS = sorted(path.name for path in (HERE / "molecules").iterdir() if path.name != "smiles.txt")
TABLE = [line.split("\t") for line in (HERE / "read.tsv").read_text().splitlines() if line[0] != "#"]


def distances(x):
    return np.linalg.norm(x[:, None] - x[None], axis=2) + 9 * np.eye(len(x))


def is_sound(one):
    """Bonded atoms are 0.6 to 2.3 Å apart, the longest of them carbon and iodine, others 1.2 Å or more (two hydrogens of a
    strained carbon are 1.6 Å apart, bonds in a ring of three 1.5)."""
    d = distances(one.positions)
    bonded = np.zeros(d.shape, bool)
    for a, near in enumerate(one.neighbours):
        bonded[a, near] = True
    return 0.6 < d[bonded].min() and d[bonded].max() < 2.4 and d[~bonded].min() > 1.2


def test_the_formula_of_a_page_is_without_the_charge():
    assert page.formula(reading.read(None, "CC(=O)[O-]").formula) == "C<sub>2</sub>H<sub>3</sub>O<sub>2</sub>"


def test_each_file_has_a_row():
    assert {row[0] for row in TABLE} == set(INPUTS)


@pytest.mark.parametrize("name, options, expected, said", TABLE, ids=["-".join(row[:2]) for row in TABLE])
def test_files(name, options, expected, said, monkeypatch):
    monkeypatch.chdir(HERE / "molecules")
    options = {key: int(value) for key, value in (word.split("=") for word in options.split())}
    try:
        one = reading.read(name, None, **options)
    except Failed as why:
        assert expected == "refused" and str(why) == f"{name}: {said}"
        return
    assert f"{one.formula} {one.charge} {one.unpaired} {'built' if one.built else 'as-given'}" == expected
    assert "; ".join(one.said) == said and is_sound(one)
    assert reading.sdf(reading.read(name, None, **options)) == reading.sdf(one)  # the same shape another time


def test_places_and_what_is_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(HERE / "molecules")
    # Of two alternate locations the one of 0.60 has its oxygen at y = 1.34.
    for name in "altloc.pdb", "altloc2.pdb":
        assert abs(reading.read(name, None).positions[2, 1] - 1.34) < 1e-6, name
    # The same ethanol in bohr and in ångström; the file has five decimals.
    a, b = (distances(reading.read(name, None).positions) for name in ("bohr.xyz", "ethanol_bom.xyz"))
    assert np.abs(a - b).max() < 1e-4
    # What the command keeps is what it goes on with.
    one = reading.read("en2.sdf", None)
    (tmp_path / "start.sdf").write_text(reading.sdf(one))
    two = reading.started(str(tmp_path / "start.sdf"))
    assert (two.charge, two.unpaired, two.built) == (2, 0, False)
    assert Chem.GetFormalCharge(two.rd) == 2 and Chem.MolToSmiles(two.rd) == Chem.MolToSmiles(one.rd)


# Functional groups whose bonds and charges an XYZ file does not say.
GROUPS = """CC([O-])=C CC(=O)C=C([O-])C [O-]c1ccccc1 OCl(=O)(=O)=O CC#[N+][O-] [O-][N+]#Cc1ccccc1 CC(=O)[O-] [O-]C(=O)C(=O)[O-]
C[N+](=O)[O-] CCO[N+](=O)[O-] COP(=O)([O-])[O-] OP(=O)(O)O C[N+](C)(C)[O-] [O-][n+]1ccccc1 C[N+]#[C-] [C-]#[N+]c1ccccc1
C=[N+]=[N-] CCOC(=O)C=[N+]=[N-] N#[N+]c1ccccc1 CN=[N+]=[N-] [N-]=[N+]=[N-] [C-]#[O+] O=[O+][O-] CS(=O)(=O)C CS(N)(=O)=O
CC=[N+](C)[O-] CN=[N+]([O-])C CS(C)(=N)=O [O-]C#N CN=C=S NC(N)=[NH2+] C[n+]1cc[nH]c1 CC#[O+] C=[N+](C)C O=[N+]=O O=C=C=C=O
C[N+](C)(C)CC(=O)[O-] Cn1cnc2c1c(=O)n(C)c(=O)n2C CN(C)C(=S)[S-] CC(=O)N[O-] O=C1C=CC(=O)C=C1 C1=CC=CC=CC=C1 [BH4-]
[NH3+]CC(=O)[O-] CS(C)=O FS(F)(F)F O=I(=O)c1ccccc1 C[P+](C)(C)C Cc1c[nH]c(=O)[nH]c1=O CC(=O)OO""".split()

# Molecules that are told by their shape where a file has no hydrogens: phenprocoumon, nifedipine, chlordiazepoxide, betaine ...
BARE = """Cc1c[nH]c2ccccc12 CCN=[N+]=[N-] CN(C)N=O Cc1ncc[nH]1 Cc1cc[nH]n1 CCC(c1ccccc1)c1c(O)oc2ccccc2c1=O
COC(=O)C1=C(C)NC(C)=C(C(=O)OC)C1c1ccccc1[N+](=O)[O-] CNC1=Nc2ccc(Cl)cc2C(c2ccccc2)=[N+]([O-])C1 C[N+](C)(C)CC(=O)[O-]
C[N+](C)(C)[O-] CC=[N+](C)[O-] CCO[N+](=O)[O-] CC(=O)N(C)O C[N+](C)(C)CCO C[NH+](C)C COP(=O)([O-])[O-]""".split()


def forms(mol):
    """The SMILES of its resonance structures."""
    flags = Chem.ALLOW_INCOMPLETE_OCTETS | Chem.ALLOW_CHARGE_SEPARATION
    return {Chem.MolToSmiles(one) for one in Chem.ResonanceMolSupplier(Chem.RemoveHs(mol), flags, 200) if one is not None}


@pytest.mark.parametrize("smiles", GROUPS)
def test_an_xyz_file_is_the_molecule_that_it_is_of_or_its_charge_is_advised(smiles):
    one = reading.read(None, smiles)
    rows = [f"{SYMBOLS[z]} {x:.5f} {y:.5f} {w:.5f}\n" for z, (x, y, w) in zip(one.numbers, one.positions)]
    pathlib.Path("group.xyz").write_text(f"{len(rows)}\n\n{''.join(rows)}")
    if one.charge:
        with pytest.raises(Failed, match=re.escape(f"{one.charge:+d}")):
            reading.read("group.xyz", None)
    two = reading.read("group.xyz", None, one.charge or None)
    assert two.charge == one.charge and forms(one.rd) & forms(two.rd), Chem.MolToSmiles(two.rd)


@pytest.mark.parametrize("smiles", BARE)
def test_a_pdb_file_without_hydrogens(smiles):  # and an ion with its charge
    one = reading.read(None, smiles)
    rows = [f"HETATM{n:5} {SYMBOLS[z]:>2}   LIG A   1    {x:8.3f}{y:8.3f}{w:8.3f}  1.00  0.00          {SYMBOLS[z]:>2}\n"
            for n, (z, (x, y, w)) in enumerate(zip(one.numbers, one.positions), 1) if z > 1]
    pathlib.Path("group.pdb").write_text("".join(rows))
    two = reading.read("group.pdb", None, one.charge or None)
    assert Chem.MolToSmiles(Chem.RemoveHs(two.rd)) == Chem.MolToSmiles(Chem.RemoveHs(one.rd))


@pytest.mark.parametrize("formula, rows", [
    ("F5I", "6\n\nI 0 0 0\nF 0 0 1.84\nF 1.87 0 -0.2\nF -1.87 0 -0.2\nF 0 1.87 -0.2\nF 0 -1.87 -0.2\n"),
    ("ClF3", "4\n\nCl 0 0 0\nF 1.6 0 0\nF 0 1.7 0\nF 0 -1.7 0\n"),
])
def test_a_square_pyramid_and_a_t_whose_shape_rdkit_cannot_build(formula, rows):
    pathlib.Path("group.xyz").write_text(rows)
    assert reading.read("group.xyz", None).formula == formula


@pytest.mark.parametrize("smiles, charge, why", [
    ("CC(=O)[O-]", 3, "its bonds fit --charge -1, and not +3"),
    ("C1CC1", 2, "its bonds fit --charge 0, and not +2"),
    ("c1cc[nH]c1", 1, "35 electrons with charge +1 do not go with 0 unpaired ones"),
    ("[H][H]", 2, "its bonds fit --charge 0"),
])
def test_a_charge_that_does_not_fit(smiles, charge, why):
    with pytest.raises(Failed, match=re.escape(f"SMILES '{smiles}': {why}")):
        reading.read(None, smiles, charge)


def test_charge_and_unpaired_electrons_that_fit():
    assert reading.read(None, "c1cc[nH]c1", 1, 1).formula == "C4H5N+"
    assert reading.read(None, "[CH2]", unpaired=2).unpaired == 2
    # With --charge and --uhf both given the bonds need not fit; no force field knows such a molecule, which then stays as it is.
    odd = reading.read(None, "F[B-](F)(F)F", 0, 1)
    shape, = molecule.conformers(odd, 4)
    assert (shape == odd.positions).all() and odd.charge == 0


def canonical(text, kind):
    conversion, ob = openbabel.OBConversion(), openbabel.OBMol()
    openbabel.obErrorLog.SetOutputLevel(-1)
    conversion.SetInAndOutFormats(kind, "can")
    assert conversion.ReadString(ob, text)
    return conversion.WriteString(ob).split()[0]


SMILES = [line.split() for line in (HERE / "molecules/smiles.txt").read_text().splitlines()]


# The larger ones take minutes: HAPGRID_ALL_SMILES=1 builds them, too.
@pytest.mark.parametrize("name, smiles", [row for row in SMILES
                                          if "HAPGRID_ALL_SMILES" in os.environ or sum(map(str.isalpha, row[1])) <= 18])
def test_smiles(name, smiles):
    one = reading.read(None, smiles)
    assert (one.charge, one.unpaired, one.built) == (0, 0, True) and is_sound(one)
    if "@" in smiles or "/" in smiles:
        got, expected = canonical(reading.sdf(one), "sdf"), canonical(smiles, "smi")
        assert got == expected or expected.count("@") < got.count("@")


@pytest.mark.parametrize("smiles, why", [
    ("C(C)(C)(C)(C)C", "C1 has 5 bonds, too many for its charge of 0: correct its bonds or its charge"),
    ("c1cccc1", "not understood: its aromatic rings have no alternating bonds: mark the hydrogen of a nitrogen, as in [nH], or "
     "write single and double bonds"),
    ("[CH2]", "open valences of C1: write the hydrogen that is missing, or give --uhf: 0 for a singlet, 2 for a triplet"),
    ("F[C@]12C[C@@](F)(C1)C2", "no shape could be built: is its handedness possible? Otherwise give a file with a shape"),
    ("CC)", "not understood"),
    ("C C", "not understood"),
])
def test_smiles_that_are_refused(smiles, why):
    with pytest.raises(Failed) as got:
        reading.read(None, smiles)
    assert str(got.value) == f"SMILES '{smiles}': {why}"


# What MMFF94 has no parameters for, what has nothing to search, and five bonds or six.
@pytest.mark.parametrize("smiles", ["C[Se]C", "OB(O)c1ccccc1", "[H][H]", "FP(F)(F)(F)F", "FS(F)(F)(F)(F)F", "FI(F)(F)(F)F",
                                    "F[P-](F)(F)(F)(F)F"])
def test_shapes_that_no_force_field_knows(smiles):
    assert is_sound(reading.read(None, smiles))


def test_a_handedness_that_is_not_given_is_said():
    assert reading.read(None, "CC(O)CN").said == ["the handedness of C2 is not given: S is taken"]


# An isomer that is named is built, also where RDKit's bounds take a ring to be Z; of others it is said which was taken, if
# there is a choice. Caryophyllene, humulene and parthenolide; an allene's ends by OpenSMILES; binaphthol, adamantane, camphor.
ISOMERS = {
    "C1CCC/C=C/CC1": "C5=C6 E", r"C/C/1=C\CCC(=C)[C@H]2CC([C@@H]2CC1)(C)C": "C8 S, C11 R, C2=C3 E",
    r"C/C/1=C\CC(/C=C/C/C(=C/CC1)/C)(C)C": "C2=C3 E, C6=C7 E, C9=C10 E",
    r"C/C/1=C\CC[C@@]2([C@H](O2)[C@@H]3[C@@H](CC1)C(=C)C(=O)O3)C": "C6 R, C7 R, C9 S, C10 S, C2=C3 E",
    "CC=[C@]=CC": "C2=C3=C4 M", "CC=[C@@]=CC": "C2=C3=C4 P", "NC12CC3CC(CC(C3)C1)C2": "", "C1CN2CCC1CC2": "",
    "CC1(C)C2CCC1(C)C(=O)C2": "C4 R, C7 R; the handedness of C4, C7 is not given: R, R is taken",
    "CC=CC": "C2=C3 E; the side of C2=C3 is not given: E is taken",
    "c1ccc2c(c1)ccc(O)c2-c1c(O)ccc2ccccc12": "C11-C12 P; the handedness of C11-C12 is not given: P is taken"}


ANILIDE = "CC(=O)N(C)c1ccccc1C(C)(C)C"


@pytest.mark.parametrize("smiles, expected", ISOMERS.items())
def test_isomers(smiles, expected):
    one = reading.read(None, smiles)
    isomer = stereo.of(one.rd, one.positions)
    assert "; ".join([stereo.told(one.rd, one.positions, isomer), *one.said]) == expected
    assert not isomer.differs(one.positions)
    assert bool(isomer.differs(-one.positions)) == any(e.kind != stereo.FLAT for e in isomer.elements)  # its mirror image


# E in rings of 8 and 14, and one hand of an axis.
@pytest.mark.parametrize("smiles, atoms, of", [
    ("C1CCC/C=C/CC1", (3, 4, 5, 6), np.cos), ("CC1CCCC/C=C/CCCCC(=O)O1", (5, 6, 7, 8), np.cos),
    ("Oc1ccc2ccccc2c1-c1c(O)ccc2ccccc12", (1, 10, 11, 12), np.sin), (ANILIDE, (1, 3, 5, 10), np.sin),
])
def test_the_lowest_conformers_are_of_the_isomer_that_was_read(smiles, atoms, of):
    one = reading.read(None, smiles)
    isomer = stereo.of(one.rd, one.positions)
    sign = -1 if of is np.cos else np.sign(of(geometry.torsion(one.positions, *atoms)))
    found = molecule.conformers(one, 4, lambda x: not isomer.differs(x), stereo.bounds)
    assert found and all(sign * of(geometry.torsion(x, *atoms)) > 0.3 for x in found)


def test_the_axis_of_an_anilide():
    # The acyl group is above methyl, and the carbon beside tert-butyl above the other one.
    one = reading.read(None, ANILIDE)
    hand = "P" if geometry.torsion(one.positions, 1, 3, 5, 10) > 0 else "M"
    assert one.said == [f"the handedness of N4-C6 is not given: {hand} is taken"]
    for smiles in "CC(=O)N(C)c1ccccc1", "CC(=O)Nc1c(C)cccc1CC", "CN(C(C)=O)c1c(C)cccc1C":  # two places are taken, or both sides are equal
        one = reading.read(None, smiles)
        assert not stereo.of(one.rd, one.positions).elements, smiles


def one_line(function):
    try:
        sandbox.run(function, "file")
    except Failed as why:
        return str(why)
    raise AssertionError("not refused")


def taken_over(answer):
    """A reader that answers what is not its answer."""
    pipe = max(filter(is_open, range(3, 99)))
    os.write(pipe, len(answer).to_bytes(4, "big") + answer)
    os._exit(0)


def is_open(n):
    try:
        return os.fstat(n) is not None
    except OSError:
        return False


def test_the_reader_in_its_walls():
    assert sandbox.run(lambda: ["ä", 1.5], "file") == ["ä", 1.5]
    for function, why in (
        (lambda: ctypes.string_at(0), "its reader crashed (SIGSEGV): the file is damaged"),
        (os.abort, "its reader crashed (SIGABRT)"),
        (socket.socket, "Operation not permitted"),
        (lambda: subprocess.run(["/bin/true"]).returncode, "Operation not permitted"),
        (lambda: len(bytearray(8 << 30)), "more than 4 GiB of memory"),
        (lambda: signal.raise_signal(signal.SIGKILL), "its reader was killed, perhaps for want of memory: "),
        (lambda: taken_over(b'{"refused": 5}'), "5"),
        (lambda: (f := lambda: f())(), "not understood: maximum recursion"),
    ):
        assert why in one_line(function)


@pytest.mark.parametrize("answer", [
    b"5", b'{"refused": {}, "value": 5}', b"[" * 1000000, b'{"value": {"array": [-1]}}', b'{"value": {"array": [1e999]}}',
    b'{"value": {"array": [9, 99999999]}}', b'{"value": {"array": [3]}}', b'{"value"'], ids=range(8))
def test_an_answer_that_no_reader_gives(answer):
    assert "its reader crashed" in one_line(lambda: taken_over(answer))


def test_reading_that_takes_too_long(monkeypatch):
    monkeypatch.setattr(sandbox, "CPU_SECONDS", 1)
    assert "reading it takes too long" in one_line(lambda: [None for _ in iter(int, 1)])


def test_damaged_files():
    chance = random.Random(1)
    outcomes = {"read": 0, "refused": 0}
    for name in INPUTS:
        content = bytearray((HERE / "molecules" / name).read_bytes())
        for _ in range(chance.randrange(1, 3)):
            at = chance.randrange(len(content))
            if chance.random() < 0.5:
                content[at] = chance.choice(b"0123456789-+. \nACHNOMV*\xff")
            else:
                del content[at:at + chance.randrange(1, 40)]
        path = f"damaged.{name.rsplit('.', 1)[1]}"
        pathlib.Path(path).write_bytes(content)
        try:
            one = reading.read(path, None)
            outcomes["read"] += 1
            assert np.isfinite(one.positions).all()
        except Failed as why:
            outcomes["refused"] += 1
            assert "\n" not in str(why), why
    assert min(outcomes.values()) > 10, outcomes
