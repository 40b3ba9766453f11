"""FASTKIT's job in the engine: both controllers, both layouts, standing bases, friction found, safe endings."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.fastkit import DONE, STOPPED, Machine, Phase, Readings, pick_and_place
from cdprlab.fastkit.job.phases import driving_speed, driving_time, job_phases
from cdprlab.mechanics.dynamics import mass_and_bias, pose_error
from cdprlab.robot.pose import rotation_vector
from cdprlab.run.winches import TorqueControl
from cdprlab.simulate.state import State
from cdprlab.tensions.standing import standing_tensions

pytest.importorskip("pybullet", reason="PyBullet has no wheel here")


def job_world(name="fastkit_suspended", base_mass=None, **changes):
    """The world's own task with something changed."""
    world = cl.load_world(name)
    robot = world.robot
    if base_mass is not None:
        robot = replace(robot, bases=tuple(replace(base, mass=base_mass) for base in robot.bases))
    return replace(world, robot=robot, tasks={"pick_and_place": replace(world.task("pick_and_place"), **changes)})


def near(world, **changes):
    """The same job begun beside the box, bases in their places: seconds less to simulate."""
    return job_world(world, coupled={}, start=cl.Pose([0.9, -0.05, 0.8]), **changes)


@pytest.fixture(scope="module")
def flown():
    """The whole job under torque control, from the coupled bases on."""
    return pick_and_place(cl.load_world("fastkit_suspended"))


@pytest.fixture(scope="module")
def wound():
    """The whole job of the constrained layout under velocity control."""
    return pick_and_place(cl.load_world("fastkit_constrained"), control="velocity")


