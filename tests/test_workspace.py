"""Criteria of workspaces against independent linear programs, and against each other."""

import dataclasses
import itertools

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.mechanics.dynamics import mass_matrix
from cdprlab.workspace import AllOrientations, AnyOrientation, position_grid
from cdprlab.workspace.margins import tension_margins
from robots import case, random_poses, robot_1r2t, robot_3r3t, two_bases

WORLDS = ("caroca", "planar_rigid", "ipanema3", "planar_point", "kntu_planar", "cogiro", "robocrane")


def around(robot, count, seed, turn=0.2):
    """Random poses in and somewhat beyond the box of the exits: on both sides of the border."""
    low, high = robot.exit_points.min(axis=0), robot.exit_points.max(axis=0)
    low = np.where(high - low < 0.5, high - 3.0, low)   # exits in one plane: below it
    rng = np.random.default_rng(seed)
    position = rng.uniform(low - 0.1 * (high - low), high + 0.1 * (high - low), (count, len(low)))
    angles = rng.uniform(-turn, turn, (count, 3))
    return cl.Pose(position, angle=angles[:, 0]) if len(low) == 2 else cl.Pose(position, rpy=angles)


def lp_margin(W, w_e, low, high, at_high=True):
    """max s with W τ + w_e = 0 and low + s ≤ τ ≤ high − s, by HiGHS; −inf where nothing balances w_e."""
    m = W.shape[1]
    rows = np.block([[-np.eye(m), np.ones((m, 1))], [np.eye(m), np.full((m, 1), float(at_high))]])
    finite = np.isfinite(np.concatenate([low, high]))
    found = linprog(np.append(np.zeros(m), -1), A_ub=rows[finite], b_ub=np.concatenate([-low, high])[finite],
                    A_eq=np.column_stack([W, np.zeros(len(W))]), b_eq=-w_e, bounds=(None, None), method="highs")
    return -found.fun if found.status == 0 else -np.inf


@pytest.mark.parametrize("name", WORLDS)
def test_tension_margin_equals_a_linear_program(name):
    robot = cl.load_world(name).robot
    poses = around(robot, 40, 1)
    W, w = cl.wrench_matrix(robot, poses), np.broadcast_to(cl.gravity_wrench(robot, poses), (40, robot.n_dof))
    found = cl.WrenchFeasible().judge(robot, poses)
    expected = np.array([lp_margin(*pose, robot.tension_min, robot.tension_max) for pose in zip(W, w)])
    # 1e-7 of the largest limit is what HiGHS keeps its rows to.
    close = 1e-7 * robot.tension_max.max()
    np.testing.assert_allclose(found.margin, expected, rtol=1e-7, atol=close)
    sure = np.abs(expected) > close
    assert (found.inside == (expected > 0))[sure].all() and sure.sum() > 0


@pytest.mark.parametrize("name, lower, upper, step", [
    ("planar_rigid", [-2, -2], [2, 3], 0.2), ("planar_suspended", [-2, 0], [2, 3], 0.25),
    ("point_mass", [-2.2, -2.1, 0], [2.2, 2.1, 3.2], 0.6), ("caroca", [-3.5, 0.5, 0], [3.5, 0.5, 3.5], 0.35)])
def test_every_grid_point_agrees_with_an_independent_linear_program(name, lower, upper, step):
    """HiGHS asked for any tensions within the limits, not for a margin; ours tells how far from the border we are."""
    robot, grid = cl.load_world(name).robot, position_grid(lower, upper, step)
    found = cl.workspace(robot, grid, cl.WrenchFeasible())
    W, limits = cl.wrench_matrix(robot, grid.poses), list(zip(robot.tension_min, robot.tension_max))
    w = np.broadcast_to(cl.gravity_wrench(robot, grid.poses), W.shape[:2])
    expected = np.array([linprog(np.zeros(len(limits)), A_eq=a, b_eq=-b, bounds=limits, method="highs").status == 0
                         for a, b in zip(W, w)])
    sure = np.abs(found.margin) > 1e-6 * robot.tension_max.max()
    assert (found.inside == expected)[sure].all() and sure.mean() > 0.9
    assert found.inside.any() and not found.inside.all()


