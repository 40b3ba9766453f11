"""Laws of control: power is the rate of energy, errors are what turns one pose into the other, one law in two ways."""

import numpy as np
import pytest

import robots
from cdprlab.mechanics.dynamics import inverse_dynamics, mobility
from cdprlab.mechanics.trajectory import Reference, quintic
from cdprlab.robot.pose import Pose, rotation_from_vector
from cdprlab.run.controllers import ComputedTorque, pose_error
from cdprlab.simulate.state import State

STEP = 1e-5  # s: central differences of the energy err by its third derivative times STEP²


def some_pose(d, rng):
    """A pose turned by less than half a turn."""
    turn = rng.uniform(-1.5, 1.5)
    return Pose(rng.normal(size=2), angle=turn) if d == 2 else Pose(rng.normal(size=3), rpy=rng.uniform(-1, 1, 3))


def energy(robot, pose, twist):
    """Kinetic and potential energy of the platform [J]."""
    d, body = robot.dimension, robot.platform
    arm = pose.rotation @ body.center_of_mass
    spin = twist[d:]
    velocity = twist[:d] + (spin[0] * np.array([-arm[1], arm[0]]) if d == 2 else np.cross(spin, arm))
    inertia = np.atleast_2d(body.inertia)
    own = spin if d == 2 else pose.rotation.T @ spin
    height = (pose.position + arm)[-1]
    return body.mass * (velocity @ velocity / 2 + robot.gravity * height) + own @ inertia @ own / 2


@pytest.mark.parametrize("make", [robots.robot_1r2t, robots.robot_3r3t,
                                  lambda: robots.build("3R3T", robots.CAROCA_EXITS, robots.CAROCA_ANCHORS)])
def test_the_power_of_the_wrench_is_the_rate_of_energy(make):
    robot, rng = make(), np.random.default_rng(3)
    d = robot.dimension
    for _ in range(20):
        path = quintic(some_pose(d, rng), some_pose(d, rng), 2.0)
        t = rng.uniform(0.2, 1.8)
        now, before, after = path(t), path(t - STEP), path(t + STEP)
        rate = (energy(robot, after.pose, after.twist) - energy(robot, before.pose, before.twist)) / (2 * STEP)
        wrench = inverse_dynamics(robot, now.pose.rotation, now.twist, now.acceleration)
        assert wrench @ now.twist == pytest.approx(rate, rel=1e-6, abs=1e-4)  # 1e3 J ε / STEP = 2e-8 W, truncation 1e-5


@pytest.mark.parametrize("d", [2, 3])
def test_the_pose_error_turns_the_pose_into_the_reference(d):
    robot, rng = robots.robot_1r2t() if d == 2 else robots.robot_3r3t(), np.random.default_rng(5)
    for _ in range(20):
        pose, wanted = some_pose(d, rng), some_pose(d, rng)
        zero = np.zeros(3 if d == 2 else 6)
        error = pose_error(State(0.0, robot, pose.position, pose.rotation, zero, zero), Reference(wanted, zero, zero))
        assert np.allclose(pose.position + error[:d], wanted.position, atol=1e-12)
        assert np.allclose(rotation_from_vector(error[d:]) @ pose.rotation, wanted.rotation, atol=1e-12)


def states(rng, robot):
    """A state and a reference with everything moving; one in five nearly where it should be, one turned far."""
    for k in range(50):
        pose, wanted = some_pose(3, rng), some_pose(3, rng)
        if k % 5 == 0:
            wanted = Pose(pose.position, matrix=rotation_from_vector(rng.normal(size=3) * 1e-10) @ pose.rotation)
        if k % 5 == 1:
            wanted = Pose(pose.position, matrix=rotation_from_vector(np.array([0, 0, np.pi - 1e-3])) @ pose.rotation)
        yield (State(0.0, robot, pose.position, pose.rotation, rng.normal(size=6), np.zeros(8)),
               Reference(wanted, rng.normal(size=6), rng.normal(size=6)))


@pytest.mark.parametrize("kp, kd", [(100.0, 20.0), (np.arange(6.0), np.arange(6.0)[::-1])])
def test_the_loop_s_own_computed_torque_is_the_one_of_arrays(kp, kd):
    robot, law = robots.robot_3r3t(), ComputedTorque(kp, kd)
    for state, reference in states(np.random.default_rng(7), robot):
        slow = law._wrench(robot, state, reference)
        assert np.allclose(law(0.0, state, reference), slow, rtol=0, atol=1e-10 * (1 + np.abs(slow).max()))


def test_the_wrench_brings_about_the_wanted_acceleration():
    robot, law = robots.robot_3r3t(), ComputedTorque(90.0, 15.0)
    for state, reference in states(np.random.default_rng(9), robot):
        acceleration = reference.acceleration + 90.0 * pose_error(state, reference) \
            + 15.0 * (reference.twist - state.twist)
        expected = inverse_dynamics(robot, state.rotation, state.twist, acceleration)
        assert np.allclose(law(0.0, state, reference), expected, rtol=0, atol=1e-10 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("name", ["3T", "2R3T", "3R3T"])
def test_mobility_is_the_inverse_of_inertia(name):
    """A wrench of inverse dynamics, put through the mobility, is the acceleration it was made for."""
    robot, rng = robots.ROBOTS[name](), np.random.default_rng(11)
    rotation, rest, acceleration = some_pose(3, rng).rotation, np.zeros(6), rng.normal(size=6)
    wrench = (inverse_dynamics(robot, rotation, rest, acceleration, every_row=True)
              - inverse_dynamics(robot, rotation, rest, rest, every_row=True))
    assert np.allclose(mobility(robot, rotation, every_row=True) @ wrench, acceleration, rtol=0, atol=1e-12)
    basis = robot.pattern.basis(rotation)
    some = rng.normal(size=robot.n_dof)
    assert np.allclose(mobility(robot, rotation) @ some,
                       (mobility(robot, rotation, every_row=True) @ basis @ some) @ basis, rtol=0, atol=1e-12)
