"""The engine against statics and against itself: hanging, falling, measuring, breaking."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InvalidInput, SimulationDiverged

try:
    from cdprlab.simulate.bullet import import_pybullet

    import_pybullet()
except cl.errors.MissingDependency as missing:
    pytest.skip(str(missing), allow_module_level=True)


def with_task(world, name, task):
    return replace(world, tasks={**world.tasks, name: task})


SPATIAL = [name for name in cl.world_names() if cl.load_world(name).engine == "spatial"]


@pytest.mark.parametrize("name", SPATIAL)
def test_every_world_hangs_still(name):
    """Platform within 1 mm after 2 s, nothing touching it, tensions measured as commanded."""
    world = cl.load_world(name)
    world = with_task(world, "still", cl.world.Task("hold", world.pose, world.pose, 2.0))
    with cl.open_simulator(world) as simulator:
        run = cl.run(world, "still", simulator=simulator)
        assert simulator.contact_force() == 0
    assert run.position_errors.max() < 1e-3
    assert run.feasible.all()
    # The legs' tips weigh 1e-4 kg: 0.001 N each.
    np.testing.assert_allclose(run.measured_tensions, run.commanded_tensions, atol=2e-3)


@pytest.mark.parametrize("name", SPATIAL)
@pytest.mark.parametrize("cables", ["tension", "force"])
def test_cut_cables_let_it_fall(name, cables):
    """Free fall for 0.1 s: h = g t²/2, up to the semi-implicit step's g t dt / 2."""
    world = cl.load_world(name)
    with cl.open_simulator(world, cables) as simulator:
        simulator.cut()
        for _ in range(100):
            simulator.step(world.robot.tension_min)
        fallen = world.pose.position - simulator.state().position
        assert simulator.contact_force() == 0
    np.testing.assert_allclose(fallen, [0, 0, 9.81 * 0.1**2 / 2], atol=9.81 * 0.1 * 1e-3)


def test_one_cut_cable_carries_nothing():
    world = cl.load_world("caroca")
    with cl.open_simulator(world) as simulator:
        simulator.cut([2])
        simulator.step(np.full(8, 300.0))
        tensions = simulator.state().tensions
        assert tensions[2] == 0
        # The others' reactions are there, up to the tips' inertia: 1e-4 kg at no more than 100 m/s².
        np.testing.assert_allclose(np.delete(tensions, 2), 300.0, atol=0.01)
        with pytest.raises(InvalidInput, match="index"):
            simulator.cut([8])


def test_rest_agrees_with_statics_at_rotated_poses_off_center():
    """CoGiRo has its center of mass off P and a full inertia matrix: rest needs W τ + w_g = 0 exactly there."""
    world = cl.load_world("cogiro")
    pose = cl.Pose(world.pose.position, rpy=[0.05, -0.04, 0.1])
    world = with_task(world, "still", cl.world.Task("hold", pose, pose, 1.0))
    run = cl.run(world, "still")
    balance = cl.wrench_matrix(world.robot, pose) @ run.measured_tensions[-1] + cl.gravity_wrench(world.robot, pose)
    # The eight tips weigh 8e-3 N in all, at arms below 1 m.
    np.testing.assert_allclose(balance, 0, atol=0.01)


def test_push_moves_a_free_body_by_newton():
    """m a = f at P with cables cut; two forces make a moment about an off-center mass."""
    world = cl.load_world("cogiro")
    robot = world.robot
    with cl.open_simulator(world, "force") as simulator:
        simulator.cut()
        simulator.push([50.0, -30.0, 20.0, 5.0, 4.0, -3.0])
        simulator.step(np.zeros(8))
        twist = simulator.state().twist
    wanted = cl.mechanics.dynamics.inverse_dynamics(robot, np.eye(3), np.zeros(6), twist / 1e-3)
    np.testing.assert_allclose(wanted, [50, -30, 20, 5, 4, -3], atol=1e-6)


def test_simulators_share_a_process():
    """Interleaved steps give the same digits as separate ones."""
    world = cl.load_world("caroca")
    tension = np.full(8, 380.0)

    def alone():
        with cl.open_simulator(world) as simulator:
            for _ in range(50):
                simulator.step(tension)
            return simulator.state().position

    with cl.open_simulator(world) as one, cl.open_simulator(cl.load_world("cogiro")) as other:
        for _ in range(50):
            one.step(tension)
            other.step(np.full(8, 400.0))
        np.testing.assert_array_equal(one.state().position, alone())


def test_reset_starts_anew():
    world = cl.load_world("caroca")
    with cl.open_simulator(world) as simulator:
        first = cl.run(world, duration=0.05, simulator=simulator)
        simulator.cut()
        again = cl.run(world, duration=0.05, simulator=simulator)
    np.testing.assert_array_equal(first.measured_tensions, again.measured_tensions)


def test_divergence_says_when_and_which_cable():
    """Cables that push as hard as they are told throw the platform out of the scene."""
    world = cl.load_world("caroca")

    def throw(t, state, reference):
        return np.array([0.0, 0.0, 1e7, 0.0, 0.0, 0.0])

    method = "pseudo_inverse"  # ignores the limits that would hold the explosion back
    with pytest.raises(SimulationDiverged, match=r"t = \S+ s.*cable \d") as caught:
        cl.run(world, method=method, controller=throw, duration=3.0, infeasible="send")
    assert caught.value.time > 0 and 1 <= caught.value.cable <= 8


def test_wrong_requests_are_named():
    world = cl.load_world("caroca")
    with pytest.raises(InvalidInput, match=r"'string' is not available.*tension, force"):
        cl.open_simulator(world, "string")
    with pytest.raises(InvalidInput, match="dt"):
        cl.open_simulator(world, dt=0.0)


def test_the_engine_is_silent():
    """Neither the banner at import nor the line at connect reaches the terminal, from C or Python."""
    code = "import cdprlab as cl; cl.open_simulator(cl.load_world('caroca')).close()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert (done.stdout, done.stderr) == ("", "")


def test_nothing_that_others_print_is_lost():
    """Four threads open engines, the first of them imports PyBullet, while two more write to either stream.

    As on Windows, the process itself is no library that ctypes could open.
    """
    code = """
import ctypes, os, sys, threading, concurrent.futures as cf
CDLL = ctypes.CDLL
def library(name, *rest, **more):
    if name is None:
        raise TypeError("argument of type 'NoneType' is not iterable")
    return CDLL(name, *rest, **more)
ctypes.CDLL = library
import cdprlab as cl
from cdprlab.simulate.bullet import import_pybullet
worlds, written, over = [cl.load_world(name) for name in ("caroca", "cogiro")] * 4, [0, 0], threading.Event()
def write(to):
    while not over.is_set():
        written[to - 1] += 1
        os.write(to, b"x" * 9 + b"\\n")
        over.wait(1e-4)
with cf.ThreadPoolExecutor(6) as pool:
    for to in (1, 2):
        pool.submit(write, to)
    list(pool.map(lambda _: import_pybullet(), range(4)))
    list(pool.map(lambda world: cl.open_simulator(world).close(), worlds))
    over.set()
print("done", *written)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    *lines, last = done.stdout.splitlines()
    assert last == f"done {len(lines)} {len(done.stderr.splitlines())}" and set(done.stderr.splitlines()) == {"x" * 9}
