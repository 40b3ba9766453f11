"""Jacobians against finite differences, and lengths back to poses."""

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.mechanics import kinematics
from robots import BASED, ROBOTS, case, cases, differences, moved, random_pose, random_poses, robot_2r3t, robot_3r3t

# Central differences of step h leave h²/6 of the third derivative (about 1 here) and rounding 1e-16/h.
STEP, CLOSE = 1e-5, 2e-9


def lengths_with_moved_base(robot, pose, k, step, pivot):
    """Lengths after base k made the step (θ, ρ₁, ρ₂): RPP about O₀, or about its own center."""
    base = robot.bases[k]
    turn, along = step[0], step[1:]
    c, s = np.cos(turn), np.sin(turn)
    center = np.array([[c, -s], [s, c]]) @ base.position if pivot == "world" else base.position
    heading = base.heading + turn
    axes = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
    return cl.cable_lengths(robot.with_bases({base.name: (*(center + axes @ along), heading)}), pose)


@pytest.mark.parametrize("name, seed", cases(4))
def test_jacobian_is_the_derivative_of_lengths(name, seed):
    robot, pose = case(name, seed)
    expected = differences(lambda x: cl.cable_lengths(robot, moved(robot, pose, x)), robot.n_dof, STEP)
    np.testing.assert_allclose(cl.jacobian(robot, pose), expected, atol=CLOSE)


@pytest.mark.parametrize("pivot", ["base", "world"])
@pytest.mark.parametrize("name", BASED)
@pytest.mark.parametrize("seed", range(4))
def test_base_jacobian_is_the_derivative_of_lengths(name, seed, pivot):
    robot, pose = case(name, seed)
    expected = np.concatenate([-differences(lambda x, k=k: lengths_with_moved_base(robot, pose, k, x, pivot), 3, STEP)
                               for k in range(len(robot.bases))], axis=1)
    np.testing.assert_allclose(cl.base_jacobian(robot, pose, pivot), expected, atol=CLOSE)


@pytest.mark.parametrize("name", BASED)
def test_the_pivots_differ_off_center_and_agree_at_the_origin(name):
    robot, pose = case(name, 5)
    assert np.abs(cl.base_jacobian(robot, pose) - cl.base_jacobian(robot, pose, "world")).max() > 0.1
    centered = robot.with_bases({base.name: (0, 0, base.heading) for base in robot.bases})
    np.testing.assert_array_equal(cl.base_jacobian(centered, pose), cl.base_jacobian(centered, pose, "world"))


@pytest.mark.parametrize("name", BASED)
def test_platform_and_bases_moving_together(name):
    robot, pose = case(name, 6)
    rng = np.random.default_rng(6)
    twist, speeds = rng.normal(size=robot.n_dof), rng.normal(size=3 * len(robot.bases))

    def at(t):
        bases = {}
        for base, speed in zip(robot.bases, speeds.reshape(-1, 3)):
            shift = base.rotation[:2, :2] @ speed[1:] * t
            bases[base.name] = (*(base.position + shift), base.heading + speed[0] * t)
        return cl.cable_lengths(robot.with_bases(bases), moved(robot, pose, twist * t))

    rates = cl.jacobian(robot, pose) @ twist - cl.base_jacobian(robot, pose) @ speeds
    # the third derivative is about ten here: speeds add up
    np.testing.assert_allclose(rates, (at(STEP) - at(-STEP)) / (2 * STEP), atol=10 * CLOSE)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_batch_equals_a_loop(name):
    robot = ROBOTS[name]()
    poses = random_poses(robot, 5, seed=7)
    for function in (cl.jacobian, cl.base_jacobian, cl.wrench_matrix):
        looped = np.stack([function(robot, poses[i]) for i in range(5)])
        np.testing.assert_allclose(function(robot, poses), looped, rtol=1e-13, atol=1e-13)
    assert cl.jacobian(robot, poses).shape == (5, robot.n_cables, robot.n_dof)


def test_unknown_pivot():
    with pytest.raises(cl.errors.InvalidInput, match="'base' or 'world'"):
        cl.base_jacobian(*case("two bases", 0), pivot="wheel")


def guess_near(robot, pose, seed):
    """A guess 0.1 m and 0.2 rad away, in the motions the pattern has."""
    rng = np.random.default_rng(seed)
    n_turns = len(robot.pattern.turn_axes)
    v, w = rng.normal(size=robot.n_dof - n_turns), rng.normal(size=n_turns)
    step = np.concatenate([0.1 * v / np.linalg.norm(v), 0.2 * w / np.linalg.norm(w) if n_turns else w])
    return moved(robot, pose, step)


