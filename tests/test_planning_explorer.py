"""The planning explorer: its ways keep their margin by exact geometry, and every slider answers at both ends."""

import numpy as np
import pytest

import cdprlab as cl
from cdprlab import course
from cdprlab.errors import InvalidInput
from cdprlab.fastkit import OccupancyGrid, Vehicle, inflated_width
from cdprlab.fastkit.navigation.driving import clearance
from cdprlab.fastkit.navigation.planner import between

PAIR = Vehicle.of(cl.load_world("fastkit_suspended").robot, 1.6)


@pytest.fixture(scope="module")
def explorer():
    explorer = course.planning_explorer(PAIR)
    yield explorer
    explorer.close()


@pytest.fixture(autouse=True)
def _as_it_was(explorer):
    yield
    explorer.set(**{name: control.start for name, control in explorer.controls.items()})


@pytest.mark.parametrize("values", [{}, {"gap": 1.0}, {"margin": 0.2}, {"heading": -180.0}, {"heading": 0.0, "y": 4.2}])
def test_the_way_leads_to_the_goal_and_keeps_its_margin(explorer, values):
    explorer.set(**values)
    plan, hall = explorer.plan(explorer.values), explorer.hall(explorer.values)
    assert plan.found
    np.testing.assert_array_equal(plan.poses[-1], explorer.goal(explorer.values))
    every = np.concatenate([between(a, b) for a, b in zip(plan.poses, plan.poses[1:])])
    # At the start as much as there is, which is more than any margin here.
    assert min(clearance(PAIR, pose, hall) for pose in every) >= explorer.values["margin"]


def test_a_gap_of_the_width_it_names_is_taken_and_one_of_the_pair_s_own_is_not(explorer):
    explorer.set(margin=0.3, gap=2.2)
    sure = inflated_width(OccupancyGrid.of(explorer.hall(explorer.values)), PAIR, 0.3)
    assert f"{sure:.2f}" in explorer.text and 1.8 < sure < 2.2     # the upper gap is 1.8 m wide
    assert "the lower gap" in explorer.text
    explorer.set(gap=1.0, margin=0.0)
    assert "the upper gap" in explorer.text and "1.00" in explorer.text


def test_no_way_is_said_in_picture_and_words(explorer):
    explorer.set(gap=0.8, margin=0.3)
    assert "way" in explorer.text and "none: there is no way of 1.89 m width" in explorer.text
    assert "no way" in explorer.alt_text
    assert explorer.says.get_text() == "no way"
    explorer.set(gap=2.2, margin=0.1)
    assert explorer.says.get_text() == "" and "through the lower gap" in explorer.alt_text


def test_the_time_is_no_shorter_than_the_slower_base_needs(explorer):
    poses = explorer.plan(explorer.values).poses
    ends = PAIR.bases(poses)[..., :2]
    ways = np.linalg.norm(np.diff(ends, axis=0), axis=-1).sum(axis=0)
    turned = np.abs(np.diff(poses[:, 2])).sum()
    shown = float(next(line for line in explorer.text.splitlines() if "time at" in line).split()[-1])
    # Both translations have their own limit of 0.2 m/s, so a diagonal goes √2 times as fast.
    assert shown >= max(ways.max() / (0.2 * np.sqrt(2)), turned / 0.2) - 0.5


def test_every_slider_answers_at_both_ends(explorer):
    for name, control in explorer.controls.items():
        for end in (control.low, control.high):
            explorer.set(**{name: end})
            assert explorer.picture.startswith(b"\x89PNG") and "A hall from above" in explorer.alt_text
        explorer.set(**{name: control.start})


def test_the_picture_comes_back(explorer):
    before = explorer.picture
    explorer.set(gap=1.2)
    assert explorer.picture != before
    explorer.set(gap=explorer.controls["gap"].start)
    assert explorer.picture == before


def test_anything_else_than_a_vehicle_is_refused():
    with pytest.raises(InvalidInput, match="must be a Vehicle, got World"):
        course.planning_explorer(cl.load_world("fastkit_suspended"))
