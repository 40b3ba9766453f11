"""The planar engine against statics, against the spatial one and against itself; winches, slack ropes, driven bases."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import cdprlab as cl
from cdprlab.errors import InvalidInput, MissingDependency, SimulationDiverged
from cdprlab.robot import Elasticity
from robots import robot_1r2t, robot_2t, spatial_twin

try:
    from cdprlab.simulate.planar import import_pymunk
    from cdprlab.simulate.planar_space import solving_order

    import_pymunk()
except MissingDependency as missing:
    pytest.skip(str(missing), allow_module_level=True)

PLANAR = [name for name in cl.world_names() if cl.load_world(name).engine == "planar"]
MOBILE = ("planar_mcdpr", "fastkit_planar")


def with_task(world, name, task):
    return replace(world, tasks={**world.tasks, name: task})


def hanging(mass=10.0, length=2.0, **more):
    """A point mass on one rope below the origin."""
    return cl.World.from_dict({
        "name": "hanging", "motion_pattern": "2T", "cable_limits": {"tension": [0, 1e4], **more},
        "platform": {"mass": mass, "size": [0.1, 0.1], "pose": {"position": [0.0, 5 - length]}},
        "cables": [{"exit_point": [0.0, 5.0], "anchor_point": [0, 0]}]})


def balance(simulator):
    """W τ + w_g where the platform is now."""
    pose = cl.Pose.of(simulator.position, simulator.rotation)
    return simulator.wrench_matrix @ simulator.tensions + cl.gravity_wrench(simulator.robot, pose)


# --- at rest ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("cables", ["tension", "force"])
@pytest.mark.parametrize("name", PLANAR)
def test_every_world_hangs_still(name, cables):
    """Tensions that balance the weight keep it where it is; only rounding moves it."""
    world = cl.load_world(name)
    world = with_task(world, "still", cl.world.Task("hold", world.pose, world.pose, 1.0))
    with cl.open_simulator(world, cables) as simulator:
        run = cl.run(world, "still", cables=cables, simulator=simulator)
        assert simulator.contact_force() == 0
    assert run.position_errors.max() < 1e-9 and run.feasible.all()
    np.testing.assert_array_equal(run.measured_tensions, run.commanded_tensions)


@pytest.mark.parametrize("name", PLANAR)
def test_on_ropes_every_world_hangs_still_by_statics(name):
    """Ropes of the pose's lengths hold the pose; what they carry balances the weight to 1e-6."""
    world = cl.load_world(name)
    lengths = cl.cable_lengths(world.robot, world.pose)
    with cl.open_simulator(world, "length") as simulator:
        for _ in range(1000):
            assert simulator.wind(lengths)
        np.testing.assert_allclose(simulator.position, world.pose.position, atol=1e-9)
        np.testing.assert_allclose(balance(simulator), 0, atol=1e-6)
        assert (simulator.tensions >= 0).all() and simulator.contact_force() == 0


def test_a_rope_carries_the_weight_it_holds():
    with cl.open_simulator(hanging(), "length") as simulator:
        for _ in range(10):
            simulator.wind([2.0])
        assert simulator.tensions[0] == pytest.approx(98.1, abs=1e-9)


def test_a_load_on_the_floor_leaves_its_rope_slack():
    """Paid out beyond the floor, the rope carries nothing and the floor everything."""
    world = hanging(speed=1.0)
    with cl.open_simulator(world, "length") as simulator:
        for length in np.linspace(2.0, 5.5, 4000):
            simulator.wind([length])
        for _ in range(500):
            simulator.wind([5.5])
        assert simulator.tensions[0] == 0
        assert simulator.contact_force() == pytest.approx(98.1, rel=1e-3)
        # Chipmunk lets shapes sink in by its collision slop of 0.1 length units before it corrects at all.
        assert -0.1 < simulator.position[1] < 0.051


