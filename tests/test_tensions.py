"""Distributions against their law, an independent LP, optimality conditions and an independent least squares."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import linprog, lsq_linear

import cdprlab as cl
from cdprlab.tensions import solver_for
from robots import random_poses, robot_3r3t

METHODS = ("linear_program", "quadratic_program", "pseudo_inverse", "closed_form", "improved_closed_form", "puncture",
           "barycenter", "relaxed")
COMPLETE = ("linear_program", "quadratic_program", "barycenter", "relaxed")
LOW, HIGH = np.full(8, 50.0), np.full(8, 2500.0)


def problems(count, seed, push=1.0):
    """Wrench matrices of CAROCA at random rotated poses, with its weight and random wrenches beside it."""
    robot, rng = robot_3r3t(), np.random.default_rng(seed)
    poses = random_poses(robot, count, seed, turn=0.3)
    w_e = cl.gravity_wrench(robot, poses) + push * rng.normal(size=(count, 6)) * [500, 500, 500, 150, 150, 150]
    return cl.wrench_matrix(robot, poses), w_e


def lp_finds_tensions(W, w_e, low=LOW, high=HIGH):
    """An independent answer to: are there tensions at all?"""
    return linprog(np.zeros(W.shape[1]), A_eq=W, b_eq=-w_e, bounds=np.stack([low, high], axis=1)).status == 0


def is_least_norm(W, tau, low, high):
    """KKT of min ‖τ‖² on the tensions that give W τ: τ is Wᵀλ, cut off at the limits, for some λ."""
    close = 1e-6 * (1 + np.abs(tau).max())     # the LP's own tolerance
    at_low, at_high = tau <= low + 1e-9 * high, tau >= high * (1 - 1e-9)
    # Wᵀλ ≤ τ (+) wherever τ may still grow less dear, i.e. not at the upper limit; and the mirror image
    rows = np.concatenate([W.T[~at_high], -W.T[~at_low]])
    bounds = np.concatenate([tau[~at_high] + close, close - tau[~at_low]])
    return linprog(np.zeros(W.shape[0]), A_ub=rows, b_ub=bounds, bounds=(None, None)).status == 0


@pytest.mark.parametrize("method", METHODS)
def test_feasible_means_balanced_within_limits(method):
    W, w_e = problems(300, seed=1)
    found = cl.distribute_tensions(W, w_e, LOW, HIGH, method)
    residual, good = np.einsum("kij,kj->ki", W, found.tensions) + w_e, found.feasible
    assert set(good) == {True, False}
    assert (np.abs(residual[good]).max(axis=-1) <= 1e-8 * (1 + np.abs(w_e[good]).max(axis=-1))).all()
    assert (found.tensions[good] >= LOW).all() and (found.tensions[good] <= HIGH).all()
    inner = np.minimum(found.tensions - LOW, HIGH - found.tensions).min(axis=-1)
    np.testing.assert_allclose(found.margin[good], inner[good], atol=1e-9)
    assert (np.array([r == "" for r in found.reason]) == good).all()


def test_feasibility_and_optimum_of_the_quadratic_program():
    W, w_e = problems(300, seed=2)
    found = cl.distribute_tensions(W, w_e, LOW, HIGH)
    assert found.complete and 0.1 < found.feasible.mean() < 0.9
    for k in range(300):
        assert found.feasible[k] == lp_finds_tensions(W[k], w_e[k])
        if found.feasible[k]:
            assert is_least_norm(W[k], found.tensions[k], LOW, HIGH)
        else:
            assert found.reason[k] == "no tensions within the limits balance the wrench"


def test_the_optimality_check_can_say_no():
    W, w_e = (x[0] for x in problems(1, seed=3, push=0.1))
    tau, null = cl.distribute_tensions(W, w_e, LOW, HIGH).tensions, np.linalg.svd(W)[2][-1]
    assert is_least_norm(W, tau, LOW, HIGH) and not is_least_norm(W, tau + 20 * null, LOW, HIGH)


def test_another_solver_finds_the_same(monkeypatch):
    """Through qpsolvers' door, whichever solver stands behind it."""
    qpsolvers = pytest.importorskip("qpsolvers")
    solve = qpsolvers.solve_qp
    monkeypatch.setattr(qpsolvers, "available_solvers", ["mine"])
    monkeypatch.setattr(qpsolvers, "solve_qp", lambda *program, solver: solve(*program, solver="quadprog"))
    W, w_e = problems(20, seed=4, push=0.3)
    own, other = (cl.distribute_tensions(W, w_e, LOW, HIGH, solver=name) for name in ("quadprog", "mine"))
    np.testing.assert_array_equal(own.feasible, other.feasible)
    np.testing.assert_allclose(own.tensions, other.tensions, rtol=1e-6, atol=1e-3)
    with pytest.raises(cl.errors.InvalidInput, match="'no one' is not installed; there are mine"):
        cl.distribute_tensions(W, w_e, LOW, HIGH, solver="no one")


