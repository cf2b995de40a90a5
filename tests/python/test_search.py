"""search() leaves the bytes of the filters, shows progress, and says what a filter said."""
import pathlib
import re
import shutil
import sys
import types

import hapgrid
import pytest
from conftest import BIN, SOURCE


@pytest.fixture
def half(define, search):
    define("half", "origin = [-1, 0, 0], spacing = 1, counts = [3, 2, 2]")
    search("half")
    return pathlib.Path("half.grid").rename("by-filters.grid").read_bytes()


def test_bytes_and_options(half, capfd):
    assert hapgrid.search("half.toml", allow_process=True) == "half.grid"
    assert pathlib.Path("half.grid").read_bytes() == half
    finer = hapgrid.search("half.toml", "finer.grid", allow_process=True, processors=2,
                           set={"grid.spacing": 0.5, "grid.counts": [5, 3, 3]})
    assert len(hapgrid.read(finer)["level"]) == 45
    assert capfd.readouterr() == ("", "")  # no terminal


@pytest.mark.parametrize("arguments, words", [
    ({}, "give search() allow_process=True"),
    ({"allow_process": True, "set": {"search.max_levels": 0}}, "max_levels"),
    ({"allow_process": True, "output": "/dev/null/x"}, "/dev/null/x"),
])
def test_what_a_filter_said(half, arguments, words):
    with pytest.raises(RuntimeError, match=re.escape(words)):
        hapgrid.search("half.toml", **arguments)


def test_a_cell_of_a_notebook_shows_one_line_that_is_replaced(half, monkeypatch):
    shown = []  # in place of Jupyter's kernel stands what search() calls of it
    handle = types.SimpleNamespace(update=lambda data, raw: shown.append(data["text/plain"]))
    monkeypatch.setitem(sys.modules, "ipykernel", types.ModuleType("ipykernel"))
    monkeypatch.setitem(sys.modules, "IPython", types.ModuleType("IPython"))
    monkeypatch.setitem(sys.modules, "IPython.display", types.SimpleNamespace(display=lambda data, raw, display_id: handle))
    hapgrid.search("half.toml", "cell.grid", allow_process=True)
    assert pathlib.Path("cell.grid").read_bytes() == half
    bar = r"\[(#* *)\] .*[0-9] of [0-9].*(conversions|one-way links).*"
    assert shown[-1] == f"[{'#' * 30}] done" and all(len(re.fullmatch(bar, line)[1]) == 30 for line in shown[:-1]), shown
    seen = len(shown)
    with pytest.raises(RuntimeError):
        hapgrid.search("half.toml", "/dev/null/x", allow_process=True)
    assert not any("done" in line for line in shown[seen:]), shown[seen:]


def test_plugins_are_found_in_HAPGRID_MODEL_PATH(run, needs, monkeypatch):
    folder = pathlib.Path("own/plugins")
    folder.mkdir(parents=True)
    shutil.copy(BIN.parent / "models/hung-ball.so", folder / "own.so")
    definition = (SOURCE / "examples/hung-ball/hung-ball.toml").read_text().replace('"hung-ball"', '"own"')
    definition = re.sub("(?m)^spacing = .*", "spacing = 0.1", re.sub("(?m)^counts = .*", "counts = [20, 10, 10]", definition))
    pathlib.Path("own/own.toml").write_text(definition)
    with pytest.raises(RuntimeError, match="no plug-in own.so"):
        hapgrid.search("own/own.toml")
    monkeypatch.setenv("HAPGRID_MODEL_PATH", str(folder))
    hapgrid.search("own/own.toml")
    run("play", "own/own.grid", "--device", "path:-", "--log", "own/a.session", input="0.1 0 0\n")
    needs("matplotlib", "python3-matplotlib")
    plot = "hapgrid", "plot", "session", "own/a.session", "--grid", "own/own.grid", "-o", "own/a.png"
    run(*plot)
    monkeypatch.delenv("HAPGRID_MODEL_PATH")
    assert "plot: own/a.session: play: model own: no plug-in own.so" in run(*plot, code=1)[1]
