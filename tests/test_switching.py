"""Laws of sequences put to work: the load keeps to the plan, only planned cables carry, errors have a seed."""

import numpy as np
import pytest
from scipy.optimize import minimize

import cdprlab as cl
from cdprlab.configurations import hanging_position, plan_configurations
from cdprlab.configurations.winding import winding_plan
from cdprlab.errors import InvalidInput
from cdprlab.run.switching import follow_sequence, taut_cables, try_errors

pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
START, GOAL = [1.05, 0.90, 0.70], [1.70, 1.05, 0.55]


@pytest.fixture(scope="module")
def world():
    return cl.load_world("marionet")


@pytest.fixture(scope="module")
def best(world):
    """A124 → A123 inside the certain window; both ends are near it, so that the flight is short."""
    return plan_configurations(world.robot, START, GOAL)[0]


@pytest.fixture(scope="module")
def flown(world, best):
    return follow_sequence(world, best, speed=0.4, reeling=0.2, slack=0.1)


@pytest.mark.parametrize("seed", range(10))
def test_a_weight_hangs_at_the_lowest_point_within_reach(world, seed):
    rng, exits = np.random.default_rng(seed), world.robot.exit_points
    lengths = np.linalg.norm(exits - [1.2, 1.0, 1.0], axis=1) + rng.uniform(-0.05, 0.3, 4)
    M, taut = hanging_position(world.robot, lengths)
    reach = [{"type": "ineq", "fun": lambda x, i=i: lengths[i] ** 2 - np.sum((x - exits[i]) ** 2)} for i in range(4)]
    lowest = minimize(lambda x: x[2], [1.2, 1.0, 1.2], constraints=reach, method="SLSQP", options={"ftol": 1e-12})
    assert M[2] == pytest.approx(lowest.x[2], abs=1e-6)
    np.testing.assert_allclose(np.linalg.norm(exits - M, axis=1)[taut.indices], lengths[taut.indices], atol=1e-9)


def test_the_plan_takes_up_before_it_pays_out(world, best):
    plan = winding_plan(world.robot, best, slack=0.1, reeling=0.2)
    assert len(best.configurations) == 2
    loose = plan.lengths - cl.cable_lengths(world.robot, cl.Pose(plan.positions))
    old, new = best.configurations
    outgoing, incoming = (set(old) - set(new)).pop() - 1, (set(new) - set(old)).pop() - 1
    paying = np.flatnonzero(loose[:, outgoing] > 1e-9)[0]
    assert loose[paying, incoming] <= 1e-9 and (loose >= -1e-12).all()
    assert np.abs(np.diff(plan.lengths, axis=0)).max() / 1e-3 <= 0.2 + 1e-6  # no rope faster than it was told
    held = plan.taut.sum(axis=1)
    assert set(held.tolist()) == {3, 4}


def test_winches_start_and_stop_gently(world, best):
    """A rope that jerks taut at reeling speed throws the load off the others."""
    plan = winding_plan(world.robot, best, slack=0.1, speed=0.4, reeling=0.2)
    speeds = np.diff(plan.lengths, axis=0) / 1e-3
    # The quintic's largest acceleration is 10/√3 D/T² with T = 15/8 D/v: below 1.7 v²/D, here 0.2² / 0.1 of reeling.
    jumps = np.abs(np.diff(speeds, axis=0)).max()
    assert jumps <= 1e-3 * 1.7 * max(0.2**2 / 0.1, 0.4**2 / 0.1)


def test_gentle_winches_hold_a_robot_that_is_a_little_off(world, best):
    """Millimeters of error move the load by millimeters, also while the cables change."""
    off = try_errors(world, best, 2, slack=0.1, speed=0.4, reeling=0.1, length_error=0.002, exit_error=0.002)
    assert max(trial.off_path for trial in off) < 0.012 and max(trial.unplanned for trial in off) < 0.01


def test_what_was_before_the_first_slack_does_not_count(world):
    """All winches by inverse kinematics at the start may leave two ropes taut: that is no fault of the sequence."""
    way = plan_configurations(world.robot, [0.86, 0.66, 1.80], [0.90, 0.67, 1.80])[0]
    trial = try_errors(world, way, 1, slack=0.1, speed=0.4, reeling=0.2, length_error=0.01, exit_error=0.02, seed=1)[0]
    assert trial.under_constrained < 0.1 and trial.unplanned == 0


def test_an_exact_robot_keeps_to_the_plan(flown, best, world):
    assert flown.position_errors.max() <= 1e-6
    assert (flown.measured_tensions >= 0).all()
    plan = winding_plan(world.robot, best, slack=0.1, speed=0.4, reeling=0.2)
    assert flown.measured_tensions[~plan.taut].max() <= 0.01
    settled = plan.taut.sum(axis=1) == 3
    assert (taut_cables(flown)[settled] == plan.taut[settled]).all()
    assert flown.feasible.all()


def test_tensions_of_three_taut_cables_equal_statics_and_inertia(flown, best, world):
    chosen, k = best.configurations[-1].indices, len(flown.time) - 400
    W = cl.wrench_matrix(world.robot, flown.poses[k])[:, chosen]
    acceleration = flown.reference.acceleration[k, :3] + [0, 0, world.robot.gravity]
    held = np.linalg.solve(W, world.robot.mass * acceleration)
    # The plan's acceleration is a second difference over 2 ms: good to 1e-3 m/s², that is 0.07 N.
    np.testing.assert_allclose(flown.measured_tensions[k, chosen], held, rtol=0, atol=0.2)


def test_slack_on_purpose_decides_which_cables_carry_when_lengths_are_off(world, best):
    """With errors, ropes wound by inverse kinematics alone leave it to chance which three of them carry."""
    errors = {"length_error": 0.004, "exit_error": 0.004, "seed": 3, "speed": 0.4, "reeling": 0.2}
    chosen = try_errors(world, best, 2, slack=0.1, **errors)
    naive = try_errors(world, best, 2, slack=0.0, **errors)
    assert max(trial.unplanned for trial in chosen) < 0.2 < max(trial.unplanned for trial in naive)
    assert chosen == try_errors(world, best, 2, slack=0.1, **errors)


def test_wrong_requests_are_named(world, best):
    with pytest.raises(InvalidInput, match=r"winches' 0.5 m/s"):
        winding_plan(world.robot, best, speed=2.0)
    with pytest.raises(InvalidInput, match="slack"):
        winding_plan(world.robot, best, slack=-0.1)
    with pytest.raises(InvalidInput, match="within reach"):
        hanging_position(world.robot, [0.5, 0.5, 0.5, 0.5])
    with pytest.raises(InvalidInput, match="the cables, bases and motion pattern"):
        follow_sequence(world, best, real=cl.load_world("marionet_five"))
