"""Cables over pulleys: an independent construction, finite differences, statics, what is refused, and the engines."""

import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq, root
from test_rest import hung

import cdprlab as cl
import robots
from cdprlab.mechanics.cables import have_directions, tangent_points
from cdprlab.view.outlines import strung
from cdprlab.workspace.certified import certify
from cdprlab.workspace.interference import obstacle_distances
from cdprlab.world import Box
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
    for pose in poses_of(robot, 5, 1):
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


# --- engines --------------------------------------------------------------------------------------------
def settled(world, cables, lengths, start):
    """The engine's state once a braked load hangs still on ropes of these lengths, let go at a pose nearby."""
    robot = world.robot
    brake = np.array([45.0] * robot.dimension + [3.0] * (robot.n_dof - robot.dimension))
    with cl.open_simulator(world, cables) as simulator:
        simulator.reset(start)
        for k in range(3500):
            if not k % 5:
                simulator.push(-brake * simulator.twist[:robot.n_dof])
            simulator.wind(lengths)
        assert np.abs(simulator.twist).max() < 1e-5
        return simulator.state()


def stretched(robot, lengths, guess):
    """The pose where ropes of these unstrained lengths balance the weight by Hooke's law, arcs and all."""
    ea = robot.elasticity.axial_stiffness

    def unrest(x):
        there = moved(robot, guess, x)
        pulls = ea * (cl.cable_lengths(robot, there) / lengths - 1)
        return cl.wrench_matrix(robot, there) @ pulls + cl.gravity_wrench(robot, there)

    return moved(robot, guess, root(unrest, np.zeros(robot.n_dof), tol=1e-13).x)


@pytest.mark.parametrize("cables, d, axis", [(2, 2, [0, 1]), (3, 3, [0.6, 0, 0.8])])
def test_a_load_on_pulleys_comes_to_rest_where_statics_says(cables, d, axis):
    if d == 3:
        pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    world, _ = hung(cables, d)
    world = replace(world, robot=over_pulleys(world.robot, 0.08, [axis]))
    lengths = cl.cable_lengths(world.robot, world.pose) + np.linspace(0, 0.03, cables)
    rest = cl.equilibrium(world.robot, lengths, world.pose)
    state = settled(world, "length", lengths, world.pose)
    np.testing.assert_allclose(state.position, rest.pose.position, atol=1e-5)
    np.testing.assert_allclose(state.rotation, rest.pose.rotation, atol=1e-5)
    np.testing.assert_allclose(state.tensions, rest.tensions, atol=0.01)   # a leg's tip weighs 1e-3 N


@pytest.mark.parametrize("radius", [None, 0.08])
def test_a_load_on_cables_that_stretch_rests_where_statics_says(radius):
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    world, _ = hung(3, 3)
    robot = over_pulleys(world.robot, radius, [[0, 0, 1]]) if radius else world.robot
    world = replace(world, robot=replace(robot, elasticity=cl.Elasticity(2e4, 0.1)))
    lengths = cl.cable_lengths(world.robot, world.pose) + np.linspace(0, 0.02, 3)
    stiff = cl.equilibrium(world.robot, lengths, world.pose)
    pose = stretched(world.robot, lengths, stiff.pose)
    assert np.linalg.norm(pose.position - stiff.pose.position) > 1e-3
    state = settled(world, "elastic", lengths, world.pose)
    np.testing.assert_allclose(state.position, pose.position, atol=1e-5)
    np.testing.assert_allclose(state.rotation, pose.rotation, atol=1e-5)


def fastkit(radius=0.06):
    """FASTKIT, its bases free to turn and drive, every cable over a pulley that comes from below."""
    world = cl.load_world("fastkit_suspended")
    robot = over_pulleys(world.robot, radius, [[0, 0, 1]])
    free = tuple(replace(base, speed_max=np.full(3, 0.2)) for base in robot.bases)
    return replace(world, robot=replace(robot, bases=free))


def holding(simulator):
    """Tensions that balance the platform's weight."""
    robot = simulator.world.robot
    weight = cl.gravity_wrench(robot, simulator.state().pose)
    return cl.distribute_tensions(simulator.wrench_matrix, weight, robot.tension_min, robot.tension_max).tensions


