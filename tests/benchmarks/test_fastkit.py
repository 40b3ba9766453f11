"""How much faster than real time FASTKIT's job runs."""

from dataclasses import replace

import cdprlab as cl
from cdprlab.picking import pick_and_place


def test_job(benchmark, report):
    """The first seconds of the job, 500 Hz engine and 250 Hz control, wheels read and everything logged."""
    world = cl.load_world("fastkit_suspended")
    task = replace(world.task("pick_and_place"), coupled={}, start=cl.Pose([0.9, -0.05, 0.8]))
    world = replace(world, tasks={"pick_and_place": task})

    def fly():
        return pick_and_place(world, faults=(lambda sensors: "enough" if sensors.time > 4 else "",))

    fly()   # friction is identified once
    assert pick_and_place(cl.load_world("fastkit_suspended")).state == "done"  # all of it, 75 s
    report("FASTKIT's job / real time", max(fly().real_time_factor for _ in range(3)), 3, at_least=True)
    benchmark.pedantic(fly, rounds=3)
