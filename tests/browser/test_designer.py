"""The robot designer as a page of its own: voilà serves it, the keyboard is enough, it fits 1280 pixels.

Needs Debian's chromium, playwright and voilà; pictures of what was seen are left in out/browser/.
"""

from __future__ import annotations

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

import pytest

CHECKOUT = Path(__file__).parents[2]
SEEN = CHECKOUT / "out" / "browser"
OPTIONS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"]


def _missing(what: str) -> None:
    """Skips; where CI=true promises a browser it fails."""
    if os.environ.get("CI") == "true":
        pytest.fail(f"{what} is missing; .ci/run installs it")
    pytest.skip(f"{what} is not installed")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a voilà of our own."""
    try:
        import voila  # noqa: F401
    except ImportError:
        _missing("voilà")
    home = tmp_path_factory.mktemp("voila")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    own = {name: str(home / name.lower()) for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR")}
    environment = {name: value for name, value in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
    command = [sys.executable, "-m", "voila", str(CHECKOUT / "cdprlab/course/designer/page.ipynb"), "--no-browser",
               f"--port={port}", "--Voila.ip=127.0.0.1"]
    with (home / "log").open("wb") as log:
        process = subprocess.Popen(command, cwd=home, stdout=log, stderr=subprocess.STDOUT,
                                   env={**environment, **own, "PYTHONPATH": str(CHECKOUT)})
        address = f"http://127.0.0.1:{port}/"
        try:
            _wait_for(address, process, home / "log")
            yield address
        finally:
            process.terminate()
            process.wait(timeout=20)


def _wait_for(address: str, process: subprocess.Popen[bytes], log: Path) -> None:
    for _ in range(120):
        if process.poll() is not None:
            break
        try:
            with urllib.request.urlopen(address + "voila/static/voila.js", timeout=2):
                return
        except urllib.error.HTTPError:
            return  # it answers
        except OSError:
            time.sleep(0.5)
    pytest.fail(f"voilà did not start:\n{log.read_text(errors='replace')[-2000:]}")


@pytest.fixture(scope="module")
def page(server: str) -> Iterator[Any]:
    """The designer's page, 1280 pixels wide, its picture drawn."""
    chromium = shutil.which("chromium")
    if chromium is None:
        _missing("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        _missing("playwright")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=OPTIONS, headless=True,
                                             ignore_default_args=["--headless"])
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(server, timeout=120_000)
        page.wait_for_selector("img[alt*='robot at its start']", timeout=90_000)
        yield page
        SEEN.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=SEEN / "designer.png")
        browser.close()


FIELD = ".cdprlab-fields input[type=text]"


def _picture(page: Any) -> str:
    return page.locator("img[alt*='robot at its start']").get_attribute("src")


def test_nothing_is_wider_than_the_page(page: Any):
    assert page.evaluate("document.documentElement.scrollWidth") <= 1280
    parts = (FIELD, "img[alt*='robot at its start']", "img[alt*='are held']")
    boxes = [page.locator(part).first.bounding_box() for part in parts]
    assert all(box["x"] + box["width"] <= 1280 for box in boxes)
    # Fields beside the picture, the slice below it, all on the screen.
    assert boxes[0]["x"] < min(boxes[1]["x"], boxes[2]["x"])
    assert all(box["y"] + box["height"] <= 900 for box in boxes)


def test_the_keyboard_edits_and_undoes(page: Any):
    before = _picture(page)
    field = page.locator(FIELD).first
    field.fill("-3.45")
    page.keyboard.press("Enter")
    page.wait_for_function("old => document.querySelector(\"img[alt*='robot at its start']\").src !== old", arg=before,
                           timeout=20_000)
    undo = page.get_by_role("button", name="Undo: cable 1: exit point A x")
    undo.focus()
    page.keyboard.press("Enter")
    page.wait_for_function("old => document.querySelector(\"img[alt*='robot at its start']\").src === old", arg=before,
                           timeout=20_000)
    assert float(field.input_value()) == -3.5


def test_a_mistake_is_said_aloud_and_the_picture_stays(page: Any):
    before = _picture(page)
    smallest = page.get_by_role("textbox", name="min")
    smallest.fill("20000")
    smallest.press("Enter")
    page.wait_for_selector("[role=alert]", timeout=20_000)
    assert "cable 1: tension" in page.locator("[role=alert]").inner_text()
    assert _picture(page) == before
    smallest.fill("60")
    smallest.press("Enter")
    page.wait_for_selector("[role=alert]", state="detached", timeout=20_000)


def test_a_robot_on_wheels_shows_its_bases(page: Any):
    page.get_by_label("World", exact=True).select_option("planar_mcdpr")
    page.get_by_role("button", name="Open").click()
    page.wait_for_selector("img[alt^='Mobile cable robot in the plane']", timeout=20_000)
    page.get_by_role("button", name="bases", exact=True).press("Enter")
    page.get_by_text("footprint [m]").wait_for(timeout=20_000)
