"""Grids, sweeps that stop and go on, measures with bounds, and certificates that no sampled pose contradicts."""

import dataclasses
import itertools

import joblib
import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.mechanics.intervals import Intervals
from cdprlab.workspace import (
    Criterion,
    Judgement,
    certify,
    low_discrepancy_poses,
    position_grid,
    refine,
)
from cdprlab.workspace.criterion import unknown
from cdprlab.workspace.interval_statics import PoseBoxes
from robots import build, robot_1r2t, robot_3r3t, robot_3t


@dataclasses.dataclass(frozen=True)
class Disk(Criterion):
    """Poses within a radius of the origin: what a measure should come to is known."""

    radius: float = 0.8

    def judge(self, robot, poses, margin=True):
        return unknown(np.linalg.norm(poses.position, axis=-1) <= self.radius)


@dataclasses.dataclass(frozen=True)
class Interrupted(Criterion):
    """Fails from some pose on, as a sweep does whose machine is switched off."""

    broken: bool = True

    def judge(self, robot, poses, margin=True):
        if self.broken and poses.position[0, 0] > 0:
            raise KeyboardInterrupt
        return Judgement(poses.position[:, 1] > 0, poses.position[:, 1])


# --- grids --------------------------------------------------------------------------------------------
def test_a_grid_s_poses_are_its_axes_combined():
    grid = position_grid([-1, 0.3, 0], [1, 0.3, 2], 0.5, rpy=[0.1, 0.2, 0.3])
    expected = [[x, 0.3, z] for x, z in itertools.product(grid.axes["x"], grid.axes["z"])]
    np.testing.assert_array_equal(grid.poses.position, expected)
    np.testing.assert_array_equal(grid[7:11].position, expected[7:11])
    np.testing.assert_array_equal(grid[::3].position, expected[::3])
    assert grid.cell == pytest.approx(0.25) and len(grid[20:20]) == 0
    assert (grid.poses.rotation == cl.Pose([0, 0, 0], [0.1, 0.2, 0.3]).rotation).all()
    assert grid.field(grid.poses.position[:, 2])[2, 1] == 0.5


def test_samples_are_seeded_and_stay_in_their_box():
    draw = low_discrepancy_poses
    first, again, other = (draw([0, 1, 2], [1, 1, 3], 200, seed, turn=0.4) for seed in (1, 1, 2))
    assert first == again and first != other
    assert (first.position >= [0, 1, 2]).all() and (first.position <= [1, 1, 3]).all()
    assert np.abs(first.rpy).max() <= 0.4 and draw([0, 0], [1, 1], 5, turn=0.1).angle.shape == (5,)


def test_low_discrepancy_comes_closer_to_the_area_than_chance():
    def error(poses):
        return abs(4 * Disk().judge(None, poses).inside.mean() - np.pi * 0.64)

    even = [error(low_discrepancy_poses([-1, -1], [1, 1], 4096, seed)) for seed in range(5)]
    chance = [error(cl.Pose(np.random.default_rng(seed).uniform(-1, 1, (4096, 2)))) for seed in range(5)]
    assert np.mean(even) < 0.5 * np.mean(chance)


@pytest.mark.parametrize("lower, upper, step", [([0, 0], [0, 0], 0.1), ([0, 1], [1, 0], 0.1), ([0, 0], [1, 1], 0.0),
                                                ([0], [1], 0.1)])
def test_grids_that_are_none(lower, upper, step):
    with pytest.raises(InvalidInput):
        position_grid(lower, upper, step)


# --- refinement ---------------------------------------------------------------------------------------
def test_the_area_of_a_disk_lies_within_bounds_that_halve():
    errors = []
    for levels in range(5):
        found = refine(robot_1r2t(), position_grid([-1, -1], [1, 1], 0.25), Disk(), levels)
        assert found.bounds[0] <= np.pi * 0.64 <= found.bounds[1]
        np.testing.assert_allclose(np.prod(found.upper - found.lower, axis=1).sum(), 4.0)
        errors.append(found.error)
    assert (np.array(errors[1:]) < 0.65 * np.array(errors[:-1])).all()


def test_refined_and_certified_areas_overlap():
    robot = cl.load_world("planar_rigid").robot
    fine = refine(robot, position_grid([-2, -2], [2, 2], 0.2), cl.WrenchFeasible(), 3)
    proven = certify(robot, [-2, -2], [2, 2], resolution=0.03).bounds
    assert proven[0] <= fine.bounds[1] and fine.bounds[0] <= proven[1] and proven[1] - proven[0] < 1.0


# --- sweeps -------------------------------------------------------------------------------------------
GRID = position_grid([-2, 0, 0.5], [2, 0, 3], 0.1)


@pytest.fixture(scope="module")
def expected():
    return cl.workspace(robot_3r3t(), GRID, cl.WrenchFeasible())


def same(one, other):
    """Under numpy 2.5 a chunk's length decides how its last rows are summed: margins differ by 1e-12 N of thousands."""
    return (one.inside == other.inside).all() and np.allclose(one.margin, other.margin, rtol=1e-12, atol=1e-11,
                                                              equal_nan=True)


