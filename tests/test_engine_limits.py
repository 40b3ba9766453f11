"""What an engine cannot do is said, and what it can do it does: heavy robots, light ones, long falls."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import CdprWarning, InvalidInput


def fast(height=252.0):
    """FAST's cabin cage: six towers on a circle of 300 m. CASPR's model FAST (github.com/darwinlau/CASPR)."""
    angles = np.deg2rad([30, 90, 150, 210, 270, 330])
    exits = np.stack([300 * np.cos(angles), 300 * np.sin(angles), np.full(6, 270.0)], axis=1)
    pairs = np.deg2rad([60, 180, 300])
    anchors = np.repeat(np.stack([6.5 * np.cos(pairs), 6.5 * np.sin(pairs), np.zeros(3)], axis=1), 2, axis=0)
    return cl.World.from_dict({
        "name": "fast", "motion_pattern": "3R3T", "cable_limits": {"tension": [120e3, 1.2e6]},
        "platform": {"mass": 30091.8, "size": [10, 10, 1], "inertia": [1e4, 1e4, 1e4],
                     "pose": {"position": [0, 0, height]}},
        "cables": [{"exit_point": a, "anchor_point": b} for a, b in zip(exits.tolist(), anchors.tolist())]})


@pytest.mark.parametrize("cables", ["force", "tension", "length"])
@pytest.mark.parametrize("dt", [1e-3, 5e-3])
def test_fast_hangs_at_252_m(cables, dt):
    """30 t on six cables of 806 kN: m g = 6 T sin of their slope."""
    run = cl.run(fast(), cables=cables, dt=dt, duration=1.0, controller=None if cables == "length" else
                 cl.ComputedTorque(100, 20))
    still = cl.distribute_tensions(cl.wrench_matrix(fast().robot, fast().pose),
                                   cl.gravity_wrench(fast().robot, fast().pose), 120e3, 1.2e6).tensions
    assert run.position_errors.max() < 1e-4 and run.feasible.all()
    np.testing.assert_allclose(run.measured_tensions, np.broadcast_to(still, run.measured_tensions.shape), rtol=0.02)


@pytest.mark.parametrize("cables", ["tension", "length", "elastic"])
@pytest.mark.parametrize("mass", [1e8, 1e12, 1e16, 1e22])
def test_no_weight_is_too_heavy_for_its_cables(mass, cables):
    """Neither the constraint's largest force nor its tip's largest speed, 1e8 N at 1 ms, is in the way."""
    world = light(mass)
    world = replace(world, robot=replace(world.robot, elasticity=cl.Elasticity(1e4 * mass)))
    run = cl.run(world, cables=cables, duration=0.05)
    assert run.position_errors.max() < 1e-6 and run.feasible[-10:].all()   # 0.1 µm at 1 kg
    held = cl.wrench_matrix(world.robot, run.poses[-1]) @ run.measured_tensions[-1]
    np.testing.assert_allclose(held, [0, 0, 9.81 * mass], rtol=0.01, atol=0.01 * mass)


def test_ropes_that_an_engine_does_not_hold_are_said(monkeypatch):
    monkeypatch.setattr("cdprlab.simulate.spatial._TOLD", 0.0)   # tips of 0.1 g beside 1e20 kg
    with pytest.warns(CdprWarning, match=r"at t = 0\.\d+ s cable \d spans 0\.\d+ m more than the .* smaller dt"):
        run = cl.run(light(1e20), cables="length", dt=1e-2, duration=0.1)
    assert not run.feasible.all()


def light(mass):
    return cl.World.from_dict({
        "name": "light", "motion_pattern": "3T", "cable_limits": {"tension": [0, max(10, 1e2 * mass)]},
        "platform": {"mass": mass, "size": [0.1] * 3, "pose": {"position": [0, 0, 1]}},
        "cables": [{"exit_point": [x, y, 2], "anchor_point": [0, 0, 0]} for x, y in ((1, 0), (-1, 1), (-1, -1))]})


def test_a_platform_lighter_than_its_legs_tips_is_said():
    with pytest.warns(CdprWarning, match=r"0\.001 kg feels its cables' tips .* cables=\"force\""):
        cl.open_simulator(light(1e-3)).close()
    cl.open_simulator(light(1e-3), "force").close()
    cl.open_simulator(light(1e-3), tip_mass=1e-6).close()
    cl.open_simulator(light(0.1)).close()


def test_cables_that_push_are_said():
    def push(W, w_e, low, high):
        return -np.linalg.pinv(W) @ w_e

    world = cl.load_world("planar_rigid")
    with pytest.warns(CdprWarning, match=r"at t = 0 s cable \d was to carry -\d.*no cable can"):
        cl.run(world, method=push, infeasible="send", duration=0.01)


@pytest.mark.parametrize("name", ["planar_rigid", "caroca"])
def test_a_long_fall_is_a_fall(name):
    world = cl.load_world(name)
    deep = -120.0
    world = replace(world, scene=replace(world.scene, floor_height=deep, boxes=()))
    with cl.open_simulator(world, dt=5e-3) as simulator:
        simulator.cut()
        for _ in range(1600):
            simulator.step(np.zeros(world.robot.n_cables))
        assert deep - 1 < simulator.position[-1] < deep + 2 and np.abs(simulator.twist).max() < 5


def test_a_run_shorter_than_a_step_is_refused():
    with pytest.raises(InvalidInput, match=r"at least one control step, 0\.001 s"):
        cl.run(cl.load_world("planar_rigid"), duration=5e-4)


@pytest.mark.parametrize("name", ["planar_rigid", "caroca"])
def test_simulators_do_not_travel(name):
    with cl.open_simulator(cl.load_world(name)) as simulator:
        for travel in (pickle.dumps, copy.copy, copy.deepcopy):
            with pytest.raises(InvalidInput, match="cannot be pickled or copied"):
                travel(simulator)
        state = pickle.loads(pickle.dumps(simulator.state()))
    np.testing.assert_array_equal(state.position, simulator.state().position)
