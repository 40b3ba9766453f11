"""What follows an exercise runs on: with answers written as lists, and with what a lesson offers in their place."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path
from typing import Any

import mutants
import notebooks
import pytest

STAND_IN = re.compile(r'^# ([\w, ]+ = (?:course\.fallback\(".*"\)|lambda: \w+))$', re.MULTILINE)

pytestmark = [pytest.mark.long, pytest.mark.parametrize("lesson", mutants.lessons())]


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(tmp_path)
    yield
    notebooks.round_to_nearest()


def test_what_passes_a_check_never_breaks_a_later_cell(lesson: str):
    def written_as_lists(cell: Any, space: dict[str, Any]) -> None:
        mutants.cells.run_cell(cell.source, f"<{cell.id}>", space)
        if notebooks.grader(cell).get("solution"):
            for name in mutants.defined(cell.source):
                lists = mutants.around(name, "lists", outward=mutants.as_lists)
                space.update(lists.wrap({name: space[name]}))

    _run(notebooks.read_source(lesson), written_as_lists)


def test_recorded_results_carry_through_the_lesson(lesson: str):
    def stuck(cell: Any, space: dict[str, Any]) -> None:
        """A student who wrote nothing, and ran each check in vain."""
        in_vain = notebooks.grader(cell).get("grade", False)
        with contextlib.suppress(NotImplementedError) if in_vain else contextlib.nullcontext():
            mutants.cells.run_cell(STAND_IN.sub(r"\1", cell.source), f"<{cell.id}>", space)

    _run(notebooks.read_copy(lesson), stuck)


def _run(notebook: Any, run_cell: Any) -> None:
    space: dict[str, Any] = {"__name__": "__main__", "display": lambda *shown: None}
    for cell in notebook.cells:
        if cell.cell_type == "code":
            with mutants.silence(), contextlib.suppress(SystemExit):
                run_cell(cell, space)
