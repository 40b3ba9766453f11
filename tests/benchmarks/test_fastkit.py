"""How much faster than real time FASTKIT's jobs run: both controllers, both layouts, the deployment included."""

from dataclasses import replace

import pytest

import cdprlab as cl
from cdprlab.fastkit import pick_and_place

pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
CONTROLS = ["torque", "velocity"]


@pytest.mark.parametrize("control", CONTROLS)
def test_first_seconds(benchmark, report, control):
    """500 Hz engine and 250 Hz control, wheels read and everything logged."""
    world = cl.load_world("fastkit_suspended")
    task = replace(world.task("pick_and_place"), coupled={}, start=cl.Pose([0.9, -0.05, 0.8]))
    world = replace(world, tasks={"pick_and_place": task})

    def fly():
        return pick_and_place(world, control=control, faults=(lambda sensors: "enough" if sensors.time > 4 else "",))

    fly()   # friction is identified once
    report(f"FASTKIT's job, {control} control / real time", max(fly().real_time_factor for _ in range(3)), 3,
           at_least=True)
    benchmark.pedantic(fly, rounds=3)


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("layout", ["suspended", "constrained"])
def test_whole_job(benchmark, report, layout, control):
    """From the coupled bases on, about 75 s."""
    world = cl.load_world(f"fastkit_{layout}")
    job = benchmark.pedantic(pick_and_place, args=(world,), kwargs={"control": control}, rounds=1)
    assert job.state == "done"
    report(f"the whole job, {layout}, {control} / real time", job.real_time_factor, 3, at_least=True)
