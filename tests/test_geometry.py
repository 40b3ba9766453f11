"""Lengths, directions and their batches, and the parts robots are made of."""

import numpy as np
import pytest

import cdprlab as cl
import robots
from robots import BASED, ROBOTS, case, random_pose, random_poses, robot_1r2t, robot_2t, robot_3t


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


@pytest.mark.parametrize("name", ["3R3T", "1R2T"])
def test_payload_is_the_two_body_computation(name):
    robot, d = ROBOTS[name](), ROBOTS[name]().dimension
    place, load = np.array([0.3, -0.2, -0.5])[:d], 7.0
    robot = cl.Robot(robot.pattern, robots.platform(d), robot.cables)
    body, both = robot.platform, robot.with_payload(load, place).platform
    assert both.mass == body.mass + load
    np.testing.assert_allclose(both.mass * both.center_of_mass, body.mass * body.center_of_mass + load * place)
    # kinetic energy of any motion (v of P, ω): one body against two
    rng = np.random.default_rng(3)

    def energy(part, v, w):
        at = v + turning(w, part.center_of_mass)
        return (part.mass * at @ at + w @ np.atleast_2d(part.inertia) @ w) / 2

    def turning(w, r):
        return w[0] * np.array([-r[1], r[0]]) if d == 2 else np.cross(w, r)

    for v, w in zip(rng.normal(size=(5, d)), rng.normal(size=(5, 1 if d == 2 else 3))):
        load_speed = v + turning(w, place)
        assert energy(both, v, w) == pytest.approx(energy(body, v, w) + load * load_speed @ load_speed / 2, rel=1e-12)
    pose = random_pose(robot, 1)
    weight = np.eye(d)[-1] * -load * robot.gravity
    added = robots.in_rows(robot, pose, weight, robots.cross(pose.rotation @ place, weight))
    np.testing.assert_allclose(cl.gravity_wrench(robot.with_payload(load, place), pose),
                               cl.gravity_wrench(robot, pose) + added, atol=1e-10)


SQUARE = [[1, 1], [-1, 1], [-1, -1], [1, -1]]
STAR = [[np.cos(a), np.sin(a)] for a in 4 * np.pi / 5 * np.arange(5)]


@pytest.mark.parametrize("make, says", [
    (lambda: cl.Cable([0, 0, 1], [0, 0], 1, 2), "anchor_point"), (lambda: cl.Cable([0, 0], [0, 0], 3, 2), "crossed"),
    (lambda: cl.Cable([0, 0], [0, 0], -1, 2), "at least 0"), (lambda: cl.Cable([0, 0], [0, 0], 1, 2, "fast"), "speed"),
    (lambda: cl.Cable([0, 0], [0, 0], 1, 2, 0.0), "speed"),
    (lambda: cl.Base("b", [0, 0], 0, 1, [0, 0, 0], STAR, [0, 0, 0]), "convex"),
    (lambda: cl.Base("b", [0, 0], 0, 1, [0, 0, 0], [[0, 0], [1, 0], [2, 0]], [0, 0, 0]), "convex"),
    (lambda: cl.Base("b", [0, 0], 0, 1, [0, 0, 0], SQUARE, [-1, 0, 0]), "at least 0"),
    (lambda: cl.Base("b", [0, 0], 0, 1, [0, 0], [[1, 0], [1, 0]], [0, 0, 0]), "different x"),
    (lambda: cl.Platform(1, np.diag([1, 1, 3]), [0] * 3, [1] * 3, [0] * 3), "no rigid body"),
    (lambda: cl.Platform(1, np.eye(3) + np.eye(3, k=1) / 9, [0] * 3, [1] * 3, [0] * 3), "symmetric"),
    (lambda: cl.Platform(1, -1.0, [0] * 2, [1] * 2, [0] * 2), "positive"),
    (lambda: robots.build("3T", [[0, 0, 1]], [[0.1, 0, 0]]), "meet at P"),
    (lambda: robots.build("2R3T", [[0, 0, 1]], [[0.1, 0.1, 0]]), "x′ axis"),
    (lambda: robots.build("2T", [[0, 0, 1]], [[0, 0, 0]]), "exit_point"), (lambda: robots.build("2T", [], []), "cable"),
    (lambda: robots.build("2T", [[0, 1]], [[0, 0]], carriers=["x"]), "unknown base 'x'"),
    (lambda: robot_3t().with_bases({"x": [0, 0, 0]}), "no bases"),
    (lambda: robot_3t().with_payload(-1, [0] * 3), "mass"),
    (lambda: robots.two_bases().with_bases({"left": [0, 0]}), "'left'")])
def test_parts_that_are_none(make, says):
    with pytest.raises(cl.errors.InvalidInput) as raised:
        make()
    assert says in str(raised.value)


def test_a_turned_inertia_with_rounding_is_one():
    turn = cl.Pose([0, 0, 0], [0.3, -0.4, 0.5]).rotation
    cl.Platform(1, turn @ np.diag([0.4, 0.5, 0.6]) @ turn.T, [0] * 3, [1] * 3, [0] * 3)