def test_wheels_of_bases_carry_what_pulls_at_the_tangent_points():
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    world = fastkit()
    with cl.open_simulator(world, bodies=True) as simulator:
        for _ in range(300):
            tau = holding(simulator)
            simulator.step(tau)
        np.testing.assert_allclose(simulator.tensions, tau, atol=2e-3)   # put together again from leg and rest
        assert np.linalg.norm(simulator.position - world.pose.position) < 2e-4
        for base in world.robot.bases:
            load, corners = simulator.wheel_loads()[base.name], base.footprint
            rows = cl.tipping_moments(world.robot, simulator.state().pose, tau)[base.name]
            points = cl.tipping_moments(cl.load_world("fastkit_suspended").robot, world.pose, tau)[base.name]
            assert np.abs(rows - points).max() > 1
            for k, moment in enumerate(rows):
                along = corners[(k + 1) % 4] - corners[k]
                inward = (corners - corners[k]) @ [-along[1], along[0]] / np.linalg.norm(along)
                assert -moment == pytest.approx(load @ inward, abs=0.02)   # of 400 N m


@pytest.mark.parametrize("name", ["spatial", "planar"])
def test_exits_of_bases_that_turn_and_drive_go_as_the_base_jacobian_says(name):
    speeds = np.array([0.15, 0.1, 0.05, -0.1, 0.1, -0.1])
    if name == "spatial":
        pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
        world, options, off = fastkit(), {"bodies": True}, 1e-4   # motors lag
    else:
        world, options, off = cl.load_world("planar_mcdpr"), {"cables": "length"}, 1e-4   # a step's mean velocity
        robot = over_pulleys(world.robot, 0.05, [[0, 1]])
        free = tuple(replace(base, speed_max=np.ones(3)) for base in robot.bases)
        world = replace(world, robot=replace(robot, bases=free))
    with cl.open_simulator(world, **options) as simulator:
        simulator.drive(speeds)
        for _ in range(200):
            if name == "spatial":
                simulator.step(holding(simulator))
            else:
                simulator.wind(simulator.lengths)
        robot, pose = simulator.robot, simulator.state().pose
        np.testing.assert_allclose(simulator.lengths, cl.cable_lengths(robot, pose), atol=1e-5)
        velocities = simulator.exit_velocities if name == "spatial" else simulator.bases.reel_velocities
        rates = (cl.cable_directions(robot, pose) * velocities).sum(axis=-1)
        np.testing.assert_allclose(rates, -cl.base_jacobian(robot, pose) @ speeds, atol=off)


@pytest.mark.parametrize("cables", ["tension", "length", "elastic"])
def test_ropes_over_pulleys_hold_the_platform_while_a_planar_base_turns_and_drives(cables):
    world = cl.load_world("planar_mcdpr")
    robot = over_pulleys(world.robot, 0.05, [[0, 1]])
    free = tuple(replace(base, speed_max=np.ones(3)) for base in robot.bases)
    robot = replace(robot, bases=free, elasticity=cl.Elasticity(1e5, 0.1))
    world = replace(world, robot=robot)
    with cl.open_simulator(world, cables) as simulator:
        held = cl.distribute_tensions(simulator.wrench_matrix, cl.gravity_wrench(robot, world.pose), robot.tension_min,
                                      robot.tension_max).tensions
        law, still = cl.ComputedTorque(), cl.hold(world.pose, 1.0)(0.0)
        simulator.drive([0.1, -0.2, 0, 0, 0, 0])
        for k in range(1, 301):
            heading = 1e-4 * k
            base = world.robot.bases[0]
            place = base.position + np.array([-np.sin(heading), np.cos(heading) - 1]) * 2
            ahead = world.robot.with_bases({base.name: (*place, heading)})
            lengths = cl.cable_lengths(ahead, world.pose)
            if cables == "length":
                simulator.wind(lengths)
            elif cables == "elastic":
                simulator.wind(robot.elasticity.unstrained(lengths, held))
            else:
                wanted = law(0.0, simulator.state(), still)
                simulator.step(cl.distribute_tensions(simulator.wrench_matrix, -wanted, robot.tension_min,
                                                      robot.tension_max).tensions)
            assert np.abs(simulator.position - world.pose.position).max() < 1e-4