# --- cut ----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("cables", ["tension", "force", "length"])
@pytest.mark.parametrize("name", PLANAR)
def test_cut_cables_let_it_fall(name, cables):
    """Free fall for 0.1 s: h = g t²/2, up to the semi-implicit step's g t dt / 2."""
    world = cl.load_world(name)
    g, lengths = world.robot.gravity, cl.cable_lengths(world.robot, world.pose)
    with cl.open_simulator(world, cables) as simulator:
        simulator.cut()
        for _ in range(100):
            _ = simulator.wind(lengths) if cables == "length" else simulator.step(world.robot.tension_max)
        fallen = world.pose.position - simulator.state().position
    np.testing.assert_allclose(fallen, [0, g * 0.1**2 / 2], atol=g * 0.1 * 1e-3 + 1e-12)


def test_one_cut_rope_carries_nothing():
    world = cl.load_world("planar_suspended")
    lengths = cl.cable_lengths(world.robot, world.pose)
    with cl.open_simulator(world, "length") as simulator:
        simulator.wind(lengths)
        simulator.cut([1])
        for _ in range(50):
            simulator.wind(lengths)
        assert simulator.tensions[1] == 0 and simulator.tensions.max() > 50
        with pytest.raises(InvalidInput, match="index"):
            simulator.cut([4])
        simulator.reset()
        simulator.wind(lengths)
        assert simulator.tensions[1] > 0


# --- winches ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("acceleration", [-1.0, 1.0])
def test_a_winch_raises_and_lowers_without_jerks(acceleration):
    """Paid in or out ever faster, then evenly: the rope carries m (g − a), then m g; the load is where it should be."""
    with cl.open_simulator(hanging(), "length") as simulator:
        tensions = []
        for k in range(1, 1001):
            t = 1e-3 * k
            wound = acceleration * (t**2 / 2 if t <= 0.5 else 0.5 * t - 0.125)
            simulator.wind([2.0 + wound])
            assert simulator.position[1] == pytest.approx(3.0 - wound, abs=1e-12)
            tensions.append(simulator.tensions[0])
    # A change of acceleration takes two steps.
    np.testing.assert_allclose(tensions[2:499], 10 * (9.81 - acceleration), atol=1e-6)
    np.testing.assert_allclose(tensions[501:], 98.1, atol=1e-6)


def test_a_rope_paid_out_faster_than_a_fall_is_slack():
    with cl.open_simulator(hanging(), "length") as simulator:
        for k in range(1, 101):
            simulator.wind([2.0 + 3.0 * 1e-3 * k])
            assert simulator.tensions[0] == 0
        assert 3.0 - simulator.position[1] == pytest.approx(9.81 * 0.1**2 / 2, abs=9.81 * 0.1 * 1e-3)


@pytest.mark.parametrize("name", ["planar_rigid", "planar_suspended", "planar_point", "planar_mcdpr", "kntu_planar"])
def test_ropes_wound_by_inverse_kinematics_take_the_platform_along(name):
    """Within a micrometer, on the way and at its end, whatever the redundancy; tensions never push."""
    world = cl.load_world(name)
    task = world.task()
    path = task.trajectory()(np.arange(round(1000 * task.duration) + 1) * 1e-3).pose
    lengths = cl.cable_lengths(world.robot, path)
    with cl.open_simulator(world, "length") as simulator:
        for k in range(1, len(path)):
            assert simulator.wind(lengths[k])
            assert np.abs(simulator.position - path.position[k]).max() < 2e-6
            assert (simulator.tensions >= 0).all()


def test_winches_keep_their_speed_limits_and_say_so():
    with cl.open_simulator(hanging(speed=0.5), "length") as simulator:
        assert simulator.wind([2.0 - 0.5e-3])          # at the limit
        assert not simulator.wind([1.0])               # 1 m in 1 ms
        assert simulator.lengths[0] == pytest.approx(2.0 - 1.0e-3, abs=1e-8)
        assert simulator.wind([2.0 - 2.0e-3], substeps=2)
        assert simulator.lengths[0] == pytest.approx(2.0 - 2.0e-3, abs=1e-8)


