"""What the closed loop costs beside the bare engine step of the same scene, and what the import costs."""

import dataclasses
import os
import statistics
import subprocess
import sys
import time

import pytest

import cdprlab as cl
from cdprlab.course.props.changed_cables import every_cable

STEPS = 200  # 0.2 s of free fall from 0.3 m above the floor: the bare steps meet no contact


@pytest.fixture
def simulator():
    with cl.open_simulator(cl.load_world("caroca")) as opened:
        yield opened


@pytest.fixture
def reference():
    """The same scene at 10 solver iterations, which is what the promise is measured against."""
    with cl.open_simulator(cl.load_world("caroca"), solver_iterations=10) as opened:
        yield opened


def bare_step_time(simulator):
    """Seconds per stepSimulation, residual threshold 0, same bodies and constraints, nothing read or commanded."""
    simulator.reset()
    simulator.step(simulator.robot.tension_min)
    step, client = simulator.bullet.engine.stepSimulation, simulator.bullet.client
    began = time.perf_counter()
    for _ in range(STEPS):
        step(client)
    return (time.perf_counter() - began) / STEPS


def loop_ratio(simulator, reference, control_period):
    """Loop and bare steps in turn, so that a drifting machine slows both: the median of the paired ratios."""
    ratios = []
    for _ in range(25):
        bare = bare_step_time(reference)
        run = cl.run(simulator.world, duration=0.4, control_period=control_period, simulator=simulator)
        ratios.append(run.dt / run.real_time_factor / bare)
    return statistics.median(ratios)


@pytest.mark.parametrize("control_period, promised", [(None, 1.9), (0.01, 1.25)], ids=["1 kHz", "100 Hz"])
def test_closed_loop(benchmark, report, simulator, reference, control_period, promised):
    """Reference, computed torque, QP, eight torques, eight tensions read back, logged."""
    rate = "1 kHz" if control_period is None else "100 Hz"
    report(f"closed loop at {rate} / bare stepSimulation", loop_ratio(simulator, reference, control_period), promised)
    benchmark(lambda: cl.run(simulator.world, duration=0.2, control_period=control_period, simulator=simulator))


def test_every_step_relaxed(benchmark, report, reference):
    """Limits that never carry the platform: each step misses a wrench, and finds the least error."""
    world = cl.load_world("caroca")
    weak = dataclasses.replace(world, robot=every_cable(world.robot, tension_min=50.0, tension_max=200.0))
    with cl.open_simulator(weak) as simulator:
        run = cl.run(weak, duration=0.2, simulator=simulator)
        assert not run.feasible.any()
        report("every step relaxed / bare stepSimulation", loop_ratio(simulator, reference, None), 10)
        benchmark(lambda: cl.run(weak, duration=0.2, simulator=simulator))


def import_time(module):
    """Seconds of one import in a fresh interpreter that may keep bytecode, as installed; its own start not counted."""
    code = f"import time; t = time.perf_counter(); import {module}; print(time.perf_counter() - t)"
    kept = os.environ | {"PYTHONDONTWRITEBYTECODE": ""}
    return float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                                env=kept).stdout)


def test_import(benchmark, report):
    import_time("cdprlab")  # warms the disk cache
    ratios = [import_time("cdprlab") / import_time("numpy") for _ in range(9)]
    report("import cdprlab / import numpy", statistics.median(ratios), 2)
    benchmark.pedantic(import_time, args=("cdprlab",), rounds=3)
