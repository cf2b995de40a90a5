"""serve(): a model in Python answers hapgrid's questions (libcore/model/PROTOCOL.md)."""
from __future__ import annotations

import inspect
import json
import math
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any

SHOWN = 80  # characters of what a function returned
IN_FLIGHT = 26  # questions that a model with convert_many() asks for at a time: all directions of a record
ROWS = 32  # that convert_many() gets, always: matrix products round a row otherwise when there are more or fewer of them
WHOLE = 2.0**53  # floats below are exact whole numbers


def serve(model: Callable[..., Any]) -> None:
    """Answers hapgrid's questions about a model, until there are no more.

    `model` is a class or a function. It is called with the parameters of the definition by their names, and returns an
    object with

        description             a dict: state_size, d_max, tolerance and other keys of the table in PROTOCOL.md
        convert(s, x, d)        the conversion function: the state that is reached when the HIP moves from x, where the
                                model is in state s, to x + d; or a dict with it as "s", and with those of "force",
                                "energy" and "shape" at x + d that are known then
        known_states(x)         a list of the states that are known in advance at x; it may be left out
        force(s, x)             in newtons, for the HIP at x in state s: 3 numbers
        energy(s, x)            in the energy unit of the description
        shape(s, x)             x, y, z of each of the description's spheres

    The grid stores those of the last three that the object has; "stored" in the description chooses among them. s, x
    and d are lists of floats. Answers are any sequences of numbers, arrays of NumPy among them. An answer must depend on
    nothing but the question and the parameters. relax() is the usual way from one state to the next.

    A parameter that is a whole number is an int, unless its default is a float.

    A model for NumPy or a GPU may have convert_many(s, x, d) in place of convert(): arrays with a row a question (k x n,
    k x 3, k x 3), and it returns the states as k rows, or a dict of arrays as above. k is always 32: the last question is
    repeated where there are fewer, so that matrix products round all alike. A row must not depend on the others.

    What the model or its libraries then print goes to standard error, and standard input is empty. An exception in one of
    the functions ends the search with its text.
    """
    if os.isatty(0):
        sys.exit("hapgrid.serve(): this is a model, which answers questions of hapgrid's filters: check-model MODEL.toml "
                 "--allow-process tries it")
    # hapgrid's lines get descriptors that neither the model nor what it starts has.
    questions, answers = os.dup(0), os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    with open(os.devnull, encoding="utf-8") as nothing:
        os.dup2(nothing.fileno(), 0)
    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[attr-defined]

    def say(*lines: dict[str, Any]) -> None:
        answers.write("".join(json.dumps(line, allow_nan=False, default=lambda array: array.tolist()) + "\n" for line in lines))
        answers.flush()

    batches = _batches(questions)
    hello, *rest = next(batches, [""])
    parameters = _question(hello, "parameters")["parameters"]
    try:
        served = _Served(model(**_arguments(model, parameters)))
        say(served.description)
    except Exception as error:
        return say({"error": _text(error)})
    for lines in chain([rest], batches):
        asked = [_question(line, "id", "op") for line in lines]
        if served.has_many and len(asked) > 1 and all(question["op"] == "convert" for question in asked):
            say(*served.answer_many(asked))
        else:
            for question in asked:
                say(served.answer(question))


