"""Loads that hang still: statics, the energy around, and the engine agree."""

import dataclasses

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InvalidInput, NoConvergence
from cdprlab.mechanics.kinematics import moved
from robots import ROBOTS


def hung(cables, d, seed=0):
    """A plate or box below some exits, and a guess at it."""
    rng = np.random.default_rng(seed)
    exits = np.zeros((cables, d))
    angles = 2 * np.pi * np.arange(cables) / cables
    exits[:, 0], exits[:, -1] = 2 * np.cos(angles), 3.0
    if d == 3:
        exits[:, 1] = 2 * np.sin(angles)
    else:
        exits[:, 0] = np.linspace(-2, 2, cables)
    anchors = exits * 0.1
    anchors[:, -1] = 0.1
    center = [0.02] * (d - 1) + [-0.05]
    document = {"name": "hung", "motion_pattern": "3R3T" if d == 3 else "1R2T",
                "platform": {"mass": 10.0, "size": [0.4] * d, "center_of_mass": center,
                             "inertia": [0.3, 0.3, 0.3] if d == 3 else 0.3,
                             "pose": {"position": [0.0] * (d - 1) + [1.0],
                                      **({"rpy": [0, 0, 0]} if d == 3 else {"angle": 0})}},
                "cables": [{"exit_point": a.tolist(), "anchor_point": b.tolist(), "tension": [0, 1e4]}
                           for a, b in zip(exits, anchors)]}
    world = cl.World.from_dict(document)
    return world, rng


@pytest.mark.parametrize("cables, d", [(2, 2), (3, 2), (2, 3), (3, 3), (4, 3), (6, 3)])
def test_a_load_at_rest_is_balanced_and_lies_nowhere_lower(cables, d):
    world, rng = hung(cables, d)
    robot, lengths = world.robot, cl.cable_lengths(world.robot, world.pose) + rng.uniform(0, 0.05, cables)
    pose, tensions = cl.equilibrium(robot, lengths, world.pose)
    w = cl.gravity_wrench(robot, pose)
    np.testing.assert_allclose(cl.wrench_matrix(robot, pose) @ tensions + w, 0, atol=1e-8 * np.abs(w).max())
    over = cl.cable_lengths(robot, pose) - lengths
    assert over.max() < 1e-6 and (tensions >= 0).all() and (np.abs(over[tensions > 0]) < 1e-8).all()

    def height(at):
        return (at.position + at.rotation @ robot.platform.center_of_mass)[-1]

    for step in 0.01 * rng.normal(size=(200, robot.n_dof)):   # whatever the cables allow nearby is higher
        near = moved(robot, pose, step)
        excess = max((cl.cable_lengths(robot, near) - lengths).max(), 0.0)
        assert height(near) > height(pose) - 1e-9 - 5 * excess


@pytest.mark.parametrize("name", [name for name in cl.world_names() if cl.load_world(name).robot.gravity])
def test_who_hangs_on_its_lengths_hangs_there(name):
    """Redundant cables, of which rounding decides who carries next to nothing, included."""
    world = cl.load_world(name)
    for pose in (world.pose, world.task().end):
        found = cl.equilibrium(world.robot, cl.cable_lengths(world.robot, pose), pose)
        np.testing.assert_allclose(found.pose.position, pose.position, atol=1e-9)
        np.testing.assert_allclose(cl.wrench_matrix(world.robot, pose) @ found.tensions,
                                   -cl.gravity_wrench(world.robot, pose), atol=1e-7 * world.robot.mass)


def test_a_slack_cable_carries_nothing():
    world, _ = hung(3, 2)
    lengths = cl.cable_lengths(world.robot, world.pose) + [0, 0.5, 0]
    found = cl.equilibrium(world.robot, lengths, world.pose)
    assert found.tensions[1] == 0 and (found.tensions[[0, 2]] > 0).all()
    assert cl.cable_lengths(world.robot, found.pose)[1] < lengths[1] - 0.1


def test_the_engine_comes_to_rest_there():
    """Three ropes on a box in PyBullet: put there at rest it stays, without damping to help."""
    world, _ = hung(3, 3)
    lengths = cl.cable_lengths(world.robot, world.pose)
    pose, _ = cl.equilibrium(world.robot, lengths, world.pose)
    with cl.open_simulator(world, "length") as simulator:
        simulator.reset(pose)
        for _ in range(200):
            simulator.wind(lengths)
        state = simulator.state()
    np.testing.assert_allclose(state.position, pose.position, atol=1e-5)   # it began at rest, and stays
    np.testing.assert_allclose(state.rotation, pose.rotation, atol=1e-5)


def test_what_equilibrium_refuses():
    world, _ = hung(2, 2)
    lengths = cl.cable_lengths(world.robot, world.pose)
    for bad in ([1.0], -lengths, lengths * np.nan):
        with pytest.raises(InvalidInput):
            cl.equilibrium(world.robot, bad, world.pose)
    with pytest.raises(InvalidInput, match="one pose"):
        cl.equilibrium(world.robot, lengths, cl.Pose([[0, 1], [0, 2]], angle=0.0))
    with pytest.raises(NoConvergence):
        cl.equilibrium(world.robot, [0.1, 0.1], world.pose)   # 3.6 m apart: nothing spans them


def test_all_solutions_are_distinct_and_begin_with_the_plain_one():
    """Four bars in the plane, two of them mirrored: more than one assembly, each with these lengths."""
    robot = cl.load_world("planar_rigid").robot
    truth = cl.Pose([0.3, 1.2], angle=0.2)
    lengths, guess = cl.cable_lengths(robot, truth), cl.Pose([0.25, 1.25], angle=0.1)
    found = cl.forward_kinematics(robot, lengths, guess, all_solutions=True)
    plain = cl.forward_kinematics(robot, lengths, guess)
    np.testing.assert_array_equal(found[0].position, plain.position)
    for pose in found:
        np.testing.assert_allclose(cl.cable_lengths(robot, pose), lengths, atol=1e-9)
    two = ROBOTS["2T"]()
    two = dataclasses.replace(two, cables=two.cables[:2])
    A, B = two.exit_points
    above = np.array([A[1] - B[1], B[0] - A[0]]) / np.linalg.norm(B - A)   # a point has its mirror image
    at = cl.Pose(0.4 * A + 0.6 * B + 0.4 * above)
    poses = cl.forward_kinematics(two, cl.cable_lengths(two, at), at, all_solutions=True)
    assert len(poses) == 2
    apart = [np.abs(a.position - b.position).max() for i, a in enumerate(poses) for b in poses[:i]]
    assert min(apart, default=1.0) > 1e-5
    with pytest.raises(InvalidInput, match="all_solutions"):
        cl.forward_kinematics(robot, np.stack([lengths, lengths]), guess, all_solutions=True)
