"""What the tests of the module hapgrid share: each runs in an empty folder, with the filters of HAPGRID_BIN."""
import importlib
import os
import pathlib
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(__file__).parents[2]
BIN = pathlib.Path(os.environ.get("HAPGRID_BIN", SOURCE / "build/bin"))
lacked = []


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{BIN}:/usr/bin:{os.environ['PATH']}")
    monkeypatch.setenv("HAPGRID_SOURCE", str(SOURCE))
    for name in "HAPGRID_MODEL_PATH", "PYTHONPATH", "PYTHONUNBUFFERED":
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def run():
    """run(COMMAND...): what it writes to standard output and to standard error; it must end with the given code."""

    def run(*command, code=0, **more):
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=300, **more)
        assert done.returncode == code, done.stderr
        return done.stdout, done.stderr

    return run


@pytest.fixture
def define():
    """define(NAME, GRID, PARAMETERS): NAME.toml, whose model is the process models/NAME.py, with at most 16 levels."""

    def define(name, grid, parameters=""):
        model = SOURCE / "tests/python/models" / f"{name}.py"
        process = f'["/usr/bin/python3", "{model}"]'
        pathlib.Path(f"{name}.toml").write_text(
            f'model = {{process = {process}, name = "{name}", parameters = {{{parameters}}}}}\n'
            f"search = {{max_levels = 16}}\ngrid = {{{grid}}}\n")

    return define


@pytest.fixture
def search(run):
    """search(NAME): NAME.toml becomes NAME.grid by the filters. It gives what they said."""

    def search(name, code=0):
        pipe = 'seed "$1" --allow-process | expand --complete --allow-process "$1" -o "$2"'
        return run("bash", "-o", "pipefail", "-c", pipe, "bash", f"{name}.toml", f"{name}.grid", code=code)[1]

    return search


@pytest.fixture
def dump(run):
    """dump(GRID): its records as text, by the stock tools."""
    return lambda grid: run(sys.executable, SOURCE / "tests/cli/dump.py", grid)[0]


@pytest.fixture
def needs():
    """needs(MODULE, PACKAGE): ends the test as skipped where the system's Python lacks it, and as failed in check-all."""

    def needs(module, package):
        try:
            return importlib.import_module(module)
        except ImportError:
            assert "CI" not in os.environ, f"not installed: {package}"
            lacked.append(package)
            pytest.skip(package)

    return needs


def pytest_terminal_summary(terminalreporter):
    for package in lacked:
        terminalreporter.write_line(f"not installed: {package}")
