"""Lessons for the tests: where they are, and a kernel that runs them cell by cell."""

from __future__ import annotations

import ast
import ctypes
import ctypes.util
import importlib.util
import io
import os
import re
import runpy
import tokenize
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import nbformat
from nbclient import NotebookClient

CHECKOUT = Path(__file__).parent.parent
LESSONS, SOURCE = CHECKOUT / "lessons", CHECKOUT / "lessons" / "source"
WRONG = Path(__file__).parent / "wrong_answers"
TIMEOUT = 60  # [s] a cell
WIDGET_STATE = "application/vnd.jupyter.widget-state+json"

_ANSI = re.compile(r"\x1b\[[0-9;]*m")
_FIRST_ERROR = re.compile(r"^([\w.]+)\s+Traceback \(most recent call last\)", re.MULTILINE)


def release_tool() -> ModuleType:
    """lessons/source/release.py, which is a script and no part of the package."""
    return source_tool("release")


def source_tool(name: str) -> ModuleType:
    """A script beside the lessons' sources, by its name."""
    spec = importlib.util.spec_from_file_location(name, SOURCE / f"{name}.py")
    assert spec is not None and spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool


def names() -> list[str]:
    """Every lesson that has a source: 00_first_flight, …"""
    return [path.stem for path in release_tool().sources()]


def read_source(name: str) -> Any:
    """A lesson with solutions and hidden checks."""
    return nbformat.read(SOURCE / name / f"{name}.ipynb", as_version=4)


def read_copy(name: str) -> Any:
    """The lesson as students get it."""
    return nbformat.read(LESSONS / f"{name}.ipynb", as_version=4)


def wrong_answers(name: str) -> dict[str, list[tuple[str, str]]]:
    """Answer cell's grade_id → (what is wrong, the whole wrong cell)."""
    return runpy.run_path(str(WRONG / f"{name}.py"))["WRONG_ANSWERS"]


def grader(cell: Any) -> dict[str, Any]:
    """A cell's nbgrader metadata, empty for ordinary cells."""
    return cell.metadata.get("nbgrader", {})


def answers(notebook: Any) -> dict[str, int]:
    """grade_id → index of every answer cell."""
    return _graders(notebook, "solution")


def checks(notebook: Any) -> dict[str, int]:
    """grade_id → index of every graded cell."""
    return _graders(notebook, "grade")


def read_by_all(markdown: str) -> str:
    """Its words without formulas, and without hints and explanations that stay folded until one asks."""
    unfolded = re.sub(r"<details>.*?</details>", " ", markdown, flags=re.DOTALL)
    return re.sub(r"\$\$.*?\$\$|\$[^$]*\$", " ", unfolded, flags=re.DOTALL)


def code_lines(source: str) -> int:
    """Lines with code, an import as one; solutions, docstrings and comments are not counted."""
    source = re.sub(r"### BEGIN SOLUTION.*?### END SOLUTION", "pass", source, flags=re.DOTALL)
    spared: set[int] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            spared |= set(range(node.lineno + 1, node.end_lineno + 1))
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and ast.get_docstring(node):
            spared |= set(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    code = [token for token in tokenize.generate_tokens(io.StringIO(source).readline) if token.string.strip()
            and token.type not in (tokenize.COMMENT, tokenize.ENDMARKER)]
    return len({line for token in code for line in range(token.start[0], token.end[0] + 1)} - spared)


def check_of(answer: str) -> str:
    """The grade_id of the check of an answer: name-answer → name-check."""
    return answer.removesuffix("-answer") + "-check"


@contextmanager
def kernel(notebook: Any, folder: Path) -> Iterator[NotebookClient]:
    """A fresh kernel in ``folder``; errors stay in the cells' outputs."""
    client = NotebookClient(notebook, timeout=TIMEOUT, kernel_name="python3", allow_errors=True,
                            resources={"metadata": {"path": str(folder)}})
    client.reset_execution_trackers()
    with client.setup_kernel(env=environment(folder)):
        yield client


def environment(folder: Path) -> dict[str, str]:
    """Of a lesson's kernel: as a student's, on one core."""
    # With pytest's variable ipykernel would not look at what libraries write to stderr, as it does when grading.
    kept = {name: value for name, value in os.environ.items() if name not in ("PYTEST_CURRENT_TEST", "MPLBACKEND")}
    return {**kept, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(CHECKOUT), "IPYTHONDIR": str(folder / ".ipython")}


def execute(client: NotebookClient) -> None:
    """All cells in order, then the widgets' states into the notebook."""
    for index, cell in enumerate(client.nb.cells):
        client.execute_cell(cell, index)
    client.set_widgets_metadata()


def round_to_nearest() -> None:
    """After a lesson's cells ran in this process: an interval library leaves it rounding upward."""
    ctypes.CDLL(ctypes.util.find_library("m")).fesetround(0)


def errors(cell: Any) -> list[Any]:
    """The error outputs of an executed cell."""
    return [output for output in cell.get("outputs", []) if output.output_type == "error"]


def root_cause(error: Any) -> str:
    """The name of the first error of a chain: what the others were raised from, or because of."""
    found = _FIRST_ERROR.search(_ANSI.sub("", "\n".join(error["traceback"])))
    return found.group(1) if found else error["ename"]


def swallowed(notebook: Any) -> list[Any]:
    """Outputs a widget kept to itself that are errors, or were written to stderr."""
    shown = [output for state in _widgets(notebook, "OutputModel") for output in state.get("outputs", [])]
    return [output for output in shown if output["output_type"] == "error" or output.get("name") == "stderr"]


def alerts(notebook: Any) -> list[str]:
    """Mistakes an explorer shows in place of its numbers."""
    texts = [state.get("value", "") for state in _widgets(notebook, "HTMLModel")]
    return [text for text in texts if '<div role="alert"' in text]


def noise(notebook: Any) -> str:
    """Whatever the cells wrote to stderr."""
    return "".join(output.text for cell in notebook.cells for output in cell.get("outputs", [])
                   if output.output_type == "stream" and output.name == "stderr")


def complaints(notebook: Any) -> list[str]:
    """One line an error of the executed cells, for a failing test to show."""
    return [f"cell {cell.id}: {_ANSI.sub('', error.ename)}: {error.evalue[:300]}" for cell in notebook.cells
            for error in errors(cell)]


def _widgets(notebook: Any, kind: str) -> list[dict[str, Any]]:
    """The states of all widgets of one kind, after `execute`."""
    models = notebook.metadata.get("widgets", {}).get(WIDGET_STATE, {}).get("state", {})
    return [model["state"] for model in models.values() if model["model_name"] == kind]


def _graders(notebook: Any, kind: str) -> dict[str, int]:
    return {grader(cell)["grade_id"]: index for index, cell in enumerate(notebook.cells) if grader(cell).get(kind)}
