"""A limit of "as much as you like" at one cable changes no other cable's answer, and no verdict."""

import dataclasses

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import NotListable

HUGE = (1e9, 1e12)


def problems(count, seed):
    robot = cl.load_world("caroca").robot
    rng = np.random.default_rng(seed)
    poses = cl.Pose(rng.uniform([-2, -1.2, 0.3], [2, 1.2, 2.5], (count, 3)), rpy=rng.uniform(-0.2, 0.2, (count, 3)))
    return robot, poses, cl.wrench_matrix(robot, poses), cl.gravity_wrench(robot, poses)


@pytest.mark.parametrize("huge", HUGE)
@pytest.mark.parametrize("method", ["linear_program", "quadratic_program", "barycenter", "relaxed", "pseudo_inverse",
                                    "puncture"])
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
        if method == "puncture":   # where it needs the closed form, that aims at the middle of the limits: no tolerance
            same &= cl.distribute_tensions(W, w_e, 1, ample, "pseudo_inverse").feasible
        np.testing.assert_array_equal(found.feasible[same], known.feasible[same])
        good = same & known.feasible
        assert good.sum() > 10
        np.testing.assert_allclose(found.tensions[good], known.tensions[good], rtol=1e-7, atol=1e-5)
        for k in np.flatnonzero(good)[:5]:
            one = cl.distribute_tensions(W[k], w_e[k], 1, generous, method)
            assert one.feasible
            np.testing.assert_allclose(one.tensions, found.tensions[k], rtol=1e-7, atol=1e-5)


@pytest.mark.parametrize("huge", HUGE)
def test_a_generous_limit_of_a_cable_that_is_not_redundant_is_no_wish_of_the_others(huge):
    """The closed forms aim at the middle of the limits; but one cable alone carries the third row, however turned."""
    rng = np.random.default_rng(5)
    W = np.zeros((60, 3, 5))
    W[:, :2, :4], W[:, 2, 4] = rng.normal(size=(60, 2, 4)), 1.0
    W = np.linalg.qr(rng.normal(size=(60, 3, 3)))[0] @ W
    w_e = -(W @ rng.uniform(30, 60, (60, 5, 1)))[..., 0]
    for method in ("closed_form", "improved_closed_form", "puncture"):
        known, found = (cl.distribute_tensions(W, w_e, 1, [100] * 4 + [most], method) for most in (1e4, huge))
        np.testing.assert_array_equal(found.feasible, known.feasible)
        assert known.feasible.sum() > 40
        np.testing.assert_allclose(found.tensions[known.feasible], known.tensions[known.feasible], rtol=1e-6)
    for choice in ("lowest", "middle", "highest"):
        known, found = (cl.distribute_tensions(W[..., 1:], w_e, 1, [100] * 3 + [most], "kernel", choice=choice)
                        for most in (1e4, huge))
        np.testing.assert_array_equal(found.feasible, known.feasible)
        np.testing.assert_allclose(found.tensions, known.tensions, rtol=1e-6)


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


@pytest.mark.parametrize("huge", HUGE)
@pytest.mark.parametrize("name, cables", [("fastkit_suspended", [0]), ("mobile_four_bases", [7]),
                                          ("planar_mcdpr", [0, 3])])
def test_a_limit_that_tipping_keeps_from_being_reached_is_none(name, cables, huge):
    """Wrenches under which bases stand: the same set, whatever the limit is."""
    world = cl.load_world(name)
    known, found = (cl.available_wrench_set(generous(world.robot, cables, most), world.pose, tipping=True)
                    for most in (1e5, huge))
    d = np.random.default_rng(1).normal(size=(40, known.n))
    corners = known.support_point(d)
    inner = corners.mean(axis=0)
    for share in (0.99999, 1.00001):
        np.testing.assert_array_equal(found.contains(inner + share * (corners - inner)), np.full(40, share < 1))
    for ask in (lambda aws: aws.support(d), lambda aws: aws.scale(corners[:9], inner),
                lambda aws: aws.axis_section(inner), lambda aws: aws.component_range()):
        np.testing.assert_allclose(ask(found), ask(known), rtol=1e-8, atol=1e-6)
    if known.n < 6:
        np.testing.assert_allclose(found.vertices, known.vertices, rtol=1e-8, atol=1e-6)
    assert len(found.normals) == len(known.normals)