def test_ropes_are_solved_in_the_order_that_settles_first():
    """One rope after the other, in rounds: what is left of an error shrinks a millionfold in as many as are taken."""
    world = cl.load_world("planar_rigid")
    order, rounds = solving_order(world)
    body = world.robot.platform
    rows = cl.wrench_matrix(world.robot, world.pose).T / np.sqrt([body.mass, body.mass, body.inertia])

    def left(order):
        error = np.array([1.0, -2.0, 0.5])
        for i in order * rounds:
            error = error - rows[i] * (rows[i] @ error) / (rows[i] @ rows[i])
        return np.linalg.norm(error)

    assert left(order) < 1e-5
    assert left((0, 1, 2, 3)) > 10 * left(order)


def test_substeps_wind_evenly():
    world = cl.load_world("planar_rigid")
    path = world.task().trajectory()(np.arange(0, 3.01, 0.01)).pose
    with cl.open_simulator(world, "length") as simulator:
        for k in range(1, len(path)):
            simulator.wind(cl.cable_lengths(world.robot, path[k]), substeps=10)
            # Lengths in between are straight lines of 10 ms: off by a dt²/8, a ≤ 1 m/s² here.
            assert np.abs(simulator.position - path.position[k]).max() < 5e-5


# --- bases --------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", MOBILE)
def test_a_base_drives_while_ropes_hold_the_platform_still(name):
    """At constant speed, the winches making up for it: within 0.1 mm."""
    world = cl.load_world(name)
    with cl.open_simulator(world, "length") as simulator:
        simulator.drive([0, -0.2, 0, 0, 0, 0])
        for k in range(1, 1001):
            bases = {world.robot.bases[0].name: (world.robot.bases[0].position[0] - 0.2e-3 * k, 0.0, 0.0)}
            simulator.wind(cl.cable_lengths(world.robot.with_bases(bases), world.pose))
            assert np.abs(simulator.position - world.pose.position).max() < 1e-4
        np.testing.assert_allclose(simulator.robot.bases[0].position, [-0.2, 0], atol=1e-12)
        np.testing.assert_allclose(simulator.lengths, cl.cable_lengths(simulator.robot, world.pose), atol=1e-6)


def test_a_base_that_stops_holds_its_exit_points_there():
    world = cl.load_world("planar_mcdpr")
    with cl.open_simulator(world, "length") as simulator:
        for speed in (0.5, 0.0):
            simulator.drive([0, -speed, 0, 0, 0, 0])
            for _ in range(100):
                before = simulator.robot.bases[0].position[0]
                bases = {"left": (before - speed * 1e-3, 0.0, 0.0)}
                simulator.wind(cl.cable_lengths(world.robot.with_bases(bases), world.pose))
        np.testing.assert_allclose(simulator.robot.bases[0].position, [-0.05, 0], atol=1e-12)
        np.testing.assert_allclose(simulator.position, world.pose.position, atol=1e-9)
        np.testing.assert_allclose(balance(simulator), 0, atol=1e-6)


@pytest.mark.parametrize("name", MOBILE)
def test_a_base_drives_while_tensions_hold_the_platform_still(name):
    world = cl.load_world(name)
    law, low, high = cl.ComputedTorque(), world.robot.tension_min, world.robot.tension_max
    still = cl.hold(world.pose, 1.0)(0.0)
    with cl.open_simulator(world) as simulator:
        simulator.drive([0, 0.2, 0, 0, 0, 0])
        for _ in range(500):
            wanted = law(0.0, simulator.state(), still)
            simulator.step(cl.distribute_tensions(simulator.wrench_matrix, -wanted, low, high).require().tensions)
            assert np.abs(simulator.position - world.pose.position).max() < 1e-4
        np.testing.assert_allclose(simulator.robot.bases[0].position, [0.1, 0], atol=1e-12)
        np.testing.assert_allclose(simulator.lengths, cl.cable_lengths(simulator.robot, simulator.state().pose),
                                   atol=1e-12)


