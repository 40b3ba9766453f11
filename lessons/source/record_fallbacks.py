"""Record what a lesson's later cells ask of each exercise's functions, for `course.fallback`.

``python lessons/source/record_fallbacks.py [LESSON …]`` runs the sources in this process and writes
``cdprlab/course/answers/recorded/*.gz``: results only, and only where the lesson offers them by `course.fallback`
(nobody's to give are the capstone's designs). Exercises that later cells ask freely (a controller, an explorer) stand
in ``LIBRARY`` of ``cdprlab/course/answers/fallback.py`` instead.
"""

from __future__ import annotations

import ast
import copy
import functools
import gzip
import inspect
import json
import os
import re
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import chdir, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import nbformat
from run_cells import run_cell

from cdprlab.course.answers import fallback
from cdprlab.course.answers.fallback import LIBRARY, fingerprint
from cdprlab.course.answers.plain import encode

SOURCE = Path(__file__).parent


class Recorder:
    """A lesson's functions, whose results are kept while a cell that is neither answer nor check runs."""

    def __init__(self, lesson: str) -> None:
        self.lesson = lesson
        self.calls: dict[str, dict[str, list[tuple[Any, Any]]]] = {}
        self.listening = False

    def around(self, exercise: str, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, recorded."""
        rows = self.calls.setdefault(exercise, {}).setdefault(name, [])
        signature = inspect.signature(function)

        @functools.wraps(function)
        def call(*arguments: Any, **named: Any) -> Any:
            listening, self.listening = self.listening, False  # what the function asks of itself is not recorded
            seen = fingerprint(signature.bind(*arguments, **named).args)
            try:
                returned = function(*arguments, **named)
            finally:
                self.listening = listening
            if listening and not any((seen == earlier).all() for earlier, _ in rows):
                rows.append((seen, copy.deepcopy(returned)))
            return returned

        return call


def main(wanted: list[str]) -> int:
    """Record the lessons whose names contain one of the words, or all."""
    os.environ["MPLBACKEND"] = "Agg"
    for path in sorted(SOURCE.glob("[0-9][0-9]_*/*.ipynb")):
        if wanted and not any(word in path.stem for word in wanted):
            continue
        recorder, space = Recorder(path.stem[:2]), {"__name__": "__main__", "display": lambda *shown: None}
        notebook = nbformat.read(path, as_version=4)
        text = "\n".join(cell.source for cell in notebook.cells)
        offered = set(re.findall(r'course\.fallback\("([^"]+)"\)', text))
        with tempfile.TemporaryDirectory() as folder, chdir(folder):
            for cell in notebook.cells:
                if cell.cell_type == "code":
                    _run(cell, recorder, space)
        for exercise, calls in recorder.calls.items():
            if exercise not in LIBRARY and offered & {exercise, exercise[3:]}:
                file = record(exercise, calls)
                seen = ", ".join(f"{len(rows)} of {name}" for name, rows in calls.items())
                print(f"{exercise}: {seen}, {file.stat().st_size / 1e3:.0f} kB")
    return 0


def record(exercise: str, calls: Mapping[str, Sequence[tuple[Any, Any]]]) -> Path:
    """Write the results of an exercise's functions: name → (fingerprint, result) of each call."""
    table = {name: [[seen.tolist(), encode(result)] for seen, result in rows] for name, rows in calls.items()}
    path = fallback.RECORDED / f"{exercise}.gz"
    path.write_bytes(gzip.compress(json.dumps(table).encode(), mtime=0))
    return path


def _run(cell: Any, recorder: Recorder, space: dict[str, Any]) -> None:
    role = cell.metadata.get("nbgrader", {})
    recorder.listening = not role.get("solution") and not role.get("grade")
    with redirect_stdout(StringIO()):
        run_cell(cell.source, f"<{cell.id}>", space)
    if role.get("solution"):
        exercise = f"{recorder.lesson}_{role['grade_id'].removesuffix('-answer')}"
        for statement in ast.parse(cell.source).body:
            if isinstance(statement, ast.FunctionDef):
                space[statement.name] = recorder.around(exercise, statement.name, space[statement.name])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
