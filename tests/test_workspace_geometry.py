"""Interference, stability and twists: distances against brute force, stiffness and speeds against first principles."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.mechanics.cables import anchor_offsets
from cdprlab.workspace.distances import box_distance, segment_distance
from cdprlab.workspace.interference import cable_distances, cable_pairs, obstacle_distances, platform_distances
from cdprlab.workspace.stability import smallest_stiffness
from cdprlab.world import Box
from robots import ROBOTS, case, differences, moved, random_poses, robot_1r2t, robot_3r3t, two_bases, two_planar_bases

FINE = np.linspace(0, 1, 201)


def brute_segments(p, q, r, s):
    """Smallest distance of a point on rs from pq, each of these in closed form, on a fine grid: above by at most h."""
    points = r + FINE[:, None] * (s - r)
    u = q - p
    t = np.clip((points - p) @ u / max(u @ u, 1e-300), 0, 1)
    return np.linalg.norm(points - p - t[:, None] * u, axis=1).min()


def brute_box(p, q, half):
    points = p + np.linspace(0, 1, 2001)[:, None] * (q - p)
    return np.linalg.norm(np.maximum(np.abs(points) - half, 0), axis=1).min()


@pytest.mark.parametrize("d", [2, 3])
def test_segment_distance_is_the_brute_force_minimum(d):
    rng = np.random.default_rng(d)
    ends = rng.uniform(-1, 1, (4, 300, d))
    ends[1, :20] = ends[0, :20]                                         # points
    ends[3, 20:60] = ends[2, 20:60] + 0.7 * (ends[1, 20:60] - ends[0, 20:60])   # parallel
    ends[2, 60:80] = ends[0, 60:80]                                     # a shared end
    ends[3, 80:110] = ends[2, 80:110] + (1 + 1e-9) * (ends[1, 80:110] - ends[0, 80:110])   # almost parallel
    found = segment_distance(*ends)
    brute = np.array([brute_segments(*ends[:, k]) for k in range(300)])
    step = np.linalg.norm(ends[3] - ends[2], axis=1) / 200
    # On the grid the distance is at most half a step too large, and never too small.
    assert (found <= brute + 1e-12).all() and (brute <= found + step / 2 + 1e-12).all()
    # And no closer pair of points exists near the grid's best: refined along rs.
    for k in range(0, 300, 10):
        p, q, r, s = ends[:, k]
        u = q - p

        def gap(x, p=p, r=r, s=s, u=u):
            at = r + x * (s - r)
            return np.linalg.norm(at - p - np.clip((at - p) @ u / max(u @ u, 1e-300), 0, 1) * u)

        assert min(minimize_scalar(gap, bounds=(0, 1), options={"xatol": 1e-12}, method="bounded").fun,
                   gap(0.0), gap(1.0)) == pytest.approx(found[k], abs=1e-6)


@pytest.mark.parametrize("d", [2, 3])
def test_box_distance_is_the_brute_force_minimum(d):
    rng = np.random.default_rng(10 + d)
    p, q, half = rng.uniform(-3, 3, (400, d)), rng.uniform(-3, 3, (400, d)), rng.uniform(0.2, 1, (400, d))
    q[:30] = p[:30]
    q[30:90, 0] = p[30:90, 0]                                           # along a face
    found = box_distance(p, q, half)
    brute = np.array([brute_box(*part) for part in zip(p, q, half)])
    step = np.linalg.norm(q - p, axis=1) / 2000
    assert (found <= brute + 1e-12).all() and (brute <= found + step / 2 + 1e-12).all()
    assert (found == 0).any() and (found > 0).any()


def test_interference_margin_is_the_smallest_distance_of_all():
    robot, poses = robot_3r3t(), random_poses(robot_3r3t(), 25, 1, turn=0.9)
    box = Box(np.array([1.0, 0.5, 2.2]), np.array([0.4, 0.8, 0.6]), 0.7, "obstacle", "pillar")
    found = cl.workspace(robot, poses, cl.InterferenceFree(0.02, obstacles=(box,)))
    turn = cl.Pose([0, 0, 0], rpy=[0, 0, 0.7]).rotation
    for k, pose in enumerate(poses):
        anchors = pose.position + anchor_offsets(robot, pose)
        u = cl.cable_directions(robot, pose)
        gaps = [brute_segments(anchors[i], robot.exit_points[i], anchors[j], robot.exit_points[j])
                for i, j in cable_pairs(robot)]
        body = [((x - pose.position) @ pose.rotation for x in (a + 0.2 * v, e))   # ten times the clearance
                for a, v, e in zip(anchors, u, robot.exit_points)]
        gaps += [brute_box(*ends, robot.platform.size / 2) for ends in body]
        gaps += [brute_box((a - box.position) @ turn, (e - box.position) @ turn, box.size / 2)
                 for a, e in zip(anchors, robot.exit_points)]
        assert min(gaps) - 0.02 - 0.02 < found.margin[k] <= min(gaps) - 0.02 + 1e-12
        assert found.inside[k] == (found.margin[k] >= 0)


def test_cables_that_share_an_end_are_not_compared():
    robot = robot_3r3t()
    shared = sum(np.allclose(points[i], points[j]) for points in (robot.exit_points, robot.anchor_points)
                 for i in range(8) for j in range(i))
    assert len(cable_pairs(robot)) == 28 - shared and shared > 0
    assert cable_distances(ROBOTS["3T"](), cl.Pose([0, 0, 1])).shape == (0,)


def test_crossing_cables_touch_in_the_plane():
    straight, crossed = (dataclasses.replace(robot_1r2t(), cables=tuple(
        dataclasses.replace(cable, anchor_point=0.2 * sign * np.sign(cable.exit_point))
        for cable in robot_1r2t().cables)) for sign in (1, -1))
    pose = cl.Pose([[0.0, 0.0]])
    assert cl.InterferenceFree().judge(straight, pose).inside[0]
    assert platform_distances(straight, pose).min() > 0
    for looked_at in ({"platform": False}, {"cables": False}):
        assert not cl.InterferenceFree(**looked_at).judge(crossed, pose).inside[0]


def test_obstacles_live_in_the_robot_s_dimension():
    with pytest.raises(InvalidInput, match="2 edges"):
        obstacle_distances(robot_3r3t(), cl.Pose([0, 0, 1]), Box(np.zeros(2), np.ones(2), 0.0, "box"))


# --- stability ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["1R2T", "2R3T", "3R3T", "two bases"])
def test_weight_stiffness_is_the_difference_quotient_of_the_weight(name):
    robot, pose = case(name, 5)
    robot = dataclasses.replace(robot, platform=dataclasses.replace(
        robot.platform, center_of_mass=[0.1, -0.2, 0.3][:robot.dimension]))

    def full(step):
        """The wrench in world axes, also where the pattern's rows turn along."""
        there = moved(robot, pose, step)
        arm, force = there.rotation @ robot.platform.center_of_mass, np.zeros(robot.dimension)
        force[-1] = -robot.mass * robot.gravity
        moment = np.cross(arm, force) if robot.dimension == 3 else [arm[0] * force[1]]
        return np.concatenate([force, moment])

    basis = robot.pattern.basis(pose.rotation)
    expected = -basis.T @ differences(full, robot.n_dof, 1e-6)
    loads = np.linspace(10, 90, robot.n_cables)
    added = cl.stiffness(robot, pose, loads, 1e4, weight=True) - cl.stiffness(robot, pose, loads, 1e4)
    np.testing.assert_allclose(added, expected, atol=1e-6 * robot.mass)