def test_bases_turn_and_drive_in_their_own_axes():
    """Exit points go where the base's frame takes them, and lengths follow l̇ = J t − B_b q̇_b."""
    world = cl.load_world("planar_mcdpr")
    turning = tuple(replace(base, heading=0.2, speed_max=np.ones(3)) for base in world.robot.bases)
    world = replace(world, robot=replace(world.robot, bases=turning))
    speeds = np.array([0.3, 0.2, 0.1, -0.2, 0.1, -0.1])
    with cl.open_simulator(world, dt=1e-4) as simulator:
        before, robot = simulator.lengths, simulator.robot
        assert (simulator.drive(speeds) == speeds).all()
        simulator.push(-cl.gravity_wrench(world.robot, world.pose))
        simulator.step(np.zeros(4))
        np.testing.assert_allclose((simulator.lengths - before) / 1e-4, -cl.base_jacobian(robot, world.pose) @ speeds,
                                   atol=1e-4)
        base = simulator.robot.bases[0]
        assert base.heading == pytest.approx(0.2 + 0.3e-4, abs=1e-15)
        np.testing.assert_allclose(base.position, 1e-4 * np.array([0.2 * np.cos(0.2) - 0.1 * np.sin(0.2),
                                                                   0.2 * np.sin(0.2) + 0.1 * np.cos(0.2)]), atol=1e-15)


def test_bases_keep_their_speed_limits():
    world = cl.load_world("planar_mcdpr")
    with cl.open_simulator(world) as simulator:
        np.testing.assert_array_equal(simulator.drive([1, 2, 1, 0, -5, 0]), [0, 0.8, 0, 0, -0.8, 0])
        with pytest.raises(InvalidInput, match="base speeds must be 6 numbers"):
            simulator.drive([1, 2])


def test_a_deck_stops_a_platform_let_down_on_it():
    world = cl.load_world("planar_mcdpr")
    start = cl.Pose([0.05, 0.5])
    with cl.open_simulator(world) as simulator:
        simulator.reset(start)
        simulator.cut()
        for _ in range(1500):
            simulator.step(np.zeros(4))
        # The deck is 0.25 m high and P half the platform's size above it, up to the engine's collision slop.
        assert 0.22 < simulator.position[1] < 0.33
        assert simulator.contact_force() == pytest.approx(19.62, rel=1e-3)


# --- against the spatial engine and against itself ----------------------------------------------------------------
@pytest.mark.parametrize("build", [robot_2t, robot_1r2t], ids=["2T", "1R2T"])
def test_planar_equals_spatial_in_the_plane(build):
    """(x, y, φ) is (x, 0, y) turned by −φ about y, m_z = −m_y: the same W, so the same tensions."""
    robot = build()
    pose = cl.Pose([0.2, 0.5], angle=0.3)
    turned = cl.Pose([0.2, 0.0, 0.5], rpy=[0, -0.3, 0])
    W = cl.wrench_matrix(spatial_twin(robot), turned)[[0, 2, 4]] * np.array([[1], [1], [-1]])
    np.testing.assert_allclose(cl.wrench_matrix(robot, pose), W[:robot.n_dof], atol=1e-14)
    weight = cl.gravity_wrench(robot, pose)
    plane, space = (cl.distribute_tensions(rows, weight, robot.tension_min, robot.tension_max).require()
                    for rows in (cl.wrench_matrix(robot, pose), W[:robot.n_dof]))
    np.testing.assert_allclose(plane.tensions, space.tensions, atol=1e-9)


