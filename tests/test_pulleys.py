"""Cables over pulleys: an independent construction, finite differences, statics, what is refused, and the engines."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import cdprlab as cl
import robots
from cdprlab.mechanics.cables import have_directions, tangent_points
from robots import BASED, ROBOTS, moved, random_poses

SPATIAL_AXES = [[0, 0, 1], [1, 0, 0], [0, -0.6, 0.8], [0.48, 0.6, -0.64]]   # the second is horizontal
PLANAR_AXES = [[0, 1], [1, 0], [-0.6, 0.8], [0, -1]]


def over_pulleys(robot, radius=None, axes=None):
    """The robot, but its cables leave over pulleys; left to choose, of all kinds and one straight from its exit."""
    axes = axes or (SPATIAL_AXES if robot.dimension == 3 else PLANAR_AXES)
    kinds = [cl.Pulley(radius or 0.03 * (1 + i % 3), axes[i % len(axes)]) for i in range(robot.n_cables)]
    if radius is None and robot.n_cables > 3:
        kinds[3] = None
    return replace(robot, cables=tuple(replace(cable, pulley=kind) for cable, kind in zip(robot.cables, kinds)))


PULLEYED = {name: over_pulleys(make()) for name, make in ROBOTS.items()}
each = pytest.mark.parametrize("name", PULLEYED)


def poses_of(robot, count, seed):
    """So many random poses where every cable lies on its pulley."""
    found = random_poses(robot, 3 * count, seed)
    return found[have_directions(robot, found)][:count]


def arc_and_tangent(exit_point, anchor, pulley):
    """Length, wrap angle and tangent point, T found as the point of the wheel whose tangent meets the anchor point."""
    away = anchor - exit_point
    out = away - (away @ pulley.axis) * pulley.axis
    out = out / np.linalg.norm(out)
    center = exit_point + pulley.radius * out

    def wheel(phi):
        return center - pulley.radius * np.cos(phi) * out + pulley.radius * np.sin(phi) * pulley.axis

    def tangent(phi):
        return np.sin(phi) * out + np.cos(phi) * pulley.axis

    def beside(phi):   # of the tangent's line, towards the wheel's center
        return (anchor - wheel(phi)) @ (center - wheel(phi))

    grid = np.linspace(0, np.pi, 200)
    for low, high in zip(grid, grid[1:]):
        if beside(low) * beside(high) <= 0:
            phi = brentq(beside, low, high, xtol=1e-15)
            if (anchor - wheel(phi)) @ tangent(phi) > 0:
                return pulley.radius * phi + np.linalg.norm(anchor - wheel(phi)), phi, wheel(phi)
    raise AssertionError("no tangent")


@each
def test_lengths_directions_and_tangent_points_are_those_of_an_arc_and_a_tangent(name):
    robot = PULLEYED[name]
    for pose in poses_of(robot, 8, 1):
        lengths, starts = cl.cable_lengths(robot, pose), tangent_points(robot, pose)
        vectors, directions = cl.cable_vectors(robot, pose), cl.cable_directions(robot, pose)
        for i, cable in enumerate(robot.cables):
            anchor = pose.position + pose.rotation @ cable.anchor_point
            length, start = np.linalg.norm(robot.exit_points[i] - anchor), robot.exit_points[i]
            if cable.pulley:
                axis = robot.base(cable.base).rotation @ cable.pulley.axis if cable.base else cable.pulley.axis
                length, _, start = arc_and_tangent(start, anchor, cl.Pulley(cable.pulley.radius, axis))
            assert lengths[i] == pytest.approx(length, abs=1e-12)
            np.testing.assert_allclose(starts[i], start, atol=1e-12)
            np.testing.assert_allclose(vectors[i], start - anchor, atol=1e-12)
            np.testing.assert_allclose(directions[i], (start - anchor) / np.linalg.norm(start - anchor), atol=1e-12)


def test_a_length_changes_by_what_the_anchor_point_moves_along_the_cable():
    """l̇ = −u · ḃ at 500 random points about pulleys with random axes."""
    rng = np.random.default_rng(3)
    asked = 0
    while asked < 500:
        axis = rng.normal(size=3)
        robot = robots.build("3T", [rng.uniform(-1, 1, 3)], [[0, 0, 0]])
        robot = over_pulleys(robot, rng.uniform(0.02, 0.2), [axis / np.linalg.norm(axis)])
        b, way = rng.uniform(-3, 3, 3), rng.normal(size=3)
        if not have_directions(robot, cl.Pose(b + np.outer([-1e-3, 0, 1e-3], way))).all():
            continue
        asked += 1
        h = np.array([-2, -1, 1, 2]) * 1e-3      # fourth order: h⁴ l⁽⁵⁾/30 is below rounding
        slope = cl.cable_lengths(robot, cl.Pose(b + np.outer(h, way)))[:, 0] @ [1, -8, 8, -1] / 12e-3
        assert slope == pytest.approx(-cl.cable_directions(robot, cl.Pose(b))[0] @ way, rel=1e-9, abs=1e-9), (b, way)


STEPS, WEIGHTS = np.array([-2, -1, 1, 2]) * 1e-3, np.array([1, -8, 8, -1]) / 12e-3
"""Differences of fourth order: they leave h⁴ f⁽⁵⁾/30, which is below rounding for curves of decimeters and more."""


def slopes(function, robot, pose):
    """(…, n) of a function of poses, which takes a batch of them."""
    n = robot.n_dof
    there = [moved(robot, pose, h * e) for e in np.eye(n) for h in STEPS]
    values = function(cl.Pose.of(np.stack([p.position for p in there]), np.stack([p.rotation for p in there])))
    return np.moveaxis(np.tensordot(WEIGHTS, values.reshape(n, 4, *values.shape[1:]), (0, 1)), 0, -1)


@each
def test_the_jacobian_is_the_slope_of_the_lengths_and_w_is_minus_its_transpose(name):
    robot = PULLEYED[name]
    for pose in poses_of(robot, 25, 5):
        J = slopes(lambda there: cl.cable_lengths(robot, there), robot, pose)
        np.testing.assert_allclose(cl.jacobian(robot, pose), J, rtol=1e-9, atol=1e-9)
        np.testing.assert_array_equal(cl.wrench_matrix(robot, pose), -cl.jacobian(robot, pose).T)


@pytest.mark.parametrize("pivot", ["base", "world"])
@pytest.mark.parametrize("name", BASED)
def test_the_base_jacobian_is_the_slope_of_the_lengths_as_bases_move(name, pivot):
    robot = PULLEYED[name]

    def driven(k, j, h):
        base = robot.bases[k]
        x, y, heading = base.pose
        shift = (base.rotation[:2, :2] @ np.eye(2)[j - 1] * h) if j else np.zeros(2)
        if j == 0 and pivot == "world":
            shift = np.array([np.cos(h) * x - np.sin(h) * y - x, np.sin(h) * x + np.cos(h) * y - y])
        return robot.with_bases({base.name: (x + shift[0], y + shift[1], heading + h * (j == 0))})

    poses = poses_of(robot, 100, 7)
    found = np.stack([np.tensordot(WEIGHTS, [cl.cable_lengths(driven(k, j, h), poses) for h in STEPS], 1)
                      for k in range(len(robot.bases)) for j in range(3)], axis=-1)
    np.testing.assert_allclose(-cl.base_jacobian(robot, poses, pivot), found, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("axial_stiffness", [0.0, 3e4])
@each
def test_the_stiffness_is_the_slope_of_the_cables_wrench(name, axial_stiffness):
    robot, rng = PULLEYED[name], np.random.default_rng(9)
    for pose in poses_of(robot, 13, 9):
        tau, lengths = rng.uniform(50, 500, robot.n_cables), cl.cable_lengths(robot, pose)

        def wrench(there, tau=tau, lengths=lengths):   # Hooke's law, the arc stretching as well
            pulls = (axial_stiffness + tau) * cl.cable_lengths(robot, there) / lengths - axial_stiffness
            return (cl.wrench_matrix(robot, there) @ pulls[..., None])[..., 0]

        found = cl.stiffness(robot, pose, tau, axial_stiffness)
        np.testing.assert_allclose(found, -slopes(wrench, robot, pose), rtol=1e-8, atol=1e-9 * np.abs(found).max())


@pytest.mark.parametrize("name", BASED)
def test_tipping_moments_are_those_of_pulls_at_the_tangent_points(name):
    robot, rng = PULLEYED[name], np.random.default_rng(11)
    for pose in poses_of(robot, 100, 11):
        tau = rng.uniform(0, 400, robot.n_cables)
        starts, u = tangent_points(robot, pose), cl.cable_directions(robot, pose)
        for base in robot.bases:
            loads = [(base.to_world(base.center_of_mass), np.eye(robot.dimension)[-1] * -base.mass * robot.gravity)]
            loads += [(t, -pull * way) for t, pull, way, cable in zip(starts, tau, u, robot.cables)
                      if cable.base == base.name]
            corners = base.to_world(np.pad(base.footprint, ((0, 0), (0, robot.dimension - 2))))
            for k, moment in enumerate(cl.tipping_moments(robot, pose, tau)[base.name]):
                arms = [robots.cross(point - corners[k], force) for point, force in loads]
                if robot.dimension == 3:
                    edge = corners[(k + 1) % len(corners)] - corners[k]
                    total = sum(arms) @ edge / np.linalg.norm(edge)
                else:
                    total = -np.sign(corners[k, 0] - corners[1 - k, 0]) * sum(arms)[0]
                assert moment == pytest.approx(total, rel=1e-9, abs=1e-9)


@each
def test_a_tiny_pulley_is_a_point(name):
    straight, robot = ROBOTS[name](), over_pulleys(ROBOTS[name](), 1e-10)
    poses = poses_of(robot, 25, 13)
    for function in (cl.cable_lengths, cl.cable_vectors, cl.wrench_matrix, cl.base_jacobian):
        np.testing.assert_allclose(function(robot, poses), function(straight, poses), atol=1e-9)
    tau = np.random.default_rng(1).uniform(50, 500, (len(poses), robot.n_cables))
    np.testing.assert_allclose(cl.stiffness(robot, poses, tau, 1e4), cl.stiffness(straight, poses, tau, 1e4), rtol=1e-8,
                               atol=1e-6)   # of 1e4 and more: EA


def test_the_plane_is_space_restricted():
    """(x, y, φ) is (x, 0, y) turned by −φ about y; out of the plane only space can swivel."""
    robot = PULLEYED["1R2T"]
    lifted = [cable.pulley and cl.Pulley(cable.pulley.radius, np.insert(cable.pulley.axis, 1, 0))
              for cable in robot.cables]
    twin = robots.spatial_twin(robot)
    twin = replace(twin, cables=tuple(replace(cable, pulley=kind) for cable, kind in zip(twin.cables, lifted)))
    rows, signs, tau = [0, 2, 4], np.array([1, 1, -1]), np.linspace(50, 200, 4)
    for pose in poses_of(robot, 20, 21):
        there = cl.Pose(np.insert(pose.position, 1, 0), rpy=[0, -pose.angle, 0])
        np.testing.assert_allclose(cl.cable_lengths(twin, there), cl.cable_lengths(robot, pose), rtol=1e-13)
        np.testing.assert_allclose(cl.wrench_matrix(twin, there)[rows] * signs[:, None], cl.wrench_matrix(robot, pose),
                                   atol=1e-13)
        K = cl.stiffness(twin, there, tau, 1e4)[np.ix_(rows, rows)] * np.outer(signs, signs)
        np.testing.assert_allclose(K, cl.stiffness(robot, pose, tau, 1e4), rtol=1e-10, atol=1e-9)


@pytest.mark.parametrize("name", ["1R2T", "3R3T", "2R3T"])
def test_forward_kinematics_recovers_random_poses(name):
    robot = PULLEYED[name]
    for k, pose in enumerate(poses_of(robot, 10, 15)):
        start = moved(robot, pose, np.random.default_rng(k).uniform(-0.1, 0.1, robot.n_dof))
        found = cl.forward_kinematics(robot, cl.cable_lengths(robot, pose), start)
        np.testing.assert_allclose(found.position, pose.position, atol=1e-9)
        np.testing.assert_allclose(found.rotation, pose.rotation, atol=1e-9)
