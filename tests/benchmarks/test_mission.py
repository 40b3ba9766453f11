"""How much faster than real time the pair navigates: by kinematics alone, in the engine, and the whole mission.

The mission is there, at the shelf and home again; navigation in the engine alone is the way there.
"""

import time
from types import SimpleNamespace

import numpy as np
import pytest
from practice_halls import practice_hall

import cdprlab as cl
from cdprlab.fastkit import KinematicPair, Vehicle, Walker, navigate

BOUNDS = [[-5, -6], [7, 2]]
PALLETS = [[2.6, -3.0, 0.8, 1.2, 0.3], [-1.5, -2.2, 1.2, 0.8, 0.0]]
PEOPLE = (Walker([[2.5, -1.0], [6.0, -1.0]]),)


def test_navigation_by_kinematics(benchmark, report):
    pair = Vehicle.of(cl.load_world("fastkit_suspended").robot)
    place = practice_hall(pair, 9)

    def drive():
        bases = KinematicPair(pair, place.hall, place.start, place.walkers)
        return navigate(bases, place.hall, place.start, place.goal)

    began = time.perf_counter()
    simulated = drive().time[-1]
    report("navigation, kinematics / real time", simulated / (time.perf_counter() - began), 3, at_least=True)
    benchmark.pedantic(drive, rounds=1)


@pytest.mark.parametrize("whole", [False, True], ids=["navigation", "mission"])
def test_mission_in_the_engine(benchmark, report, whole):
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    from cdprlab.fastkit import in_hall, run_mission

    world = in_hall(cl.load_world("fastkit_suspended"), BOUNDS, PALLETS)

    def given_up(there, _):
        return SimpleNamespace(state="stopped", reason="", events=(), time=np.zeros(1), base_poses=None, world=there)

    work = {} if whole else {"work": given_up}

    def go():
        return run_mission(world, BOUNDS, [5.0, -3.5, 1.8], walkers=PEOPLE, seed=3, **work)

    done = benchmark.pedantic(go, rounds=1)
    assert done.state == ("done" if whole else "stopped") and bool(done.way_home) == whole
    name = "mission" if whole else "navigation in the engine"
    report(f"{name} / real time", done.real_time_factor, 3, at_least=True)
