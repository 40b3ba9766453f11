"""What students get: a folder where their work is safe, and a zip that works and answers nothing."""

from __future__ import annotations

import functools
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from types import ModuleType

import nbformat
import notebooks
import pytest

from cdprlab.course.handing_out import hand_out as copy_lessons


def tool(path: Path) -> ModuleType:
    """A script of lessons/, which is no part of the package."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


# --- my_lessons -------------------------------------------------------------------------------------------
@pytest.fixture
def lessons(tmp_path: Path) -> Path:
    """A course of two lessons."""
    folder = tmp_path / "lessons"
    folder.mkdir()
    for name in ("00_a", "01_b"):
        (folder / f"{name}.ipynb").write_text("old\n")
    (folder / "nbgrader_config.py").write_text("")
    return folder


@pytest.fixture
def hand_out(lessons: Path, tmp_path: Path):
    """``hand_out()`` copies into ``hand_out.mine``."""
    def copy() -> list[str]:
        return copy_lessons(copy.mine, sorted(lessons.glob("*.ipynb")))
    copy.mine = tmp_path / "mine"
    return copy


def test_the_first_time_every_lesson_is_copied(hand_out):
    assert len(hand_out()) == 2
    assert sorted(path.name for path in hand_out.mine.glob("[!.]*")) == ["00_a.ipynb", "01_b.ipynb"]
    assert hand_out() == []


def test_work_is_never_overwritten(hand_out, lessons: Path):
    hand_out()
    mine = hand_out.mine / "00_a.ipynb"
    mine.write_text("old, with my answers\n")
    assert hand_out() == []
    (lessons / "00_a.ipynb").write_text("new\n")
    for _ in range(2):  # said as long as it is so
        (line,) = hand_out()
        assert "newer" in line and "00_a" in line
        assert mine.read_text() == "old, with my answers\n"
    mine.rename(hand_out.mine / "00_a_mine.ipynb")
    hand_out()
    assert mine.read_text() == "new\n"
    assert (hand_out.mine / "00_a_mine.ipynb").read_text() == "old, with my answers\n"


def test_a_lesson_nobody_touched_is_renewed(hand_out, lessons: Path):
    hand_out()
    (lessons / "01_b.ipynb").write_text("new\n")
    (line,) = hand_out()
    assert "01_b" in line and (hand_out.mine / "01_b.ipynb").read_text() == "new\n"


@pytest.mark.parametrize("spoiled", [None, "", "[1]", '{"00_a.ipynb": "'])
def test_without_its_record_all_that_differs_is_work(hand_out, spoiled: str | None):
    hand_out()
    record = hand_out.mine / ".handed_out.json"
    record.unlink() if spoiled is None else record.write_text(spoiled)
    (hand_out.mine / "00_a.ipynb").write_text("mine\n")
    (line,) = hand_out()
    assert "00_a" in line and (hand_out.mine / "00_a.ipynb").read_text() == "mine\n"


# --- the students' zip ------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The zip, unpacked."""
    work = tmp_path_factory.mktemp("zip")
    tool(notebooks.SOURCE / "student_zip.py").write(work / "students.zip")
    with zipfile.ZipFile(work / "students.zip") as archive:
        assert {name.split("/")[0] for name in archive.namelist()} == {"cdprlab"}
        archive.extractall(work)
    return work / "cdprlab"


def test_the_zip_holds_what_students_need_and_no_more(unpacked: Path):
    held = {path.relative_to(unpacked).as_posix() for path in unpacked.rglob("*") if path.is_file()}
    for needed in ("README.md", "LICENSE", "Makefile", "pyproject.toml", "requirements.txt", "worlds/caroca.yaml",
                   "cdprlab/__init__.py", "cdprlab/py.typed", "environment.yml"):
        assert needed in held
    lessons = {path for path in held if path.endswith(".ipynb") and not path.startswith("cdprlab/")}
    assert lessons == {f"lessons/{name}.ipynb" for name in notebooks.names()}
    assert [path for path in held if "source" in path or "test" in path or "wrong" in path or "nbgrader" in path] == []


