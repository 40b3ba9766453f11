"""Answers that are the same whatever is asked: empty, not a number, true, or what was given. No check takes one."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import notebooks
import numpy as np
import pytest

from cdprlab.course.grading.cells import code_cells
from cdprlab.course.grading.slices import needed, statements
from cdprlab.course.grading.split import Lost, at_most
from cdprlab.errors import InvalidInput

EMPTY = np.array([])
CONSTANTS: dict[str, Any] = {
    "empty": EMPTY, "empty rows": np.zeros((0, 2)), "empty rows of 3": np.zeros((0, 3)),
    "no matrices": np.zeros((0, 3, 3)),
    "empty list": [], "empty tuple": (), "empty dict": {}, "two empties": (EMPTY, EMPTY), "three empties": (EMPTY,) * 3,
    "empty and true": (EMPTY, True), "empty and false": (EMPTY, False), "not a number": np.nan,
    "one nan": np.array([np.nan]),
    "two nan": (np.nan,) * 2, "three nan": (np.nan,) * 3, "nan and true": (np.nan, True), "infinite": np.inf,
    "minus infinite": -np.inf, "huge": 1e300, "zero": 0.0, "one": 1.0, "true": True, "false": False, "a word": "inside",
    "nothing": None,
}


def _raises(error: type[Exception]) -> Callable[..., Any]:
    def raising(*_: Any, **__: Any) -> Any:
        raise error("no")
    return raising


def _itself(*_: Any, **__: Any) -> Any:
    return _itself


ANSWERS: dict[str, Callable[..., Any]] = {
    **{what: lambda *_, value=value, **__: value for what, value in CONSTANTS.items()},
    "what was given first": lambda *given, **_: given[0] if given else None,
    "what was given last": lambda *given, **_: given[-1] if given else None,
    "nan of that shape": lambda *given, **_: np.full(np.shape(given[0]), np.nan) if given else None,
    "ValueError": _raises(ValueError), "InvalidInput": _raises(InvalidInput), "itself": _itself,
}


def accepted(name: str) -> Iterator[str]:
    """Checks of a lesson that an answer of these passes."""
    cells = code_cells(json.loads((notebooks.SOURCE / name / f"{name}.ipynb").read_text(encoding="utf-8")))
    before, wanted, names = list[Any](), set[Any](), set[str]()
    for cell in cells:
        parsed = statements(cell.source)
        if cell.kind == "check":
            wanted |= set(needed(before, ends=parsed))
        before += parsed
    space: dict[str, Any] = {"__name__": "__main__", "display": lambda *_: None}
    for cell in cells:
        if cell.kind == "check":
            solved = dict(space)
            functions = [function for function in names if callable(space.get(function))]
            for what, answer in ANSWERS.items() if functions else ():
                space.update(dict.fromkeys(functions, answer))
                if _passes(cell.source, space):
                    yield f"{cell.grade_id}: {what}"
                space.clear()
                space.update(solved)
            exec(cell.source, space)
        elif cell.kind == "answer":
            names = set[str]().union(*(part.binds for part in statements(cell.source)))
            exec(cell.source, space)
        else:
            for statement in statements(cell.source):
                if statement in wanted:
                    exec(statement.source, space)


def _passes(check: str, space: dict[str, Any]) -> bool:
    try:
        with at_most(20):
            exec(check, space)
    except (Exception, Lost):
        return False
    return True


def accepted_there(name: str) -> list[str]:
    """The same in a process of its own, which interval libraries may leave rounding as they like."""
    done = subprocess.run([sys.executable, "-W", "ignore", __file__, name], capture_output=True, text=True, timeout=280,
                          env={**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": str(notebooks.CHECKOUT)})
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])


def test_no_constant_passes_a_check_of_one_lesson():
    assert accepted_there("02_wrench_matrix") == []


@pytest.mark.long
@pytest.mark.parametrize("name", notebooks.names())
def test_no_constant_passes_a_check(name: str):
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    assert accepted_there(name) == []


if __name__ == "__main__":
    print("\n" + json.dumps(list(accepted(sys.argv[1]))))