# --- what cannot be ---------------------------------------------------------------------------------------
def hook(radius=0.1, axis=(0, 0, 1)):
    """A point on one cable over a pulley at the origin."""
    return over_pulleys(robots.build("3T", [[0, 0, 0]], [[0, 0, 0]], limits=(0, 1000)), radius, [axis])


WRONG = [([0, 0, -2], "on the line that it comes along"), ([0, 0, 2], "on the line that it comes along"),
         ([0.1, 0.05, 0], "inside the wheel of its pulley, whose radius is 0.1 m"),
         ([0.15, 0, -2], "more than half a turn")]


@pytest.mark.parametrize("place, reason", WRONG)
@pytest.mark.parametrize("function", [cl.cable_lengths, cl.cable_vectors, cl.cable_directions, cl.wrench_matrix,
                                      cl.jacobian, cl.base_jacobian])
def test_a_cable_that_cannot_lie_on_its_pulley_is_named(function, place, reason):
    good = [1.0, 0.5, -1.0]
    with pytest.raises(cl.errors.InvalidInput, match=f"cable 1 has no direction at this pose.*{reason}"):
        function(hook(), cl.Pose(place))
    with pytest.raises(cl.errors.InvalidInput, match=f"cable 1 has no direction at pose 2 of the batch.*{reason}"):
        function(hook(), cl.Pose([good, good, place]))
    function(hook(), cl.Pose([good, good]))


def test_half_a_turn_is_the_most():
    robot = hook()
    assert cl.cable_lengths(robot, cl.Pose([0.2 + 1e-9, 0, -2]))[0] == pytest.approx(0.1 * np.pi + 2, abs=1e-8)
    np.testing.assert_allclose(cl.cable_directions(robot, cl.Pose([0.2 + 1e-9, 0, -2]))[0], [0, 0, 1], atol=1e-8)
    # As good as straight on: no wrap at all.
    assert cl.cable_lengths(robot, cl.Pose([1e-6, 0, 2]))[0] == pytest.approx(2, abs=1e-9)


def test_a_sweep_calls_such_poses_outside_and_says_why():
    robot = PULLEYED["3R3T"]
    poses = random_poses(robot, 30, 2)
    places = poses.position.copy()
    places[[4, 17]] = robot.exit_points[0] - [0, 0, 1] - robot.anchor_points[0]
    for chunk in (7, 4096):
        with pytest.warns(cl.errors.CdprWarning, match=r"2 of 30 poses are outside .* cable 1 has no direction"):
            found = cl.workspace(robot, cl.Pose(places), cl.WrenchFeasible(), chunk=chunk)
        assert not found.inside[[4, 17]].any() and np.isnan(found.margin[[4, 17]]).all()
    kept = np.delete(np.arange(30), [4, 17])
    np.testing.assert_array_equal(found.inside[kept],
                                  cl.workspace(robot, cl.Pose(places[kept]), cl.WrenchFeasible()).inside)


def test_forward_kinematics_that_comes_to_a_wheel_does_not_converge():
    robot = hook()
    with pytest.raises(cl.errors.NoConvergence, match="start nearer"):
        cl.forward_kinematics(robot, [1.0], cl.Pose([0, 0, -2.0]))


@pytest.mark.parametrize("radius, axis, words", [
    (0.0, [0, 0, 1], "radius must be positive"), (np.nan, [0, 0, 1], "radius"), (0.1, [0, 0, 0], "unit"),
    (0.1, [0, 0, 2], "unit vector.*of length 2"), (0.1, [0, np.nan, 1], "axis"), (0.1, 3.0, "axis")])
def test_a_pulley_that_is_none(radius, axis, words):
    with pytest.raises(cl.errors.InvalidInput, match=words):
        cl.Pulley(radius, axis)