@pytest.mark.parametrize("cables", ["force", "elastic"])
def test_planar_flight_equals_spatial_flight(cables):
    """The same pulls, or elastic ropes wound alike, for 0.3 s in both engines: same motion.

    But for what Bullet rounds to single precision, and its legs' tips.
    """
    try:
        from cdprlab.simulate.bullet import import_pybullet

        import_pybullet()
    except MissingDependency as missing:
        pytest.skip(str(missing))
    world = cl.load_world("planar_suspended")
    body = replace(world.robot.platform, center_of_mass=np.array([0.05, -0.08]))
    world = replace(world, robot=replace(world.robot, platform=body, elasticity=Elasticity(2e4, 0.05)))
    flat, twin = world.to_dict(), spatial_twin(world.robot)
    flat.update(engine="spatial", motion_pattern="3R3T", scene={}, tasks={})
    flat["platform"].update(inertia=[1.0, float(body.inertia), 1.0], size=[0.8, 0.3, 0.3], center=[0, 0, 0],
                            center_of_mass=[0.05, 0, -0.08], pose={"position": [-0.6, 0.0, 1.2]})
    for cable, exit_point, anchor_point in zip(flat["cables"], twin.exit_points, twin.anchor_points):
        cable.update(exit_point=exit_point.tolist(), anchor_point=anchor_point.tolist())
    pulls = np.array([80.0, 120.0, 90.0, 140.0])
    with cl.open_simulator(world, cables) as plane, cl.open_simulator(cl.World.from_dict(flat), cables) as space:
        begun = space.paid_out = plane.paid_out
        for k in range(1, 301):
            for engine in (plane, space):
                if cables == "force":
                    engine.step(pulls)
                else:
                    engine.wind(np.array(begun) + [k * 1e-3, 0, 0, -k * 1e-3])
        if cables == "elastic":
            np.testing.assert_allclose(plane.tensions, space.tensions, atol=0.05)
            assert plane.tensions.min() == 0 and plane.tensions.max() > 20
        np.testing.assert_allclose(plane.position, space.position[[0, 2]], atol=1e-5)
        np.testing.assert_allclose(plane.rotation, space.rotation[np.ix_([0, 2], [0, 2])], atol=1e-5)
        assert abs(plane.twist[2]) > 0.1 and np.linalg.norm(plane.twist[:2]) > 0.1


def test_elastic_ropes_in_the_plane_rest_where_statics_says():
    """Wound apart by millimeters, one of them cut: the pose and the tensions of `equilibrium`."""
    world = cl.load_world("planar_suspended")
    robot = replace(world.robot, elasticity=Elasticity(2e4, 0.3))
    with cl.open_simulator(replace(world, robot=robot), "elastic", 2e-3) as simulator:
        for cut, cables in ((None, [0, 1, 2, 3]), (3, [0, 1, 2])):
            if cut is not None:
                simulator.cut(cut)
            wound = np.array(simulator.paid_out) + [2e-3, 0, 0, 0]
            for _ in range(3000):
                simulator.wind(wound)
            left = replace(robot, cables=tuple(robot.cables[i] for i in cables))
            guess = cl.Pose(simulator.position, matrix=simulator.rotation)
            rest = cl.equilibrium(left, wound[cables], guess, axial_stiffness=2e4)
            np.testing.assert_allclose(simulator.position, rest.pose.position, atol=1e-5)
            np.testing.assert_allclose(simulator.tensions[cables], rest.tensions, atol=0.05)


def test_push_moves_a_free_body_by_newton():
    """m a = f at P with cables cut; a force beside an off-center mass turns it."""
    world = cl.load_world("planar_suspended")
    body = replace(world.robot.platform, center_of_mass=np.array([0.05, -0.08]))
    robot = replace(world.robot, platform=body)
    with cl.open_simulator(replace(world, robot=robot)) as simulator:
        simulator.cut()
        simulator.push([50.0, -30.0, 5.0])
        simulator.step(np.zeros(4))
        twist = simulator.twist
    wanted = cl.mechanics.dynamics.inverse_dynamics(robot, np.eye(2), np.zeros(3), twist / 1e-3)
    # By the step's end the arm of 0.1 m has turned by ω dt = 1e-6 rad under 60 N.
    np.testing.assert_allclose(wanted, [50, -30, 5], atol=1e-5)


