"""Opens the page of a folder of hapgrid molecule on two screens: page.py FOLDER"""
import os
import re
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "../view"))
from browser import Browser  # noqa: E402

FOLDER = sys.argv[1]
CLICK = """(share => { const map = part("map"), box = map.getBoundingClientRect();
  map.dispatchEvent(new MouseEvent("click", {clientX: box.left + share[0] * box.width, clientY: box.top + share[1] * box.height}));
  return part("place").textContent; })"""


def bond_of(path):
    return path.removesuffix("-plus").removesuffix("-minus")


def titles(path):
    """The energies of a path's file, kJ/mol."""
    with open(os.path.join(FOLDER, path + ".xyz"), encoding="utf-8") as file:
        return np.array([float(value) for value in re.findall(r"^dE=(\S+)", file.read(), re.M)])


with open(os.path.join(FOLDER, os.path.basename(FOLDER) + ".toml"), encoding="utf-8") as file:
    PATHS = re.findall(r'^  "(.*)\.xyz",$', file.read(), re.M)
with open(os.path.join(FOLDER, "played.log"), encoding="utf-8") as file:
    LINES = file.read().splitlines()
LOG = dict(zip(LINES[0].lstrip("# ").split("\t"), np.array([line.split("\t") for line in LINES[1:]], float).T))


def compare(page):
    """Energies of the page's curves with the model's own, of the states through which the play went."""
    curves = {one["name"]: one for one in page.value("curves")}
    assert len(curves) == 2 and set(curves) == set(map(bond_of, PATHS)), (curves.keys(), PATHS)
    ways = []
    for k, path in enumerate(PATHS):
        one = curves[bond_of(path)]
        last = len(titles(path)) - 1
        ahead = np.allclose(one["energies"][one["start"]:one["start"] + last + 1], titles(path)[:len(one["energies"]) - one["start"]], atol=0.002)
        ways.append((bond_of(path), one["start"], last if ahead else -last, LOG[f"s{k}"]))
    rows = np.flatnonzero(LOG["own_energy"] > 0.5)
    assert len(rows) > 20, len(rows)
    for n in rows[::max(1, len(rows) // 40)]:
        own = sum(page.value(f"energyAt(curves.find(one => one.name === '{bond}'), {start + last * t[n]})") for bond, start, last, t in ways)
        assert abs(own - LOG["own_energy"][n]) < 0.01, (n, own, LOG["own_energy"][n])  # energies have three decimals in the page


with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder, Browser(folder) as browser:
    for width in (390, 1300):
        page = browser.open(f"file://{os.path.abspath(FOLDER)}/index.html", width, 844)
        page.wait("document.readyState == 'complete' && !!document.querySelector('pre')")
        assert page.value("document.documentElement.scrollWidth") == width, page.value("document.documentElement.scrollWidth")
        highest = {}
        for path in PATHS:
            bond = bond_of(path)
            highest[bond] = max(highest.get(bond, 0), titles(path).max())
        told = page.value("part('steps').textContent")
        assert f"from 0.0 (dark) to {sum(highest.values()):.1f} (bright)" in told, told
        compare(page)
        # A click in the middle tells the sum of the two bonds where it is.
        place = page.value(CLICK + "([0.5, 0.5])")
        found = re.fullmatch(r"(\S+) at (\S+)°, (\S+) at (\S+)°: (\S+) kJ/mol", place)
        assert found, place
        angles = [float(found[k].replace("−", "-")) for k in (2, 4)]
        sums = [page.value(f"[0, 1].map(n => [-360, 0, 360].map(turn => {angles}[n] + turn + {off}).filter(a => a >= both[n].angles[0] && "
                           "a <= both[n].angles.at(-1)).map(a => energyAt(both[n], nodeAt(both[n], a)))[0])") for off in (-0.5, 0, 0.5)]
        low, high = (pick(sum(row) for row in sums) for pick in (min, max))
        assert low - 0.1 < float(found[5]) < high + 0.1, (place, sums)
        page.value("part('unit').click()")
        told = page.value("part('steps').textContent")
        assert f"to {sum(highest.values()) / 4.184:.1f} (bright)" in told and "kcal/mol" in told, told
    assert not browser.complaints, browser.complaints
