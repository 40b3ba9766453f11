"""A limit of "as much as you like" at one cable changes no other cable's answer, and no verdict."""

import dataclasses

import numpy as np
import pytest

import cdprlab as cl

HUGE = (1e9, 1e12)


def problems(count, seed):
    robot = cl.load_world("caroca").robot
    rng = np.random.default_rng(seed)
    poses = cl.Pose(rng.uniform([-2, -1.2, 0.3], [2, 1.2, 2.5], (count, 3)), rpy=rng.uniform(-0.2, 0.2, (count, 3)))
    return robot, poses, cl.wrench_matrix(robot, poses), cl.gravity_wrench(robot, poses)


@pytest.mark.parametrize("huge", HUGE)
@pytest.mark.parametrize("method", ["linear_program", "quadratic_program", "barycenter", "relaxed", "pseudo_inverse"])
def test_one_generous_limit_changes_no_other_answer(method, huge):
    """Where a limit of 1e4 N is not met, 1e12 N gives the same; batch and single."""
    _, _, W, w_e = problems(60, 1)
    most = np.full(8, 1500.0)
    for cable in (0, 5):
        ample, generous = most.copy(), most.copy()
        ample[cable], generous[cable] = 1e5, huge
        known = cl.distribute_tensions(W, w_e, 1, ample, method)
        found = cl.distribute_tensions(W, w_e, 1, generous, method)
        same = known.tensions[:, cable] < 9e4
        np.testing.assert_array_equal(found.feasible[same], known.feasible[same])
        good = same & known.feasible
        assert good.sum() > 10
        np.testing.assert_allclose(found.tensions[good], known.tensions[good], rtol=1e-7, atol=1e-5)
        for k in np.flatnonzero(good)[:5]:
            one = cl.distribute_tensions(W[k], w_e[k], 1, generous, method)
            assert one.feasible
            np.testing.assert_allclose(one.tensions, found.tensions[k], rtol=1e-7, atol=1e-5)


@pytest.mark.parametrize("huge", HUGE)
@pytest.mark.parametrize("criterion", [cl.WrenchFeasible(), cl.WrenchFeasible(half_widths=[50, 50, 50, 5, 5, 5]),
                                       cl.WrenchFeasible([0, 0, 100.0, 0, 0, 0], by="facets"),
                                       cl.DynamicEquilibrium([0.5] * 3 + [0.2] * 3)], ids=str)
def test_one_generous_limit_changes_no_verdict(criterion, huge):
    robot, poses, *_ = problems(150, 2)

    def judged(most):
        cables = [dataclasses.replace(cable, tension_min=20.0, tension_max=most if k == 0 else 700.0)
                  for k, cable in enumerate(robot.cables)]
        return criterion.judge(dataclasses.replace(robot, cables=tuple(cables)), poses)

    known, found = judged(1e6), judged(huge)
    assert 0 < known.inside.sum() < 150
    np.testing.assert_array_equal(found.inside, known.inside)
    np.testing.assert_allclose(found.margin, known.margin, rtol=1e-6, atol=1e-3)


