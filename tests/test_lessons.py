"""Every lesson: its form, full marks for its solutions, none for an untouched copy or for planted mistakes."""

from __future__ import annotations

import base64
import copy
import importlib.util
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat
import notebooks
import pytest
from nbgrader.nbgraderformat import MetadataValidator
from nbgrader.utils import determine_grade

NAMES = notebooks.names()
METADATA = {"kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
            "language_info": {"name": "python"}}
KEBAB = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
LINK = re.compile(r"\]\(([\w/.-]+\.ipynb)\)")
NO_VERDICT = ("NameError", "SyntaxError", "NotImplementedError")
MARKERS = ("BEGIN SOLUTION", "END SOLUTION", "BEGIN HIDDEN", "END HIDDEN")

ANSI = re.compile(r"\x1b\[[0-9;]*m")
every_lesson = pytest.mark.parametrize("name", NAMES)


def _has_engine() -> bool:
    try:
        return importlib.util.find_spec("pybullet") is not None
    except ValueError:  # blocked on purpose
        return False


flies = pytest.mark.skipif(not _has_engine(), reason="PyBullet has no wheel here")


@dataclass(frozen=True)
class Flight:
    """A lesson's source after it ran in a fresh kernel, and what its planted mistakes came to."""

    notebook: Any
    mistakes: list[tuple[str, str, Any, Any]]  # answer's grade_id, what is wrong, its cell, its check


@pytest.fixture(scope="module")
def flight(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Flight]:
    """One kernel a lesson: the solved cells in order, then each wrong answer with its check, then the right one."""
    name = request.param
    notebook = notebooks.read_source(name)
    with notebooks.kernel(notebook, tmp_path_factory.mktemp(name)) as client:
        notebooks.execute(client)
        yield Flight(notebook, list(_plant(client, notebook, notebooks.wrong_answers(name))))


def _plant(client: Any, notebook: Any, wrong: dict[str, list[tuple[str, str]]]) -> Iterator[tuple[str, str, Any, Any]]:
    answers, checks = notebooks.answers(notebook), notebooks.checks(notebook)
    for answer, mistakes in wrong.items():
        right, check = notebook.cells[answers[answer]], notebook.cells[checks[notebooks.check_of(answer)]]
        for what, code in mistakes:
            planted, tried = copy.deepcopy(right), copy.deepcopy(check)
            planted.source = code
            for cell in (planted, tried):
                client.execute_cell(cell, 0)
            yield answer, what, planted, tried
        client.execute_cell(copy.deepcopy(right), 0)


every_flight = pytest.mark.parametrize("flight", NAMES, indirect=True, scope="module")


# --- what it earns ----------------------------------------------------------------------------------------
@flies
@every_flight
def test_solutions_run_without_a_word_on_stderr(flight: Flight):
    assert notebooks.complaints(flight.notebook) == []
    assert notebooks.noise(flight.notebook) == ""


@flies
@every_flight
def test_widgets_swallow_no_error(flight: Flight):
    assert notebooks.swallowed(flight.notebook) == []
    assert notebooks.alerts(flight.notebook) == []


@flies
@every_flight
def test_what_is_shown_can_be_shown_on_a_page(flight: Flight):
    """The book, which is still, knows text, pictures, and explorers by their text; docs/book/lesson_page.py."""
    kinds = {tuple(sorted(output.data)) for cell in flight.notebook.cells for output in cell.get("outputs", [])
             if "data" in output}
    assert kinds <= {("text/plain",), ("image/png", "text/html", "text/plain"),
                     ("application/vnd.jupyter.widget-view+json", "text/plain")}


@flies
@every_flight
def test_every_figure_has_alternative_text_in_the_notebook_too(flight: Flight):
    shown = [output.data["text/html"] for cell in flight.notebook.cells for output in cell.get("outputs", [])
             if "image/png" in output.get("data", {})]
    assert shown and all(re.search(r' alt="[^"$]{8,}"', picture) for picture in shown)


