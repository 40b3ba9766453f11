"""What ropes of commanded length cost beside the bare engine step of the same scene, and what a plan costs."""

import statistics
import time

import numpy as np

import cdprlab as cl

STEPS = 300


def bare_step_time(simulator):
    """Seconds per stepSimulation of four legs at rest, nothing read or commanded."""
    simulator.reset()
    step, client = simulator.bullet.engine.stepSimulation, simulator.bullet.client
    began = time.perf_counter()
    for _ in range(STEPS):
        step(client)
    return (time.perf_counter() - began) / STEPS


def winding_time(simulator, lengths):
    """Seconds per step of the complementarity problem, torques, read-back and state, along given lengths."""
    simulator.reset()
    began = time.perf_counter()
    for length in lengths:
        simulator.wind(length)
    return (time.perf_counter() - began) / len(lengths)


def test_length_controlled_loop(benchmark, report):
    """Marionet along its task, cable 3 slack."""
    world = cl.load_world("marionet")
    times = np.arange(1, STEPS + 1) * 1e-3
    lengths = cl.cable_lengths(world.robot, world.task().trajectory()(times).pose)
    lengths[:, 2] += np.minimum(0.2, 0.4 * times)
    with cl.open_simulator(world, "length") as wound, cl.open_simulator(world, solver_iterations=10) as bare:
        ratios = [winding_time(wound, lengths) / bare_step_time(bare) for _ in range(25)]
        benchmark.pedantic(winding_time, args=(wound, lengths), rounds=3)
    report("length-controlled loop / bare stepSimulation", statistics.median(ratios), 2.4)


def test_plan(benchmark, report):
    """All sequences of the paper's example, ranked, by either method [ms]."""
    robot = cl.load_world("marionet").robot
    cl.plan_configurations(robot, [0.6, 0.8, 0.8], [1.9, 1.1, 0.5], "accuracy")
    spent = []
    for method in ("stability", "accuracy") * 5:
        began = time.perf_counter()
        cl.plan_configurations(robot, [0.6, 0.8, 0.8], [1.9, 1.1, 0.5], method)
        spent.append(time.perf_counter() - began)
    benchmark.pedantic(cl.plan_configurations, args=(robot, [0.6, 0.8, 0.8], [1.9, 1.1, 0.5]), rounds=5)
    report("a plan of configurations [ms]", 1e3 * max(spent), 50)