def test_the_zip_answers_nothing(unpacked: Path):
    text = {path: path.read_bytes() for path in unpacked.rglob("*") if path.is_file()}
    for marker in (b"BEGIN SOLUTION", b"BEGIN HIDDEN TESTS", b"WRONG_ANSWERS"):
        assert [path for path, content in text.items() if marker in content] == []
    for name in notebooks.names():
        source, held = notebooks.read_source(name), (unpacked / f"lessons/{name}.ipynb").read_bytes()
        assert held == (notebooks.LESSONS / f"{name}.ipynb").read_bytes()
        copied = "\n".join(cell.source for cell in notebooks.read_copy(name).cells)
        for index in notebooks.answers(source).values():
            solution = source.cells[index].source.split("### BEGIN SOLUTION\n")[1].split("### END SOLUTION")[0]
            assert solution.strip() not in copied


def test_no_file_holds_a_solution_or_a_hidden_test(unpacked: Path):
    """Neither lessons nor package: the wheel is made of the same files."""
    include = tomllib.loads((unpacked / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]["build"]
    assert include["targets"]["wheel"]["include"] == ["/cdprlab", "/worlds/*.yaml", "/lessons/*.ipynb"]
    held = {}
    for path in [*(unpacked / "cdprlab").rglob("*"), *(unpacked / "lessons").glob("*.ipynb")]:
        if path.suffix == ".ipynb":
            held[path] = "\n".join(cell.source for cell in nbformat.read(path, as_version=4).cells)
        elif path.is_file():
            held[path] = path.read_bytes().decode(errors="replace")
    secrets = [secret for name in notebooks.names() for cell in notebooks.read_source(name).cells
               for secret in re.findall(r"### BEGIN (?:SOLUTION|HIDDEN TESTS)\n(.*?)### END", cell.source, re.DOTALL)]
    assert len(secrets) > 80
    for secret in secrets:
        words = "".join(secret.split())   # however it is indented
        if len(words) > 60:               # shorter ones are formulas that stand in every book
            assert [path for path, text in held.items() if words in squeezed(text)] == []


@functools.cache
def squeezed(text: str) -> str:
    return "".join(text.split())


@pytest.mark.long
def test_what_was_unpacked_installs_and_flies_where_nothing_can_be_written(unpacked: Path, tmp_path: Path):
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    site, home = tmp_path / "site", tmp_path / "home"
    home.mkdir()
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--no-build-isolation",
           "--disable-pip-version-check", "--target", str(site), str(unpacked)]
    done = subprocess.run(pip, capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, done.stderr
    lesson = notebooks.read_source("00_first_flight")
    code = "\n".join(cell.source for cell in lesson.cells if cell.cell_type == "code")
    (tmp_path / "lesson.py").write_text(f"{code}\nprint(cl.__file__)\n", encoding="utf-8")
    before = sorted(site.rglob("*"))
    for path in [site, *before]:
        path.chmod(path.stat().st_mode & 0o555)
    done = subprocess.run([*_without_powers(), sys.executable, "-W", "error", str(tmp_path / "lesson.py")], cwd=home,
                          capture_output=True, text=True, timeout=250,
                          env={"PATH": os.environ["PATH"], "HOME": str(home), "PYTHONPATH": str(site),
                               "MPLBACKEND": "Agg", "OMP_NUM_THREADS": "1"})
    after = sorted(site.rglob("*"))
    for path in [site, *after]:  # so that it can be removed again
        path.chmod(path.stat().st_mode | 0o200)
    assert done.returncode == 0, done.stderr
    assert Path(done.stdout.splitlines()[-1]).is_relative_to(site)
    assert done.stdout.count(" is right: ") == 3
    assert after == before


def _without_powers() -> list[str]:
    """What makes root obey file permissions too."""
    if os.getuid() != 0:
        return []
    if shutil.which("setpriv") is None:
        pytest.skip("root writes everywhere, and setpriv is not installed")
    return ["setpriv", "--bounding-set=-all", "--inh-caps=-all"]