@pytest.mark.parametrize("redundancy", [0, 1, 2, 3])
@pytest.mark.parametrize("at_high", [True, False])
def test_margins_of_random_matrices(redundancy, at_high):
    """Wrenches within reach, on the far side, and W without full rank; one cable's limits may be equal."""
    rng = np.random.default_rng(10 * redundancy + at_high)
    n, m = 3, 3 + redundancy
    W, low, high = rng.normal(size=(60, n, m)), rng.uniform(0, 2, m), rng.uniform(2, 9, m)
    low[0] = high[0] if redundancy == 2 else low[0]
    W[:10, 2] = W[:10, 0] + W[:10, 1]
    w = -(W @ rng.uniform(-4, 12, (60, m, 1)))[..., 0]
    found = tension_margins(W, w, low, high, at_high=at_high)
    expected = np.array([lp_margin(*pose, low, high, at_high) for pose in zip(W, w)])
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("name", WORLDS)
def test_verdict_without_margin_is_the_margin_s_sign(name):
    robot = cl.load_world(name).robot
    poses = around(robot, 300, 2)
    full, quick = (cl.workspace(robot, poses, cl.WrenchFeasible(), margin=margin) for margin in (True, False))
    sure = np.abs(full.margin) > 1e-7 * robot.tension_max.max()
    assert (full.inside == quick.inside)[sure].all() and np.isnan(quick.margin).all()


def test_a_cable_without_length_is_named_and_puts_its_pose_outside():
    robot = cl.load_world("planar_point").robot
    poses = cl.Pose(np.concatenate([robot.exit_points[:2], [[1.0, 1.0]]]))
    with pytest.raises(InvalidInput, match=r"cable [12] has no length"):
        cl.WrenchFeasible().judge(robot, poses)
    found = cl.workspace(robot, poses, cl.WrenchFeasible() & cl.StaticEquilibrium())
    assert found.inside.tolist() == [False, False, True] and np.isnan(found.margin).tolist() == [True, True, False]


# --- facets -------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", WORLDS)
def test_facets_and_tensions_agree_on_hulls_and_boxes(name):
    robot = cl.load_world(name).robot
    rng, poses = np.random.default_rng(4), around(robot, 150, 4)
    half, loads = rng.uniform(0, robot.mass, robot.n_dof), rng.normal(size=(3, robot.n_dof)) * robot.mass
    by_facets = cl.workspace(robot, poses, cl.WrenchFeasible(loads, half))
    by_tensions = cl.workspace(robot, poses, cl.WrenchFeasible(loads, half, by="tensions"))
    sure = np.abs(by_tensions.margin) > 1e-7 * robot.tension_max.max()
    assert (by_facets.inside == by_tensions.inside)[sure].all()
    quick = cl.workspace(robot, poses, cl.WrenchFeasible(loads, half), margin=False)
    assert (quick.inside == by_facets.inside).all()


@pytest.mark.parametrize("name", ["caroca", "planar_rigid", "planar_point", "kntu_planar", "robocrane"])
def test_capacity_margin_is_the_distance_to_the_nearest_facet_of_the_set(name):
    robot = cl.load_world(name).robot
    rng, poses = np.random.default_rng(5), around(robot, 12, 5)
    half = rng.uniform(0, robot.mass, robot.n_dof)
    corners = np.array(list(itertools.product(*zip(-half, half))))
    found = cl.WrenchFeasible(half_widths=half).judge(robot, poses).margin
    for pose, margin in zip(poses, found):
        aws = cl.available_wrench_set(robot, pose)
        points = -cl.gravity_wrench(robot, pose) - corners
        expected = (aws.offsets[:, None] - aws.normals @ points.T).min()
        assert margin == pytest.approx(expected, rel=1e-7, abs=1e-7 * robot.tension_max.max())