def test_pushed_from_a_stable_pose_the_wrench_pushes_back():
    """At constant unstrained lengths the work of any small displacement is that of the smallest eigenvalue or more."""
    robot, pose = robot_3r3t(), cl.Pose([0.3, -0.2, 1.2], rpy=[0.05, 0.1, -0.1])
    W, w = cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose)
    tau = cl.distribute_tensions(W, w, robot.tension_min, robot.tension_max).tensions
    smallest, ea = float(smallest_stiffness(robot, pose, tau, 5e4)), 5e4
    free = cl.cable_lengths(robot, pose) / (1 + tau / ea)

    def unbalanced(step):
        there = moved(robot, pose, step)
        pulls = ea * (cl.cable_lengths(robot, there) / free - 1)
        return cl.wrench_matrix(robot, there) @ pulls + cl.gravity_wrench(robot, there)

    rng = np.random.default_rng(6)
    for way in rng.normal(size=(20, 6)):
        way *= 1e-5 / np.linalg.norm(way)
        # Unstrained lengths make the axial stiffness EA / l₀, larger than EA / l by the strain.
        assert -way @ unbalanced(way) >= smallest * (way @ way) * (1 - 1e-3)


def test_pretension_stiffens_the_weak_direction():
    """A planar robot with cables in one line: across it only tension resists."""
    robot = cl.load_world("planar_rigid").robot
    poses = cl.Pose([[0.0, 1.0], [0.3, 0.8]])
    base = cl.StaticallyStable(axial_stiffness=1e5).judge(robot, poses)
    tight = dataclasses.replace(robot, cables=tuple(dataclasses.replace(c, tension_min=0.9 * c.tension_max)
                                                    for c in robot.cables))
    found = cl.StaticallyStable(axial_stiffness=1e5).judge(tight, poses)
    assert base.inside.all() and (np.isnan(found.margin) | (found.margin > base.margin)).all()


# --- twists -------------------------------------------------------------------------------------------
def quick(robot, speed=2.0):
    return dataclasses.replace(robot, cables=tuple(dataclasses.replace(c, speed_max=speed) for c in robot.cables))


@pytest.mark.parametrize("robot", [two_bases(), two_planar_bases()], ids=["spatial", "planar"])
@pytest.mark.parametrize("moving", ["none", "all", "left"])
def test_twists_are_feasible_where_the_twist_set_holds_them(robot, moving):
    robot, n = quick(robot), robot.n_dof
    poses, twists = random_poses(robot, 6, 7), np.random.default_rng(8).uniform(-2.0, 2.0, (3, n))
    for twist in twists:
        found = cl.TwistFeasible(twist, moving=moving).judge(robot, poses)
        expected = [bool(cl.available_twist_set(robot, pose, moving).contains(twist)) for pose in poses]
        assert found.inside.tolist() == expected and ((found.margin >= 0) == expected).all()


@pytest.mark.parametrize("moving", ["none", "all"])
def test_a_box_of_twists_is_feasible_where_the_set_reaches_its_corners(moving):
    robot = quick(two_planar_bases())
    poses, half = random_poses(robot, 8, 9), np.array([0.9, 0.7, 2.0])
    found = cl.TwistFeasible(half_widths=half, moving=moving).judge(robot, poses)
    corners = half * np.array([[a, b, c] for a in (1, -1) for b in (1, -1) for c in (1, -1)])
    expected = [bool(cl.available_twist_set(robot, pose, moving).contains(corners).all()) for pose in poses]
    assert found.inside.tolist() == expected
    assert np.isinf(cl.TwistFeasible(half_widths=half).judge(two_planar_bases(), poses).margin).all()