def test_pseudo_inverse_is_least_norm_and_says_which_limit_breaks():
    W, w_e = problems(100, seed=5)
    found = cl.distribute_tensions(W, w_e, LOW, HIGH, "pseudo_inverse")
    for k in range(100):
        least = np.linalg.lstsq(W[k], -w_e[k], rcond=None)[0]
        np.testing.assert_allclose(found.tensions[k], least, rtol=1e-9, atol=1e-7)
        broken = np.flatnonzero((least < LOW) | (least > HIGH))
        assert found.feasible[k] == (not broken.size)
        assert not broken.size or int(found.reason[k].split()[1]) - 1 in broken
    assert not found.complete and (found.margin[~found.feasible] < 0).all()


def test_relaxed_is_the_least_error_then_the_least_norm():
    W, w_e = problems(150, seed=6, push=2.0)
    found = cl.distribute_tensions(W, w_e, LOW, HIGH, "relaxed")
    for k in np.flatnonzero(~found.feasible):
        tau = found.tensions[k]
        best = lsq_linear(W[k], -w_e[k], (LOW, HIGH), method="bvls", tol=1e-14)
        least = np.linalg.norm(W[k] @ best.x + w_e[k])
        assert np.linalg.norm(found.residual[k]) <= least * (1 + 1e-8)
        assert (tau >= LOW - 1e-6).all() and (tau <= HIGH + 1e-6).all()
        assert is_least_norm(W[k], np.clip(tau, LOW, HIGH), LOW, HIGH)
        assert "is left" in found.reason[k]
    assert 0.2 < found.feasible.mean() < 0.8


@pytest.mark.parametrize("size", [1e12, 1e16, 1e20, 1e29])
def test_of_a_wrench_out_of_all_proportion_relaxed_takes_the_direction(size):
    """Least error of a goal far away: each cable at the limit towards it."""
    W, w_e = problems(20, 3)
    away = size * w_e / np.abs(w_e).max(axis=1, keepdims=True)
    pull = -(np.swapaxes(W, 1, 2) @ away[..., None])[..., 0]
    clear = np.abs(pull) > 1e-3 * size
    found = cl.distribute_tensions(W, away, LOW, HIGH, "relaxed")
    assert not found.feasible.any() and clear.mean() > 0.9
    np.testing.assert_allclose(found.tensions[clear], np.where(pull > 0, HIGH, LOW)[clear], rtol=1e-9)


def test_relaxed_is_the_quadratic_program_where_that_has_an_answer():
    W, w_e = problems(200, seed=7)
    exact, relaxed = (cl.distribute_tensions(W, w_e, LOW, HIGH, method) for method in ("quadratic_program", "relaxed"))
    np.testing.assert_array_equal(exact.feasible, relaxed.feasible)
    np.testing.assert_allclose(relaxed.tensions[exact.feasible], exact.tensions[exact.feasible], rtol=1e-9)


@given(arrays(float, (3, 5), elements=st.integers(-2, 2)), arrays(float, 5, elements=st.integers(0, 4)),
       arrays(float, 3, elements=st.sampled_from([0.0, 0.0, 0.0, 1.0, -3.0])))
def test_small_whole_numbers_with_every_degeneracy(W, inside, off):
    """Dependent rows, zero columns, wrenches on the border: QP and LP must agree, relaxed must not be worse."""
    low, high, w_e = np.full(5, 1.0), np.array([3.0, 3, 3, 1, 2]), -W @ np.clip(inside, 1, [3, 3, 3, 1, 2]) + off
    exact = cl.distribute_tensions(W, w_e, low, high)
    relaxed = cl.distribute_tensions(W, w_e, low, high, "relaxed")
    assert exact.feasible == relaxed.feasible == lp_finds_tensions(W, w_e, low, high)
    best = lsq_linear(W, -w_e, (low, high + 1e-12), method="bvls", tol=1e-14)
    assert np.linalg.norm(relaxed.residual) <= np.linalg.norm(W @ best.x + w_e) + 1e-7
    assert is_least_norm(W, np.clip(relaxed.tensions, low, high), low, high)
    assert not exact.feasible or is_least_norm(W, exact.tensions, low, high)


