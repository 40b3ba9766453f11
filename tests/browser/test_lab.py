"""Lessons in a real browser: JupyterLab opens them, runs them, and their sliders move picture and numbers.

Needs Debian's chromium and playwright; pictures of what was seen are left in out/browser/.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import notebooks
import pytest

import cdprlab as cl
from cdprlab.view.scene import MotionScene

TOKEN = "tested-here-only"
SEEN = notebooks.CHECKOUT / "out" / "browser"
LESSONS = notebooks.names()
OPTIONS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader",
           "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"]
SETTINGS = {
    # All cells are in the page, however far down.
    "@jupyterlab/notebook-extension/tracker": {"windowingMode": "none"},
}


def _missing(what: str) -> None:
    """Skips; where CI=true promises a browser it fails."""
    if os.environ.get("CI") == "true":
        pytest.fail(f"{what} is missing; .ci/run installs it")
    pytest.skip(f"{what} is not installed")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Chromium without a window."""
    chromium = shutil.which("chromium")
    if chromium is None:
        _missing("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        _missing("playwright")
    with sync_playwright() as playwright:
        # The options name the headless mode; playwright's own would ask for the old one.
        browser = playwright.chromium.launch(executable_path=chromium, args=OPTIONS, headless=True,
                                             ignore_default_args=["--headless"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a JupyterLab of our own, with the solved lessons."""
    home = tmp_path_factory.mktemp("lab")
    lessons, settings = home / "lessons", home / "settings"
    lessons.mkdir()
    for name in LESSONS:
        shutil.copy(notebooks.SOURCE / name / f"{name}.ipynb", lessons)
    for plugin, values in SETTINGS.items():
        path = settings / f"{plugin}.jupyterlab-settings"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(values), encoding="utf-8")
    own = {name: str(home / name.lower()) for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR",
                                                       "JUPYTERLAB_WORKSPACES_DIR")}
    port = _free_port()
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", f"--port={port}", "--ServerApp.port_retries=0",
               f"--IdentityProvider.token={TOKEN}", f"--ServerApp.root_dir={lessons}", "--allow-root"]
    with (home / "log").open("wb") as log:
        server = subprocess.Popen(command, cwd=lessons, stdout=log, stderr=subprocess.STDOUT,
                                  env={**notebooks.environment(home), **own, "JUPYTERLAB_SETTINGS_DIR": str(settings)})
    address = f"http://127.0.0.1:{port}"
    try:
        _wait_for(address, server, home / "log")
        yield address
    finally:
        server.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            server.wait(20)
        server.kill()


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _wait_for(address: str, server: subprocess.Popen[bytes], log: Path) -> None:
    for _ in range(240):
        with contextlib.suppress(urllib.error.URLError, ConnectionError, TimeoutError), \
                urllib.request.urlopen(f"{address}/api?token={TOKEN}", timeout=5):
            return
        if server.poll() is not None:
            break
        time.sleep(0.25)
    pytest.fail(f"JupyterLab did not start:\n{log.read_text()[-2000:]}")


@pytest.fixture(scope="module")
def lesson(request: pytest.FixtureRequest, browser: Any, lab: str) -> Iterator[Any]:
    """A page with a lesson after Run > Run All Cells."""
    name = request.param
    page = browser.new_page(viewport={"width": 1280, "height": 800})   # a common laptop, file browser open
    page.set_default_timeout(60_000)
    page.sent = []   # what goes to the kernel
    page.on("websocket", lambda socket: socket.on("framesent", lambda frame: page.sent.append(frame)))
    try:
        _run_all(page, f"{lab}/lab/tree/{name}.ipynb?token={TOKEN}&reset")
        for asked in page.locator(".cdprlab-predicted").all():
            _predict(page, asked)
        yield page
    finally:
        _picture_of_all(page, name)
        page.close()


def _run_all(page: Any, address: str) -> None:
    page.goto(address)
    page.locator(".jp-Notebook").wait_for()
    page.get_by_text("Python 3 (ipykernel) | Idle").wait_for()  # cells that are run before that are passed over
    page.get_by_role("menuitem", name="Run", exact=True).click()
    page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
    rests = 0
    for _ in range(180):
        page.wait_for_timeout(1000)
        prompts = page.locator(".jp-CodeCell .jp-InputPrompt").all_inner_texts()
        idle = page.get_by_text("Python 3 (ipykernel) | Idle").is_visible()
        # A folded cell has no prompt, so the kernel must rest too; between two cells it may, for a moment.
        rests = rests + 1 if idle and "[1]:" in prompts and "[*]:" not in prompts else 0
        if rests == 2:
            return
    pytest.fail(f"the lesson did not come to its end: {prompts}")


def _predict(page: Any, asked: Any) -> None:
    """By keyboard alone: answer what is asked, and the explorer opens."""
    explorer, opens = asked.locator(".cdprlab").first, asked.locator(".cdprlab-form").get_by_role("button", name="Open")
    asked.scroll_into_view_if_needed()
    assert not explorer.is_visible() and opens.is_disabled()
    assert asked.bounding_box()["height"] <= ROOM["height"]
    for number in asked.locator(".cdprlab-form input").all():
        number.focus()
        page.keyboard.type("1.5")
    for choices in asked.locator(".cdprlab-form .widget-toggle-buttons").all():
        choices.locator("button").first.press("Enter")
    asked.locator(".cdprlab-form button:not([disabled])", has_text="Open").press("Enter")
    explorer.wait_for()
    truth = asked.locator(".cdprlab-truth").first
    truth.get_by_role("button", name="See").press("Enter")
    truth.get_by_text(", it is").wait_for()


def _picture_of_all(page: Any, name: str) -> None:
    """The whole lesson in one tall picture."""
    SEEN.mkdir(parents=True, exist_ok=True)
    height = page.evaluate("document.querySelector('.jp-WindowedPanel-outer').scrollHeight")
    page.set_viewport_size({"width": 1280, "height": min(int(height) + 150, 16_000)})
    page.evaluate("document.querySelector('.jp-WindowedPanel-outer').scrollTop = 0")
    page.wait_for_timeout(500)
    page.locator(".jp-NotebookPanel").screenshot(path=SEEN / f"{name}.png")


SAMPLE = ("00", "04")
every_lesson = pytest.mark.parametrize(
    "lesson", [name if name[:2] in SAMPLE else pytest.param(name, marks=pytest.mark.long) for name in LESSONS],
    indirect=True, scope="module")
"""In `make long` all of them; here those with the most kinds of widgets."""


@every_lesson
def test_nothing_goes_wrong(lesson: Any):
    for kind in ("error", "stderr"):
        assert lesson.locator(f"[data-mime-type='application/vnd.jupyter.{kind}']").all_inner_texts() == []
    for words in ("Click to show javascript error", "Error displaying widget"):
        assert lesson.get_by_text(words).count() == 0, words
    assert lesson.locator(".jp-OutputArea-output img").count() > 0


@every_lesson
def test_sliders_move_picture_and_numbers(lesson: Any):
    explorers = lesson.locator(".jp-OutputArea-output", has=lesson.locator(".widget-slider"))
    assert explorers.count() > 0
    for explorer in explorers.all():
        explorer.scroll_into_view_if_needed()
        before, views = _shown(explorer), explorer.locator(".view-only .noUi-handle").count()
        only_views = views == explorer.locator(".noUi-handle").count()
        _drag(lesson, explorer.locator(".noUi-handle").first)
        dragged = _changed(explorer, before, only_views)
        explorer.locator(".noUi-handle").first.press("ArrowLeft")
        _changed(explorer, dragged, only_views)
        assert explorer.get_by_role("alert").count() == 0


ROOM = {"width": 848, "height": 640}
"""Pixels that JupyterLab with its file browser leaves of 1280 x 800, toolbar and cell number taken off."""

CUT = """widget => [...widget.querySelectorAll('*')].filter(part => {
    const box = part.getBoundingClientRect(), all = widget.getBoundingClientRect();
    if (!box.width || !box.height || part.closest('.noUi-target, svg, .cdprlab-scene')) return false;
    const rolls = part.parentElement.closest('.cdprlab-fields, .cdprlab-worth');   // the designer's columns scroll
    const outside = box.right > all.right + 1 || (!rolls && box.bottom > all.bottom + 1) || box.left < all.left - 1;
    const hidden = part.scrollWidth > part.clientWidth + 1 && part.clientWidth
                   && getComputedStyle(part).overflowX != 'visible';
    if (part.tagName == 'SELECT') {
        const pen = document.createElement('canvas').getContext('2d');
        pen.font = getComputedStyle(part).font;
        if (pen.measureText(part.selectedOptions[0].text).width > part.clientWidth - 22) return true;   // its arrow
    }
    return outside || hidden;
}).map(part => part.tagName + ' ' + part.className + ': ' + (part.value || part.textContent.slice(0, 60)))"""
"""Parts of a widget that stand out of it or hide some of their own words."""


@every_lesson
def test_every_explorer_is_seen_at_once_and_whole(lesson: Any):
    """Picture, controls and numbers together; in 600 pixels stacked, and still nothing is cut."""
    for widget in lesson.locator(".cdprlab-predicted, :not(.cdprlab-predicted) > .cdprlab").all():
        widget.scroll_into_view_if_needed()
        box = widget.bounding_box()
        assert box["width"] <= ROOM["width"] and box["height"] <= ROOM["height"], box
        assert widget.evaluate(CUT) == []
        if widget.locator(".cdprlab-columns").count() == 0:
            continue   # the player, one above the other
        # The designer has its fields on the left, its pictures on the right.
        picture, beside = (widget.locator(parts).first for parts in (".cdprlab-picture, .cdprlab-fields",
                                                                     ".cdprlab-beside, .cdprlab-design"))
        assert picture.bounding_box()["x"] < beside.bounding_box()["x"]
        widget.evaluate("widget => { widget.style.width = '600px'; }")
        assert picture.bounding_box()["x"] == beside.bounding_box()["x"]
        assert widget.evaluate(CUT) == []
        widget.evaluate("widget => { widget.style.width = null; }")


@pytest.mark.parametrize("lesson", LESSONS[:1], indirect=True, scope="module")
def test_a_run_plays_without_asking_the_kernel(lesson: Any):
    """The scene moves, time and tensions with it; frame time is printed, a quiet machine's median is below 40 ms."""
    player = lesson.locator(".cdprlab", has=lesson.locator(".cdprlab-scene")).first
    player.scroll_into_view_if_needed()
    bar = player.locator(".cdprlab-play")
    bar.wait_for()
    assert not player.locator(".cdprlab-still").is_visible()
    before = player.locator("canvas").first.screenshot(), bar.locator(".cdprlab-tensions").inner_text()
    bar.get_by_label("speed").select_option("2")
    sent = len(lesson.sent)
    bar.get_by_role("button", name="play").press("Enter")
    lesson.wait_for_timeout(3000)
    assert len(lesson.sent) == sent
    after = player.locator("canvas").first.screenshot(), bar.locator(".cdprlab-tensions").inner_text()
    assert before[0] != after[0] and before[1] != after[1]
    frames = bar.evaluate("bar => bar.parentNode.cdprlabFrames.slice().sort((a, b) => a - b)")
    print(f"{len(frames)} frames, median {frames[len(frames) // 2]:.0f} ms")
    assert len(frames) > 10


NUMBERS = """() => Array.from(document.querySelectorAll('.katex-html')).map(word => word.getBoundingClientRect())
  .filter(box => box.width > 0).map(box => [box.x, box.y, box.x + box.width, box.y + box.height])"""
"""Where the cables' numbers stand in a scene, in pixels."""


def test_a_scene_shows_the_number_of_every_cable_before_it_is_touched(browser: Any, tmp_path: Path):
    """k3d left those on the right out, in a picture that is wider than high."""
    with cl.open_simulator(cl.load_world("planar_rigid")) as engine:
        (tmp_path / "scene.html").write_text(MotionScene([engine.state()]).page(), encoding="utf-8")
    page = browser.new_page(viewport={"width": 848, "height": 400})
    page.goto((tmp_path / "scene.html").as_uri())
    page.locator(".cdprlab-play").wait_for()
    page.wait_for_timeout(2000)
    boxes = page.evaluate(NUMBERS)
    page.close()
    assert len(boxes) == 4
    assert all(left >= 0 and top >= 0 and right <= 848 and bottom <= 400 for left, top, right, bottom in boxes)


@pytest.mark.parametrize("lesson", LESSONS[:1], indirect=True, scope="module")
def test_no_news_and_no_instructors_menus(lesson: Any):
    """As `pip install` of cdprlab leaves JupyterLab in its environment; one made before that needs it again."""
    menus = lesson.locator(".lm-MenuBar-itemLabel").all_inner_texts()
    assert "Kernel" in menus and "Nbgrader" not in menus
    assert lesson.get_by_text("Jupyter news").count() == 0


def _drag(page: Any, handle: Any) -> None:
    """A sixth of the slider's way to the left, or right where there is no room."""
    knob = handle.bounding_box()
    way = handle.locator("xpath=ancestor::*[contains(@class, 'noUi-target')]").bounding_box()
    x, y = knob["x"] + knob["width"] / 2, knob["y"] + knob["height"] / 2
    by = way["width"] / 6 * (-1 if x - way["x"] > way["width"] / 2 else 1)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + by, y, steps=5)
    page.mouse.up()


def _shown(explorer: Any) -> tuple[str, str]:
    """The picture's bytes, and the numbers."""
    return explorer.locator("img").first.get_attribute("src"), "\n".join(explorer.locator("pre").all_inner_texts())


def _changed(explorer: Any, before: tuple[str, str], only_views: bool) -> tuple[str, str]:
    """What is shown once picture and numbers both differ from before; looking from elsewhere changes no number."""
    for _ in range(100):
        now = _shown(explorer)
        if now[0] != before[0] and (only_views or now[1] != before[1]):
            return now
        time.sleep(0.1)
    raise AssertionError(f"picture changed: {now[0] != before[0]}, numbers changed: {now[1] != before[1]}")
