"""Wrenches, stiffness, payload and tipping against independent computations."""

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
import robots
from robots import BASED, ROBOTS, case, cases, differences, moved, random_pose, random_poses


@pytest.mark.parametrize("name, seed", cases(3))
def test_wrench_matrix_is_minus_the_jacobian_transposed_and_sums_the_pulls(name, seed):
    robot, pose = case(name, seed)
    w = cl.wrench_matrix(robot, pose)
    np.testing.assert_array_equal(w, -cl.jacobian(robot, pose).T)
    for i, (a, b) in enumerate(zip(robot.exit_points, robot.anchor_points)):
        arm = pose.rotation @ b
        u = a - pose.position - arm
        u = u / np.linalg.norm(u)
        np.testing.assert_allclose(w[:, i], robots.in_rows(robot, pose, u, robots.cross(arm, u)), atol=1e-13)


@pytest.mark.parametrize("name, seed", cases(3))
def test_gravity_wrench_is_the_slope_of_the_potential(name, seed):
    robot, pose = case(name, seed)

    def energy(x):
        there = moved(robot, pose, x)
        center = there.position + there.rotation @ robot.platform.center_of_mass
        return robot.mass * robot.gravity * center[-1]

    # energies of a few hundred joule: rounding 1e-13 / 1e-5
    np.testing.assert_allclose(cl.gravity_wrench(robot, pose), -differences(energy, robot.n_dof, 1e-5), atol=1e-6)


@pytest.mark.parametrize("name, seed", cases(3))
@pytest.mark.parametrize("axial_stiffness", [0.0, 3e4])
def test_stiffness_is_the_derivative_of_the_cables_wrench(name, seed, axial_stiffness):
    robot, pose = case(name, seed)
    tau = np.random.default_rng(seed).uniform(50, 500, robot.n_cables)
    lengths = cl.cable_lengths(robot, pose)

    def wrench(x):   # Hooke's law T = EA (l − l₀) / l₀ with l₀ = EA l / (EA + τ) as it is, written for EA = 0 too
        there = moved(robot, pose, x)
        return cl.wrench_matrix(robot, there) @ ((axial_stiffness + tau) * cl.cable_lengths(robot, there) / lengths
                                                 - axial_stiffness)

    expected = -differences(wrench, robot.n_dof, 1e-5)
    # third derivatives up to 1e5 times h²/6, rounding 1e-13 * 1e3 / 1e-5
    np.testing.assert_allclose(cl.stiffness(robot, pose, tau, axial_stiffness), expected, atol=2e-5)


def test_stiffness_with_the_weight_is_symmetric_at_rest():
    """With the center of mass off P the cables' own part is not: it differs by the moment they exert."""
    caroca = cl.load_world("caroca")
    robot = caroca.robot.with_payload(50.0, [0.2, -0.1, 0.15])
    pose = cl.Pose([0.3, 0.2, 1.0], rpy=[0.1, -0.05, 0.2])
    weight = cl.gravity_wrench(robot, pose)
    tau = cl.distribute_tensions(cl.wrench_matrix(robot, pose), weight, robot.tension_min, robot.tension_max).tensions
    own, whole = (cl.stiffness(robot, pose, tau, 1e5, weight=on) for on in (False, True))
    size = np.abs(own).max()
    assert np.abs(whole - whole.T).max() < 1e-12 * size < np.abs(own - own.T).max()
    np.testing.assert_allclose(np.abs(own - own.T).max(), np.abs(weight[3:]).max(), rtol=1e-6)


def test_stiffness_of_a_batch_and_of_unequal_cables():
    robot = ROBOTS["3R3T"]()
    poses, tau = random_poses(robot, 4, seed=5), np.random.default_rng(5).uniform(50, 500, (4, 8))
    ea = np.linspace(1e4, 1e5, 8)
    looped = np.stack([cl.stiffness(robot, poses[i], tau[i], ea) for i in range(4)])
    np.testing.assert_allclose(cl.stiffness(robot, poses, tau, ea), looped, rtol=1e-12, atol=1e-8)
    parts = sum(cl.stiffness(robot, poses[0], 0 * tau[0], ea * e) for e in np.eye(8))
    np.testing.assert_allclose(cl.stiffness(robot, poses[0], 0 * tau[0], ea), parts, rtol=1e-12, atol=1e-8)