@pytest.mark.parametrize("redundancy", [3, 4])
def test_more_cables_than_the_compiled_kernels_take(redundancy):
    """Facets, verdict and margin of the same robot."""
    m = 3 + redundancy
    angles = 2 * np.pi * (np.arange(m) + 0.3) / m
    exits, anchors = 3 * np.exp(1j * angles), 0.3 * np.exp(1j * (angles + 0.4))
    cables = tuple(cl.Cable([a.real, a.imag], [b.real, b.imag], 5.0, 300.0) for a, b in zip(exits, anchors))
    robot = dataclasses.replace(robot_1r2t(), cables=cables)
    poses = cl.Pose(np.random.default_rng(6).uniform(-2.5, 2.5, (40, 2)))
    answers = [cl.workspace(robot, poses, criterion, margin=margin).inside
               for criterion in (cl.WrenchFeasible(by="facets"), cl.WrenchFeasible()) for margin in (True, False)]
    assert 0 < answers[0].sum() < 40
    assert all((answer == answers[0]).all() for answer in answers)


def test_flat_sets_hold_flat_boxes_only():
    """Cables 1 and 2 pull along one line: the vertical force is out of their reach."""
    robot = cl.load_world("planar_point").robot
    line = dataclasses.replace(robot, gravity=0.0, cables=tuple(
        dataclasses.replace(cable, exit_point=[x, 1.0]) for cable, x in zip(robot.cables, (-2, 2, -3, 3))))
    pose = cl.Pose([[0.1, 1.0]])
    for half, inside in (([10.0, 0.0], True), ([0.0, 1.0], False), ([1e6, 0.0], False)):
        for by in ("facets", "tensions"):
            assert cl.WrenchFeasible(half_widths=half, by=by).judge(line, pose).inside[0] == inside


# --- the other criteria of tensions -------------------------------------------------------------------
@pytest.mark.parametrize("name", ["ipanema3", "planar_rigid", "kntu_planar", "caroca"])
def test_wrench_closure_means_that_huge_limits_balance_any_wrench(name):
    robot = cl.load_world(name).robot
    rng, poses = np.random.default_rng(7), around(robot, 60, 7, turn=0.1)
    found = cl.workspace(robot, poses, cl.WrenchClosure())
    W = cl.wrench_matrix(robot, poses)
    for k in range(60):
        spanned = all(linprog(np.zeros(W.shape[2]), A_eq=W[k], b_eq=w, bounds=(0, None), method="highs").status == 0
                      for w in np.concatenate([np.eye(robot.n_dof), -np.eye(robot.n_dof),
                                               rng.normal(size=(5, robot.n_dof))]))
        assert spanned == found.inside[k] or abs(found.margin[k]) < 1e-6
    assert name == "caroca" or found.inside.any()


@pytest.mark.parametrize("name", ["caroca", "cogiro", "robocrane", "planar_suspended"])
def test_static_equilibrium_asks_for_a_non_negative_balance(name):
    robot = cl.load_world(name).robot
    poses = around(robot, 60, 8, turn=0.02)
    found = cl.workspace(robot, poses, cl.StaticEquilibrium())
    W, w = cl.wrench_matrix(robot, poses), np.broadcast_to(cl.gravity_wrench(robot, poses), (60, robot.n_dof))
    balanced = [linprog(np.ones(W.shape[2]), A_eq=a, b_eq=-b, bounds=(0, None), method="highs") for a, b in zip(W, w)]
    # The criterion looks at tensions up to a hundred weights.
    expected = np.array([f.status == 0 and f.x.max() < 50 * robot.mass * robot.gravity for f in balanced])
    sure = np.abs(found.margin) > 1e-6 * robot.mass * robot.gravity
    assert (expected == found.inside)[sure].all() and found.inside.any()


def test_dynamic_equilibrium_is_feasibility_of_the_inertial_wrenches():
    robot = cl.load_world("cogiro").robot
    poses, half = around(robot, 50, 9), np.array([1.0, 0.5, 2.0, 0.0, 0.3, 0.0])
    found = cl.workspace(robot, poses, cl.DynamicEquilibrium(half))
    assert (cl.workspace(robot, poses, cl.DynamicEquilibrium(half), margin=False).inside == found.inside).all()
    for k in range(0, 50, 7):
        M = mass_matrix(robot, poses)[k]
        corners = -np.array(list(itertools.product(*zip(-half, half)))) @ M.T
        assert cl.WrenchFeasible(corners).judge(robot, poses[k:k + 1]).margin[0] == pytest.approx(found.margin[k])


