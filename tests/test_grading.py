"""The instructors' page, command by command: a course of one lesson, one student who solved it, one who did not."""

from __future__ import annotations

import csv
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import notebooks
import pytest

PAGE = notebooks.CHECKOUT / "docs" / "instructors.md"
LESSON = "00_first_flight"


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The home folder of an instructor who typed the whole page."""
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    if shutil.which("bash") is None:
        pytest.skip("the page's commands are for bash")
    folder = tmp_path_factory.mktemp("home")
    (folder / "submissions").mkdir()
    nbformat.write(_solved(), folder / "submissions" / "ada.ipynb")
    shutil.copy(notebooks.LESSONS / f"{LESSON}.ipynb", folder / "submissions" / "ben.ipynb")
    commands = re.findall(r"^```sh\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    tools = {"HOME": str(folder), "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", "".join(commands)], cwd=notebooks.CHECKOUT, timeout=250,
                          capture_output=True, text=True, env={**notebooks.environment(folder), **tools})
    assert done.returncode == 0, done.stderr[-3000:]
    return folder


def _solved():
    """A student's copy with the answers filled in."""
    copy, source = notebooks.read_copy(LESSON), notebooks.read_source(LESSON)
    for answer, index in notebooks.answers(copy).items():
        copy.cells[index].source = source.cells[notebooks.answers(source)[answer]].source
    return copy


def test_what_is_released_is_what_is_committed(home: Path):
    released = home / "course" / "release" / LESSON / f"{LESSON}.ipynb"
    assert nbformat.read(released, 4) == notebooks.read_copy(LESSON)


def test_the_table_of_grades(home: Path):
    with (home / "course" / "grades.csv").open(newline="", encoding="utf-8") as table:
        rows = {row["student_id"]: row for row in csv.DictReader(table)}
    most = sum(notebooks.grader(cell).get("points", 0) for cell in notebooks.read_source(LESSON).cells)
    assert {name: float(row["score"]) for name, row in rows.items()} == {"ada": most, "ben": 0.0}
    assert {float(row["max_score"]) for row in rows.values()} == {most}


def test_everyone_gets_feedback(home: Path):
    assert {path.parents[1].name for path in (home / "course" / "feedback").rglob("*.html")} == {"ada", "ben"}