@pytest.mark.parametrize("ea", [-1.0, np.nan, np.ones(3), np.ones((2, 8))])
def test_axial_stiffness_that_is_none(ea):
    with pytest.raises(cl.errors.InvalidInput, match="axial_stiffness"):
        cl.stiffness(*case("3R3T", 0), np.ones(8), ea)


@pytest.mark.parametrize("seed", range(5))
def test_planar_is_spatial_turned_by_minus_phi(seed):
    robot = ROBOTS["1R2T"]()
    twin, pose = robots.spatial_twin(robot), random_pose(robot, seed)
    x, y = pose.position
    there = cl.Pose([x, 0, y], rpy=[0, -float(pose.angle), 0])
    np.testing.assert_allclose(cl.cable_lengths(twin, there), cl.cable_lengths(robot, pose), rtol=1e-14)
    rows, sign = [0, 2, 4], np.array([1, 1, -1])
    np.testing.assert_allclose(cl.wrench_matrix(twin, there)[rows] * sign[:, None],
                               cl.wrench_matrix(robot, pose), atol=1e-14)
    np.testing.assert_allclose(cl.gravity_wrench(twin, there)[rows] * sign, cl.gravity_wrench(robot, pose), atol=1e-12)
    tau = np.random.default_rng(seed).uniform(10, 100, 4)
    k = cl.stiffness(twin, there, tau, 1e4)[np.ix_(rows, rows)] * np.outer(sign, sign)
    np.testing.assert_allclose(k, cl.stiffness(robot, pose, tau, 1e4), rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_planar_tipping_is_spatial_tipping_about_the_two_cross_edges(seed):
    exits, anchors = [[-0.3, 2.0], [0.4, 1.0]], [[-0.2, 0.1], [0.2, 0.1]]
    flat = cl.Base("b", [0.5, 0.0], 0.0, 50.0, [0.1, 0.6], [[0.4, 0], [-0.5, 0]], [0, 0, 0])
    box = cl.Base("b", [0.5, 0.0], 0.0, 50.0, [0.1, 0.0, 0.6], [[0.4, -1], [0.4, 1], [-0.5, 1], [-0.5, -1]], [0, 0, 0])
    planar = robots.build("1R2T", exits, anchors, bases=[flat], carriers=["b", "b"])
    spatial = robots.build("3R3T", [[x, 0, y] for x, y in exits], [[x, 0, y] for x, y in anchors], bases=[box],
                    carriers=["b", "b"])
    rng = np.random.default_rng(seed)
    (x, y), phi, tau = rng.uniform(2, 3, 2), rng.uniform(-1, 1), rng.uniform(0, 300, 2)
    edges = cl.tipping_moments(spatial, cl.Pose([x, 0, y], rpy=[0, -phi, 0]), tau)["b"]
    contacts = cl.tipping_moments(planar, cl.Pose([x, y], angle=phi), tau)["b"]
    np.testing.assert_allclose(contacts, edges[[0, 2]], rtol=1e-12)


@pytest.mark.parametrize("name", BASED)
def test_bases_stand_under_their_own_weight(name):
    robot, pose = case(name, 1)
    moments = cl.tipping_moments(robot, pose, np.zeros(robot.n_cables))
    assert list(moments) == ["left", "right"]
    assert all((m < 0).all() for m in moments.values())


def test_edges_run_counter_clockwise_from_the_first_contact_whichever_way_listed():
    robot, pose = case("two bases", 2)
    tau = np.linspace(100, 300, 8)
    mirrored = tuple(cl.Base(b.name, b.position, b.heading, b.mass, b.center_of_mass,
                          np.concatenate([b.footprint[:1], b.footprint[:0:-1]]), b.speed_max) for b in robot.bases)
    other = cl.Robot(robot.pattern, robot.platform, robot.cables, mirrored)
    for name, moments in cl.tipping_moments(robot, pose, tau).items():
        np.testing.assert_array_equal(cl.tipping_moments(other, pose, tau)[name], moments)


@pytest.mark.parametrize("seed", range(4))
def test_tipping_moments_edge_by_edge(seed):
    robot, pose = case("two bases", seed)
    tau = np.random.default_rng(seed).uniform(0, 400, 8)
    for base in robot.bases:
        corners = base.to_world(np.pad(base.footprint, ((0, 0), (0, 1))))
        for k, moment in enumerate(cl.tipping_moments(robot, pose, tau)[base.name]):
            start, end = corners[k], corners[(k + 1) % len(corners)]
            axis = (end - start) / np.linalg.norm(end - start)
            loads = robots.pulls_on(robot, pose, base, tau)
            total = sum(axis @ np.cross(point - start, force) for point, force in loads)
            assert moment == pytest.approx(total, abs=1e-9)


def wheels_hold(robot, pose, base, tau):
    """Whether non-negative vertical wheel reactions balance the base (friction at floor height unlimited)."""
    contacts = base.to_world(np.pad(base.footprint, ((0, 0), (0, 1)))) if robot.dimension == 3 else \
        base.to_world(base.footprint)
    loads = robots.pulls_on(robot, pose, base, tau)
    force = sum(f for _, f in loads)
    moment = sum(robots.cross(point, f) for point, f in loads)
    if robot.dimension == 3:
        rows = np.stack([np.ones(len(contacts)), contacts[:, 1], -contacts[:, 0]])
        goal = [force[2], moment[0], moment[1]]
    else:
        rows, goal = np.stack([np.ones(2), contacts[:, 0]]), [force[1], moment[0]]
    return linprog(np.zeros(len(contacts)), A_eq=rows, b_eq=-np.array(goal), method="highs").status == 0


@pytest.mark.parametrize("name", BASED)
def test_tipping_agrees_with_wheel_reactions(name):
    robot = BASED[name]()
    if robot.dimension == 2:    # both contacts on the floor, so that friction turns nothing
        robot = robot.with_bases({"left": (-3.0, 0.0, 0.0)})
    poses, rng, seen = random_poses(robot, 200, seed=9), np.random.default_rng(9), set()
    tau = rng.uniform(0, 400 if robot.dimension == 3 else 700, (200, robot.n_cables)) * rng.uniform(0, 1, (200, 1))
    moments = cl.tipping_moments(robot, poses, tau)
    for i in range(200):
        for base in robot.bases:
            worst = moments[base.name][i].max()
            if abs(worst) > 1e-3:   # LP tolerance 1e-7 on forces of hundreds of newton
                assert wheels_hold(robot, poses[i], base, tau[i]) == (worst < 0)
                seen.add(bool(worst < 0))
    assert seen == {True, False}


@pytest.mark.parametrize("function", [cl.tipping_moments, lambda *args: cl.stiffness(*args, 1e4)])
@pytest.mark.parametrize("shape", [(7,), (2, 8)])
def test_tensions_that_do_not_fit(function, shape):
    with pytest.raises(cl.errors.InvalidInput, match="tensions"):
        function(ROBOTS["two bases"](), random_poses(ROBOTS["two bases"](), 3, seed=0), np.ones(shape))


def test_without_a_footprint_a_base_is_fastened():
    robot = ROBOTS["two bases"]()
    bases = tuple(cl.Base(b.name, b.position, b.heading, b.mass, b.center_of_mass, [], b.speed_max)
                  for b in robot.bases)
    assert cl.tipping_moments(cl.Robot(robot.pattern, robot.platform, robot.cables, bases),
                              random_pose(robot, 0), np.ones(8)) == {}