@flies
@every_flight
def test_solutions_earn_full_marks(flight: Flight):
    graded = {check: flight.notebook.cells[index] for check, index in notebooks.checks(flight.notebook).items()}
    assert {check: determine_grade(cell) for check, cell in graded.items()} == {
        check: (notebooks.grader(cell)["points"],) * 2 for check, cell in graded.items()}
    said = {check: [output.text.strip() for output in cell.outputs] for check, cell in graded.items()}
    assert [check for check, lines in said.items() if len("\n".join(lines).splitlines()) != 1] == [], said


@flies
@every_flight
def test_wrong_answers_earn_nothing(flight: Flight):
    for answer, what, planted, check in flight.mistakes:
        assert notebooks.errors(planted) == [], f"{answer}, {what}: the wrong answer itself must run"
        assert determine_grade(check)[0] == 0, f"{answer}, {what}: earns points"
        (error,) = notebooks.errors(check)
        assert notebooks.root_cause(error) not in NO_VERDICT, f"{answer}, {what}"
        assert error.evalue.strip(), f"{answer}, {what}: the check fails without a message"


@flies
@every_flight
def test_students_own_checks_notice_wrong_answers(flight: Flight):
    passed = [what for _, what, _, check in flight.mistakes if _failing_line(check) > _hidden_from(check)]
    assert passed == [], "a student's copy, which has no hidden checks, would call these right"


def _failing_line(check: Any) -> int:
    """Where in its cell a check failed, counted from 1."""
    (error,) = notebooks.errors(check)
    told = ANSI.sub("", "\n".join(error.traceback))
    return int(re.findall(r"(?:Cell In\[\d+\], |\()line (\d+)(?: of the check\))?", told)[0])


def _hidden_from(check: Any) -> int:
    return check.source[:check.source.index("### BEGIN HIDDEN TESTS")].count("\n") + 1


@flies
@pytest.mark.parametrize(
    "name", [name if k % 8 == 0 else pytest.param(name, marks=pytest.mark.long) for k, name in enumerate(NAMES)])
def test_untouched_copies_earn_nothing_because_nothing_was_done(name: str, tmp_path: Path):
    notebook = notebooks.read_copy(name)
    with notebooks.kernel(notebook, tmp_path) as client:
        notebooks.execute(client)
    assert {check: determine_grade(notebook.cells[index])[0] for check, index in notebooks.checks(notebook).items()
            } == dict.fromkeys(notebooks.checks(notebook), 0)
    seen = [error for cell in notebook.cells for error in notebooks.errors(cell)] + notebooks.swallowed(notebook)
    assert {notebooks.root_cause(error) for error in seen} == {"NotImplementedError"}, notebooks.complaints(notebook)


# --- its form ---------------------------------------------------------------------------------------------
@every_lesson
def test_copies_are_current(name: str):
    path = notebooks.LESSONS / f"{name}.ipynb"
    made = notebooks.release_tool().student_copy(notebooks.SOURCE / name / f"{name}.ipynb")
    assert path.is_file() and path.read_text(encoding="utf-8") == made, "run `make lessons` and commit what it wrote"


def test_every_copy_has_its_source():
    assert {path.stem for path in notebooks.LESSONS.glob("*.ipynb")} <= set(NAMES)


@every_lesson
def test_sources_are_clean(name: str):
    notebook, path = notebooks.read_source(name), notebooks.SOURCE / name / f"{name}.ipynb"
    MetadataValidator().validate_nb(notebook)
    assert path.read_text(encoding="utf-8") == notebooks.release_tool().as_text(notebook)
    assert (notebook.nbformat, notebook.nbformat_minor) == (4, 5)
    assert notebook.metadata == METADATA
    assert len(notebook.cells) <= 30
    for cell in notebook.cells:
        assert KEBAB.fullmatch(cell.id), cell.id
        assert set(cell.metadata) <= {"nbgrader", "tags", "jupyter"}, f"{cell.id}: {dict(cell.metadata)}"
        assert cell.cell_type != "code" or (cell.outputs == [] and cell.execution_count is None), cell.id
    assert len({cell.id for cell in notebook.cells}) == len(notebook.cells)


@every_lesson
def test_copies_hold_no_solution(name: str):
    copied = notebooks.read_copy(name)
    text = nbformat.writes(copied)
    assert [marker for marker in MARKERS if marker in text] == []
    for index in notebooks.answers(copied).values():
        assert "raise NotImplementedError" in copied.cells[index].source