def test_pushed_ropes_carry_the_push():
    world = cl.load_world("planar_rigid")
    lengths, push = cl.cable_lengths(world.robot, world.pose), np.array([40.0, -20.0, 1.0])
    with cl.open_simulator(world, "length") as simulator:
        simulator.push(push)
        for _ in range(200):
            simulator.wind(lengths)
        np.testing.assert_allclose(balance(simulator) + push, 0, atol=1e-6)


@pytest.mark.parametrize("cables", ["tension", "length"])
def test_two_flights_are_bit_identical(cables):
    """One after the other in one engine, cables cut in between, and in two engines step by step."""
    world = cl.load_world("planar_rigid")
    lengths = cl.cable_lengths(world.robot, world.task().trajectory()(np.linspace(0, 0.3, 101)).pose)

    def fly(*simulators):
        for k in range(1, 101):
            for simulator in simulators:
                _ = simulator.wind(lengths[k]) if cables == "length" else simulator.step(20.0 + lengths[k])
        return [np.array(simulator.sample()) for simulator in simulators]

    with cl.open_simulator(world, cables) as one, cl.open_simulator(world, cables) as two:
        first = fly(one)[0]
        one.cut([1])
        fly(one)
        one.reset()
        for again in fly(one, two):
            np.testing.assert_array_equal(again, first)


@pytest.mark.parametrize("cables", ["tension", "length"])
def test_two_runs_with_driving_bases_are_bit_identical(cables):
    """Each in an engine of its own, the log of the second as that of the first."""
    world = cl.load_world("planar_mcdpr")
    first, again = (cl.run(world, cables=cables, duration=0.3, base_speeds=[0, -0.3, 0, 0, 0.2, 0]) for _ in range(2))
    assert first.base_poses[-1, 0, 0] < -0.08
    for name in ("measured_tensions", "commanded_tensions", "lengths", "twists", "errors", "base_poses", "feasible"):
        np.testing.assert_array_equal(getattr(again, name), getattr(first, name))


def test_divergence_says_when_and_which_cable():
    """K_d dt = 200 is far beyond 2: the platform is thrown out of the scene."""
    world = cl.load_world("planar_rigid")
    with pytest.raises(SimulationDiverged, match=r"t = \S+ s.*cable \d") as caught:
        cl.run(world, method="pseudo_inverse", controller=cl.ComputedTorque(1e5, 2e5), duration=3.0,
               infeasible="send")
    assert caught.value.time > 0 and 1 <= caught.value.cable <= 4


@pytest.mark.parametrize("pulls", [np.full(4, np.nan), [1e300, 0, 0, 0], [1e12, 0, 0, 0]])
def test_numbers_no_engine_can_bear_are_refused_or_divergence(pulls):
    """Chipmunk ends the whole process on some of these; they must not reach it."""
    wrong = InvalidInput if np.isnan(pulls).any() else (InvalidInput, SimulationDiverged)
    with cl.open_simulator(cl.load_world("planar_rigid")) as simulator, pytest.raises(wrong):
        for _ in range(3):
            simulator.step(np.asarray(pulls))