@pytest.mark.parametrize("name, seed", cases(8))
def test_forward_kinematics_finds_the_pose(name, seed):
    robot, pose = case(name, seed)
    guess = guess_near(robot, pose, seed)
    found = cl.forward_kinematics(robot, cl.cable_lengths(robot, pose), guess)
    # 2R3T: the guess's turn about x′ stays, so only the rod's direction is the lengths' to tell
    told = np.s_[:, :1] if name == "2R3T" else np.s_[:, :]
    np.testing.assert_allclose(found.position, pose.position, atol=1e-9)
    np.testing.assert_allclose(found.rotation[told], pose.rotation[told], atol=1e-9)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_fit_knows_its_own_slope(name):
    """A wrong slope still converges from near, only slower: so it is looked at itself."""
    robot, start = case(name, 3)
    x = np.random.default_rng(3).uniform(-0.5, 0.5, robot.n_dof)
    expected = differences(lambda dx: cl.cable_lengths(robot, kinematics.moved(robot, start, x + dx)), robot.n_dof,
                           STEP)
    slope = cl.jacobian(robot, kinematics.moved(robot, start, x)) @ kinematics.moved_rates(robot, start, x)
    np.testing.assert_allclose(slope, expected, atol=CLOSE)
    both = kinematics.moved(robot, start, np.stack([x, 0 * x]))
    np.testing.assert_allclose(both.position, [kinematics.moved(robot, start, x).position, start.position], atol=1e-15)
    np.testing.assert_allclose(both.rotation, [kinematics.moved(robot, start, x).rotation, start.rotation], atol=1e-15)


def test_forward_kinematics_of_a_batch():
    robot = robot_3r3t()
    poses = random_poses(robot, 5, seed=8)
    lengths = cl.cable_lengths(robot, poses)
    one_guess = cl.forward_kinematics(robot, lengths, cl.Pose([0, 0, 1]))
    many = cl.forward_kinematics(robot, lengths, poses)
    for found in (one_guess, many):
        assert found.batch_shape == (5,)
        np.testing.assert_allclose(found.position, poses.position, atol=1e-9)
        np.testing.assert_allclose(found.rotation, poses.rotation, atol=1e-9)


def test_2r3t_keeps_the_turn_about_the_rod():
    robot = robot_2r3t()
    pose = random_pose(robot, 9)
    roll = cl.Pose(pose.position, matrix=pose.rotation @ cl.Pose([0, 0, 0], [0.7, 0, 0]).rotation)
    found = cl.forward_kinematics(robot, cl.cable_lengths(robot, pose), roll)
    np.testing.assert_allclose(found.rotation, roll.rotation, atol=1e-9)


def test_lengths_no_pose_has():
    robot = robot_3r3t()
    pose = random_pose(robot, 10)
    lengths = cl.cable_lengths(robot, pose) + 0.05 * np.array([1, -1, 1, -1, 1, 1, -1, 1])
    with pytest.raises(cl.errors.NoConvergence, match="tolerance=inf") as raised:
        cl.forward_kinematics(robot, lengths, pose)
    left = raised.value.residuals
    best = cl.forward_kinematics(robot, lengths, pose, tolerance=np.inf)
    np.testing.assert_allclose(cl.cable_lengths(robot, best) - lengths, left, atol=1e-12)
    # a least-squares pose leaves residuals orthogonal to every motion; LM stops where the cost no longer moves
    np.testing.assert_allclose(cl.jacobian(robot, best).T @ left, 0, atol=1e-7)


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_lengths_that_are_none(bad):
    robot = robot_3r3t()
    lengths = np.full(8, 3.0)
    lengths[2] = bad
    with pytest.raises(cl.errors.InvalidInput, match="lengths"):
        cl.forward_kinematics(robot, lengths, cl.Pose([0, 0, 1]))


@pytest.mark.parametrize("lengths, guess", [
    (np.ones(7), cl.Pose([0, 0, 1])), (np.ones(8), cl.Pose([0, 0])),
    (np.ones((2, 8)), cl.Pose(np.zeros((3, 3))))], ids=["count", "dimension", "batch"])
def test_shapes_that_do_not_fit(lengths, guess):
    with pytest.raises(cl.errors.InvalidInput):
        cl.forward_kinematics(robot_3r3t(), lengths, guess)
