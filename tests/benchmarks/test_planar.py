"""How much faster than real time a planar robot on four ropes flies at 1 kHz, log and all."""

import statistics
import time

import cdprlab as cl


def test_planar_loop(benchmark, report, monkeypatch):
    """Winches, engine, readings and log every millisecond; in processor time, for the machine has other users."""
    monkeypatch.setattr(time, "perf_counter", time.process_time)     # what the loop takes its time with
    world = cl.load_world("planar_rigid")
    with cl.open_simulator(world, "length") as simulator:
        factors = [cl.run(world, cables="length", duration=0.5, simulator=simulator).real_time_factor
                   for _ in range(80)]
        report("planar loop, 4 ropes at 1 kHz / real time", statistics.median(factors), 100, at_least=True)
        benchmark(lambda: cl.run(world, cables="length", duration=0.5, simulator=simulator))


def test_planar_control_loop(benchmark, report):
    """Computed torque and quadratic program instead of winches: nothing is promised."""
    world = cl.load_world("planar_rigid")
    with cl.open_simulator(world) as simulator:
        factors = sorted(cl.run(world, duration=0.2, simulator=simulator).real_time_factor for _ in range(20))
        report("planar control loop, 4 cables at 1 kHz / real time", statistics.median(factors[15:]), None)
        benchmark(lambda: cl.run(world, duration=0.1, simulator=simulator))
