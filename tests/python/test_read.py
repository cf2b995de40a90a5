"""read() gives what the dump of a grid and the text of a session say."""
import pathlib
import re
import sys
import warnings

import hapgrid
import numpy as np
import pytest
from conftest import SOURCE

SESSION = SOURCE / "tests/cli/stats/session.py"


@pytest.fixture
def played(define, search, run):
    """half.grid, and what play says of two ticks in it: a session, frames and a log."""
    define("half", "origin = [-1, 0, 0], spacing = 1, counts = [3, 2, 2]")
    search("half")
    pathlib.Path("path").write_text("-0.5 0.5 0.5\n0.5 0.5 0.5\n")
    run("play", "half.grid", "--device", "path:path", "--log", "a.session", "--frames", "a.frames")
    run("play", "half.grid", "--device", "path:path", "--log", "a.log")


def test_grid(played, dump):
    grid = hapgrid.read("half.grid")
    rows = np.array([line.split("\t")[:6] for line in dump("half.grid").splitlines() if line[0] != "#"], float)
    assert len(rows) >= 12
    assert f"{len(rows)} records with point, level, " in repr(grid), grid
    assert (grid["point"] == rows[:, :3]).all() and (grid["level"] == rows[:, 3]).all()
    assert (grid["state"] == rows[:, 4:]).all()
    # In closed form: the state is half of where the HIP is, and the force leads back from it.
    assert (grid["state"] == (grid["origin"] + grid["spacing"] * grid["point"])[:, :2] / 2).all()
    assert (grid["force"] == np.column_stack([-grid["state"], np.full(len(rows), 0.5)])).all()


def test_session_and_log(played, run):
    text = run(sys.executable, SESSION, "text", "a.session")[0]
    ticks, text = hapgrid.read(pathlib.Path("a.session"))["ticks"], np.loadtxt(text.splitlines())
    assert len(ticks) == len(text) == 2 and (ticks["t"] == text[:, 0]).all() and (ticks["hip"] == text[:, 1:4]).all()
    text, log = np.loadtxt("a.log"), hapgrid.read("a.log")["ticks"]
    assert log.dtype.names == ("t", "hip", "force", "sent", "levels", "state", "energy", "snap")
    for got in log, hapgrid.read("a.session", grid="half.grid")["ticks"]:
        assert (got["t"] == text[:, 0]).all() and (got["hip"] == text[:, 1:4]).all() and (got["force"] == text[:, 4:7]).all()
        assert (got["sent"] == text[:, 7:10]).all() and (got["levels"] == text[:, 10:18]).all()
        assert (got["state"] == text[:, 18:20]).all() and (got["energy"] == text[:, 20]).all()


def test_frames(played, run):
    log, frames = hapgrid.read("a.log")["ticks"], hapgrid.read("a.frames")["frames"]
    assert len(frames) >= 1 and (frames["hip"][-1] == [0.5, 0.5, 0.5]).all() and (frames["position"] == frames["hip"]).all()
    last = frames[-1]
    assert (last["state"] == log["state"][-1]).all() and last["energy"] == log["energy"][-1] and last["tick"] == len(log) - 1
    assert last["shape"].shape == (2, 3) and np.isnan(last["own_energy"]) and np.isnan(last["hand"]).all()
    assert (last["sent"] == log["sent"][-1]).all()
    assert np.abs(last["shape"] - [[*last["state"], 0], last["hip"]]).max() < 1e-6  # floats below 1
    run("stats", "a.frames", "--npy", "a.npy")
    assert (np.load("a.npy")["radius"] == np.float32(0.1)).all()
    pathlib.Path("cut.frames").write_bytes(pathlib.Path("a.frames").read_bytes()[:-1])  # as when play was stopped
    cut = hapgrid.read("cut.frames")["frames"]
    assert cut.dtype == frames.dtype and cut.tobytes() == frames[:-1].tobytes()


def test_a_session_is_as_it_was_played_and_a_replay_without_the_model_is_told(run):
    ball = SOURCE / "examples/hung-ball"
    allow = "--allow-process", ball / "hung-ball-process.toml"
    run("seed", ball / "hung-ball-process.toml", *allow[:1], "--set", "grid.spacing=0.2", "--set", "grid.counts=[10, 5, 5]", "-o", "seeds")
    run("expand", "--complete", "seeds", *allow, "-o", "coarse.grid")
    run("play", "coarse.grid", "--device", f"path:{ball / 'path-there-and-back.txt'}", "--log", "a.session", *allow)
    played = hapgrid.read("a.session")["ticks"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        asked = hapgrid.read("a.session", grid="coarse.grid", allow_process=allow[1])["ticks"]
    with pytest.warns(UserWarning, match="whose force differs by up to .* N from that which was played.*--allow-process MODEL.toml"):
        alone = hapgrid.read("a.session", grid="coarse.grid")["ticks"]
    for ticks in asked, alone:
        assert all((ticks[name] == played[name]).all() for name in played.dtype.names)
    assert np.abs(asked["state"] - alone["state"]).max() > 1e-3


def test_damaged_files(played):
    damaged = {
        "cut": pathlib.Path("half.grid").read_bytes()[:200],
        "empty": b"",
        "cut.session": pathlib.Path("a.session").read_bytes()[:-20],
        "text": b"# i j k\n",
        "bad.frames": pathlib.Path("a.frames").read_bytes() + b"\377" * 100,  # no message begins so
        "bad.log": re.sub(b"(?m)^([^#\t]*)\t", b"\\1\tx", pathlib.Path("a.log").read_bytes()),
    }
    for name, data in damaged.items():
        pathlib.Path(name).write_bytes(data)
    for name, error, words in (
        ("gone", FileNotFoundError, "gone"), ("cut", ValueError, "cut: stats: "), ("empty", ValueError, "empty: stats: "),
        ("cut.session", ValueError, "a session without a tick, which ended early"), ("text", ValueError, "text: stats: "),
        ("bad.frames", ValueError, "bad.frames: stats: standard input: byte "), ("bad.log", ValueError, "bad.log: not a log of play"),
    ):
        with pytest.raises(error) as why:
            hapgrid.read(name)
        assert words in str(why.value) and "\n" not in str(why.value)