def test_on_a_rail_only_x_moves():
    """1T: cables pull along x, the rail carries all else."""
    world = cl.World.from_dict({
        "name": "rail", "motion_pattern": "1T", "cable_limits": {"tension": [1, 100]},
        "platform": {"mass": 2.0, "size": [0.2, 0.2], "pose": {"position": [-0.5, 1.0]}},
        "cables": [{"exit_point": [x, y], "anchor_point": [0, 0]} for x, y in ((-2.0, 1.2), (2.0, 1.5))],
        "tasks": {"default": {"kind": "quintic", "to": {"position": [0.5, 1.0]}, "duration": 1.0, "hold": 1.0}}})
    run = cl.run(world)
    assert run.position_errors.max() < 1e-3 and run.feasible.all()
    np.testing.assert_allclose(run.poses.position[:, 1], 1.0, atol=1e-6)
    np.testing.assert_array_equal(run.poses.angle, 0)


# --- errors -------------------------------------------------------------------------------------------------
def test_wrong_requests_are_named():
    world = cl.load_world("planar_rigid")
    with pytest.raises(InvalidInput, match=r"'springs' is not available; .* force, length, elastic$"):
        cl.open_simulator(world, "springs")
    with cl.open_simulator(world, "length") as simulator:
        with pytest.raises(InvalidInput, match=r"use wind\(lengths\)"):
            simulator.step(np.ones(4))
        for lengths, message in (([1.0, 2.0], "must be 4 numbers"),
                                 ([*simulator.lengths, 1.0], "must be 4 numbers"),
                                 ([-1.0, 1, 1, 1], "4 positive numbers"), ([np.nan] * 4, "finite")):
            with pytest.raises(InvalidInput, match=message):
                simulator.wind(lengths)
    with cl.open_simulator(world) as simulator, pytest.raises(InvalidInput, match=r'open .* with cables="length"'):
        simulator.wind(np.ones(4))


def test_without_the_engine_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pymunk", None)
    import_pymunk.cache_clear()
    try:
        with pytest.raises(MissingDependency, match=r"pip install pymunk") as caught:
            cl.open_simulator(cl.load_world("planar_rigid"))
        assert "\n" not in str(caught.value)
    finally:
        import_pymunk.cache_clear()


# --- pictures -----------------------------------------------------------------------------------------------
def test_planar_runs_become_stills_and_films(tmp_path):
    run = cl.run(cl.load_world("planar_rigid"), duration=0.5, control_period=0.005)
    with Image.open(cl.view.still(run, tmp_path / "still.png", t=0.2)) as picture:
        assert picture.width == 960 and "seen from the front" in picture.info["Description"]
    with Image.open(cl.view.save_film(run, tmp_path / "film.gif", width=240)) as film:
        assert film.n_frames > 3


# --- runs on ropes ------------------------------------------------------------------------------------------
def test_a_run_on_ropes_is_logged_like_any_other(tmp_path):
    world = cl.load_world("planar_rigid")
    run = cl.run(world, cables="length")
    assert run.position_errors.max() < 2e-6 and run.feasible.all() and run.method == "inverse_kinematics"
    np.testing.assert_allclose(cl.cable_lengths(world.robot, run.poses), run.lengths, atol=1e-12)
    # Ropes are never longer than let out; a step begins where the last one ended. They bow out of straight lines by
    # (v dt)² / 2 l, below 1e-6 m at 1 m/s.
    assert (run.lengths[1:] <= run.commanded_lengths[:-1] + 1e-6).all()
    assert np.isnan(run.commanded_tensions).all() and (run.measured_tensions >= 0).all()
    log = np.load(run.save(tmp_path) / "log.npz")
    np.testing.assert_array_equal(log["commanded_length"], run.commanded_lengths)
    assert "steps with a slack cable" in run.table()
    text = cl.view.plot(run).alt_text
    assert "Measured tensions of 4 cables" in text and "nan" not in text


def test_a_run_says_where_a_winch_was_too_slow():
    world = cl.load_world("planar_rigid")
    slow = tuple(replace(cable, speed_max=0.3) for cable in world.robot.cables)
    run = cl.run(replace(world, robot=replace(world.robot, cables=slow)), cables="length", duration=3.0)
    assert 0 < (~run.feasible).sum() < run.time.size
    assert run.table()["steps not held as commanded"].startswith(str((~run.feasible).sum()))
    assert "did not hold the platform" in cl.view.plot_tensions(run).alt_text


