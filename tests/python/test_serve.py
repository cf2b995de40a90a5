"""serve() answers for a model as the protocol says, whatever the model prints and returns."""
import pathlib
import re

import hapgrid
import pytest

MODELS = pathlib.Path(__file__).parent / "models"
BALL = MODELS.parents[2] / "examples/hung-ball/hung_ball.py"
CHATTY = "origin = [-1, 0, 0], spacing = 1, counts = [3, 2, 2]"
WRONG = "origin = [0, 0, 0], spacing = 1, counts = [2, 2, 2]"
PRINTED = {"before serve", "converting", "from beneath"}


def test_what_a_model_prints_goes_to_standard_error(define, search):
    define("chatty", CHATTY)
    assert PRINTED <= set(search("chatty").splitlines())


@pytest.mark.parametrize("fault, why", [
    ("said", "nothing is known.*beyond 0"),
    ("key", r"KeyError: 'gone' \(chatty\.py, line 17\)"),
    ("nan", r"convert\(\) returned \[nan, 0\.0\]"),
])
def test_a_question_that_fails_ends_the_search_in_its_line(fault, why, define, search):
    define("chatty", CHATTY, f'fault = "{fault}"')
    said = [line for line in search("chatty", code=1).splitlines() if line not in PRINTED]
    assert len(said) == 1 and re.fullmatch(
        rf"expand: conversion at point [0-9]+ \([0-9], [0-9], [0-9]\) level 0, direction [0-9]+: {why}", said[0])


@pytest.mark.parametrize("parameters, why", [
    ('fault = "refused"', "no fault is refused"),
    ("falt = 1", "unknown parameter falt (known: fault)"),
])
def test_a_model_that_refuses_its_parameters(parameters, why, define, run):
    define("chatty", CHATTY, parameters)
    assert run("seed", "chatty.toml", "--allow-process", code=1) == ("", f"before serve\nseed: model chatty: {why}\n")


def test_a_module_hapgrid_in_PYTHONPATH_comes_first(define, run, monkeypatch):
    define("chatty", CHATTY)
    pathlib.Path("mine").mkdir()
    pathlib.Path("mine/hapgrid.py").write_text("raise SystemExit(5)")  # a module there hides the package
    monkeypatch.setenv("PYTHONPATH", "mine")
    assert "exited with status 5" in run("seed", "chatty.toml", "--allow-process", code=1)[1]


@pytest.mark.parametrize("line, why", [
    ("[" * 100000, "it is nested too deep"),
    ("{", "it is no JSON: .*"),
    ("[1]", "it must be an object with .*"),
    ('"x"', "it must be an object with .*"),
    ('{"x": 1}', "it must be an object with .*"),
])
def test_a_line_that_hapgrid_would_not_write_is_refused_in_one(line, why, run, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(pathlib.Path(hapgrid.__file__).parents[1]))
    for before, answer in ("", ""), ('{"hapgrid": 1, "parameters": {}}\n', r'\{"hapgrid": 1.*\}\n'):
        out, said = run("/usr/bin/python3", BALL, code=1, input=f"{before}{line}\n")
        assert re.fullmatch(answer, out) and re.fullmatch(f"hapgrid: a question is not understood: {why}\n", said)


def wrong(fault, atoms="atoms = 3, "):
    return f'fault = "{fault}", {atoms}sizes = [1, 2], many = [1, 2], probe.radius = 2'


# Each fault is of the model wrong.py, at the questions that its definition asks.
@pytest.mark.parametrize("fault, why", [
    ("scalar", "convert() must return 2 numbers, it returned 0.5"),
    ("nothing", "convert() must return 2 numbers, it returned None"),
    ("nan", "energy() returned nan"),
    ("one of three", "force() returned [0.0, nan, 1.0]"),
    ("short", "shape() must return 6 numbers, it returned [[0.0, 0.0, 0.0]]"),
    ("text", "energy() must return 1 number, it returned '1 eV'"),
    ("flat", "known_states() must return states of 2 numbers, it returned 0.0"),
    ("unset", 'convert() returned a dict without "s"'),
    ("lost", "the model has no function convert(s, x, d)"),
    ("stored", "\"stored\" names 'energy', but the model has no function energy(s, x)"),
])
def test_what_a_function_returned_wrongly_is_named(fault, why, define, search):
    define("wrong", WRONG, wrong(fault))
    assert f": {why}" in search("wrong", code=1)


def test_parameters_arrive_and_none_may_lack(define, search, run):
    define("wrong", WRONG, wrong("none"))
    search("wrong")
    define("wrong", WRONG, wrong("none", atoms=""))
    assert run("seed", "wrong.toml", "--allow-process", code=1) == ("", "seed: model wrong: the definition lacks the parameter atoms\n")


def test_convert_many_gives_the_bytes_of_one_question_at_a_time(define, search, dump):
    records, said = [], []
    for at_once in 0, 1:
        define("many", "origin = [-1, -1, -1], spacing = 0.5, counts = [5, 5, 5]", f"at_once = {at_once}")
        said.append(search("many"))
        records.append(dump("many.grid"))
    assert records[0] == records[1]
    assert [line for line in said[1].splitlines() if line.startswith("rows")] == ["rows 32"]


def test_a_matrix_product_gives_the_same_bytes_in_all_ways(define, run):
    define("product", "origin = [-1, -1, -1], spacing = 0.5, counts = [3, 3, 3]")
    run("seed", "product.toml", "--allow-process", "-o", "seeds")

    def grid(*options):
        run("expand", "--complete", "seeds", "--allow-process", "product.toml", "-o", "grid", *options)
        return pathlib.Path("grid").read_bytes()

    first = grid()
    assert grid("-j", 2) == first and grid("-j", 4) == first
    for in_flight in 1, 7:
        text = (MODELS / "product.py").read_text().replace('"state_size": 40', f'"state_size": 40, "in_flight": {in_flight}')
        pathlib.Path("product.py").write_text(text)
        pathlib.Path("product.toml").write_text(pathlib.Path("product.toml").read_text().replace(str(MODELS / "product.py"), "product.py"))
        assert grid() == first