@pytest.mark.parametrize("huge", HUGE)
@pytest.mark.parametrize("world, cable", [("planar_rigid", 1), ("caroca", 0), ("caroca", 5), ("planar_point", 2)])
def test_one_generous_limit_moves_no_facet_of_the_others(world, cable, huge):
    loaded = cl.load_world(world)

    def available(most):
        cables = [dataclasses.replace(one, tension_min=5.0, tension_max=most if k == cable else 700.0)
                  for k, one in enumerate(loaded.robot.cables)]
        return cl.available_wrench_set(dataclasses.replace(loaded.robot, cables=tuple(cables)), loaded.pose)

    known, found = available(700.0), available(huge)
    pull = cl.wrench_matrix(loaded.robot, loaded.pose)[:, cable]
    assert len(known.normals) == len(found.normals) and len(known.vertices) == len(found.vertices)
    # Facets across which the cable does not help, in the one set and the other.
    calm = known.normals @ pull < 1e-9
    assert calm.sum() >= len(calm) / 2
    for normal, offset in zip(known.normals[calm], known.offsets[calm]):
        assert np.abs(np.c_[found.normals - normal, found.offsets - offset]).max(axis=1).min() < 1e-7
    np.testing.assert_allclose(found.support(known.normals[calm]), known.offsets[calm], rtol=1e-9, atol=1e-7)
    touching = known.vertices @ known.normals.T > known.offsets - 1e-6
    for facet in np.flatnonzero(calm):
        middle = known.vertices[touching[:, facet]].mean(axis=0)
        assert found.contains(middle - 1e-4 * known.normals[facet])
        assert not found.contains(middle + 1e-4 * known.normals[facet])
    reach, before = found.component_range(), known.component_range()
    np.testing.assert_allclose(reach[pull >= 0, 0], before[pull >= 0, 0], rtol=1e-9, atol=1e-7)
    np.testing.assert_allclose(reach[pull <= 0, 1], before[pull <= 0, 1], rtol=1e-9, atol=1e-7)


def test_one_generous_speed_is_no_tolerance():
    robot, poses, *_ = problems(40, 3)
    cables = [dataclasses.replace(one, speed_max=1e12 if k == 0 else 1.0) for k, one in enumerate(robot.cables)]
    generous = dataclasses.replace(robot, cables=tuple(cables))
    inside, margin = cl.workspace(generous, poses, cl.TwistFeasible([1.05, 0, 0, 0, 0, 0]))
    np.testing.assert_array_equal(inside, margin >= -1e-8)
    assert 0 < inside.sum() < 40


def test_no_tension_is_too_large_for_static_equilibrium():
    """Two cables at (±2, 3): y = 2.99 m takes 100 weights; closure has static equilibrium, too."""
    document = {"name": "two", "motion_pattern": "2T",
                "platform": {"mass": 10.0, "size": [0.2, 0.2], "pose": {"position": [0, 1]}},
                "cables": [{"exit_point": [x, 3.0], "anchor_point": [0, 0], "tension": [0, 100]} for x in (-2.0, 2.0)]}
    robot = cl.World.from_dict(document).robot
    inside, margin = cl.workspace(robot, cl.Pose([[0.0, 2.99], [0.0, 2.99999], [0.0, 3.01], [0.5, 1.0]]),
                                  cl.StaticEquilibrium())
    np.testing.assert_array_equal(inside, [True, True, False, True])
    assert margin[1] == 0 and margin[2] < 0
    rigid, pose = cl.load_world("planar_rigid").robot, cl.Pose([[-0.4, 1.5]], angle=np.radians(60))
    assert cl.WrenchClosure().judge(rigid, pose).inside[0] <= cl.StaticEquilibrium().judge(rigid, pose).inside[0]
    assert cl.StaticEquilibrium().judge(rigid, pose).inside[0]


def test_complete_is_false_where_a_method_does_not_apply():
    W = np.concatenate([np.eye(2), -np.eye(2), np.ones((2, 1))], axis=1)   # r = 3
    few = np.array([[1.0, 0, -1, 0, 0], [0, 1, 0, -1, 0.0]])
    few[:, 4] = few[:, 0]
    for method in ("barycenter", "kernel"):
        found = cl.distribute_tensions(W, np.zeros(2), 0, 1, method)
        assert not found.feasible and found.complete is False and "the LP says" in found.reason
    rank_one = np.array([[1.0, -1.0, 0.0], [0.0, 0.0, 0.0]])   # r = 2 of three cables: not the kernel's
    full = np.array([[1.0, -1.0, 0.3], [0.0, 0.5, -1.0]])
    both = cl.distribute_tensions(np.stack([rank_one, full]), np.zeros(2), 1, 9, "kernel")
    assert both.complete.tolist() == [False, True]
    proven = cl.distribute_tensions(full, np.array([1e6, 0.0]), 1, 9, "kernel")
    assert not proven.feasible and proven.complete is True