def test_chunks_and_shapes_make_no_difference(expected):
    steps = []
    assert same(cl.workspace(robot_3r3t(), GRID, cl.WrenchFeasible(), chunk=97,
                             progress=lambda done, total: steps.append((done, total))), expected)
    assert steps[-1] == (len(GRID), len(GRID)) and len(steps) == -(-len(GRID) // 97)
    poses = GRID.poses
    shaped = cl.Pose(poses.position.reshape(*GRID.shape, 3))
    assert same(cl.workspace(robot_3r3t(), shaped, cl.WrenchFeasible()), Judgement(*map(GRID.field, expected)))
    single = cl.workspace(robot_3r3t(), poses[5], cl.WrenchFeasible())
    assert single.inside.shape == () and single.margin == pytest.approx(expected.margin[5], rel=1e-12, abs=1e-11)


def test_cores_make_no_difference(expected):
    assert same(cl.workspace(robot_3r3t(), GRID, cl.WrenchFeasible(), n_jobs=2, chunk=300), expected)


def test_a_dask_cluster_makes_no_difference(expected):
    distributed = pytest.importorskip("distributed", reason="extra `distributed` is not installed")
    two = {"n_workers": 2, "threads_per_worker": 1, "processes": False, "dashboard_address": None}
    with distributed.LocalCluster(**two) as cluster, distributed.Client(cluster), joblib.parallel_config("dask"):
        assert same(cl.workspace(robot_3r3t(), GRID, cl.WrenchFeasible(), chunk=300), expected)


def test_an_interrupted_sweep_goes_on_where_it_stopped(tmp_path):
    robot, poses = robot_1r2t(), cl.Pose(np.stack([np.linspace(-1, 1, 40), np.linspace(1, -1, 40)], axis=1))
    broken, sound = Interrupted(True), Interrupted(False)
    with pytest.raises(KeyboardInterrupt):
        cl.workspace(robot, poses, broken, chunk=5, checkpoint=tmp_path)
    assert len(list(tmp_path.iterdir())) == 4
    # What was judged stays judged: the same question is not asked again, and now fails at its fifth chunk first.
    done = []
    with pytest.raises(KeyboardInterrupt):
        cl.workspace(robot, poses, broken, chunk=5, checkpoint=tmp_path, progress=lambda *now: done.append(now))
    assert done[-1] == (20, 40) and len(list(tmp_path.iterdir())) == 4
    # Another criterion, robot or pose is another question.
    assert same(cl.workspace(robot, poses, sound, chunk=5, checkpoint=tmp_path), cl.workspace(robot, poses, sound))
    assert len(list(tmp_path.iterdir())) == 12
    heavier = robot.with_payload(1.0, [0, 0])
    cl.workspace(heavier, poses, sound, chunk=5, checkpoint=tmp_path)
    assert len(list(tmp_path.iterdir())) == 20
    robot.exit_points   # noqa: B018  (what a robot has worked out for itself is no other question)
    cl.workspace(robot, poses, sound, chunk=5, checkpoint=tmp_path)
    assert len(list(tmp_path.iterdir())) == 20


# --- certificates -------------------------------------------------------------------------------------
def decided(robot, w, W):
    """The LP's verdict: largest s with the limits kept by s."""
    m = W.shape[1]
    rows = np.block([[-np.eye(m), np.ones((m, 1))], [np.eye(m), np.ones((m, 1))]])
    found = linprog(np.append(np.zeros(m), -1), A_ub=rows, b_ub=np.concatenate([-robot.tension_min, robot.tension_max]),
                    A_eq=np.column_stack([W, np.zeros(len(W))]), b_eq=-w, bounds=(None, None), method="highs")
    return -found.fun if found.status == 0 else -np.inf


def off_center():
    """Center of mass off P, anchors apart."""
    return build("1R2T", [[-2, -2], [2, -2], [2, 2], [-2, 2]], [[-0.2, -0.15], [0.25, -0.1], [0.2, 0.2], [-0.15, 0.2]],
                 (10.0, 900.0))


CASES = {
    "planar point": (cl.load_world("planar_point").robot, [-1.2, 0.0], [3.2, 2.4], {}, 0.08),
    "planar platform": (off_center(), [-2, -2], [2, 2], {"angle": 0.15}, 0.06),
    "planar platform, turning": (off_center(), [-0.5, 0.9, -0.2], [0.5, 1.9, 0.2], {}, 0.07),
    "point in space": (robot_3t(), [-1, -1, 0], [3, 3, 5], {}, 0.4),
    "a plane of the Caroca": (robot_3r3t(), [-3.5, 0.3, 0], [3.5, 0.3, 4.0], {"rpy": [0.1, -0.05, 0.2]}, 0.2),
}


@pytest.mark.parametrize("name", CASES)
def test_sampled_poses_never_contradict_a_certificate(name):
    robot, lower, upper, options, resolution = CASES[name]
    found = certify(robot, lower, upper, resolution=resolution, **options)
    assert len(found.inside) and len(found.outside)
    rng = np.random.default_rng(11)
    # As many samples in each box decided as make 4000, a third of them on its corners.
    chosen = rng.choice(np.flatnonzero(found.verdict != 0), 4000)
    share = rng.random((4000, len(lower)))
    share[::3] = share[::3].round()
    x = found.lower[chosen] + share * (found.upper - found.lower)[chosen]
    turning = len(lower) > robot.dimension
    poses = cl.Pose(x[:, :2], angle=x[:, 2]) if turning else cl.Pose(x, **options)
    assert (cl.workspace(robot, poses, cl.WrenchFeasible()).inside == (found.verdict[chosen] == 1)).all()
    W, w = cl.wrench_matrix(robot, poses), np.broadcast_to(cl.gravity_wrench(robot, poses), (4000, robot.n_dof))
    for k in range(0, 4000, 50):
        margin = decided(robot, w[k], W[k])
        assert margin * found.verdict[chosen[k]] > -1e-7 * robot.tension_max.max()


def verdict_at(found, point):
    """1, −1 or 0: the verdict of a box that holds a point, 0 beyond all boxes. Neighbors do not contradict."""
    return np.sign(found.verdict[((found.lower <= point) & (point <= found.upper)).all(axis=1)].sum())


def test_boxes_fill_the_domain_and_say_what_holds_where():
    found = certify(off_center(), [-2, -2], [2, 2], resolution=0.2)
    assert np.prod(found.upper - found.lower, axis=1).sum() == pytest.approx(16.0)
    assert ((found.upper - found.lower)[found.verdict == 0] <= 0.2 + 1e-9).all()
    assert [verdict_at(found, point) for point in ([0, 0], [1.999, 1.999], [9, 9])] == [1, -1, 0]


def test_a_box_around_an_exit_point_is_halved():
    robot = cl.load_world("planar_point").robot
    middle = robot.exit_points[1]
    found = certify(robot, middle - 0.5, middle + 0.5, resolution=0.1)
    assert found.bounds[0] < found.bounds[1] < 1.0 and len(found.outside)


def test_a_certificate_for_several_wrenches_holds_for_each():
    robot, loads = off_center(), np.array([[0, -200.0, 0], [100.0, 0, 0]])
    both = certify(robot, [-2, -2], [2, 2], resolution=0.1, wrenches=loads)
    poses = cl.Pose(np.random.default_rng(12).uniform(-2, 2, (2000, 2)))
    inside = cl.workspace(robot, poses, cl.WrenchFeasible(loads)).inside
    verdict = np.array([verdict_at(both, point) for point in poses.position])
    assert not ((verdict == 1) & ~inside).any() and not ((verdict == -1) & inside).any() and (verdict == 1).any()


@pytest.mark.parametrize(("planar", "held"), [(True, True), (True, False), (False, True)])
def test_interval_sums_hold_what_they_stand_for(planar, held):
    """V σ, the weight, the lengths and n · column at random poses inside boxes."""
    rng = np.random.default_rng(13)
    robot = off_center() if planar else robot_3r3t()
    d = robot.dimension
    low = rng.uniform(-0.5, 0.5, (50, d))
    high = low + rng.uniform(0, 0.1, (50, d))
    p, angles, turn = low + rng.random((50, d)) * (high - low), rng.uniform(-0.5, 0.5, 50), 0.05
    if held:
        pose = cl.Pose(p, **({"angle": 0.3} if planar else {"rpy": [0.2, -0.1, 0.4]}))
    else:
        pose = cl.Pose(p, angle=angles + rng.uniform(-turn, turn, 50))
        low, high = np.column_stack([low, angles - turn]), np.column_stack([high, angles + turn])
    boxes = PoseBoxes(robot, Intervals(low, high), pose.rotation[0])   # which counts where no angle is given
    sigma, normal = rng.normal(size=(50, 2, robot.n_cables)), rng.normal(size=(50, robot.n_dof))
    W, lengths = cl.wrench_matrix(robot, pose), cl.cable_lengths(robot, pose)
    V = W * lengths[:, None]
    for intervals, value in ((boxes.wrenches(sigma), np.einsum("kij,klj->kli", V, sigma)), (boxes.lengths, lengths),
                             (boxes.weight, np.broadcast_to(cl.gravity_wrench(robot, pose), (50, robot.n_dof))),
                             (boxes.pulls(normal), np.einsum("ki,kij->kj", normal, W))):
        close = 1e-12 * (1 + np.abs(value))   # the value itself is rounded
        assert (intervals.lower <= value + close).all() and (value <= intervals.upper + close).all()


@pytest.mark.parametrize("arguments, options, message", [
    (("2R3T", [0, 0, 0], [1, 1, 1]), {}, "2R3T"),
    (("3R3T", [0, 0], [1, 1]), {}, "lower must be 3 numbers"),
    (("1R2T", [1, 1], [0, 0]), {}, "lower first"),
    (("1R2T", [0, 0], [1, 1]), {"rpy": [0, 0, 0]}, "takes angle="),
])
def test_what_cannot_be_certified_is_said(arguments, options, message):
    from robots import ROBOTS

    with pytest.raises(InvalidInput, match=message):
        certify(ROBOTS[arguments[0]](), *arguments[1:], **options)