class _Served:
    """The user's object, and the answers that it gives."""

    def __init__(self, served: Any) -> None:
        self.served = served
        self.has_many = hasattr(served, "convert_many")
        if not isinstance(getattr(served, "description", None), dict):
            raise ValueError("the model has no description, which must be a dict")
        if not (self.has_many or hasattr(served, "convert")):
            raise ValueError("the model has no function convert(s, x, d)")
        stored = [name for name in ("force", "energy", "shape") if hasattr(served, name)]
        self.description: dict[str, Any] = {"hapgrid": 1, "stored": stored, **served.description}
        if self.has_many:
            self.description.setdefault("in_flight", IN_FLIGHT)
        self.stored = self.description["stored"]
        for name in self.stored:
            if not hasattr(served, name):
                raise ValueError(f'"stored" names {name!r}, but the model has no function {name}(s, x)')
        self.size = self.description.get("state_size")
        self.counts = {"s": self.size, "force": 3, "energy": 1, "shape": 3 * len(self.description.get("spheres", ()))}

    def answer(self, question: dict[str, Any]) -> dict[str, Any]:
        number, op = question.pop("id"), question.pop("op")
        try:
            return {"id": number, **getattr(self, "_" + op)(**question)}
        except Exception as error:
            return {"id": number, "error": _text(error)}

    def answer_many(self, questions: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """To questions for conversions alone. Where the model fails on them together, each is asked alone."""
        try:
            rows = self._convert_many(questions)
            return [{"id": question["id"], **self._reached(row, question["x"], question["d"], "convert_many")}
                    for question, row in zip(questions, rows)]
        except Exception:
            return [self.answer(question) for question in questions]

    def _convert_many(self, questions: list[dict[str, Any]]) -> list[dict[str, Any]]:
        return [row for i in range(0, len(questions), ROWS) for row in self._convert_block(questions[i:i + ROWS])]

    def _convert_block(self, questions: list[dict[str, Any]]) -> list[dict[str, Any]]:
        import numpy

        padded = questions + questions[-1:] * (ROWS - len(questions))
        reached = self.served.convert_many(*(numpy.array([q[key] for q in padded]) for key in ("s", "x", "d")))
        columns = dict(reached) if isinstance(reached, dict) else {"s": reached}
        for key, column in columns.items():
            if not hasattr(column, "__len__") or len(column) != ROWS:
                raise ValueError(f'convert_many() must return a row of "{key}" for each of {ROWS} questions, it returned '
                                 f"{_shown(column)}")
        return [{key: column[i] for key, column in columns.items()} for i in range(len(questions))]

    def _convert(self, s: Any, x: Any, d: Any) -> dict[str, Any]:
        if self.has_many:
            return self._reached(self._convert_many([{"s": s, "x": x, "d": d}])[0], x, d, "convert_many")
        return self._reached(self.served.convert(s, x, d), x, d, "convert")

    def _reached(self, reached: Any, x: Any, d: Any, name: str) -> dict[str, Any]:
        known = dict(reached) if isinstance(reached, dict) else {"s": reached}
        if "s" not in known:
            raise ValueError(f'{name}() returned a dict without "s"')
        known = {key: _numbers(name if key == "s" else f"{name}()'s {key}", value, self.counts[key])
                 for key, value in known.items() if key in self.counts}
        there = [a + b for a, b in zip(x, d)]
        return {"s": known["s"], **self._evaluate(known.pop("s"), there, **known)}

    def _evaluate(self, s: Any, x: Any, **known: Any) -> dict[str, Any]:
        numbers = {name: known[name] if name in known else
                   _numbers(name, getattr(self.served, name)(list(s), list(x)), self.counts[name]) for name in self.stored}
        if "energy" in numbers:
            numbers["energy"] = numbers["energy"][0]
        return numbers

    def _known_states(self, x: Any) -> dict[str, Any]:
        states = self.served.known_states(x) if hasattr(self.served, "known_states") else []
        if not hasattr(states, "__iter__"):
            raise ValueError(f"known_states() must return a list of states, it returned {_shown(states)}")
        return {"states": [_numbers("known_states", state, self.size, "states of") for state in states]}


def _numbers(name: str, value: Any, count: int | None, of: str = "") -> list[float]:
    """What a function returned as `count` finite floats. @raises ValueError that says what it returned instead."""
    call = name if " " in name else name + "()"
    try:
        numbers = [float(a) for a in _flat(value)]
    except (TypeError, ValueError):
        numbers = None
    if numbers is None or count is not None and len(numbers) != count:
        many = "numbers" if count is None else f"{count} number{'s' * (count != 1)}"
        raise ValueError(f"{call} must return {of + ' ' * bool(of)}{many}, it returned {_shown(value)}")
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"{call} returned {_shown(value)}")
    return numbers


def _flat(value: Any) -> Iterator[Any]:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (str, bytes, dict)):
        raise TypeError
    if not hasattr(value, "__iter__"):
        yield value
        return
    for part in value:
        yield from _flat(part)


def _shown(value: Any) -> str:
    text = " ".join(repr(value.tolist() if hasattr(value, "tolist") else value).split())
    return text if len(text) <= SHOWN else text[:SHOWN] + "..."


def _arguments(model: Any, parameters: dict[str, Any]) -> dict[str, Any]:
    """The parameters as the model wants them. @raises ValueError that names those which it does not know, or misses."""
    known = inspect.signature(model).parameters.values()
    named = {p.name: p for p in known if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}
    takes_all = any(p.kind == p.VAR_KEYWORD for p in known)
    for key in parameters:
        if key not in named and not takes_all:
            raise ValueError(f"unknown parameter {key} (known: {', '.join(named) or 'none'})")
    missing = [name for name, p in named.items() if p.default is p.empty and name not in parameters]
    if missing:
        raise ValueError(f"the definition lacks the parameter {', '.join(missing)}")
    return {key: _whole(value, named[key].default if key in named else None) for key, value in parameters.items()}


def _whole(value: Any, default: Any) -> Any:
    """Whole numbers as int, but not where the default says that it is a float."""
    if isinstance(value, list):
        like = default[0] if isinstance(default, (list, tuple)) and default else None
        return [_whole(entry, like) for entry in value]
    is_whole = isinstance(value, float) and value.is_integer() and abs(value) <= WHOLE
    return int(value) if is_whole and not isinstance(default, float) else value


def _batches(questions: int) -> Iterator[list[str]]:
    """The lines that are there, as they come."""
    rest = b""
    while text := os.read(questions, 1 << 16):
        *lines, rest = (rest + text).split(b"\n")
        if lines:
            yield [line.decode("utf-8", "replace") for line in lines]
    if rest:
        yield [rest.decode("utf-8", "replace")]


def _question(line: str, *keys: str) -> dict[str, Any]:
    """A line of hapgrid's as a dict that has these keys. Any other line, of whoever tries the model by hand, ends the
    program with one line."""
    try:
        question = json.loads(line)
        if isinstance(question, dict) and all(key in question for key in keys):
            return question
        why = "it must be an object with " + " and ".join(keys)
    except RecursionError:
        why = "it is nested too deep"
    except ValueError as error:
        why = f"it is no JSON: {error}"
    sys.exit(f"hapgrid: a question is not understood: {why}")


def _text(error: Exception) -> str:
    """What an exception says. ValueError and ArithmeticError speak to the user; others show a fault of the program, and
    have a name and a place."""
    if isinstance(error, (ValueError, ArithmeticError)) and str(error):
        return str(error)
    where = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {error} ({os.path.basename(where.filename)}, line {where.lineno})"