@pytest.mark.parametrize("name", ["1R2T", "3T", "2R3T", "3R3T"])
def test_mass_matrix_gives_the_kinetic_energy(name):
    """Off-center mass: ½ t·M t = ½ m |v + ω × R c|² + ½ ω·I ω."""
    from robots import build, full_twist

    robot, pose = case(name, 3)
    robot = build(name, robot.exit_points, robot.anchor_points)   # its center of mass off P
    t = np.random.default_rng(10).normal(size=robot.n_dof)
    v, w = full_twist(robot, pose, t)
    arm = pose.rotation @ robot.platform.center_of_mass
    if robot.dimension == 2:
        velocity, spin = v + w[0] * np.array([-arm[1], arm[0]]), robot.platform.inertia * w[0]**2
    else:
        velocity = v + np.cross(w, arm)
        spin = w @ pose.rotation @ robot.platform.inertia @ pose.rotation.T @ w
    energy = 0.5 * robot.mass * velocity @ velocity + 0.5 * spin
    M = mass_matrix(robot, cl.Pose(pose.position[None], matrix=pose.rotation[None]))[0]
    assert 0.5 * t @ M @ t == pytest.approx(energy, rel=1e-12)


def test_tipping_margin_is_reached_and_not_exceeded():
    robot = two_bases()
    poses = random_poses(robot, 10, 11)
    margin = cl.workspace(robot, poses, cl.TippingSafe()).margin
    assert np.isfinite(margin).any()
    for k, pose in ((k, pose) for k, pose in enumerate(poses) if np.isfinite(margin[k])):
        rows = cl.tipping_rows(robot, pose)
        A, b = (np.concatenate([getattr(row, part) for row in rows.values()]) for part in ("matrix", "offset"))
        W, w = cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose)
        for share, feasible in ((1 - 1e-6, True), (1 + 1e-6, False)):
            asked = margin[k] * share if margin[k] > 0 else margin[k] / share
            found = linprog(np.zeros(8), A_ub=A, b_ub=-b - asked, A_eq=W, b_eq=-w,
                            bounds=list(zip(robot.tension_min, robot.tension_max)), method="highs")
            assert (found.status == 0) == feasible


# --- combinations -------------------------------------------------------------------------------------
def test_both_and_orientations():
    robot, grid = robot_3r3t(), position_grid([-3, 0, 0.5], [3, 0, 3], 0.5)
    tilts = [[a, 0.1, 0] for a in (-0.3, 0.0, 0.3)]
    single = [cl.WrenchFeasible().judge(robot, cl.Pose(grid.poses.position, rpy=tilt)) for tilt in tilts]
    every = cl.workspace(robot, grid, AllOrientations(cl.WrenchFeasible(), tilts))
    some = cl.workspace(robot, grid, AnyOrientation(cl.WrenchFeasible(), tilts))
    assert (every.inside == np.all([s.inside for s in single], axis=0)).all()
    assert (some.inside == np.any([s.inside for s in single], axis=0)).all()
    assert (every.margin == np.min([s.margin for s in single], axis=0)).all()
    both = cl.workspace(robot, grid, cl.WrenchFeasible() & cl.StaticEquilibrium())
    one, two = (cl.workspace(robot, grid, c) for c in (cl.WrenchFeasible(), cl.StaticEquilibrium()))
    assert (both.inside == (one.inside & two.inside)).all()
    assert (both.margin == np.minimum(one.margin, two.margin)).all()
    mixed = cl.workspace(robot, grid, cl.WrenchFeasible() & cl.WrenchClosure())
    assert np.isnan(mixed.margin).all() and not mixed.inside.any()


@pytest.mark.parametrize("criterion, message", [
    (cl.WrenchFeasible([1.0, 2.0]), "wrenches"),
    (cl.WrenchFeasible(half_widths=[-1.0] * 6), "must not be negative"),
    (cl.WrenchFeasible(by="magic"), "'tensions' or 'facets'"),
    (cl.TippingSafe(), "this robot has none"),
    (cl.TwistFeasible(), "one of the two"),
    (cl.StaticallyStable(), "axial_stiffness"),
    ("wrench_feasible", "must be a Criterion"),
])
def test_what_does_not_fit_is_said(criterion, message):
    with pytest.raises(InvalidInput, match=message):
        cl.workspace(cl.load_world("caroca").robot, cl.Pose([[0, 0, 1.0]]), criterion)
