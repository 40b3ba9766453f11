"""What sweeps of workspaces cost beside loops of quadprog and linprog over the same poses, in the same run."""

import itertools
import time
import tracemalloc

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.workspace import low_discrepancy_poses, position_grid

POSES = 2000


@pytest.fixture(scope="module")
def caroca():
    """Robot, poses on both sides of the border, and what a loop of solvers needs of them: W and the weight."""
    robot = cl.load_world("caroca").robot
    poses = low_discrepancy_poses([-3.3, -1.9, 0.2], [3.3, 1.9, 3.4], POSES, seed=0, turn=0.2)
    return robot, poses, cl.wrench_matrix(robot, poses), np.broadcast_to(cl.gravity_wrench(robot, poses), (POSES, 6))


def quadprog_feasibility(W, w_e, low, high):
    """Whether quadprog finds tensions: constants written once, W and w_e into place, the answer dropped."""
    import quadprog

    n, m = W.shape[1:]
    identity, zero = np.eye(m), np.zeros(m)
    rows = np.concatenate([np.zeros((m, n)), identity, -identity], axis=1)
    bounds = np.concatenate([np.zeros(n), low, -high])

    def one(k, wrench):
        rows[:, :n] = W[k].T
        np.negative(wrench, out=bounds[:n])
        try:
            quadprog.solve_qp(identity, zero, rows, bounds, n)
        except ValueError:
            return False
        return True

    return one


def seconds(call):
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


def paired(reference, candidate, repeats):
    """Least time of the reference over least time of the candidate, measured in turn."""
    candidate()
    times = [(reference(), candidate()) for _ in range(repeats)]
    return min(first for first, _ in times) / min(second for _, second in times)


def test_wrench_matrices_of_a_batch(benchmark, report, caroca):
    """Microseconds a pose; as many poses at a time as stay in the cache."""
    robot, poses, *_ = caroca
    batch = poses[:500]
    cl.wrench_matrix(robot, batch)
    least = min(seconds(lambda: cl.wrench_matrix(robot, batch)) for _ in range(101))
    report("W of the Caroca, in a batch [µs a pose]", least / 500 * 1e6, 0.3)
    benchmark(cl.wrench_matrix, robot, batch)


@pytest.mark.parametrize("margin, promised", [(False, 15), (True, None)], ids=["verdict", "margin"])
def test_wrench_feasibility_beside_quadprog(benchmark, report, caroca, margin, promised):
    """From poses to verdicts, wrench matrices included; the loop gets its W for nothing."""
    robot, poses, W, w = caroca
    one, share = quadprog_feasibility(W, w, robot.tension_min, robot.tension_max), 200

    def sweep():
        return cl.workspace(robot, poses, cl.WrenchFeasible(), margin=margin)

    verdicts = [one(k, w[k]) for k in range(POSES)]
    assert (sweep().inside == verdicts).mean() > 0.999   # quadprog itself errs at the very border
    ratio = paired(lambda: seconds(lambda: [one(k, w[k]) for k in range(share)]) * POSES / share,
                   lambda: seconds(sweep), repeats=101)
    report(f"quadprog loop / WFW of the Caroca, {'margin' if margin else 'verdict'}", ratio, promised, at_least=True)
    benchmark(sweep)


def test_wrench_feasibility_beside_linprog(benchmark, report, caroca):
    from scipy.optimize import linprog

    robot, poses, W, w = caroca
    limits, share = list(zip(robot.tension_min, robot.tension_max)), 15

    def programs():
        for k in range(share):
            linprog(np.ones(8), A_eq=W[k], b_eq=-w[k], bounds=limits, method="highs")

    def sweep():
        return cl.workspace(robot, poses, cl.WrenchFeasible(), margin=False)

    ratio = paired(lambda: seconds(programs) * POSES / share, lambda: seconds(sweep), repeats=9)
    report("linprog loop / WFW of the Caroca", ratio, 500, at_least=True)
    benchmark(sweep)


def test_a_box_of_64_wrenches(benchmark, report, caroca):
    """By facets, margin and all, beside one quadprog a vertex."""
    robot, poses, W, w = caroca
    half = np.array([100.0, 100, 100, 30, 30, 30])
    corners = np.array(list(itertools.product(*zip(-half, half))))
    one, share = quadprog_feasibility(W, w, robot.tension_min, robot.tension_max), 10
    box = cl.WrenchFeasible(half_widths=half)

    def sweep():
        return cl.workspace(robot, poses, box)

    def vertices(count):
        return [all([one(k, w[k] + corner) for corner in corners]) for k in range(count)]

    found = sweep()
    sure = np.abs(found.margin[:200]) > 1e-3
    assert (found.inside[:200] == vertices(200))[sure].all()
    ratio = paired(lambda: seconds(lambda: vertices(share)) * POSES / share, lambda: seconds(sweep), repeats=25)
    report("64 quadprogs a pose / a box of 64 wrenches", ratio, 50, at_least=True)
    benchmark(sweep)


def test_memory_is_flat_in_the_number_of_poses(benchmark, report, caroca):
    """What a sweep holds at its peak beyond its answers, at twenty times as many poses."""
    robot = caroca[0]

    def peak(step):
        grid = position_grid([-3.3, 0, 0.2], [3.3, 0, 3.4], step)
        tracemalloc.start()
        cl.workspace(robot, grid, cl.WrenchFeasible())
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return most - 9 * len(grid)   # a verdict and a margin a pose

    peak(0.1)
    report("memory of 530 000 poses / of 21 000", peak(0.00632) / peak(0.0318), 1.5)
    benchmark(lambda: None)
