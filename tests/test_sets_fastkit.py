"""The FASTKIT worlds: published numbers as published, and what the chosen ones make of them."""

import dataclasses

import numpy as np
import pytest
import scipy.spatial
from programs import lp_support
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab.errors import NotListable

NAMES = ("fastkit_suspended", "fastkit_constrained")
SHELF = cl.Pose([0.8, 0.0, 0.9])


@pytest.fixture(params=NAMES)
def robot(request):
    return cl.load_world(request.param).robot


def test_published_numbers(robot):
    assert robot.n_cables == 8 and robot.mass == 5.0
    assert (robot.tension_max == 45).all() and (robot.speed_max == 2).all()
    assert robot.exit_points[:, 2].max() == 2.4
    assert (robot.platform.size > [0.6, 0.36, 0.2]).all()     # inner dimensions, so the outside is larger
    winch = robot.winch
    assert (winch.drum_radius, winch.gear_ratio, winch.efficiency, winch.torque) == (0.04, 5, 0.7, 0.6)
    assert robot.base("active").speed_max.tolist() == [0.2, 0.2, 0.2]
    assert robot.base("passive").speed_max.tolist() == [0, 0, 0]


def test_seven_kilograms_at_the_shelf_within_45_newtons_and_no_base_tips():
    robot = cl.load_world("fastkit_suspended").robot.with_payload(7.0, [0, 0, 0])
    W, weight = cl.wrench_matrix(robot, SHELF), cl.gravity_wrench(robot, SHELF)
    held = cl.distribute_tensions(W, weight, robot.tension_min, robot.tension_max).require()
    assert held.tensions.max() < 45
    assert all((moments < 0).all() for moments in cl.tipping_moments(robot, SHELF, held.tensions).values())
    assert cl.available_wrench_set(robot, SHELF, tipping=True).contains(-weight)


@pytest.mark.parametrize("z", [0.4, 0.9, 1.4, 1.9])
def test_the_largest_payload_is_an_lps(robot, z):
    pose, m = cl.Pose([0.5, 0.0, z]), robot.n_cables
    weight, up = -cl.gravity_wrench(robot, pose), 9.81 * np.eye(6)[2]
    columns = np.column_stack([cl.wrench_matrix(robot, pose), -up])
    found = linprog(np.append(np.zeros(m), -1.0), A_eq=columns, b_eq=weight,
                    bounds=[*zip(robot.tension_min, robot.tension_max), (None, None)], method="highs")
    largest = cl.available_wrench_set(robot, pose).scale(weight + up, weight)
    assert found.status in (0, 2)
    if found.status == 2:
        assert np.isnan(largest)
    else:
        assert largest == pytest.approx(found.x[-1], abs=1e-7)


@pytest.mark.parametrize("turned", [False, True])
def test_wrenches_that_tip_no_base_are_listed_also_where_many_planes_meet_in_a_corner(turned, monkeypatch):
    """Qhull lists some of these sets and, by rounding, gives up at others; then programs find the same planes."""
    robot = cl.load_world("fastkit_suspended").robot
    rng = np.random.default_rng(4)
    for position in rng.uniform([-1, -0.5, 0.5], [1, 0.5, 1.5], (6, 3)):
        pose = cl.Pose(position, rpy=rng.uniform(-0.2, 0.2, 3) * turned)
        aws = cl.available_wrench_set(robot, pose, tipping=True)
        again = cl.Polytope.from_rows(aws.normals, aws.offsets)
        d = rng.normal(size=(50, 6))
        np.testing.assert_allclose(lp_support(again, d), lp_support(aws, d), rtol=1e-9)
        with monkeypatch.context() as without_qhull:
            without_qhull.setattr(scipy.spatial, "ConvexHull", give_up)
            asked = cl.available_wrench_set(robot, pose, tipping=True)
            np.testing.assert_array_equal(asked.normals, aws.normals)
            with pytest.raises(NotListable, match="too many"):
                _ = asked.vertices


def give_up(points):
    """What Qhull does where too many planes meet."""
    raise scipy.spatial.QhullError("too many meet in one corner")


def test_no_seven_kilograms_half_way_between_the_bases_and_high():
    robot = cl.load_world("fastkit_suspended").robot.with_payload(7.0, [0, 0, 0])
    for z, possible in ((1.1, True), (1.4, False), (1.9, False)):
        pose = cl.Pose([0.0, 0.0, z])
        assert cl.available_wrench_set(robot, pose).contains(-cl.gravity_wrench(robot, pose)) == possible


def test_every_translation_up_to_the_cables_speed(robot):
    rng = np.random.default_rng(0)
    v = rng.normal(size=(200, 3))
    v *= 2.0 / np.linalg.norm(v, axis=1)[:, None]
    for position in rng.uniform([-2.4, -0.1, 0.2], [2.4, 0.1, 1.9], (10, 3)):
        ats = cl.available_twist_set(robot, cl.Pose(position), moving="none")
        assert ats.contains(np.pad(v, ((0, 0), (0, 3)))).all()


def test_moving_bases_never_lower_a_bar_and_do_not_raise_all(robot):
    fixed, moving = (cl.available_twist_set(robot, SHELF, moving) for moving in ("none", "active"))
    for ask in (lambda s: s.component_range(), lambda s: s.axis_section()):
        gain = np.abs(ask(moving)).max(axis=1) - np.abs(ask(fixed)).max(axis=1)
        assert (gain > -1e-9).all() and gain.max() > 0.05
    assert abs(gain[1]) < 1e-9     # pure v_y: cables of the passive base are the limit


def test_twenty_newtons_tip_no_base_and_forty_five_do():
    robot = cl.load_world("fastkit_suspended").robot
    for high, bites in ((20.0, False), (45.0, True)):
        limited = dataclasses.replace(robot, cables=tuple(
            dataclasses.replace(c, tension_min=0.0, tension_max=high) for c in robot.cables))
        free, standing = (cl.available_wrench_set(limited, SHELF, tipping=t).component_range() for t in (False, True))
        assert (np.abs(free - standing).max() > 1.0) == bites
