"""What evaluating an object shows in a notebook, and what printing it says: small, and told in words."""

import json
import re
import subprocess
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import MissingDependency

WORLD = cl.load_world("planar_rigid")
ROBOT = WORLD.robot
W, WEIGHT = cl.wrench_matrix(ROBOT, WORLD.pose), cl.gravity_wrench(ROBOT, WORLD.pose)
LIMITS = ROBOT.tension_min, ROBOT.tension_max

SHOWN: dict[str, tuple[Callable[[], Any], str]] = {
    "world": (lambda: WORLD, "fully constrained"),
    "world in space": (lambda: cl.load_world("fastkit_suspended"), "passive"),
    "robot": (lambda: cl.load_world("caroca").robot, "150 kg"),
    "run": (lambda: cl.run(WORLD, duration=0.05), "tracking error, largest"),
    "distribution": (lambda: cl.distribute_tensions(W, WEIGHT, *LIMITS), "margin [N]"),
    "infeasible": (lambda: cl.distribute_tensions(W, 1e6 * WEIGHT, *LIMITS), "no tensions"),
    "batch": (lambda: cl.distribute_tensions(W, np.outer(np.linspace(0, 90, 3000), WEIGHT), *LIMITS), "of 3000"),
    "comparison": (lambda: cl.compare_tensions(WORLD), "improved_closed_form"),
    "polytope": (lambda: cl.available_wrench_set(ROBOT, WORLD.pose), "12 facets"),
    "unbounded": (lambda: cl.Polytope.from_rows([[1.0, 0.0]], [1.0]), "unbounded"),
    "empty": (lambda: cl.Polytope.from_rows([[1.0], [-1.0]], [-1.0, -1.0]), "empty"),
}


class Page(HTMLParser):
    """Pictures without words, words, and tags that were opened and not closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.pictures: list[str | None] = []
        self.words = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        if tag == "img":
            self.pictures.append(dict(attributes).get("alt"))
        else:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words += data


@pytest.mark.parametrize(("make", "said"), SHOWN.values(), ids=SHOWN)
def test_objects_show_themselves(make: Callable[[], Any], said: str):
    thing = make()
    html = thing._repr_html_()
    page = Page(html)
    assert said in page.words and page.open == []
    assert all(page.pictures) and len(page.pictures) == isinstance(thing, cl.World | type(ROBOT) | cl.Run)
    assert not re.search(r"(?<!-)color:|background", html), "words take the colors of the notebook's theme"
    assert len(html) < 200_000
    assert len(repr(thing).splitlines()) <= 10 and len(repr(thing)) < 1500


def test_a_job_says_what_it_was_in_ten_lines():
    job = pytest.importorskip("cdprlab.fastkit").Job
    assert job.__repr__ is cl.Run.__repr__ and job._repr_html_ is cl.Run._repr_html_


def test_a_bound_method_left_without_parentheses_says_little():
    run = cl.run(WORLD, duration=0.05)
    assert len(repr(run.table).splitlines()) <= 10


@pytest.mark.parametrize("name", ["planar_mcdpr", "mobile_four_bases", "point_mass", "kntu_planar"])
def test_every_kind_of_robot_is_drawn(name: str):
    world = cl.load_world(name)
    assert Page(world.robot._repr_html_()).pictures and Page(world._repr_html_()).pictures


def test_without_matplotlib_the_numbers_are_shown(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "PIL", None)
    page = Page(WORLD._repr_html_())
    assert page.pictures == [] and "pip install pillow" in page.words and "5 kg" in page.words


def test_tables_become_frames(monkeypatch: pytest.MonkeyPatch):
    """pandas itself may be missing here: what it would be given is what counts."""
    class Pandas:
        DataFrame = staticmethod(dict)

    monkeypatch.setitem(sys.modules, "pandas", Pandas)
    run = cl.run(WORLD, duration=0.05)
    frame = run.to_frame()
    np.testing.assert_array_equal(frame["time [s]"], run.time)
    np.testing.assert_array_equal(frame["measured_tension_4 [N]"], run.measured_tensions[:, 3])
    assert next(iter(cl.compare_tensions(WORLD).to_frame()["method"])) == "linear_program"
    spread = cl.distribute_tensions(W, np.outer([1.0, 2.0], WEIGHT), *LIMITS)
    np.testing.assert_array_equal(spread.to_frame()["cable 2 [N]"], spread.tensions[:, 1])
    assert spread.to_frame()["feasible"].tolist() == [True, True]


def test_without_pandas_one_line_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(MissingDependency, match=r"to_frame needs pandas.* install pandas$"):
        cl.distribute_tensions(W, WEIGHT, *LIMITS).to_frame()


def test_importing_the_package_is_all_it_takes(tmp_path):
    """As in a notebook's first cell, and without loading what draws before something is shown."""
    code = ("import sys, json, cdprlab as cl; early = 'matplotlib' in sys.modules; "
            "print(json.dumps([early, '<img' in cl.load_world('planar_rigid')._repr_html_()]))")
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert json.loads(done.stdout) == [False, True], done.stderr
