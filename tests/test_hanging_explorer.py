"""The hanging explorer: what it tells is equilibrium, and every slider answers at both ends of its range."""

import itertools

import numpy as np
import pytest

import cdprlab as cl
from cdprlab import course
from cdprlab.errors import InvalidInput

SPATIAL = ["caroca", "okoli_cube", "cogiro", "point_mass"]


@pytest.fixture(scope="module")
def caroca():
    return course.hanging_explorer(cl.load_world("caroca"))


@pytest.mark.parametrize("name", SPATIAL)
def test_both_ends_of_every_slider(name):
    explorer = course.hanging_explorer(cl.load_world(name))
    first = explorer.picture
    for ends in itertools.product(*((control.low, control.high) for control in explorer.controls.values())):
        explorer.set(**dict(zip(explorer.controls, ends)))
        assert "weight [N]" in explorer.text and explorer.picture != first


def test_tensions_shown_carry_the_weight(caroca):
    caroca.set(x=-1.0, y=0.5, z=2.0)
    robot, pose = caroca.robot, caroca.pose(caroca.values)
    shown = np.array([float(label.get_text()) for label in caroca.words])
    # Labels are rounded to whole newtons: half a newton a cable at most.
    force = cl.cable_directions(robot, pose).T @ shown
    assert np.abs(force - [0, 0, robot.mass * robot.gravity]).max() < 0.5 * robot.n_cables


def test_tensions_grow_without_bound_toward_the_exit_points(caroca):
    caroca.set(x=0.0, y=0.0)
    hardest = []
    for height in (0.5, 1.5, 2.5, 3.15):
        caroca.set(z=height)
        hardest.append(caroca.tensions(caroca.values).tensions.max())
    assert np.all(np.diff(hardest) > 0)
    assert "→" in caroca.words[0].get_text()  # beyond the scale the number still tells


def test_what_cannot_be_held_is_said_in_words():
    explorer = course.hanging_explorer(cl.load_world("point_mass"))
    heavy = explorer.robot.with_payload(1e6, [0, 0, 0])
    explorer.robot = heavy
    explorer.set(z=explorer.controls["z"].high)
    assert "cannot hold" in explorer.text and "no tensions" in explorer.alt_text
    assert explorer.words[0].get_text() == "?"


@pytest.mark.parametrize("subject", ["caroca", None])
def test_only_spatial_worlds_hang(subject):
    with pytest.raises(InvalidInput, match=r"spatial World|must be a World"):
        course.hanging_explorer(subject)