def test_a_pulley_lives_in_its_cables_dimension():
    with pytest.raises(cl.errors.InvalidInput, match="axis of a pulley must be 3 numbers"):
        cl.Cable([0, 0, 0], [0, 0, 0], 0, 1, pulley=cl.Pulley(0.1, [0, 1]))
    np.testing.assert_array_equal(cl.Pulley(0.1, [0.7071, 0.7071]).axis, np.full(2, np.sqrt(0.5)))


def test_proofs_say_that_they_know_points_only():
    robot = PULLEYED["3R3T"]
    with pytest.raises(cl.errors.InvalidInput, match="pulleys: use workspace"):
        certify(robot, [0, 0, 1], [0.1, 0.1, 1.1])
    for question in (lambda: cl.classify_configurations(PULLEYED["3T"], [0, 0, 1]),
                     lambda: cl.plan_configurations(PULLEYED["3T"], [0, 0, 1], [0.5, 0, 1])):
        with pytest.raises(cl.errors.InvalidInput, match="pulleys"):
            question()
    world = fastkit()
    poses, weight = cl.Pose([[0, 0, 0.5]]), cl.gravity_wrench(world.robot, world.pose)
    with pytest.raises(cl.errors.NoPlacement, match="a search, no proof"):
        cl.place_bases(world.robot, poses, 100 * weight, evaluations=1)


@pytest.mark.parametrize("name", ["point_mass", "planar_point"])
def test_a_load_that_comes_under_its_pulley_ends_the_flight_and_says_why(name):
    if name == "point_mass":
        pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    world = cl.load_world(name)
    d = world.robot.dimension
    world = replace(world, robot=over_pulleys(world.robot, 0.05, [np.eye(d)[-1]]))
    exit_point = world.robot.exit_points[0]
    towards = np.zeros(d)
    towards[0] = np.sign(world.pose.position[0] - exit_point[0])
    start = exit_point + 0.3 * towards - np.eye(d)[-1]
    with cl.open_simulator(world, "force") as simulator:
        simulator.reset(cl.Pose(start))
        simulator.push(-2000 * towards)
        with pytest.raises(cl.errors.SimulationDiverged, match="cable 1 has no direction at this pose") as caught:
            for _ in range(300):
                simulator.step(np.zeros(world.robot.n_cables))
    assert caught.value.time > 0 and caught.value.cable == 1


# --- what is drawn and told ---------------------------------------------------------------------------------
def test_pictures_and_interference_begin_at_the_tangent_points():
    world = cl.load_world("caroca_pulleys")
    robot, pose = world.robot, world.pose
    ropes = 1.1 * cl.cable_lengths(robot, pose)
    lines, wheels = strung(robot, pose, np.zeros(robot.n_cables), ropes)
    starts, arcs = lines[:, 0], cl.cable_lengths(robot, pose) - np.linalg.norm(cl.cable_vectors(robot, pose), axis=1)
    np.testing.assert_allclose(starts, tangent_points(robot, pose), rtol=0, atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(np.diff(lines, axis=1), axis=-1).sum(axis=1), ropes - arcs, rtol=1e-10)
    for exit_point, start, wheel in zip(robot.exit_points, starts, wheels):
        center = wheel[:-1].mean(axis=0)
        for point in (exit_point, start, *wheel):
            assert np.linalg.norm(point - center) == pytest.approx(0.045, abs=1e-12)
    obstacle = Box(starts[0], np.full(3, 0.002))
    assert obstacle_distances(robot, pose, obstacle)[0] < 1e-9
    assert obstacle_distances(cl.load_world("caroca").robot, pose, obstacle)[0] > 0.01


def test_the_page_tells_what_is_computed():
    page = script_of("pulleys")
    for name in ("lengths", "stretch", "pretension"):
        told = f"<!-- table {name} -->\n\n{page.TABLES[name]()}\n\n<!-- end -->"
        assert told in page.PAGE.read_text("utf-8"), "run docs/pulleys.py"


def script_of(name):
    """The script of a page, which is no part of the package."""
    folder = Path(__file__).parent.parent / "docs"
    sys.path.insert(0, str(folder))
    try:
        return import_module(name)
    finally:
        sys.path.remove(str(folder))
