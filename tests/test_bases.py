"""Mobile bases: speeds shared with the winches, and lengths integrated along a drive."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog, minimize

import cdprlab as cl
from cdprlab.errors import InfeasibleTwist, InvalidInput
from cdprlab.mechanics.redundancy import resolve_twist
from robots import BASED, case, moved


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
@pytest.mark.parametrize("name", BASED)
def test_speeds_give_the_twist(name):
    """l̇ + B_b q̇_b = J t, feasible or not; held directions stay still."""
    robot, pose = limited_case(name, 1)
    for size in (0.1, 5.0):
        twist = size * np.random.default_rng(1).normal(size=robot.n_dof)
        found = resolve_twist(robot, pose, twist)
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


@pytest.mark.parametrize("name", BASED)
def test_where_no_limit_is_reached_it_is_the_cheapest(name):
    """min Σ w x², w = 1 / limit², with [B_b I] x = J t is x = D⁻¹ Aᵀ (A D⁻¹ Aᵀ)⁻¹ J t."""
    robot, pose = limited_case(name, 2)
    rng = np.random.default_rng(2)
    robot = replace(robot, bases=tuple(replace(base, speed_max=rng.uniform(0.5, 2.0, 3)) for base in robot.bases))
    twist = 1e-3 * rng.normal(size=robot.n_dof)
    A = np.concatenate([cl.base_jacobian(robot, pose), np.eye(robot.n_cables)], axis=1)
    cheap = limits_of(robot)**2
    found = resolve_twist(robot, pose, twist).require()
    cheapest = cheap[:, None] * A.T @ np.linalg.solve(A * cheap @ A.T, cl.jacobian(robot, pose) @ twist)
    np.testing.assert_allclose(np.concatenate([found.base_speeds, found.cable_speeds]), cheapest, atol=1e-13)


def test_twists_along_a_motion():
    world = cl.load_world("mobile_four_bases")
    path = world.task().trajectory()
    at_rest, moving = (resolve_twist(world.robot, at.pose, at.twist) for at in (path(0.0), path(1.5)))
    assert moving.feasible and moving.base_speeds.shape == (12,) and moving.cable_speeds.shape == (8,)
    assert np.isinf(at_rest.scale)   # at rest nothing limits it
    with pytest.raises(InvalidInput, match="one pose"):
        resolve_twist(world.robot, path([0.0, 1.0]).pose, np.zeros(6))


def test_robots_without_bases_or_limits():
    world = cl.load_world("point_mass")
    found = resolve_twist(world.robot, world.pose, [0.1, 0.2, 0.3])
    assert found.base_speeds.size == 0 and found.feasible
    endless = replace(world.robot, cables=tuple(replace(c, speed_max=np.inf) for c in world.robot.cables))
    assert resolve_twist(endless, world.pose, [9.0, 0, 0]).scale == np.inf


def test_a_wrong_twist_is_named():
    world = cl.load_world("planar_mcdpr")
    with pytest.raises(InvalidInput, match="twist must be 2 numbers"):
        resolve_twist(world.robot, world.pose, [0, 0, 0])
