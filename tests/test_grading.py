"""The instructors' page, command by command: a course of one lesson, one student who solved it, one who did not."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from dataclasses import asdict
from pathlib import Path

import nbformat
import notebooks
import pytest
from nbgrader.api import Gradebook
from test_grade import attack_table

from cdprlab.course.grading import Result
from cdprlab.course.grading.jail import find_jail
from cdprlab.course.grading.judge import Outcome
from cdprlab.errors import InvalidInput

PAGE = notebooks.CHECKOUT / "docs" / "instructors.md"
LESSON = "00_first_flight"
COMMANDS = "".join(re.findall(r"^```sh\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
                   ).splitlines()


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The home folder of an instructor who typed the whole page."""
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    if shutil.which("bash") is None:
        pytest.skip("the page's commands are for bash")
    folder = tmp_path_factory.mktemp("home")
    (folder / "submissions" / "ada").mkdir(parents=True)
    nbformat.write(_solved(), folder / "submissions" / "ada" / f"{LESSON}.ipynb")
    shutil.copy(notebooks.LESSONS / f"{LESSON}.ipynb", folder / "submissions" / "ben.ipynb")
    tools = {"HOME": str(folder), "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    trust = "" if command_is_jailed() else " --trust"
    commands = [line + trust * (" grade " in line) for line in COMMANDS]
    commands.insert(1, "printf 'student\\nada\\nben\\ncyd\\n' > ~/course/roster.csv")
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", "\n".join(commands)], cwd=notebooks.CHECKOUT, timeout=250,
                          capture_output=True, text=True, env={**notebooks.environment(folder), **tools})
    assert done.returncode == 0, done.stderr[-3000:]
    return folder


def command_is_jailed() -> bool:
    try:
        return bool(find_jail())
    except InvalidInput:
        return False


def _solved():
    """A student's copy with the answers filled in."""
    copy, source = notebooks.read_copy(LESSON), notebooks.read_source(LESSON)
    for answer, index in notebooks.answers(copy).items():
        copy.cells[index].source = source.cells[notebooks.answers(source)[answer]].source
    return copy


def test_ten_commands_do():
    assert len(COMMANDS) <= 10


def test_the_table_of_grades(home: Path):
    with (home / "course" / "grades" / "grades.csv").open(newline="", encoding="utf-8") as table:
        rows = {row["student"]: row for row in csv.DictReader(table)}
    most = sum(notebooks.grader(cell).get("points", 0) for cell in notebooks.read_source(LESSON).cells)
    assert {name: float(row["points"]) for name, row in rows.items()} == {"ada": most, "ben": 0.0}
    assert {float(row["max_points"]) for row in rows.values()} == {most}


def test_everyone_gets_feedback_and_the_zip_holds_it(home: Path):
    with zipfile.ZipFile(home / "course" / "feedback.zip") as archive:
        pages = {name.split("/")[-2] for name in archive.namelist() if name.endswith(".html")}
    assert pages == {"ada", "ben"}
    assert (home / "course" / "grades" / "class.html").exists()


def test_what_students_get_answers_nothing(home: Path):
    with zipfile.ZipFile(home / "course" / "students.zip") as archive:
        assert not any("source" in name for name in archive.namelist())


def test_the_page_s_table_of_attacks_is_the_test_s():
    assert attack_table() in PAGE.read_text(encoding="utf-8")


def test_nbgraders_gradebook_is_filled(tmp_path: Path):
    result = Result("ada", LESSON, "graded", 3.0, 8.0, outcomes=[Outcome("hardest-check", 2.0, 2.0),
                                                                 Outcome("support-check", 1.0, 6.0)])
    place = tmp_path / "results" / "ada"
    place.mkdir(parents=True)
    (place / f"{LESSON}.json").write_text(json.dumps(asdict(result)))
    for _ in range(2):
        assert notebooks.source_tool("fill_gradebook").fill(tmp_path, tmp_path / "gradebook.db") == 1
    with Gradebook(f"sqlite:///{tmp_path / 'gradebook.db'}") as book:
        handed_in = book.find_submission(LESSON, "ada")
        assert (handed_in.score, handed_in.max_score, handed_in.needs_manual_grade) == (3.0, 8.0, False)
