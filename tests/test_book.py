"""The book: it builds without a warning, every link leads somewhere, it answers no exercise, it needs no network."""

from __future__ import annotations

import doctest
import html
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType

import notebooks
import pytest
from matplotlib.figure import Figure

import cdprlab
from cdprlab.course.shown import describe

BOOK = notebooks.CHECKOUT / "docs" / "book"
RUN = "00_first_flight"
"""The one lesson that is executed here, where its engine is; `make book` executes all."""
FLIES = importlib.util.find_spec("pybullet") is not None


def tool(name: str) -> ModuleType:
    """A script of docs/book/, which is no part of the package."""
    spec = importlib.util.spec_from_file_location(name, BOOK / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The book with one lesson executed, as `make book` makes it: warnings are errors."""
    place = tmp_path_factory.mktemp("book") / "site"
    done = subprocess.run([sys.executable, str(BOOK / "build.py"), "--run", RUN if FLIES else "none",
                           "--out", str(place)], capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert str(place / "index.html") in done.stdout
    return place


class _Words(HTMLParser):
    """The text of a page; pygments puts marks between any two words."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.text = ""
        self.feed(page.read_text(encoding="utf-8"))

    def handle_data(self, data: str) -> None:
        self.text += data


# --- what is in it ----------------------------------------------------------------------------------------
def test_everything_has_a_page(site: Path):
    there = {path.relative_to(site).as_posix() for path in site.rglob("*.html")}
    pages = {f"docs/{path.stem}.html" for path in (notebooks.CHECKOUT / "docs").glob("*.md")}
    assert {f"lessons/{name}.html" for name in notebooks.names()} | pages <= there
    front = (site / "index.html").read_text(encoding="utf-8")
    assert [page for page in sorted(pages) if f'href="{page}"' not in front] == []


def test_every_public_name_is_documented_once(site: Path):
    pages = "".join(path.read_text(encoding="utf-8") for path in sorted((site / "api").glob("*.html")))
    counts = {name: len(re.findall(rf'<dt [^>]*id="cdprlab\.{name}"', pages)) for name in cdprlab.__all__
              if name not in ("errors", "CdprError")}
    counts["CdprError"] = pages.count('id="cdprlab.errors.CdprError"')
    assert {name: count for name, count in counts.items() if count != 1} == {}


def test_a_docstring_keeps_its_formulas_shapes_and_units(site: Path):
    words = " ".join(_Words(site / "api" / "mechanics.html").text.split())
    for said in ("so that equilibrium reads W τ + w_e = 0.", "axial_stiffness : EA, a number or (m,) [N]",
                 ">>> stiffness(robot, pose, np.full(8, 400.0), 1e5).shape (6, 6)"):
        assert said in words


def test_the_form_of_docstrings_is_understood():
    docstrings = tool("docstrings")
    results = doctest.testmod(docstrings)
    assert results.attempted >= 2 and results.failed == 0
    assert [line for line in docstrings.as_rst("""One line, |x| ≤ 1,
that goes on.

a : 3 b; c, d_e : ``a`` or
    more [m]
But not both.
Returns a pair, and so
on.
Raises Wrong.

>>> 1
1
""") if line] == ["One line, \\|x\\| ≤ 1, that goes on.",
                  ":Arguments:", "   **a** : 3 b", "   **c, d_e** : ``a`` or more [m]", "But not both.",
                  ":Returns: a pair, and so on.", ":Raises: Wrong.", ">>> 1\n1"]


@pytest.mark.skipif(not FLIES, reason="PyBullet has no wheel here")
def test_an_executed_lesson_shows_numbers_pictures_and_explorers(site: Path):
    page = html.unescape((site / "lessons" / f"{RUN}.html").read_text(encoding="utf-8"))
    words = _Words(site / "lessons" / f"{RUN}.html").text
    assert words.count(" is right: ") == 2 * 3   # in the checks' code and in what they print
    assert "Set to x [m] 0.9" in words and "hardest pull" in words   # an explorer, its sliders and its numbers
    assert "colored by tension" in page and "tracking error, largest" in words   # the player
    assert len(re.findall(r'<img [^>]*src="\.\./_images/00_first_flight-', page)) >= 6
    assert [mark for mark in ("Traceback", "HBox(", "VBox(", "<Figure size", "widget-view") if mark in page] == []


def test_a_figure_says_in_words_what_it_shows():
    figure = Figure()
    left, right = figure.subplots(1, 2)
    left.set(title="Two ways", xlabel="time [s]", ylabel=r"$\\tau_\\mathrm{min}$ [N]")
    left.plot([0, 1], [0, 1], label="measured")
    left.legend()
    right.axis("off")
    figure.colorbar(left.scatter([0], [0], c=[1.0]), ax=right, label="margin [N]")
    assert describe(figure) == "Two ways: τ_min [N] against time [s] (shown: measured); colors: margin [N]"
    assert describe(Figure()) == "Drawing without axes"


def test_each_lesson_can_be_taken_home(site: Path):
    taken = {path.name: path.read_bytes() for path in (site / "_downloads").rglob("*.ipynb")}
    assert taken == {f"{name}.ipynb": (notebooks.LESSONS / f"{name}.ipynb").read_bytes()
                     for name in notebooks.names()}


# --- what is not ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", notebooks.names())
def test_no_page_answers_an_exercise(site: Path, name: str):
    source = "\n".join(cell.source for cell in notebooks.read_source(name).cells)
    copy = "\n".join(cell.source for cell in notebooks.read_copy(name).cells)
    secret = re.findall(r"### BEGIN (?:SOLUTION|HIDDEN TESTS)\n(.*?)### END", source, re.DOTALL)
    lines = {line.strip() for part in secret for line in part.splitlines()}
    long = [line for line in lines if len(line) > 25 and line not in copy]   # what students have is no secret
    assert len(long) >= 5
    words = _Words(site / "lessons" / f"{name}.html").text
    assert [line for line in long if line in words] == []
    assert [page.name for page in site.rglob("*") if page.is_file() and b"BEGIN SOLUTION" in page.read_bytes()] == []


def test_the_site_is_whole(site: Path):
    assert tool("site_check").faults(site) == []


@pytest.mark.parametrize(("body", "fault"), [
    ('<a href="nowhere.html">x</a>', "points at nowhere.html"),
    ('<a href="other.html#nothing">x</a>', "points at other.html#nothing"),
    ('<a href="../outside.html">x</a>', "points at ../outside.html"),
    ('<a href="#nothing">x</a>', "points at #nothing"),
    ('<img src="there.png">', "without alternative text"),
    ('<img src="there.png" alt=" ">', "without alternative text"),
    ('<img src="gone.png" alt="a robot">', "loads gone.png"),
    ('<img src="https://example.org/a.png" alt="a robot">', "loads https://example.org/a.png"),
    ('<script src="//example.org/a.js"></script>', "loads //example.org/a.js"),
    ('<link rel="stylesheet" href="http://example.org/a.css">', "loads http://example.org/a.css"),
    ('<link rel="stylesheet" href="faulty.css">', "faulty.css loads https://example.org/font.woff"),
])
def test_the_check_sees_what_is_wrong(tmp_path: Path, body: str, fault: str):
    site = tmp_path / "site"
    site.mkdir()
    (tmp_path / "outside.html").write_text("")
    (site / "other.html").write_text('<p id="this"></p>')
    (site / "there.png").write_bytes(b"")
    if "faulty" in body:
        (site / "faulty.css").write_text("@font-face {src: url('https://example.org/font.woff')}")
    (site / "good.html").write_text('<a href="other.html#this">x</a><img src="there.png" alt="x"><a href="https://a.b">')
    check = tool("site_check")
    assert check.faults(site) == [] or "faulty" in body
    (site / "page.html").write_text(body)
    (found,) = check.faults(site)
    assert fault in found


# --- without a network ------------------------------------------------------------------------------------
def test_formulas_are_drawn_by_what_the_site_brings(site: Path):
    chromium = shutil.which("chromium")
    if chromium is None:
        assert os.environ.get("CI") != "true", "chromium is missing; .ci/run installs it"
        pytest.skip("chromium is not installed")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, headless=True,
                                             args=["--headless=new", "--no-sandbox", "--disable-gpu"],
                                             ignore_default_args=["--headless"])
        page = browser.new_page()
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto((site / "lessons" / "04_tension_distribution.html").as_uri())
        page.wait_for_function("window.MathJax && MathJax.isReady && MathJax.Hub.queue.pending === 0", timeout=60_000)
        formulas, drawn = (page.locator(f"article .math{kind}").count() for kind in (":not(.MathJax *)", " .MathJax"))
        mistakes = page.locator(".merror, .MathJax_Error, .noError").count()
        browser.close()
    assert [url for url in asked if not url.startswith(("file:", "data:", "about:"))] == []
    assert formulas > 50 and drawn == formulas and mistakes == 0