@given(arrays(float, (3, 5), elements=st.integers(-2, 2)), arrays(float, 5, elements=st.integers(0, 4)),
       arrays(float, 3, elements=st.sampled_from([0.0, 0.0, 0.0, 1.0, -3.0])))
def test_small_whole_numbers_in_polygons(W, inside, off):
    """Polygons that are points, segments and empty, ranks of 0 to 3: every answer keeps the law and the LP's word."""
    low, high, w_e = np.full(5, 1.0), np.array([3.0, 3, 3, 1, 2]), -W @ np.clip(inside, 1, [3, 3, 3, 1, 2]) + off
    program = linprog(np.ones(5), A_eq=W, b_eq=-w_e, bounds=np.stack([low, high], axis=1))
    r = 5 - np.linalg.matrix_rank(W)
    for method in ("linear_program", "barycenter", "closed_form", "improved_closed_form", "puncture"):
        found = cl.distribute_tensions(W, w_e, low, high, method)
        if found.complete and (r <= 2 or method == "linear_program"):
            assert found.feasible == (program.status == 0)
        assert program.status == 0 or not found.feasible
        assert (found.reason == "") == found.feasible
        assert not found.feasible or np.abs(W @ found.tensions + w_e).max() <= 1e-8 * (1 + np.abs(w_e).max())
        if method == "linear_program" and found.feasible:
            assert found.tensions.sum() == pytest.approx(program.fun, rel=1e-7)


def test_a_batch_of_different_ranks():
    """Polygons, segments and a point in one call: what one pose leaves behind does not reach the next."""
    rng = np.random.default_rng(0)
    W = rng.normal(size=(40, 5, 5))
    W[::4, 4] = W[::4, 3]                                   # r = 1
    W[1::4, 3:] = W[1::4, 1:2]                              # r = 2
    tau = rng.uniform(1, 3, (40, 5))
    w_e = -(W @ tau[..., None])[..., 0]
    for method in ("barycenter", "linear_program", "improved_closed_form"):
        found = cl.distribute_tensions(W, w_e, 1, 3, method)
        assert found.feasible.all() or method == "improved_closed_form"
        for k in range(40):
            one = cl.distribute_tensions(W[k], w_e[k], 1, 3, method)
            np.testing.assert_array_equal(one.tensions, found.tensions[k])
    np.testing.assert_allclose(found.tensions[2::4], tau[2::4], rtol=1e-7)


def test_dependent_rows_get_the_exact_answer_or_a_clear_reason():
    W, w_e = (x[0] for x in problems(1, seed=8, push=0.1))
    twice, also = np.concatenate([W, W[:2]]), np.concatenate([w_e, w_e[:2]])
    np.testing.assert_allclose(cl.distribute_tensions(twice, also, LOW, HIGH).tensions,
                               cl.distribute_tensions(W, w_e, LOW, HIGH).tensions, rtol=1e-9)
    for method in METHODS:
        if cl.distribute_tensions(W, w_e, LOW, HIGH, method).feasible:
            np.testing.assert_allclose(cl.distribute_tensions(twice, also, LOW, HIGH, method).tensions,
                                       cl.distribute_tensions(W, w_e, LOW, HIGH, method).tensions, rtol=1e-8)
    also[-1] += 1.0
    for method in METHODS:
        assert not cl.distribute_tensions(twice, also, LOW, HIGH, method).feasible
    for method in ("linear_program", "barycenter", "closed_form", "improved_closed_form"):
        assert "outside the range" in cl.distribute_tensions(twice, also, LOW, HIGH, method).reason
    assert "outside its range" in cl.distribute_tensions(twice, also, LOW, HIGH).reason