def test_limits_that_are_reached_and_hide_the_others_are_not_listed():
    """From rows: a needle of 1e12 by 1 has no facets that can be told apart; what asks no list answers."""
    needle = cl.Polytope.from_image(np.array([[1.0, 0.6, 0.2], [0.0, 0.8, 1.0]]),
                                    np.concatenate([np.eye(3), -np.eye(3)]), [1e12, 1.0, 2.0, 0.0, 0.0, 0.0])
    with pytest.raises(NotListable, match="so much larger than others"):
        _ = needle.vertices
    np.testing.assert_allclose(needle.support([[-1.0, 0.0], [0.0, 1.0]]), [0.0, 2.8])
    np.testing.assert_array_equal(needle.contains([[1e5, 2.79], [1e5, 2.81], [3.0, 2.8], [-1e-3, 0.0]]), [1, 0, 1, 0])


@pytest.mark.parametrize("huge", HUGE)
def test_a_generous_limit_moves_no_base_and_tips_none(huge):
    world = cl.load_world("planar_mcdpr")
    robot = world.robot.with_bases({base.name: (*base.position, base.heading) for base in world.robot.bases})
    poses = cl.Pose(np.random.default_rng(2).uniform([0.5, 0.5], [1.5, 1.5], (30, 2)))
    known, found = (cl.TippingSafe().judge(generous(robot, [1], most), poses) for most in (1e5, huge))
    np.testing.assert_array_equal(found.inside, known.inside)
    np.testing.assert_allclose(found.margin, known.margin, rtol=1e-6, atol=1e-5)
    far = cl.Pose([[2.6, 1.2], [3.2, 1.4]])
    known, found = (cl.place_bases(generous(robot, [1], most), far, cl.gravity_wrench(robot, world.pose))
                    for most in (1e5, huge))
    np.testing.assert_allclose([base.position for base in found.bases], [base.position for base in known.bases])


def test_verdicts_of_workspaces_are_those_of_tension_distributions():
    """Also where the least tensions differ by a million, and on the border: one cable's own limit is its measure."""
    world, rng = cl.load_world("planar_rigid"), np.random.default_rng(3)
    counted = 0
    for _ in range(60):
        pose = cl.Pose(world.pose.position + rng.uniform(-0.3, 0.3, (1, 2)), angle=rng.uniform(-0.2, 0.2))
        W, weight = cl.wrench_matrix(world.robot, pose), cl.gravity_wrench(world.robot, pose)
        low = 10.0 ** rng.uniform(-1, 6, 4)
        tau = low * rng.uniform(1.01, 1.5, 4)
        load = -W[0] @ tau - weight[0]
        high = 1.3 * tau
        k = rng.integers(4)   # the others have no choice; by rounding, by less than the law forgives, by more
        high[np.arange(4) != k] = low[np.arange(4) != k] = tau[np.arange(4) != k]
        short = rng.choice([0.0, 1e-12, 3e-9, 1e-7]) * (1 + np.abs(W[0] @ tau).max() + low[k])
        high[k], low[k] = tau[k] - short, min(low[k], tau[k] - short)
        cables = [dataclasses.replace(one, tension_min=a, tension_max=b)
                  for one, a, b in zip(world.robot.cables, low, high)]
        robot = dataclasses.replace(world.robot, cables=tuple(cables))
        told = cl.distribute_tensions(W, weight + load, low, high).feasible
        counted += int(told[0])
        for by in ("tensions", "facets"):
            assert cl.WrenchFeasible(load, by=by).judge(robot, pose).inside == told
    assert 20 < counted < 55


def generous(robot, cables, most):
    return dataclasses.replace(robot, cables=tuple(dataclasses.replace(one, tension_max=most) if k in cables else one
                                                   for k, one in enumerate(robot.cables)))


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
    heights = [2.99, 2.99999, 3 - 1e-12, 3.0, 3 + 1e-12, 3.01, 1.0]
    for cables in (robot.cables, robot.cables * 3):   # six cables are more than a polygon's
        inside, margin = cl.workspace(dataclasses.replace(robot, cables=cables),
                                      cl.Pose([[0.0, y] for y in heights]), cl.StaticEquilibrium())
        np.testing.assert_array_equal(inside, [True, True, True, False, False, False, True])
        assert (margin[1:3] == 0).all() and (margin[3:6] < 0).all() and margin[6] > 0
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
