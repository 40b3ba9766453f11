"""Lengths, directions and their batches."""

import numpy as np
import pytest

import cdprlab as cl
from robots import BASED, ROBOTS, case, random_poses, robot_1r2t, robot_2t, robot_3t


@pytest.mark.parametrize("name", ROBOTS)
def test_vectors_run_from_anchor_to_exit(name):
    robot, pose = case(name, 1)
    for i, vector in enumerate(cl.cable_vectors(robot, pose)):
        anchor = pose.position + pose.rotation @ robot.anchor_points[i]
        np.testing.assert_allclose(anchor + vector, robot.exit_points[i], atol=1e-14)


@pytest.mark.parametrize("name", ROBOTS)
def test_directions_times_lengths_are_vectors(name):
    robot, pose = case(name, 2)
    u, lengths = cl.cable_directions(robot, pose), cl.cable_lengths(robot, pose)
    np.testing.assert_allclose(np.linalg.norm(u, axis=-1), 1.0, rtol=1e-14)
    np.testing.assert_allclose(u * lengths[:, None], cl.cable_vectors(robot, pose), atol=1e-14)


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("function", [cl.cable_vectors, cl.cable_directions, cl.cable_lengths])
def test_a_batch_equals_a_loop(name, function):
    robot = ROBOTS[name]()
    poses = random_poses(robot, 6, seed=3)
    d = robot.dimension
    grid = cl.Pose(poses.position.reshape(2, 3, d), matrix=poses.rotation.reshape(2, 3, d, d))
    looped = np.stack([function(robot, poses[i]) for i in range(6)])
    np.testing.assert_allclose(function(robot, poses), looped, rtol=1e-14, atol=1e-14)
    np.testing.assert_allclose(function(robot, grid), looped.reshape(2, 3, *looped.shape[1:]), rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize("name", BASED)
def test_exit_points_ride_on_their_bases(name):
    robot = BASED[name]()
    moved = robot.with_bases({"left": (1.0, 2.0, 0.7)})
    c, s = np.cos(0.7), np.sin(0.7)
    for before, after, cable in zip(robot.exit_points, moved.exit_points, robot.cables):
        if cable.base != "left":
            np.testing.assert_array_equal(after, before)
            continue
        x, y = cable.exit_point[:2]
        np.testing.assert_allclose(after[:2], [1.0 + c * x - s * y, 2.0 + s * x + c * y], atol=1e-14)
        np.testing.assert_array_equal(after[2:], cable.exit_point[2:])


def test_a_shift_of_everything_changes_no_length():
    robot = ROBOTS["two bases"]()
    pose = random_poses(robot, 4, seed=4)
    shift = np.array([0.3, -0.2, 0.0])
    cables = tuple(cable if cable.base else cl.Cable(cable.exit_point + shift, cable.anchor_point, 0, 1)
                   for cable in robot.cables)
    bases = {base.name: (*(base.position + shift[:2]), base.heading) for base in robot.bases}
    there = cl.Robot(robot.pattern, robot.platform, cables, robot.bases).with_bases(bases)
    shifted = cl.Pose(pose.position + shift, matrix=pose.rotation)
    np.testing.assert_allclose(cl.cable_lengths(there, shifted), cl.cable_lengths(robot, pose), rtol=1e-14)


def test_dimensions_must_agree():
    with pytest.raises(cl.errors.InvalidInput, match="dimensions"):
        cl.cable_lengths(robot_3t(), cl.Pose([0, 0]))
    with pytest.raises(cl.errors.InvalidInput, match="dimensions"):
        cl.cable_lengths(robot_1r2t(), cl.Pose([0, 0, 0]))


def test_a_cable_without_length_has_no_direction_and_says_which():
    robot = robot_2t()
    at_exit = cl.Pose([[0.0, 0.0], robot.exit_points[1]])
    assert cl.cable_lengths(robot, at_exit)[1, 1] == 0.0
    with pytest.raises(cl.errors.InvalidInput, match="cable 2 has no length"):
        cl.cable_directions(robot, at_exit)
