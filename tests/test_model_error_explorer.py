"""The explorer of model errors: what it shows is at rest, as statics and the engine have it."""

from dataclasses import replace

import numpy as np
import pytest

import cdprlab as cl
from cdprlab import course
from cdprlab.errors import InvalidInput


@pytest.fixture(scope="module")
def explorer():
    world = cl.load_world("fastkit_suspended")   # in a run, its winches would have a say
    made = course.model_error_explorer(replace(world, robot=replace(world.robot, winch=None)))
    yield made
    made.close()


def moved_to(explorer, **values):
    explorer.set(**values)
    real = cl.perturbed(explorer.world, exit_points=1e-3 * values["size"], seed=values["seed"]).robot
    return real, *explorer.rest(explorer.values)


def test_a_robot_that_is_its_model_is_where_it_should_be(explorer):
    for control in explorer.controls["control"].options:
        _, pose, tensions = moved_to(explorer, size=0, seed=3, control=control)
        np.testing.assert_allclose(tensions, explorer.wanted, atol=1e-5)
        np.testing.assert_allclose(pose.position, explorer.pose.position, atol=1e-8)


@pytest.mark.parametrize(("size", "seed"), [(1, 0), (5, 1), (20, 2)])
def test_ropes_wound_to_the_model_hold_the_robot_as_built(explorer, size, seed):
    real, pose, tensions = moved_to(explorer, size=size, seed=seed, control="wound to length")
    left = cl.wrench_matrix(real, pose) @ tensions + cl.gravity_wrench(real, pose)
    assert np.abs(left).max() < 1e-6
    assert f"slack cables          {int((tensions == 0).sum())}" in explorer.text
    assert [word.get_text() == "slack" for word in explorer.words] == (tensions == 0).tolist()


def test_under_tension_control_it_ends_where_the_engine_s_robot_ends(explorer):
    pytest.importorskip("pybullet")
    _, pose, _ = moved_to(explorer, size=20, seed=4, control="tension control")
    real = cl.perturbed(explorer.world, exit_points=0.02, seed=4)
    run = cl.run(explorer.world, real=real, controller=cl.ComputedTorque(100, 20), cables="force", dt=2e-3,
                 duration=6.0)
    off = pose.position - explorer.pose.position
    # To first order: the engine's controller distributes tensions anew where the platform has gone.
    np.testing.assert_allclose(run.poses.position[-1] - explorer.pose.position, off, atol=0.05 * np.abs(off).max())


def test_ropes_that_do_not_stretch_are_refused():
    with pytest.raises(InvalidInput, match="caroca has no axial_stiffness"):
        course.model_error_explorer(cl.load_world("caroca"))