def test_a_run_on_ropes_is_feasible_only_while_they_hold_the_platform():
    """Ropes from above hold against no push upwards: the winches reach their lengths, the platform rises."""
    world = cl.load_world("planar_suspended")
    up = np.zeros(world.robot.n_dof)
    up[1] = 2 * world.robot.mass * world.robot.gravity
    assert cl.run(world, cables="length", duration=0.5).feasible.all()
    run = cl.run(world, cables="length", duration=0.5,
                 external_wrench=lambda t: up if t >= 0.2 else 0 * up)
    # It rises with g: more than 1 mm of slack after some 15 ms, and slack all the time from then on.
    assert run.feasible[run.time < 0.2].all() and not run.feasible[run.time > 0.25].any()


def test_a_run_on_ropes_feels_a_push_and_takes_no_controller():
    world = cl.load_world("planar_rigid")
    pushed = cl.run(world, cables="length", duration=0.2, external_wrench=[0.0, -30.0, 0.0])
    calm = cl.run(world, cables="length", duration=0.2)
    assert pushed.measured_tensions[-1, 2:].sum() > calm.measured_tensions[-1, 2:].sum() + 20
    with pytest.raises(InvalidInput, match="takes no controller"):
        cl.run(world, cables="length", controller=cl.ComputedTorque())


def test_the_command_line_flies_planar_robots(tmp_path, capsys):
    from cdprlab.__main__ import main

    out = tmp_path / "out"
    assert main(["run", "planar_rigid", "--cables", "length", "--duration", "0.3", "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} >= {"film.gif", "log.csv", "log.npz", "tensions.png", "tracking.png"}
    assert "steps with a slack cable" in capsys.readouterr().out


@pytest.mark.parametrize("cables", ["tension", "length", "elastic"])
def test_bases_drive_in_a_run_and_are_logged(cables, tmp_path):
    """Out and back on one side, away on the other: the platform keeps to its path, the log to the laws."""
    world = cl.load_world("planar_mcdpr")
    world = replace(world, robot=replace(world.robot, elasticity=cl.Elasticity(1e5, 0.1)))

    def speeds(t):
        return [0, -0.4 * np.sin(np.pi * t / 1.5), 0, 0, 0.6 * np.sin(np.pi * t / 3), 0]

    run = cl.run(world, cables=cables, base_speeds=speeds, dt=2e-3)
    # With tensions the integrator's v dt / 2 shows: 0.9 m/s at most here; ropes that stretch ring a little.
    assert run.position_errors.max() < {"tension": 1e-3, "length": 1e-6, "elastic": 1e-5}[cables]
    assert run.feasible.all()
    assert run.base_poses.shape == (1500, 2, 3)
    # ∫ 0.6 sin(π t / 3) dt over 3 s is 3.6/π; summed up at the steps' beginnings it is exact to dt².
    np.testing.assert_allclose(run.base_poses[-1, 1], [2 + 3.6 / np.pi, 0, 0], atol=1e-5)
    for k in (0, 700, 1499):
        np.testing.assert_allclose(cl.cable_lengths(run.robot_at(k), run.poses[k]), run.lengths[k], atol=1e-12)
    np.testing.assert_array_equal(np.load(run.save(tmp_path) / "log.npz")["base_pose"], run.base_poses)
    early, late = (np.asarray(Image.open(cl.view.still(run, tmp_path / f"{t}.png", t, width=320))) for t in (0.1, 2.9))
    assert (early != late).any(axis=-1).sum() > 1000


def test_bases_drive_in_planar_runs_only():
    world = cl.load_world("mobile_four_bases")
    with pytest.raises((InvalidInput, MissingDependency), match=r"bases that drive|pybullet"):
        cl.run(world, duration=0.01, base_speeds=np.zeros(12))
