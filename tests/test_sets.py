"""Available twist and wrench sets: against linear programs, sampled speeds, wheel reactions and the papers."""

import dataclasses
import itertools
import pickle

import numpy as np
import pytest
from programs import lp_support
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

import cdprlab as cl
import robots
from cdprlab.course.props.submatrices import submatrix_twist_set
from cdprlab.errors import InvalidInput
from cdprlab.sets import sliding_rows, twist_set
from robots import BASED, ROBOTS, case, random_poses


def with_speeds(robot, speed=2.0):
    """All cables at most this fast."""
    return dataclasses.replace(robot, cables=tuple(dataclasses.replace(c, speed_max=speed) for c in robot.cables))


def with_tensions(robot, low, high):
    """All cables between these tensions."""
    return dataclasses.replace(robot, cables=tuple(dataclasses.replace(c, tension_min=low, tension_max=high)
                                                   for c in robot.cables))


def planar_case(**speeds):
    """Rasheed et al. 2018, sec. 4.1: a point on four cables from two bases; the geometry is chosen."""
    bases = [cl.Base(name, [x, 0.0], 0.0, 40.0, [0.0, 0.5], [[-0.4, 0], [0.4, 0]], [0.0, 0.8, 0.0])
             for name, x in (("left", 0.0), ("right", 2.0))]
    robot = robots.build("2T", [[0, 0.25], [0, 2.0]] * 2, [[0, 0]] * 4, bases=bases,
                         carriers=["left", "left", "right", "right"], center_of_mass=[0, 0])
    return with_speeds(robot), cl.Pose([1.0, 1.6])


# --- twist ---------------------------------------------------------------------------------------------------------

def twist_lp(robot, pose, pivot, directions):
    """max d·t over t and base speeds, rows written out from the equation."""
    J, B, q = cl.jacobian(robot, pose), cl.base_jacobian(robot, pose, pivot), robot.base_speed_max
    A = np.block([[J, -B], [-J, B]])
    b = np.concatenate([robot.speed_max, robot.speed_max])
    free = [(None, None)] * J.shape[1] + [(-v, v) for v in q]
    return [-linprog(-np.concatenate([d, 0 * q]), A_ub=A, b_ub=b, bounds=free, method="highs").fun for d in directions]