def rotation(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def edge_loads(job):
    """What the two wheels of each edge carry, without the first tenth of a second in which wheels find the floor."""
    wheels = job.wheels[job.time >= 0.1]
    return wheels + np.roll(wheels, -1, axis=-1)


# --- the job ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("which", "load"), [("flown", 7.0), pytest.param("wound", 2.0, marks=pytest.mark.long)])
def test_the_whole_job_is_done(request, which, load):
    job = request.getfixturevalue(which)
    assert job.state == DONE and not job.reason
    assert [event.state for event in job.events][:6] == [
        "coupled", "uncouple", "sidestep", "deploy", "line up", "stabilize"]
    assert job.position_errors.max() <= 5e-3
    assert job.box_error <= 0.02
    robot = job.world.robot
    assert (job.measured_tensions[1:] >= robot.tension_min).all() and (job.measured_tensions <= robot.tension_max).all()
    assert np.abs(job.motor_torques).max() < robot.winch.torque and np.abs(job.motor_speeds).max() < robot.winch.speed
    assert job.feasible.all() and edge_loads(job).min() > 0
    assert job.carried.max() == load


@pytest.mark.parametrize("which", ["flown", pytest.param("wound", marks=pytest.mark.long)])
def test_the_platform_keeps_its_pose_while_the_base_deploys(request, which):
    """The base ends in the world file's place to a centimeter, within its speed; nobody else moved."""
    job = request.getfixturevalue(which)
    deploying = [k for k, event in enumerate(job.events) if event.state in ("sidestep", "deploy", "line up")]
    during = np.isin(job.states, deploying)
    assert np.ptp(job.base_poses[during, 0, 0]) > 4  # m
    assert np.linalg.norm(job.poses.position[during] - job.work.start.position, axis=1).max() <= 5e-3
    np.testing.assert_allclose(job.base_poses[-1], [[-3.2, 0, 0], [3.2, 0, 0]], atol=0.01)
    np.testing.assert_allclose(job.base_poses[:, 1], np.tile([3.2, 0, 0], (len(job.time), 1)), atol=0.01)
    speed = np.linalg.norm(np.diff(job.base_poses[:, 0, :2], axis=0), axis=1) / 4e-3
    assert speed.max() <= 0.2 * 1.01


def test_the_tilt_is_made_by_cables_alone(flown):
    tilted = [k for k, event in enumerate(flown.events) if event.state == "reach"]
    np.testing.assert_allclose(flown.poses.rpy[flown.states == tilted[0]][-1], [-0.2, 0, 0], atol=2e-3)


@pytest.mark.long
@pytest.mark.parametrize("control", ["torque", "velocity"])
@pytest.mark.parametrize(("name", "start"), [("fastkit_suspended", [0.9, -0.05, 0.8]),
                                             ("fastkit_constrained", [0.8, 0.0, 0.6])])
def test_a_job_is_done_over_pulleys(name, start, control):
    """By bases that stand deployed: at coupled ones cables would wrap more than half a turn, which is said."""
    robot = cl.load_world(f"{name}_pulleys").robot
    world = replace(job_world(name, coupled={}, start=cl.Pose(start)), robot=robot)
    job = pick_and_place(world, control=control)
    assert job.state == DONE and job.box_error <= 0.02 and job.position_errors.max() <= 5e-3
    assert (job.measured_tensions[1:] >= robot.tension_min).all() and job.feasible.all()
    assert (job.measured_tensions <= robot.tension_max + 0.1).all()   # ropes ring
    assert edge_loads(job).min() > 0


@pytest.mark.long
def test_velocity_control_carries_seven_kilograms_too():
    job = pick_and_place(near("fastkit_suspended"), control="velocity")
    assert job.state == DONE and job.box_error <= 0.02 and job.carried.max() == 7.0
    robot = job.world.robot
    assert (job.measured_tensions[1:] >= robot.tension_min).all() and (job.measured_tensions <= robot.tension_max).all()
    assert edge_loads(job).min() > 0


@pytest.mark.parametrize(("name", "margin"), [("fastkit_suspended", 2.0), ("fastkit_constrained", 5.5)])
def test_the_whole_deployment_is_feasible(name, margin):
    """Every 5 cm of the way: tensions off their limits hold the platform where it starts, and no base tips."""
    world = cl.load_world(name)
    task, robot = world.task("pick_and_place"), world.robot
    low, high = robot.tension_min + margin, robot.tension_max - margin
    x, y, heading = task.coupled["active"]
    assert heading == 0.0 and list(task.coupled) == ["active"]
    stops = [(x, y), (x, y + task.aside), (-3.2, task.aside), (-3.2, 0.0)]
    for (x0, y0), (x1, y1) in pairwise(stops):
        for s in np.linspace(0, 1, 1 + round(20 * max(abs(x1 - x0), abs(y1 - y0)))):
            there = robot.with_bases({"active": (x0 + s * (x1 - x0), y0 + s * (y1 - y0), 0.0)})
            W, w_e = cl.wrench_matrix(there, task.start), cl.gravity_wrench(there, task.start)
            found = cl.distribute_tensions(W, w_e, low, high)
            assert found.feasible
            assert all((rows < 0).all() for rows in cl.tipping_moments(there, task.start, found.tensions).values())


@pytest.mark.parametrize("name", ["fastkit_suspended", "fastkit_constrained"])
def test_bases_keep_clear_of_the_shelf(name):
    """On the way of the deployment no wheel comes nearer than 10 cm to the shelf."""
    world = cl.load_world(name)
    task, shelf = world.task("pick_and_place"), np.concatenate([
        box.position[:2] + 0.5 * np.array([[-1, -1], [1, 1]]) * np.abs(rotation(box.yaw) @ box.size[:2])
        for box in world.scene.boxes])
    low, high = shelf.min(axis=0), shelf.max(axis=0)
    x, y, _ = task.coupled["active"]
    for (x0, y0), (x1, y1) in pairwise([(x, y), (x, y + task.aside), (-3.2, task.aside), (-3.2, 0.0)]):
        for s in np.linspace(0, 1, 100):
            wheels = world.robot.base("active").footprint + [x0 + s * (x1 - x0), y0 + s * (y1 - y0)]
            apart = np.maximum(low - wheels.max(axis=0), wheels.min(axis=0) - high).max()
            assert apart >= 0.1 - 1e-9


@pytest.mark.parametrize("answer", [None, 5, np.zeros(2), float("nan")], ids=str)
def test_a_guard_that_answers_nonsense_is_told_when(answer):
    with pytest.raises(InvalidInput, match=r"a guard answers at t = 0\.1\d* s must be text") as caught:
        pick_and_place(job_world(), faults=(lambda sensors: answer if sensors.time >= 0.1 else "",))
    assert 0 < caught.value.run.time.size < 60


def test_a_base_that_drives_does_not_pull_at_ropes():
    """Velocity control while a base drives: tensions are those wanted.

    A base's speed is known a step late: 0.2 m/s² for 4 ms, over the gain of 20/s, are 40 µm, or EA / l of it 0.5 N.
    """
    world = job_world(coupled={"active": (-2.0, 0.0, 0.0)})
    watch = (lambda sensors: "enough" if sensors.time > 4.5 else "",)
    job = pick_and_place(world, control="velocity", faults=watch)
    driving = (job.time > 1.0) & (job.time < 4.4)
    assert job.state_at(int(np.flatnonzero(driving)[-1])) == "deploy"
    assert np.abs(job.measured_tensions - job.commanded_tensions)[driving].max() <= 0.5
    stopped = job.time > 4.6
    assert np.abs(np.diff(job.base_poses[stopped, 0, :2], axis=0)).max() / 4e-3 <= 0.2  # it brakes
    assert np.abs(job.base_poses[-1] - job.base_poses[-2]).max() < 1e-6


def test_a_job_is_saved(flown, tmp_path):
    flown.save(tmp_path)
    log = np.load(tmp_path / "log.npz")
    np.testing.assert_array_equal(log["measured_tension"], flown.measured_tensions)
    np.testing.assert_array_equal(log["state"], flown.states)
    lines = (tmp_path / "events.csv").read_text().splitlines()
    assert len(lines) == 1 + len(flown.events) and "0.500,uncouple" in lines[2]
    assert cl.load_world(str(tmp_path / "world.yaml")).task("pick_and_place").box_mass == 7.0


def test_a_job_is_a_run(flown):
    """With all its columns under the same names, so that what draws runs draws jobs."""
    assert isinstance(flown, cl.Run) and flown.reference.twist.shape == flown.twists.shape
    assert {"time", "position", "error", "measured_tension", "wheel", "state"} <= set(flown.columns())
    np.testing.assert_allclose(flown.lengths[100], cl.cable_lengths(flown.robot_at(100), flown.poses[100]), atol=1e-5)
    assert "FASTKIT" in cl.plot(flown).alt_text


def test_the_film_shows_every_phase(flown):
    from cdprlab.fastkit.pictures.job_figure import film_moments

    moments = np.array(film_moments(flown, 128))
    assert moments[0] == 0 and moments[-1] == flown.time[-1] and (np.diff(moments) > 0).all()
    shown = [int((flown.states[np.searchsorted(flown.time, moments - 1e-9)] == k).sum())
             for k in range(len(flown.events))]
    assert min(shown) >= 4  # of 128 in 16 s: half a second


def test_a_job_is_pictured(flown, tmp_path):
    from cdprlab.fastkit.pictures.job_figure import frame_at, plot_job

    figure = plot_job(flown)
    assert "done" in figure.alt_text and len(figure.axes) == 5
    early, late = (np.asarray(frame_at(flown, t)) for t in (0.0, flown.time[-1]))
    assert early.shape == late.shape and (early != late).any()


@pytest.mark.parametrize(("name", "control"), [pytest.param("fastkit_suspended", "torque", marks=pytest.mark.long),
                                               ("fastkit_constrained", "velocity")])
def test_two_jobs_are_identical(name, control):
    """Up to some time: bases coupled, released and driving."""
    first, again = (pick_and_place(cl.load_world(name), control=control,
                                   faults=(lambda sensors: "enough" if sensors.time > 6 else "",)) for _ in range(2))
    same = first.time < 6
    assert same.sum() > 1000
    for record in ("measured_tensions", "motor_torques", "wheels", "errors", "base_poses"):
        np.testing.assert_array_equal(getattr(first, record)[same], getattr(again, record)[same])


# --- tipping ----------------------------------------------------------------------------------------------
STIFF = 45.0  # N: a distribution that prestresses the constrained robot for stiffness


def light():
    """The constrained robot's job on bases of 38 kg, which stand in their places already."""
    return job_world("fastkit_constrained", 38.0, coupled={}, start=cl.Pose([0.8, 0, 0.6]))


def test_without_tipping_rows_the_base_tips():
    """Cables as tight as they may be: detected by the wheels before it can be seen."""
    job = pick_and_place(light(), control=TorqueControl(toward=STIFF, standing=False))
    assert job.state == STOPPED and "lifts its wheels" in job.reason
    lifted = next(event.time for event in job.events if event.state == STOPPED)
    assert job.tilts[job.time <= lifted].max() < np.radians(0.5)


@pytest.mark.long
def test_with_tipping_rows_the_same_job_is_done_standing():
    job = pick_and_place(light(), control=TorqueControl(toward=STIFF))
    assert job.state == DONE and job.box_error <= 0.02 and job.position_errors.max() <= 5e-3
    # The reserve of 5 N m over a track of 0.9 m.
    assert edge_loads(job).min() > 4.0 and job.tilts.max() < 1e-3


def test_standing_tensions_are_optimal():
    """No feasible point is nearer: the gradient has no way down (checked on convex combinations with other points)."""
    rng = np.random.default_rng(1)
    W, low, high = rng.normal(size=(3, 6)), np.ones(6), np.full(6, 10.0)
    inside, rows = rng.uniform(2, 6, 6), rng.normal(size=(4, 6))
    offset, w_e = -rows @ inside - 0.2, -W @ inside
    tau, reason = standing_tensions(W, w_e, low, high, rows, offset, toward=9.0)
    assert not reason
    np.testing.assert_allclose(W @ tau, -w_e, atol=1e-9)
    assert (rows @ tau + offset <= 1e-9).all() and (tau >= low).all() and (tau <= high).all()
    assert (tau - 9.0) @ (inside - tau) >= -1e-9
    free, _ = standing_tensions(W, w_e, low, high, rows[:0], offset[:0], toward=9.0)
    assert (rows @ free + offset).max() > 0  # the rows did bind


def test_impossible_standing_is_said():
    W = np.array([[1.0, -1.0]])
    tau, reason = standing_tensions(W, np.zeros(1), np.full(2, 5.0), np.full(2, 9.0), np.ones((1, 2)), np.array([-8.0]))
    assert np.isnan(tau).all() and "keep every base standing" in reason


@pytest.mark.parametrize("turned", [False, True])
def test_computed_torque_is_mass_and_bias_at_the_wanted_acceleration(turned):
    """Where it spins but is not turned away, and the other way round: there the rate of the error is the twist's."""
    rng = np.random.default_rng(2)
    robot = cl.load_world("fastkit_suspended").robot.with_payload(7.0, [0.1, -0.2, 0.05])
    pose = cl.Pose([0, 0, 1], rpy=rng.normal(size=3))
    twist, acceleration = rng.normal(size=(2, 6))
    if turned:
        twist[3:] = acceleration[3:] = 0.0
    mass, bias = mass_and_bias(robot, pose.rotation, twist)
    state = State(0.0, robot, pose.position, pose.rotation, twist, np.zeros(8))
    wanted = cl.Pose([0.1, 0.2, 1.1], rpy=[0.3, -0.2, 0.5] if turned else pose.rpy)
    law = cl.ComputedTorque(30, 12)(0.0, state, cl.Reference(wanted, np.zeros(6), acceleration))
    off = pose_error(pose, wanted)
    np.testing.assert_allclose(mass @ (acceleration - 12 * twist + 30 * off) + bias, law, atol=1e-9)
    np.testing.assert_allclose(off[3:], rotation_vector(wanted.rotation @ pose.rotation.T), atol=1e-12)


# --- the state machine ------------------------------------------------------------------------------------
def sensed(time, **seen):
    calm = {"error": 0.0, "turn_error": 0.0, "tensions": np.full(8, 9.0), "overloaded": 0.0, "missing": 0.0,
            "wheels": {"active": np.full(4, 100.0)}, "base_error": 0.0, "gripped": False, "slipped": 0.0}
    return Readings(time, **{**calm, **seen})


def test_a_shut_guard_waits_then_stops():
    machine = Machine((Phase("first", "", 1.0), Phase("second", "", 1.0)), (), patience=2.0)
    assert not machine.step(sensed(0.5)) and machine.state == "first"
    assert machine.step(sensed(1.0)) and machine.state == "second"
    assert not machine.step(sensed(2.5, error=0.02))
    assert machine.step(sensed(4.1, error=0.02)) and machine.state == STOPPED
    assert "in second: waited 2 s: the platform is 20 mm off" in machine.history[-1].why
    assert not machine.step(sensed(9.0)) and machine.state == STOPPED  # for good


@pytest.mark.parametrize(("seen", "why"), [
    ({"wheels": {"active": np.array([0.0, 0.2, 300.0, 300.0])}}, "'active' lifts"),
    ({"overloaded": 0.2}, "off their limits"), ({"missing": 0.2}, "no tensions"),
    ({"error": 0.06}, "off its path"), ({"gripped": True, "slipped": 0.05}, "slipped")])
def test_every_fault_stops(seen, why):
    from cdprlab.fastkit.job.machine import FAULTS

    machine = Machine((Phase("first", "", 1.0),), FAULTS)
    assert machine.step(sensed(0.5, **seen)) and machine.state == STOPPED and why in machine.history[-1].why


def test_the_gripper_does_not_close_on_nothing():
    world = cl.load_world("fastkit_suspended")
    phases = job_phases(world, world.task("pick_and_place"))
    hook = next(k for k, phase in enumerate(phases) if phase.name == "hook")
    machine = Machine(phases[hook:hook + 2], ())
    assert not machine.step(sensed(1.0, slipped=0.05)) and machine.state == "hook"
    assert machine.step(sensed(9.0, slipped=0.05)) and "no box to grip: it is 50 mm" in machine.history[-1].why
    machine = Machine(phases[hook:hook + 2], ())
    assert machine.step(sensed(1.0, slipped=0.001)) and machine.state == "grip"


def test_phases_have_names_of_their_own():
    world = cl.load_world("fastkit_suspended")
    names = [phase.name for phase in job_phases(world, world.task("pick_and_place"))]
    assert len(set(names)) == len(names) and names[0] == "coupled" and names[-1] == "return"


@pytest.mark.parametrize("way", [0.02, -1.0, 4.8])
def test_drives_end_where_they_should(way):
    total = driving_time(way, 0.2, 0.2)
    times = np.linspace(0, total, 20001)
    speeds = [driving_speed(t, way, 0.2, 0.2) for t in times]
    assert np.trapezoid(speeds, times) == pytest.approx(way, rel=1e-4) and np.abs(speeds).max() <= 0.2


def test_wrong_requests_are_named():
    world = cl.load_world("fastkit_suspended")
    with pytest.raises(InvalidInput, match="of kind quintic"):
        pick_and_place(world, "default")
    with pytest.raises(InvalidInput, match="control must be"):
        pick_and_place(world, control="position")
    with pytest.raises(InvalidInput, match="no single motion"):
        cl.run(world, "pick_and_place", duration=0.1)
