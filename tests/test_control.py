"""Laws of control: power is the rate of energy, errors are what turns one pose into the other, one law in two ways."""

import numpy as np
import pytest

import robots
from cdprlab.mechanics.dynamics import inverse_dynamics, mass_and_bias, mass_matrix, pose_error
from cdprlab.mechanics.statics import gravity_wrench
from cdprlab.mechanics.trajectory import Reference, quintic
from cdprlab.robot.pose import Pose, rotation_from_vector, rotation_vector
from cdprlab.run.controllers import ComputedTorque
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
    rng = np.random.default_rng(5)
    for _ in range(20):
        pose, wanted = some_pose(d, rng), some_pose(d, rng)
        error = pose_error(pose, wanted)
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


def test_the_wrench_brings_about_the_wanted_acceleration():
    robot, law = robots.robot_3r3t(), ComputedTorque(90.0, 15.0)
    for state, reference in states(np.random.default_rng(9), robot):
        acceleration = reference.acceleration + 90.0 * pose_error(state.pose, reference.pose) \
            + 15.0 * (reference.twist - state.twist)
        expected = inverse_dynamics(robot, state.rotation, state.twist, acceleration)
        assert np.allclose(law(0.0, state, reference), expected, rtol=0, atol=1e-10 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("name", robots.ROBOTS)
def test_errors_are_corrected_in_the_motion_pattern_s_rows(name):
    """a = a_d + S (K_d Sᵀ ė + K_p Sᵀ e), gains one by one, planar or spatial, the mass off P."""
    robot, rng = robots.ROBOTS[name](), np.random.default_rng(7)
    d, rows = robot.dimension, 3 * (robot.dimension - 1)
    law = ComputedTorque(np.arange(robot.n_dof) + 3.0, np.arange(robot.n_dof)[::-1])
    for _ in range(10):
        pose, wanted = some_pose(d, rng), some_pose(d, rng)
        twist, wanted_twist, wanted_acceleration = rng.normal(size=(3, rows))
        state = State(0.0, robot, pose.position, pose.rotation, twist, np.zeros(robot.n_cables))
        S = robot.pattern.basis(pose.rotation)
        correction = law.kd * (S.T @ (wanted_twist - twist)) + law.kp * (S.T @ pose_error(pose, wanted))
        expected = inverse_dynamics(robot, pose.rotation, twist, wanted_acceleration + S @ correction)
        found = law(0.0, state, Reference(wanted, wanted_twist, wanted_acceleration))
        assert np.allclose(found, expected, rtol=0, atol=1e-10 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("d", [2, 3])
def test_pose_errors_of_a_batch_are_the_logarithms(d):
    rng = np.random.default_rng(8)
    here, there = [some_pose(d, rng) for _ in range(6)], [some_pose(d, rng) for _ in range(6)]
    poses, wanted = (Pose(np.array([p.position for p in several]).reshape(2, 3, d),
                          matrix=np.array([p.rotation for p in several]).reshape(2, 3, d, d))
                     for several in (here, there))
    errors = pose_error(poses, wanted)
    turns = rotation_vector(wanted.rotation @ np.swapaxes(poses.rotation, -1, -2))
    np.testing.assert_array_equal(errors[..., :d], wanted.position - poses.position)
    np.testing.assert_allclose(errors[..., d:], turns, atol=1e-14)


def momentum(robot, pose, twist):
    """[p; L], linear and angular momentum, the latter about the world's origin [N s, N m s]."""
    d, body = robot.dimension, robot.platform
    arm, spin = pose.rotation @ body.center_of_mass, twist[d:]
    moved = body.mass * (twist[:d] + (spin[0] * np.array([-arm[1], arm[0]]) if d == 2 else np.cross(spin, arm)))
    own = np.atleast_1d(body.inertia * spin[0]) if d == 2 else pose.rotation @ body.inertia @ pose.rotation.T @ spin
    return np.concatenate([moved, own + robots.cross(pose.position + arm, moved)])


@pytest.mark.parametrize("make", [robots.robot_1r2t, robots.robot_3r3t,
                                  lambda: robots.build("3R3T", robots.CAROCA_EXITS, robots.CAROCA_ANCHORS)])
def test_the_wrench_and_the_weight_are_the_rate_of_momentum(make):
    """Newton and Euler for every row: M a + h + weight, moved from P to the origin, by differences of momentum."""
    robot, rng = make(), np.random.default_rng(4)
    d = robot.dimension
    for _ in range(20):
        path = quintic(some_pose(d, rng), some_pose(d, rng), 2.0)
        t = rng.uniform(0.2, 1.8)
        now, before, after = path(t), path(t - STEP), path(t + STEP)
        rate = (momentum(robot, after.pose, after.twist) - momentum(robot, before.pose, before.twist)) / (2 * STEP)
        M, h = mass_and_bias(robot, now.pose.rotation, now.twist)
        wrench = M @ now.acceleration + h + gravity_wrench(robot, now.pose)
        wrench[d:] += robots.cross(now.pose.position, wrench[:d])
        assert np.allclose(wrench, rate, rtol=1e-6, atol=1e-4)


@pytest.mark.parametrize("name", robots.ROBOTS)
def test_mass_is_symmetric_and_positive_and_seen_in_the_pattern_s_rows(name):
    robot, rng = robots.ROBOTS[name](), np.random.default_rng(11)
    pose = some_pose(robot.dimension, rng)
    M, _ = mass_and_bias(robot, pose.rotation, rng.normal(size=3 * (robot.dimension - 1)))
    S = robot.pattern.basis(pose.rotation)
    assert np.allclose(M, M.T, rtol=0, atol=1e-14) and np.linalg.eigvalsh(M).min() > 0
    np.testing.assert_allclose(mass_matrix(robot, pose), S.T @ M @ S, rtol=1e-14, atol=1e-14)