@every_lesson
def test_lessons_are_short_and_their_lines_narrow(name: str):
    """As JupyterLab shows them beside its file browser; checks are folded."""
    notebook, words, lines = notebooks.read_source(name), 0, 0
    for cell in notebook.cells:
        folded = cell.metadata.get("jupyter", {}).get("source_hidden", False)
        if cell.cell_type == "markdown":
            words += len(notebooks.read_by_all(cell.source).split())
            continue
        assert [line for line in cell.source.splitlines() if len(line) > 96] == [], cell.id
        assert folded or not notebooks.grader(cell).get("grade"), cell.id
        lines += 0 if folded or notebooks.grader(cell).get("grade") else notebooks.code_lines(cell.source)
    assert words <= 2600 and lines <= 200


@flies
@every_flight
def test_printed_lines_are_narrow(flight: Flight):
    printed = [line for cell in flight.notebook.cells for output in cell.get("outputs", [])
               if output.output_type == "stream" for line in output.text.splitlines()]
    assert [line for line in printed if len(line) > 95] == []


@every_lesson
def test_every_answer_has_a_check_and_planted_mistakes(name: str):
    notebook = notebooks.read_source(name)
    answers, checks, wrong = notebooks.answers(notebook), notebooks.checks(notebook), notebooks.wrong_answers(name)
    assert 1 <= len(answers) <= 5
    assert {notebooks.check_of(answer) for answer in answers} == set(checks)
    assert set(wrong) == set(answers)
    assert [answer for answer, mistakes in wrong.items() if len(mistakes) < 2] == []
    for answer, index in answers.items():
        check = notebook.cells[checks[notebooks.check_of(answer)]]
        assert "### BEGIN SOLUTION" in notebook.cells[index].source and '"""' in notebook.cells[index].source
        assert "### BEGIN HIDDEN TESTS" in check.source and notebooks.grader(check)["points"] > 0


@every_lesson
def test_the_first_cell_says_what_for_how_long_and_shows_a_picture(name: str):
    title = notebooks.read_source(name).cells[0]
    assert title.source.startswith("# ")
    assert "You will be able to" in title.source
    (minutes,) = re.findall(r"(\d+) minutes", title.source)
    assert int(minutes) <= 120  # as honest as long
    ((words, file),) = re.findall(r"!\[([^\]]*)\]\(attachment:([\w.-]+)\)", title.source)
    assert len(words.split()) >= 8, "alt text says what is seen"
    picture = base64.b64decode(title.attachments[file]["image/png"])
    assert picture.startswith(b"\x89PNG") and len(picture) <= 60_000


@every_lesson
def test_links_between_lessons_lead_somewhere(name: str):
    links = {link for cell in notebooks.read_source(name).cells if cell.cell_type == "markdown"
             for link in LINK.findall(cell.source)}
    assert [link for link in links if not (notebooks.LESSONS / link).is_file()] == []
    # The last lesson has no next one.
    assert name == NAMES[-1] or links, "every lesson names the next"


# --- without the spatial engine ---------------------------------------------------------------------------
@pytest.mark.long
@every_lesson
def test_without_the_spatial_engine_only_flights_fail_and_the_first_cell_says_so(name: str, tmp_path: Path,
                                                                                 monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "sitecustomize.py").write_text("import sys\nsys.modules['pybullet'] = None\n", encoding="utf-8")
    usual = notebooks.environment(tmp_path)
    there = {**usual, "PYTHONPATH": f"{usual['PYTHONPATH']}{os.pathsep}{tmp_path}"}
    monkeypatch.setattr(notebooks, "environment", lambda folder: there)
    notebook = notebooks.read_source(name)
    with notebooks.kernel(notebook, tmp_path) as client:
        notebooks.execute(client)
    failed = [notebooks.errors(cell)[0] for cell in notebook.cells if notebooks.errors(cell)]
    assert ("**Engine:** PyBullet" in notebook.cells[0].source) == bool(failed)
    # A name is missing only where the flight that makes it could not be made.
    assert [error.ename for error in failed[:1]] in ([], ["MissingDependency"])
    assert {error.ename for error in failed} <= {"MissingDependency", "NameError"}
