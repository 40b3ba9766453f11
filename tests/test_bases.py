"""Mobile bases: speeds shared with the winches, and lengths integrated along a drive."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog, minimize

import cdprlab as cl
from cdprlab.errors import InfeasibleTwist, InvalidInput
from cdprlab.mechanics.redundancy import RESOLUTION_METHODS, resolve_twist
from robots import BASED, case, moved

LIMITED = ("weighted", "quadratic_program")


def limited_case(name, seed):
    """A robot with bases whose cables have speed limits too."""
    robot, pose = case(name, seed)
    return replace(robot, cables=tuple(replace(cable, speed_max=1.5) for cable in robot.cables)), pose


def limits_of(robot):
    return np.concatenate([*(base.speed_max for base in robot.bases), robot.speed_max])


# --- the first-order model ----------------------------------------------------------------------------------
def drive_lengths(robot, pose, twist, speeds, duration, steps, pivot):
    """Lengths by integrating l̇ = J t − B_b q̇_b (Simpson's rule), and exactly, at the end."""
    def at(t):
        bases = {}
        for base, (turn, *along) in zip(robot.bases, speeds.reshape(-1, 3)):
            heading, (x, y) = base.heading + turn * t, base.position
            if pivot == "world":   # about O₀, the translation turning along: the RPP chain (θ first)
                c, s = np.cos(turn * t), np.sin(turn * t)
                x, y = c * x - s * y, s * x + c * y
            c, s = np.cos(heading), np.sin(heading)
            shift = np.array([[c, -s], [s, c]]) @ np.array(along) * t
            bases[base.name] = (x + shift[0], y + shift[1], heading)
        return robot.with_bases(bases), moved(robot, pose, twist * t)

    def rate(t):
        there, platform = at(t)
        # In the RPP chain ρ is measured from O₀ along axes that turn with θ; about a base's own center, θ̇ leaves the
        # translation so far behind: the center does not swing with it.
        chain = cl.base_jacobian(there, platform, pivot) @ speeds
        if pivot == "base":
            chain = chain + swing(there, platform, t)
        return cl.jacobian(there, platform) @ twist - chain

    def swing(there, platform, t):
        extra = np.zeros(3 * len(robot.bases))
        for k, (turn, *along) in enumerate(speeds.reshape(-1, 3)):
            extra[3 * k + 1:3 * k + 3] = turn * np.array([-along[1], along[0]]) * t
        return cl.base_jacobian(there, platform) @ extra

    times = np.linspace(0, duration, 2 * steps + 1)
    rates = np.array([rate(t) for t in times])
    h = duration / steps
    simpson = h / 6 * (rates[:-2:2] + 4 * rates[1::2] + rates[2::2]).sum(axis=0)
    there, platform = at(duration)
    return cl.cable_lengths(robot, pose) + simpson, cl.cable_lengths(there, platform)


@pytest.mark.parametrize("pivot", ["base", "world"])
@pytest.mark.parametrize("name", BASED)
def test_integrating_the_first_order_model_gives_the_lengths(name, pivot):
    """Bases drive and turn, the platform moves and turns: Simpson's error is h⁴ f⁗ / 2880, below 1e-9 at 40 steps."""
    robot, pose = case(name, 3)
    rng = np.random.default_rng(3)
    twist, speeds = 0.2 * rng.normal(size=robot.n_dof), 0.2 * rng.normal(size=3 * len(robot.bases))
    integrated, exact = drive_lengths(robot, pose, twist, speeds, 1.0, 40, pivot)
    np.testing.assert_allclose(integrated, exact, atol=1e-8)


# --- a twist shared among bases and cables -------------------------------------------------------------------
@pytest.mark.parametrize("method", RESOLUTION_METHODS)
@pytest.mark.parametrize("name", BASED)
def test_speeds_give_the_twist(name, method):
    """l̇ + B_b q̇_b = J t whatever the method, feasible or not; held directions stay still."""
    robot, pose = limited_case(name, 1)
    for size in (0.1, 5.0):
        twist = size * np.random.default_rng(1).normal(size=robot.n_dof)
        found = resolve_twist(robot, pose, twist, method)
        rates = found.cable_speeds + cl.base_jacobian(robot, pose) @ found.base_speeds
        np.testing.assert_allclose(rates, cl.jacobian(robot, pose) @ twist, atol=1e-12)
        held = limits_of(robot)[:found.base_speeds.size] == 0
        assert (found.base_speeds[held] == 0).all()


@pytest.mark.parametrize("name", BASED)
@pytest.mark.parametrize("seed", range(3))
def test_the_program_is_optimal_and_complete(name, seed):
    """Just inside the largest scale it keeps all limits, and an independent solver finds nothing cheaper."""
    robot, pose = limited_case(name, seed)
    twist = np.random.default_rng(seed).normal(size=robot.n_dof)
    scale = resolve_twist(robot, pose, twist).scale
    found = resolve_twist(robot, pose, 0.999 * scale * twist).require()
    limits = limits_of(robot)
    free = limits > 0
    B, rates = cl.base_jacobian(robot, pose), 0.999 * scale * cl.jacobian(robot, pose) @ twist

    def cost(x):
        return float((np.square(x[free] / limits[free])).sum())

    speeds = np.concatenate([found.base_speeds, found.cable_speeds])
    assert (np.abs(speeds) <= limits).all()
    other = minimize(cost, speeds, bounds=list(zip(-limits, limits)), method="SLSQP", options={"ftol": 1e-14},
                     constraints={"type": "eq", "fun": lambda x: x[B.shape[1]:] + B @ x[:B.shape[1]] - rates})
    assert cost(speeds) <= other.fun * (1 + 1e-6)


@pytest.mark.parametrize("name", BASED)
@pytest.mark.parametrize("seed", range(3))
def test_the_largest_scale_is_that_of_the_available_twists(name, seed):
    """Its dual: s* = min over y with y · J t = 1 of Σ limits |[Bᵀ; I] y|."""
    robot, pose = limited_case(name, seed)
    twist = np.random.default_rng(seed + 9).normal(size=robot.n_dof)
    B, rates, limits = cl.base_jacobian(robot, pose), cl.jacobian(robot, pose) @ twist, limits_of(robot)
    M = np.concatenate([B.T, np.eye(robot.n_cables)])
    count, m = M.shape
    eye = np.eye(count)
    dual = linprog(np.concatenate([np.zeros(m), limits]), A_ub=np.block([[M, -eye], [-M, -eye]]),
                   b_ub=np.zeros(2 * count), A_eq=np.append(rates, np.zeros(count))[None], b_eq=[1.0],
                   bounds=[(None, None)] * m + [(0, None)] * count)
    assert resolve_twist(robot, pose, twist).scale == pytest.approx(dual.fun, rel=1e-7)


def test_the_papers_planar_example():
    """RTS (1.15, 1.675) m/s: scaled by at most 0.984994 with the bases fixed, 1.219512 with them moving."""
    world = cl.load_world("planar_mcdpr")
    fixed = replace(world.robot, bases=tuple(replace(base, speed_max=np.zeros(3)) for base in world.robot.bases))
    alone, together = (resolve_twist(robot, world.pose, [1.15, 1.675]) for robot in (fixed, world.robot))
    assert not alone.feasible and together.feasible
    assert (round(alone.scale, 6), round(together.scale, 6)) == (0.984994, 1.219512)
    assert "0.985 times" in alone.reason
    with pytest.raises(InfeasibleTwist, match=r"cable 1 would run at 2\.03 m/s, allowed 2; .*0\.985 times") as caught:
        alone.require()
    assert caught.value.resolution is alone


def test_weights_choose():
    """Dear bases stand, dear cables stand still as far as they can."""
    world = cl.load_world("planar_mcdpr")
    twist = [0.3, 0.0]
    bases_dear = resolve_twist(world.robot, world.pose, twist, "weighted", weights=[1e9] * 6 + [1] * 4)
    np.testing.assert_allclose(bases_dear.base_speeds, 0, atol=1e-8)
    cables_dear = resolve_twist(world.robot, world.pose, twist, "weighted", weights=[1e-9] * 6 + [1] * 4)
    # Both bases at the platform's own speed: no cable needs to run.
    np.testing.assert_allclose(cables_dear.base_speeds[[1, 4]], 0.3, atol=1e-8)
    np.testing.assert_allclose(cables_dear.cable_speeds, 0, atol=1e-8)


def test_least_norm_is_the_pseudo_inverse():
    robot, pose = limited_case("two bases", 2)
    robot = replace(robot, bases=tuple(replace(base, speed_max=np.ones(3)) for base in robot.bases))
    twist = 0.1 * np.random.default_rng(2).normal(size=6)
    B = np.concatenate([cl.base_jacobian(robot, pose), np.eye(robot.n_cables)], axis=1)
    found = resolve_twist(robot, pose, twist, "least_norm")
    np.testing.assert_allclose(np.concatenate([found.base_speeds, found.cable_speeds]),
                               np.linalg.pinv(B) @ cl.jacobian(robot, pose) @ twist, atol=1e-12)


@pytest.mark.parametrize("name", BASED)
def test_weighted_is_the_cheapest(name):
    """min Σ w x² with [B_b I] x = J t is x = D⁻¹ Aᵀ (A D⁻¹ Aᵀ)⁻¹ J t, whatever the limits say."""
    robot, pose = limited_case(name, 2)
    robot = replace(robot, bases=tuple(replace(base, speed_max=np.ones(3)) for base in robot.bases))
    rng = np.random.default_rng(2)
    twist = rng.normal(size=robot.n_dof)
    A = np.concatenate([cl.base_jacobian(robot, pose), np.eye(robot.n_cables)], axis=1)
    weights = rng.uniform(0.1, 10.0, A.shape[1])
    found = resolve_twist(robot, pose, twist, "weighted", weights=weights)
    cheapest = A.T / weights[:, None] @ np.linalg.solve(A / weights @ A.T, cl.jacobian(robot, pose) @ twist)
    np.testing.assert_allclose(np.concatenate([found.base_speeds, found.cable_speeds]), cheapest, atol=1e-10)


def test_a_batch_of_twists_along_a_motion():
    world = cl.load_world("mobile_four_bases")
    path = world.task().trajectory()(np.linspace(0, 3, 7))
    found = resolve_twist(world.robot, path.pose, path.twist)
    assert found.base_speeds.shape == (7, 12) and found.cable_speeds.shape == (7, 8) and found.feasible.all()
    one = resolve_twist(world.robot, path.pose[3], path.twist[3])
    np.testing.assert_allclose(found.base_speeds[3], one.base_speeds, atol=1e-12)
    assert np.isinf(found.scale[0])   # at rest nothing limits it
    with pytest.raises(InfeasibleTwist, match="6 of 7 twists"):
        resolve_twist(world.robot, path.pose, np.concatenate([path.twist[:1], path.twist[1:] * 0 + 9])).require()


def test_robots_without_bases_or_limits():
    world = cl.load_world("point_mass")
    found = resolve_twist(world.robot, world.pose, [0.1, 0.2, 0.3])
    assert found.base_speeds.size == 0 and found.feasible
    endless = replace(world.robot, cables=tuple(replace(c, speed_max=np.inf) for c in world.robot.cables))
    assert resolve_twist(endless, world.pose, [9.0, 0, 0]).scale == np.inf


def test_wrong_requests_are_named():
    world = cl.load_world("planar_mcdpr")
    with pytest.raises(InvalidInput, match="unknown method 'best'; there are quadratic_program"):
        resolve_twist(world.robot, world.pose, [0, 0], "best")
    with pytest.raises(InvalidInput, match="twist must be 2 numbers"):
        resolve_twist(world.robot, world.pose, [0, 0, 0])
    with pytest.raises(InvalidInput, match="weights must be 10 numbers"):
        resolve_twist(world.robot, world.pose, [0, 0], weights=[1, 2])
    with pytest.raises(InvalidInput, match="weights must not be negative"):
        resolve_twist(world.robot, world.pose, [0, 0], weights=-np.ones(10))
    with pytest.raises(InvalidInput, match="alike"):
        resolve_twist(world.robot, world.pose, [0, 0], "least_norm", weights=np.ones(10))
