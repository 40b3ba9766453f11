"""What tensions cost on the CAROCA beside a bare quadprog loop over the same wrenches, in the same run."""

import time

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.tensions import solver_for

POSES = 2000


@pytest.fixture(scope="module")
def wrenches():
    """W, w_e, limits at random rotated poses that all have tensions."""
    robot, rng = cl.load_world("caroca").robot, np.random.default_rng(0)
    poses = cl.Pose(rng.uniform([-2.5, -1.3, 0.5], [2.5, 1.3, 2.6], (2 * POSES, 3)),
                    rpy=rng.uniform(-0.3, 0.3, (2 * POSES, 3)))
    W, w_e = cl.wrench_matrix(robot, poses), cl.gravity_wrench(robot, poses)
    good = cl.distribute_tensions(W, w_e, robot.tension_min, robot.tension_max, "barycenter").feasible
    chosen = np.flatnonzero(good)[:POSES]
    assert chosen.size == POSES
    return np.ascontiguousarray(W[chosen]), w_e[chosen], robot.tension_min, robot.tension_max


def quadprog_loop(W, w_e, low, high):
    """Nothing but the solver: constants written once, W and w_e into place, the answer dropped."""
    import quadprog

    n, m = W.shape[1:]
    identity, zero = np.eye(m), np.zeros(m)
    rows = np.concatenate([np.zeros((m, n)), identity, -identity], axis=1)
    bounds = np.concatenate([np.zeros(n), low, -high])

    def loop(count):
        for k in range(count):
            rows[:, :n] = W[k].T
            np.negative(w_e[k], out=bounds[:n])
            quadprog.solve_qp(identity, zero, rows, bounds, n)

    return loop


def seconds(call, *arguments):
    began = time.perf_counter()
    call(*arguments)
    return time.perf_counter() - began


def paired(reference, candidate, repeats=41):
    """Least time of the reference over least time of the candidate, measured in turn.

    What else the machine does only ever adds time, and to a call of a millisecond it adds in lumps.
    """
    candidate()
    times = [(reference(), candidate()) for _ in range(repeats)]
    return min(first for first, _ in times) / min(second for _, second in times)


@pytest.mark.parametrize("method, promised", [("closed_form", 12), ("barycenter", 15), ("quadratic_program", 15),
                                              ("linear_program", None),
                                              ("improved_closed_form", None), ("puncture", None)])
def test_batches(benchmark, report, wrenches, method, promised):
    """Checked distributions of a batch; poses a second."""
    W, w_e, low, high = wrenches
    loop, share = quadprog_loop(*wrenches), POSES // 4

    def batch():
        return seconds(cl.distribute_tensions, W, w_e, low, high, method)

    ratio = paired(lambda: seconds(loop, share) * POSES / share, batch)
    report(f"bare quadprog loop / {method} of a batch", ratio, promised, at_least=True)
    benchmark(batch)


def test_barycenter_beside_linprog(benchmark, report, wrenches):
    from scipy.optimize import linprog

    W, w_e, low, high = wrenches
    costs, bounds, share = np.ones(low.size), np.stack([low, high], axis=1), 20

    def programs():
        for k in range(share):
            linprog(costs, A_eq=W[k], b_eq=-w_e[k], bounds=bounds)

    def batch():
        return seconds(cl.distribute_tensions, W, w_e, low, high, "barycenter")

    ratio = paired(lambda: seconds(programs) * POSES / share, batch, repeats=15)
    report("linprog loop / barycenter of a batch", ratio, 500, at_least=True)
    benchmark(batch)


def test_quadratic_program_in_the_loop(benchmark, report, wrenches):
    """One wrench at a time by the solver the control loop holds, equilibrium and limits checked each time."""
    W, w_e, low, high = wrenches
    loop, solve, share = quadprog_loop(*wrenches), solver_for("quadratic_program", 6, low, high), 500

    def solves():
        for k in range(share):
            tau, reason = solve(W[k], w_e[k])
            error = max(map(abs, (W[k].dot(tau) + w_e[k]).tolist()))
            assert not reason and error < 1e-5
            assert tau.min() >= 50 - 1e-4 and tau.max() <= 10000 + 1e-4

    ratio = 1 / paired(lambda: seconds(loop, share), lambda: seconds(solves))
    report("quadratic_program in the loop / bare quadprog", ratio, 1.4)
    benchmark(solves)


def test_a_wrench_out_of_reach_in_the_loop(benchmark, report, wrenches):
    """`relaxed` where each step misses something: the least error, then the least norm."""
    W, w_e, low, high = wrenches
    loop, solve, share = quadprog_loop(*wrenches), solver_for("relaxed", 6, low, high / 10), 200

    def relaxed():
        for k in range(share):
            solve(W[k], 10 * w_e[k])

    assert all(solve(W[k], 10 * w_e[k])[1] for k in range(share))
    benchmark.pedantic(relaxed, rounds=1)
    ratio = 1 / paired(lambda: seconds(loop, share), lambda: seconds(relaxed), 11)
    report("relaxed in the loop, out of reach / bare quadprog", ratio, 60)


@pytest.mark.parametrize("method, promised", [("quadratic_program", 3), ("linear_program", None), ("barycenter", None),
                                              ("closed_form", None), ("improved_closed_form", None)])
def test_one_public_call(benchmark, report, wrenches, method, promised):
    W, w_e, low, high = wrenches
    loop, share = quadprog_loop(*wrenches), 50

    def calls():
        for k in range(share):
            cl.distribute_tensions(W[k], w_e[k], low, high, method)

    ratio = 1 / paired(lambda: seconds(loop, share), lambda: seconds(calls), repeats=151)
    report(f"distribute_tensions, one {method} / bare quadprog", ratio, promised)
    benchmark(calls)
