"""The two circles explorer: circles, a formula's point and the engine's load say the same, or why they do not."""

import itertools

import numpy as np
import pytest

from cdprlab import course
from cdprlab.errors import InvalidInput

HUNG = "yes"


@pytest.fixture(scope="module")
def explorer():
    made = course.two_circles_explorer()
    yield made
    made.close()


def test_by_hand_three_and_four_meters_meet_and_hang_there(explorer):
    explorer.set(l1=3.0, l2=4.0, hang=HUNG)
    assert explorer.text.count("(1.800, 0.600)") == 3 and "both ropes are taut" in explorer.text
    # Printed to a micrometer; at rest within ten.
    assert float(explorer.text.split()[-1]) <= 0.01


def test_where_a_cable_would_have_to_push_the_load_hangs_elsewhere(explorer):
    explorer.set(l1=3.0, l2=6.5, hang=HUNG)
    assert "hangs at (0.000, 0.000) m" in explorer.text and "rope 2 is slack" in explorer.alt_text


def test_circles_that_miss_each_other_may_still_hang_a_load(explorer):
    explorer.set(l1=1.0, l2=7.0, hang=HUNG)
    assert "miss each other" in explorer.text and "hangs at (0.000, 2.000) m" in explorer.text
    explorer.set(l1=2.0, l2=2.5)
    assert "nowhere" in explorer.text and not explorer.load


def test_nothing_hangs_until_asked(explorer):
    explorer.set(l1=3.0, l2=4.0, hang="no")
    assert "not hung yet" in explorer.text and not explorer.load


@pytest.mark.parametrize("hang", ["no", HUNG])
def test_both_ends_of_every_slider(explorer, hang):
    for l1, l2 in itertools.product(*((explorer.controls[name].low, explorer.controls[name].high)
                                      for name in ("l1", "l2"))):
        explorer.set(l1=l1, l2=l2, hang=hang)
        assert explorer.picture.startswith(b"\x89PNG") and "nan" not in explorer.text + explorer.alt_text


def test_somebodys_own_formula_is_drawn_right_or_wrong():
    upper = course.two_circles_explorer(lambda A1, A2, l1, l2: np.array([1.8, 5.4]))
    upper.set(hang=HUNG)
    assert "your point [m]           (1.800, 5.400)" in upper.text and upper.text.endswith("4800.000")
    upper.close()


def test_a_formula_that_says_there_is_none_is_believed_and_one_that_answers_nonsense_is_named():
    def none(A1, A2, l1, l2):
        raise ValueError("no point has these lengths")

    silent = course.two_circles_explorer(none)
    assert "your point [m]  none" in silent.text
    silent.close()
    with pytest.raises(InvalidInput, match="the point must be"):
        course.two_circles_explorer(lambda A1, A2, l1, l2: np.zeros(3))