@pytest.mark.parametrize("name", BASED)
@pytest.mark.parametrize("pivot", ["base", "world"])
def test_moving_twist_supports_at_50_poses_in_200_directions(name, pivot):
    robot = with_speeds(BASED[name]())
    rng = np.random.default_rng(1)
    for pose in (random_poses(robot, 50, seed=1)[i] for i in range(50)):
        ats, d = cl.available_twist_set(robot, pose, pivot=pivot), rng.normal(size=(200, robot.n_dof))
        h = ats.support(d)
        np.testing.assert_allclose(h, lp_support(ats, d), rtol=0, atol=1e-9)
        np.testing.assert_allclose(h[:1], twist_lp(robot, pose, pivot, d[:1]), rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", ["1T", "2T", "1R2T", "3T", "2R3T", "3R3T", *BASED])
def test_fixed_bases_leave_the_cables_speeds(name):
    robot, pose = with_speeds(ROBOTS[name]()), robots.random_pose(ROBOTS[name](), 2)
    ats = cl.available_twist_set(robot, pose, moving="none")
    t = np.random.default_rng(2).normal(size=(300, robot.n_dof)) * 2
    speeds = np.abs(t @ cl.jacobian(robot, pose).T)
    np.testing.assert_array_equal(ats.contains(t), (speeds <= robot.speed_max).all(axis=1))
    np.testing.assert_allclose((ats.normals @ ats.vertices.T).max(axis=1), ats.offsets, atol=1e-8)


@pytest.mark.parametrize("name", BASED)
def test_facets_of_the_moving_set_are_support_planes_and_enough(name):
    robot, pose = with_speeds(BASED[name]()), robots.random_pose(BASED[name](), 3)
    ats = cl.available_twist_set(robot, pose)
    np.testing.assert_allclose(ats.support(ats.normals), ats.offsets, rtol=0, atol=1e-8)
    d = np.random.default_rng(3).normal(size=(200, robot.n_dof))
    np.testing.assert_allclose(cl.Polytope.from_rows(ats.normals, ats.offsets).support(d), ats.support(d),
                               rtol=0, atol=1e-8)
    planes = np.unique(ConvexHull(ats.vertices).equations.round(5), axis=0) if robot.n_dof == 3 else ats.normals
    assert len(planes) == len(ats.normals)


@pytest.mark.parametrize("name", BASED)
def test_more_moving_bases_never_take_a_twist_away(name):
    robot, pose = with_speeds(BASED[name]()), robots.random_pose(BASED[name](), 4)
    d = np.random.default_rng(4).normal(size=(100, robot.n_dof))
    h = {str(moving): cl.available_twist_set(robot, pose, moving=moving).support(d)
         for moving in ("none", "left", "right", ("left", "right"), "all")}
    assert (h["none"] <= h["left"] + 1e-12).all() and (h["left"] <= h["all"] + 1e-12).all()
    assert (h["none"] < h["all"]).any()
    np.testing.assert_array_equal(h["all"], h["('left', 'right')"])


def test_the_two_pivots_give_different_sets():
    robot, pose = with_speeds(ROBOTS["two bases"]()), robots.random_pose(ROBOTS["two bases"](), 5)
    base, world = (cl.available_twist_set(robot, pose, pivot=pivot).component_range() for pivot in ("base", "world"))
    assert np.abs(base - world).max() > 0.01


def test_planar_case_has_the_areas_and_scales_of_its_geometry():
    robot, pose = planar_case()
    fixed, moving = (cl.available_twist_set(robot, pose, moving=m) for m in ("none", "all"))
    assert fixed.volume == pytest.approx(13.663988, abs=5e-7)
    assert moving.volume == pytest.approx(22.576722, abs=5e-7)
    wanted = [1.15, 1.675]
    assert not fixed.contains(wanted) and moving.contains(wanted)
    assert fixed.scale(wanted) == pytest.approx(0.984994, abs=5e-7)
    assert moving.scale(wanted) == pytest.approx(1.219512, abs=5e-7)


def test_planar_case_by_sampling_base_speeds():
    robot, pose = planar_case()
    moving = cl.available_twist_set(robot, pose)
    J, B = cl.jacobian(robot, pose), cl.base_jacobian(robot, pose)[:, [1, 4]]
    grid = np.linspace(-0.8, 0.8, 17)
    d = np.random.default_rng(6).normal(size=(40, 2))
    best = np.full(40, -np.inf)
    for q in itertools.product(grid, grid):
        standing = cl.Polytope.from_rows(np.concatenate([J, -J]), np.concatenate([2 + B @ q, 2 - B @ q]))
        h = standing.support(d)
        assert (h <= moving.support(d) + 1e-9).all()
        best = np.maximum(best, h)
    # The support is concave in the base speeds; between grid points 0.1 m/s apart it gains at most |slope| 0.05 each.
    np.testing.assert_allclose(best, moving.support(d), rtol=0, atol=0.1)


@pytest.mark.parametrize("name", BASED)
def test_submatrices_are_exact_where_every_base_moves_by_itself(name):
    robot, pose = with_speeds(BASED[name]()), robots.random_pose(BASED[name](), 7)
    for pivot in ("base", "world"):
        J, B = cl.jacobian(robot, pose), cl.base_jacobian(robot, pose, pivot)
        found = submatrix_twist_set(J, B, robot.speed_max, robot.base_speed_max)
        assert found.exact
        d = np.random.default_rng(7).normal(size=(5, robot.n_dof))
        exact = cl.available_twist_set(robot, pose, pivot=pivot).support(d)
        np.testing.assert_allclose(found.set.support(d), exact, rtol=0, atol=1e-8)


def test_submatrices_are_too_generous_with_a_shared_actuator():
    found = submatrix_twist_set([[1], [1]], [[1], [-1]], [2, 2], [0.8])
    assert not found.exact
    assert found.set.support([1.0]) == pytest.approx(2.8)
    assert twist_set([[1], [1]], [[1], [-1]], [2, 2], [0.8]).support([1.0]) == pytest.approx(2.0)
    with pytest.raises(InvalidInput, match="regular"):
        submatrix_twist_set([[1, 1]], [[0]], [1], [1])


def test_cables_without_a_speed_limit_bound_nothing():
    robot, pose = case("two bases", 8)
    ats = cl.available_twist_set(robot, pose)
    assert np.isinf(ats.component_range()).all() and ats.contains(1e6 * np.ones(6))


@pytest.mark.parametrize("moving", ["middle", ("left", "middle")])
def test_unknown_moving_base(moving):
    with pytest.raises(InvalidInput, match="left, right"):
        cl.available_twist_set(*case("two bases", 0), moving=moving)


@pytest.mark.parametrize("function", [cl.available_twist_set, cl.available_wrench_set])
def test_a_set_is_asked_pose_by_pose(function):
    robot = ROBOTS["two bases"]()
    with pytest.raises(InvalidInput, match="one pose"):
        function(robot, random_poses(robot, 2, seed=0))


# --- wrench --------------------------------------------------------------------------------------------------------

def heavier(robot, mass=400.0):
    """Bases that do not tip at the smallest tensions."""
    return dataclasses.replace(robot, bases=tuple(dataclasses.replace(b, mass=mass) for b in robot.bases))


@pytest.mark.parametrize("name", BASED)
@pytest.mark.parametrize("tipping", [False, True])
def test_wrench_supports_at_50_poses_in_200_directions(name, tipping):
    robot = with_tensions(heavier(BASED[name]()), 5.0, 2000.0)
    rng, poses, bites = np.random.default_rng(10), random_poses(robot, 50, seed=10), 0
    for pose in (poses[i] for i in range(50)):
        aws, d = cl.available_wrench_set(robot, pose, tipping=tipping), rng.normal(size=(200, robot.n_dof))
        h = aws.support(d)
        # forces of thousands of newton: 1e-9 of that
        np.testing.assert_allclose(h, lp_support(aws, d), rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(h[:1], wrench_lp(robot, pose, tipping, d[:1]), rtol=1e-9, atol=1e-9)
        bites += (h < cl.available_wrench_set(robot, pose).support(d) - 1.0).any()
    assert bites == (50 if tipping else 0)


def wrench_lp(robot, pose, tipping, directions):
    """max d·W τ with moments written as the library's own `tipping_moments` of single tensions."""
    W, m = cl.wrench_matrix(robot, pose), robot.n_cables
    A, b = np.zeros((1, m)), np.zeros(1)
    if tipping:
        rest = np.concatenate(list(cl.tipping_moments(robot, pose, np.zeros(m)).values()))
        each = np.stack([np.concatenate(list(cl.tipping_moments(robot, pose, e).values())) for e in np.eye(m)], axis=1)
        A, b = each - rest[:, None], -rest
    limits = np.stack([robot.tension_min, robot.tension_max], axis=1)
    return [-linprog(-d @ W, A_ub=A, b_ub=b, bounds=limits, method="highs").fun for d in directions]


@pytest.mark.parametrize("name", ["1T", "2T", "1R2T", "3T", "2R3T", "3R3T"])
def test_wrench_facets_equal_qhulls_hull_of_all_corners(name):
    robot, pose = case(name, 11)
    aws = cl.available_wrench_set(robot, pose)
    corners = np.array(list(itertools.product(*zip(robot.tension_min, robot.tension_max)))) \
        @ cl.wrench_matrix(robot, pose).T
    np.testing.assert_allclose(aws.component_range(), np.stack([corners.min(axis=0), corners.max(axis=0)], axis=1),
                               rtol=1e-12, atol=1e-9)
    if robot.n_dof == 1:
        return
    size = np.ptp(corners, axis=0)
    planes = np.unique(ConvexHull(corners / size).equations.round(7), axis=0)
    mine = np.column_stack([aws.normals * size, -aws.offsets])
    mine /= np.linalg.norm(mine[:, :-1], axis=1)[:, None]
    assert len(planes) == len(mine)
    assert (np.abs(planes[:, None] - mine[None]).max(axis=-1).min(axis=0) < 1e-6).all()


@pytest.mark.parametrize("name", cl.world_names())
@pytest.mark.parametrize("middle", [False, True])
def test_every_world_at_its_symmetric_poses(name, middle):
    """Where many cables lie in a plane, planes coincide and corners are shared: facets are still Qhull's."""
    world = cl.load_world(name)
    robot, pose = world.robot, world.pose
    if middle:
        upright = np.append(np.zeros(robot.dimension - 1), pose.position[-1])
        pose = cl.Pose(upright, angle=0.0) if robot.dimension == 2 else cl.Pose(upright)
    aws, d = cl.available_wrench_set(robot, pose), np.random.default_rng(18).normal(size=(60, robot.n_dof))
    scale = np.abs(aws.component_range()).max()
    np.testing.assert_allclose((d @ aws.vertices.T).max(axis=1), aws.support(d), rtol=0, atol=1e-9 * scale)
    assert aws.contains(aws.vertices).all()
    if aws.dimension == robot.n_dof > 1:
        corners = np.array(list(itertools.product(*zip(robot.tension_min, robot.tension_max)))) \
            @ cl.wrench_matrix(robot, pose).T
        hull = ConvexHull(corners / np.ptp(corners, axis=0))
        assert len(np.unique(hull.equations.round(6), axis=0)) == len(aws.normals)
        assert aws.volume == pytest.approx(hull.volume * np.ptp(corners, axis=0).prod(), rel=1e-6)
    standing = cl.available_wrench_set(robot, pose, tipping=True)
    if not standing.is_empty:
        np.testing.assert_allclose(standing.support(d), lp_support(standing, d), rtol=0, atol=1e-9 * scale)
    if np.isfinite(robot.speed_max).all():
        ats = cl.available_twist_set(robot, pose)
        np.testing.assert_allclose(ats.support(d), lp_support(ats, d), rtol=0, atol=1e-9)
        np.testing.assert_allclose((d @ ats.vertices.T).max(axis=1), ats.support(d), rtol=0, atol=1e-8)


@pytest.mark.parametrize("name", BASED)
def test_tipping_facets_are_support_planes_and_enough(name):
    robot, pose = with_tensions(heavier(BASED[name]()), 5.0, 2000.0), robots.random_pose(BASED[name](), 12)
    aws = cl.available_wrench_set(robot, pose, tipping=True)
    scale = np.abs(aws.component_range()).max()
    np.testing.assert_allclose(aws.support(aws.normals), aws.offsets, rtol=0, atol=1e-9 * scale)
    d = np.random.default_rng(12).normal(size=(200, robot.n_dof))
    np.testing.assert_allclose((d @ aws.vertices.T).max(axis=1), aws.support(d), rtol=0, atol=1e-8 * scale)
    again = cl.Polytope.from_rows(aws.normals, aws.offsets).support(d)
    np.testing.assert_allclose(again, aws.support(d), rtol=0, atol=1e-8 * scale)


@pytest.mark.parametrize("name", BASED)
def test_each_condition_takes_wrenches_away_and_adds_none(name):
    robot, pose = with_tensions(heavier(BASED[name]()), 5.0, 2000.0), robots.random_pose(BASED[name](), 13)
    d = np.random.default_rng(13).normal(size=(100, robot.n_dof))
    free, standing, gripping = (cl.available_wrench_set(robot, pose, **k).support(d) for k in (
        {}, {"tipping": True}, {"tipping": True, "friction": 0.4}))
    assert (standing <= free + 1e-9).all() and (gripping <= standing + 1e-9).all()
    assert (standing < free - 1).any() and (gripping < standing - 1).any()


def test_the_order_of_the_contacts_does_not_matter():
    robot, pose = case("two bases", 1)
    robot = with_tensions(heavier(robot), 5.0, 2000.0)
    d = np.random.default_rng(14).normal(size=(100, 6))
    h = cl.available_wrench_set(robot, pose, tipping=True).support(d)
    for turn in (lambda f: f[::-1], lambda f: np.roll(f, 1, axis=0)):
        bases = tuple(dataclasses.replace(b, footprint=turn(b.footprint)) for b in robot.bases)
        other = cl.available_wrench_set(dataclasses.replace(robot, bases=bases), pose, tipping=True)
        np.testing.assert_allclose(other.support(d), h, rtol=1e-12)


def test_wrenches_at_the_border_are_those_at_which_a_wheel_lifts():
    """From the border's tensions to the wheels: reactions by a program of their own."""
    robot, pose = case("two bases", 2)
    robot = with_tensions(heavier(robot), 5.0, 2000.0)
    aws, W = cl.available_wrench_set(robot, pose, tipping=True), cl.wrench_matrix(robot, pose)
    rng, seen = np.random.default_rng(15), set()
    for tau in rng.uniform(5, 2000, (150, 8)) * rng.uniform(0.02, 1, (150, 1)):
        tau = np.maximum(tau, 5.0)
        stands = all(_least_reaction(robot, pose, base, tau) > 0 for base in robot.bases)
        if stands:
            assert aws.contains(W @ tau)
        seen.add((stands, bool(aws.contains(W @ tau))))
    assert (True, True) in seen and (False, False) in seen


def _least_reaction(robot, pose, base, tau):
    """Largest smallest wheel load that balances the base, negative when wheels would have to pull."""
    contacts = base.to_world(np.pad(base.footprint, ((0, 0), (0, 1))))
    loads = robots.pulls_on(robot, pose, base, tau)
    force, moment = sum(f for _, f in loads), sum(np.cross(p, f) for p, f in loads)
    k = len(contacts)
    rows = np.stack([np.ones(k), contacts[:, 1], -contacts[:, 0]])
    found = linprog(np.append(np.zeros(k), -1.0), A_ub=np.column_stack([-np.eye(k), np.ones(k)]), b_ub=np.zeros(k),
                    A_eq=np.column_stack([rows, np.zeros(3)]), b_eq=-np.array([force[2], moment[0], moment[1]]),
                    bounds=(None, None), method="highs")
    return -found.fun if found.status == 0 else -np.inf


def test_a_singular_pose_has_a_flat_wrench_set():
    """All lines of action through one vertical axis: no moment about it, whatever the tensions."""
    exits = [[x, y, 3.0] for x in (-2, 2) for y in (-1, 1)] * 2
    robot = robots.build("3R3T", exits, [[0, 0, 0.2]] * 4 + [[0, 0, -0.2]] * 4, center_of_mass=[0, 0, 0])
    aws = cl.available_wrench_set(robot, cl.Pose([0.1, 0.2, 1.0]))
    assert aws.dimension == 5 and "flat" in repr(aws) and aws.volume == 0
    w = cl.wrench_matrix(robot, cl.Pose([0.1, 0.2, 1.0])) @ np.full(8, 300.0)
    assert aws.contains(w) and not aws.contains(w + [0, 0, 0, 0, 0, 1.0])
    np.testing.assert_allclose(aws.axis_section(w)[5], 0, atol=1e-9)
    np.testing.assert_allclose((aws.normals @ aws.vertices.T).max(axis=1), aws.offsets, atol=1e-6)


def test_a_flat_set_with_tipping_is_listed_in_its_span():
    exits = [[x, y, 2.0] for x in (-0.2, 0.2) for y in (-1, 1)]
    contacts = [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]]
    bases = [cl.Base(name, [x, 0.0], 0.0, 150.0, [0, 0, 0.5], contacts, [0, 0, 0])
             for name, x in (("left", -2.0), ("right", 2.0))]
    robot = robots.build("3R3T", exits * 2, [[0, 0, 0.2]] * 4 + [[0, 0, -0.2]] * 4, (5.0, 400.0), bases=bases,
                         carriers=["left", "right"] * 4, center_of_mass=[0, 0, 0])
    pose = cl.Pose([0.1, 0.2, 1.0])
    free, standing = (cl.available_wrench_set(robot, pose, tipping=t) for t in (False, True))
    d = np.random.default_rng(19).normal(size=(100, 6))
    assert standing.dimension == free.dimension == 5 and (standing.support(d) < free.support(d) - 1).any()
    np.testing.assert_allclose((d @ standing.vertices.T).max(axis=1), standing.support(d), rtol=0, atol=1e-6)
    np.testing.assert_allclose((standing.normals @ standing.vertices.T).max(axis=1), standing.offsets, atol=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_limits_that_pin_cables_and_bases_about_to_tip(seed):
    """Sets that are thin, flat or empty: all the same laws."""
    robot, pose = case(list(BASED)[seed % 2], seed)
    rng = np.random.default_rng(seed)
    low = rng.choice([0.0, 5.0, 50.0], robot.n_cables)
    high = low + rng.choice([0.0, 100.0, 1000.0], robot.n_cables)
    cables = tuple(dataclasses.replace(c, tension_min=a, tension_max=b) for c, a, b in zip(robot.cables, low, high))
    bases = tuple(dataclasses.replace(b, mass=rng.choice([20.0, 60.0, 400.0])) for b in robot.bases)
    robot, d = dataclasses.replace(robot, cables=cables, bases=bases), rng.normal(size=(20, robot.n_dof))
    for conditions in ({}, {"tipping": True}, {"tipping": True, "friction": 0.3}):
        aws = cl.available_wrench_set(robot, pose, **conditions)
        feasible = linprog(np.zeros(robot.n_cables), A_ub=aws.rows, b_ub=aws.limits, bounds=(None, None)).status == 0
        assert aws.is_empty != feasible
        if feasible:
            np.testing.assert_allclose(aws.support(d), lp_support(aws, d), rtol=1e-9, atol=1e-6)
            np.testing.assert_allclose((d @ aws.vertices.T).max(axis=1), aws.support(d), rtol=1e-8, atol=1e-6)
            assert aws.contains(aws.vertices).all()


def test_what_can_be_added_while_holding():
    robot, pose = case("3R3T", 16)
    aws, weight = cl.available_wrench_set(robot, pose), cl.gravity_wrench(robot, pose)
    down = aws.axis_section(-weight)[2, 1]     # the cables can pull that much more upwards
    held = cl.distribute_tensions(cl.wrench_matrix(robot, pose), weight - (down - 1e-3) * np.eye(6)[2],
                                  robot.tension_min, robot.tension_max, method="quadratic_program")
    assert held.feasible
    assert not aws.contains(-weight + (down + 1e-3) * np.eye(6)[2])


@pytest.mark.parametrize("name", BASED)
def test_sliding_rows_are_coulombs_law_on_each_base(name):
    robot, pose = heavier(BASED[name]()), robots.random_pose(BASED[name](), 17)
    rows, limits = sliding_rows(robot, pose, 0.4)
    rng, seen = np.random.default_rng(17), set()
    for tau in rng.uniform(0, 1500, (200, robot.n_cables)) * rng.uniform(0, 1, (200, 1)):
        ratios = []
        for base in robot.bases:
            force = sum(f for _, f in robots.pulls_on(robot, pose, base, tau))
            ratios.append(np.linalg.norm(force[:-1]) / -force[-1] if force[-1] < 0 else np.inf)
        sure = robot.dimension == 2 or not 0.4 * np.cos(np.pi / 8) <= max(ratios) <= 0.4   # the octagon is inside
        if sure and abs(max(ratios) - 0.4) > 1e-9:
            assert bool((rows @ tau <= limits).all()) == (max(ratios) < 0.4)
            seen.add(max(ratios) < 0.4)
    assert seen == {True, False}


@pytest.mark.parametrize("friction", [-0.1, "rough"])
def test_friction_that_is_none(friction):
    with pytest.raises(InvalidInput):
        sliding_rows(*case("two bases", 0), friction)


@pytest.mark.parametrize("moving", ["all", "none"])
def test_twist_sets_cross_process_borders(moving):
    world = cl.load_world("planar_mcdpr")
    there = cl.available_twist_set(world.robot, world.pose, moving)
    back = pickle.loads(pickle.dumps(there))
    assert back.volume == pytest.approx(there.volume) and (there == back) in (True, False)


def test_trajectories_compare_and_hash():
    path = cl.load_world("caroca").task().trajectory()
    other = cl.load_world("caroca").task().trajectory()
    assert path == path and (path == other) in (True, False) and len({path, other}) in (1, 2)