def test_a_wrench_only_the_smallest_tensions_balance():
    W, _ = problems(30, seed=13)
    found = cl.distribute_tensions(W, -W @ LOW, LOW, HIGH).require()
    np.testing.assert_allclose(found.tensions, np.tile(LOW, (30, 1)), rtol=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_four_cables_in_six_dof(method):
    W, tau = problems(1, seed=9)[0][0][:, :4], np.array([100.0, 200.0, 300.0, 150.0])
    found = cl.distribute_tensions(W, -W @ tau, 50, 2500, method)
    assert found.feasible
    np.testing.assert_allclose(found.tensions, tau, rtol=1e-8)
    assert not cl.distribute_tensions(W, np.ones(6), 50, 2500, method).feasible


@pytest.mark.parametrize("method", COMPLETE)
@pytest.mark.parametrize("low, high", [(np.full(8, 50.0), [50] + [2500] * 7), (0, 2500), (0, [0] + [2500] * 7)])
def test_equal_limits_and_limits_from_zero(method, low, high):
    W, w_e = problems(40, seed=10, push=0.3)
    found = cl.distribute_tensions(W, w_e, low, high, method)
    low, high = np.broadcast_to(low, 8), np.broadcast_to(high, 8)
    for k in range(40):
        assert found.feasible[k] == lp_finds_tensions(W[k], w_e[k], low, high)


@pytest.mark.parametrize("method", METHODS)
def test_a_batch_equals_a_loop_and_limits_broadcast(method):
    W, w_e = problems(12, seed=11)
    low = np.random.default_rng(11).uniform(20, 60, (4, 8))
    grid = cl.distribute_tensions(W.reshape(3, 4, 6, 8), w_e.reshape(3, 4, 6), low, 2500, method)
    for k in range(12):
        at, one = divmod(k, 4), cl.distribute_tensions(W[k], w_e[k], low[k % 4], 2500, method)
        # A batch of the quadratic program is solved in the polygon, one wrench by quadprog.
        exact = method not in ("quadratic_program", "relaxed")
        np.testing.assert_allclose(grid.tensions[at], one.tensions, rtol=0 if exact else 1e-11)
        assert (grid.feasible[at], grid.reason[at]) == (one.feasible, one.reason)
    assert not grid.tensions.flags.writeable and isinstance(one.feasible, bool)


@pytest.mark.parametrize("change, says", [
    ({"W": np.full((6, 8), np.nan)}, "W"), ({"w_e": np.full(6, np.nan)}, "w_e"), ({"W": np.ones(8)}, "W"),
    ({"w_e": np.ones(5)}, "w_e"), ({"tension_min": np.ones(7)}, "tension_min"), ({"tension_max": np.inf}, "finite"),
    ({"tension_min": 3000}, "crossed at cable 1"), ({"tension_min": -1}, "only pull"), ({"W": np.ones((6, 0))}, "W"),
    ({"w_e": np.ones((2, 6)), "W": np.ones((3, 6, 8))}, "do not fit"), ({"method": "guess"}, "quadratic_program"),
    ({"speed": 3}, "'speed'"), ({"solver": "none such"}, "not installed"),
    ({"method": "kernel", "choice": "best"}, "lowest, middle, highest"),
    ({"method": "barycenter", "choice": 1}, "none"), ({"method": "relaxed", "choice": "lowest"}, "none")])
def test_input_that_cannot_be_used(change, says):
    with pytest.raises(cl.errors.InvalidInput) as raised:
        cl.distribute_tensions(**{"W": np.ones((6, 8)), "w_e": np.ones(6), "tension_min": LOW, "tension_max": HIGH,
                                  **change})
    assert says in str(raised.value)


@pytest.mark.parametrize("method", METHODS)
def test_what_the_control_loop_calls_is_never_silent(method):
    """Tensions without a reason keep the limits; a wrench that is no number gets one."""
    W, w_e = problems(60, seed=14)
    solve = solver_for(method, 6, LOW, HIGH)
    judged = cl.distribute_tensions(W, w_e, LOW, HIGH, method)
    for k in range(60):
        tau, reason = solve(W[k], w_e[k])
        assert (reason == "") == judged.feasible[k]
        assert reason or ((tau >= LOW - 1e-6) & (tau <= HIGH + 1e-6)).all()
    nothing = w_e[0].copy()
    nothing[2] = np.nan
    assert solve(W[0], nothing)[1] == "the wrench is not finite"
    again, reason = solve(np.asfortranarray(W[1]), w_e[1])     # any memory layout, and no memory of what came before
    np.testing.assert_allclose(again, judged.tensions[1], rtol=1e-6, atol=1e-4)


def test_require_raises_with_the_answer_in_hand():
    W, w_e = problems(30, seed=12)
    batch = cl.distribute_tensions(W, w_e, LOW, HIGH)
    with pytest.raises(cl.errors.InfeasibleTensions, match=f"{(~batch.feasible).sum()} of 30") as raised:
        batch.require()
    assert raised.value.distribution is batch
    one = cl.distribute_tensions(*(x[batch.feasible.argmax()] for x in (W, w_e)), LOW, HIGH)
    assert one.require() is one
