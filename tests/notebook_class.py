"""A class of students for the grader's tests: a lesson of three exercises, and notebooks that answer it somehow."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

LESSON = "90_tiny"
SECRET = "swordfish"
"""Stands in a hidden check; no student may ever read it."""

SETUP = "import numpy as np\nfrom cdprlab import course\nfactor = 2.0"
STUB = '    raise NotImplementedError("Your turn: replace this line.")'
EXERCISES = {
    "double": ("def double(x):\n{}", "    return factor * np.asarray(x, float)", """
found = np.asarray(double(np.array([1.0, 2.0])), float)
assert found.shape == (2,), f"Two numbers, please, not the shape {found.shape}."
np.testing.assert_allclose(found, [2, 4], err_msg="Twice 1 and 2 are 2 and 4.")
### BEGIN HIDDEN TESTS
word = "swordfish"
given = np.array([3.5, -7.25])
found = np.asarray(double(given), float)
assert np.allclose(found, 2 * given), f"Twice {given} is something else than {found}, {word}."
### END HIDDEN TESTS
print("Exercise 1 is right.")
"""),
    "said": ("def said(word):\n{}", '    return f"{word}!"', """
def loud(word):
    return word + "!"

answered = said("so")
assert type(answered) is str, "A word, please."
assert answered == loud("so"), f"so! was asked for, you say {answered}"
### BEGIN HIDDEN TESTS
for word in ("mellon", "sesame"):
    assert said(word) == loud(word), f"{loud(word)}: you say {said(word)}"
### END HIDDEN TESTS
"""),
    "applied": ("def applied(f, x):\n{}", "    return [f(f(x)), x]", """
twice, same = applied(lambda value: value + 1, 5)
assert twice == 7 and same == 5, f"f(f(5)) and 5 are asked for, not {twice} and {same}"
given = [3.0]
assert applied(lambda value: 1, given)[1] is given, "x itself, not a copy"
assert applied(loud, "a")[0] == "a!!", f"any function will do, seed {course.seed(7)}"
"""),
}
POINTS = {"double-check": 2, "said-check": 3, "applied-check": 4}


def code(source: str, **grader: Any) -> dict[str, Any]:
    """A code cell."""
    metadata = {"nbgrader": {"schema_version": 3, "locked": False, "grade": False, "solution": False, **grader}}
    return {"cell_type": "code", "id": f"c{abs(hash(source)) % 10**8}", "metadata": metadata if grader else {},
            "execution_count": None, "outputs": [], "source": source}


def lesson() -> dict[str, Any]:
    """The instructor's notebook."""
    cells = [code(SETUP)]
    for name, (frame, solution, check) in EXERCISES.items():
        body = f"    ### BEGIN SOLUTION\n{solution}\n    ### END SOLUTION"
        cells.append(code(frame.format(body), grade_id=f"{name}-answer", solution=True))
        cells.append(code(check.strip("\n"), grade_id=f"{name}-check", grade=True, locked=True,
                          points=POINTS[f"{name}-check"]))
    return {"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}


def handed_in(own: str = "", late: str = "", **answers: str) -> dict[str, Any]:
    """A student's notebook; stubs where no answer is given.

    own, late : cells of the student's own, behind the first and at the end
    """
    from cdprlab.course.grading.cells import code_cells

    cells = copy.deepcopy(lesson()["cells"])
    for cell, parsed in zip(cells, code_cells(lesson()), strict=True):
        name = parsed.grade_id.rpartition("-")[0]
        if parsed.kind == "answer":
            cell["source"] = answers.get(name) or EXERCISES[name][0].format(STUB)
        elif parsed.kind == "check":
            cell["source"] = parsed.visible
            cell["metadata"]["nbgrader"]["checksum"] = parsed.version
    if own:
        cells.insert(1, code(own))
    if late:
        cells.append(code(late))
    return {"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}


def solved() -> dict[str, str]:
    """The right answers."""
    return {name: frame.format(solution) for name, (frame, solution, _) in EXERCISES.items()}


def at(notebook: dict[str, Any], grade_id: str) -> dict[str, Any]:
    """The cell of that name."""
    return next(cell for cell in notebook["cells"] if cell["metadata"].get("nbgrader", {}).get("grade_id") == grade_id)


def write_source(folder: Path) -> Path:
    """The lesson where an instructor keeps it."""
    place = folder / "source" / LESSON
    place.mkdir(parents=True)
    (place / f"{LESSON}.ipynb").write_text(json.dumps(lesson()), encoding="utf-8")
    return folder / "source"
