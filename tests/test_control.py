"""Laws of control: power is the rate of energy, errors are what turns one pose into the other, one law in two ways."""

import numpy as np
import pytest

import robots
from cdprlab.mechanics.dynamics import inverse_dynamics, mass_and_bias, mass_matrix, pose_error
from cdprlab.mechanics.statics import gravity_wrench
from cdprlab.mechanics.trajectory import Reference, quintic
from cdprlab.robot.pose import (
    Pose,
    rotation_from_vector,
    rotation_vector,
    rotation_vector_jacobian,
    rotation_vector_jacobian_rate,
)
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


def lawful(pose, twist, reference, K_p, K_d):
    """The acceleration with ë + K_d ė + K_p e = 0: in the left form, ω_T = ω_d − T ω = J_l ė of T = R_d Rᵀ."""
    d, e, rate = pose.dimension, pose_error(pose, reference.pose), reference.twist - twist
    if d == 2:
        return reference.acceleration + K_d @ rate + K_p @ e
    T, wanted = reference.pose.rotation @ pose.rotation.T, reference.twist[3:]
    J, spin = rotation_vector_jacobian(e[3:]), wanted - T @ twist[3:]
    rate[3:] = np.linalg.solve(J, spin)
    x = K_d @ rate + K_p @ e
    turn = T.T @ (reference.acceleration[3:] - np.cross(spin, wanted) + J @ x[3:]
                  - rotation_vector_jacobian_rate(e[3:], rate[3:]) @ rate[3:])
    return np.concatenate([reference.acceleration[:3] + x[:3], turn])


def test_the_wrench_brings_about_the_wanted_acceleration():
    robot, law = robots.robot_3r3t(), ComputedTorque(90.0, 15.0)
    for state, reference in states(np.random.default_rng(9), robot):
        acceleration = lawful(state.pose, state.twist, reference, 90.0 * np.eye(6), 15.0 * np.eye(6))
        expected = inverse_dynamics(robot, state.rotation, state.twist, acceleration)
        assert np.allclose(law(0.0, state, reference), expected, rtol=0, atol=1e-10 * (1 + np.abs(expected).max()))


@pytest.mark.parametrize("name", robots.ROBOTS)
def test_errors_are_corrected_in_the_motion_pattern_s_rows(name):
    """ë + S (K_d Sᵀ ė + K_p Sᵀ e) = 0, gains one by one, planar or spatial, the mass off P."""
    robot, rng = robots.ROBOTS[name](), np.random.default_rng(7)
    d, rows = robot.dimension, 3 * (robot.dimension - 1)
    law = ComputedTorque(np.arange(robot.n_dof) + 3.0, np.arange(robot.n_dof)[::-1])
    for _ in range(10):
        pose, wanted = some_pose(d, rng), some_pose(d, rng)
        twist, wanted_twist, wanted_acceleration = rng.normal(size=(3, rows))
        state = State(0.0, robot, pose.position, pose.rotation, twist, np.zeros(robot.n_cables))
        S = robot.pattern.basis(pose.rotation)
        reference = Reference(wanted, wanted_twist, wanted_acceleration)
        acceleration = lawful(pose, twist, reference, (law.kp * S) @ S.T, (law.kd * S) @ S.T)
        expected = inverse_dynamics(robot, pose.rotation, twist, acceleration)
        found = law(0.0, state, reference)
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


@pytest.mark.parametrize("spin", [0.0, 1.0, 3.0, 10.0])
def test_the_error_law_holds_about_every_axis_of_a_spinning_reference(spin):
    """ë + K_d ė + K_p e = 0 of the platform's own motion: 0.1 rad about x stays about x, and follows the law."""
    robot = robots.build("3R3T", robots.CAROCA_EXITS, robots.CAROCA_ANCHORS)
    kp, kd, h, steps = 100.0, 20.0, 1e-3, 500
    law = ComputedTorque(kp, kd)
    axis = np.array([1.0, 2.0, 2.0]) / 3 * spin   # turned about its own axis, faster and slower
    place = np.zeros(3)

    def wanted(t):
        angle = t - 0.1 * np.sin(3 * t)
        R_d = rotation_from_vector(axis * angle) @ rotation_from_vector(np.array([0.3, -0.2, 0.5]))
        twist, acceleration = np.zeros(6), np.zeros(6)
        twist[3:], acceleration[3:] = axis * (1 - 0.3 * np.cos(3 * t)), axis * 0.9 * np.sin(3 * t)
        return Reference(Pose.of(place, R_d), twist, acceleration)

    def acceleration(t, R, w):
        twist = np.concatenate([place, w])
        state = State(t, robot, place, R, twist, np.zeros(8))
        M, bias = mass_and_bias(robot, R, twist)
        return np.linalg.solve(M, law(t, state, wanted(t)) - bias)[3:]

    reference = wanted(0.0)
    # The rate of e is 0 as it begins: R_d Rᵀ ω = ω_d.
    start = rotation_from_vector(np.array([-0.1, 0.0, 0.0]))
    R, w = start @ reference.pose.rotation, start @ reference.twist[3:]
    errors = [[0.1, 0.0, 0.0]]
    for k in range(steps):   # Runge-Kutta of fourth order (Munthe-Kaas), local rotation vector q

        def slope(q, v, s, t=k * h, R=R):
            turn = rotation_from_vector(q)
            return (np.linalg.solve(rotation_vector_jacobian(q), v),
                    acceleration(t + s, turn @ R, v))

        q1, v1 = slope(np.zeros(3), w, 0.0)
        q2, v2 = slope(h / 2 * q1, w + h / 2 * v1, h / 2)
        q3, v3 = slope(h / 2 * q2, w + h / 2 * v2, h / 2)
        q4, v4 = slope(h * q3, w + h * v3, h)
        R = rotation_from_vector(h / 6 * (q1 + 2 * q2 + 2 * q3 + q4)) @ R
        w = w + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
        errors.append(rotation_vector(wanted((k + 1) * h).pose.rotation @ R.T))
    t = h * np.arange(steps + 1)
    law_says = 0.1 * (1 + 10 * t) * np.exp(-10 * t)   # both poles at -10 1/s
    # Fourth order: some (h × 20/s)⁴ = 2e-7 of 0.1 rad.
    np.testing.assert_allclose(errors, np.stack([law_says, 0 * t, 0 * t], axis=1), atol=2e-8)
