"""Laws of bases that are bodies: weight on the wheels, tipping where statics says, driving as told, boxes held."""

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InvalidInput

pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
G = 9.81


@pytest.fixture
def world():
    return cl.load_world("fastkit_suspended")


@pytest.fixture
def simulator(world):
    with cl.open_simulator(world, bodies=True) as opened:
        yield opened


def holding(simulator):
    """Tensions that balance the platform's weight."""
    robot = simulator.world.robot
    weight = cl.gravity_wrench(robot, simulator.state().pose)
    limits = robot.tension_min, robot.tension_max
    return cl.distribute_tensions(simulator.wrench_matrix, weight, *limits).require().tensions


def test_wheels_carry_the_bases_and_what_hangs_on_them(simulator, world):
    start, tau = simulator.position, holding(simulator)
    for _ in range(400):
        simulator.step(holding(simulator))
    assert np.linalg.norm(simulator.position - start) <= 1e-3 and simulator.contact_force() == 0
    np.testing.assert_allclose(simulator.tensions, tau, rtol=0, atol=0.02)  # tips of 1e-4 kg: 1e-3 N, drift of the pose
    loads = simulator.wheel_loads()
    robot = world.robot
    total = sum(load.sum() for load in loads.values())
    assert total == pytest.approx((sum(base.mass for base in robot.bases) + robot.mass) * G, rel=1e-3)
    for name, rows in cl.tipping_moments(robot, simulator.state().pose, tau).items():
        assert (rows < 0).all() and (loads[name] > 0).all()


def test_wheel_loads_give_the_moments_of_statics(simulator, world):
    """The moment about an edge is what the wheels off that edge carry, times their distance."""
    tau = holding(simulator)
    for _ in range(300):
        simulator.step(holding(simulator))
    for base in world.robot.bases:
        moments = cl.tipping_moments(world.robot, simulator.state().pose, tau)[base.name]
        load, corners = simulator.wheel_loads()[base.name], base.footprint
        for k, moment in enumerate(moments):
            a, b = corners[k], corners[(k + 1) % len(corners)]
            along = (b - a) / np.linalg.norm(b - a)
            inward = (corners - a) @ [-along[1], along[0]]
            assert -moment == pytest.approx(load @ inward, abs=0.5)  # of 353 N m: contacts settle within 1 N


@pytest.mark.parametrize("direction", range(8))
def test_a_base_tips_where_statics_says(world, direction):
    """A horizontal push on the base, growing by 200 N/s: the wheels on the far side lift at m g d / h."""
    angle = direction * np.pi / 4 + 0.1
    push, height = np.array([np.cos(angle), np.sin(angle), 0.0]), 1.5
    base = world.robot.bases[1]
    corners = base.footprint
    edges = np.roll(corners, -1, axis=0) - corners
    outward = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1)[:, None]
    distance = ((corners - base.center_of_mass[:2]) * outward).sum(axis=1)
    towards = outward @ push[:2]
    limits = base.mass * G * distance / np.where(towards > 1e-9, towards * height, np.nan)
    edge = int(np.nanargmin(limits))
    with cl.open_simulator(world, bodies=True) as simulator:
        simulator.cut()
        body, at, (b, client) = simulator.bases.bodies[1], [*base.position, height], simulator.bullet
        for k in range(10000):
            force = 0.9 * limits[edge] + 0.2 * k
            b.applyExternalForce(body, 6, (push * force).tolist(), at, b.WORLD_FRAME, physicsClientId=client)
            simulator.step(np.zeros(8))
            inner = [i for i in range(4) if i not in (edge, (edge + 1) % 4)]
            if simulator.wheel_loads()["passive"][inner].sum() < 0.5 and k > 20:
                break
    assert force == pytest.approx(limits[edge], rel=0.01)


def test_bases_drive_as_told_within_their_limits(simulator):
    driven = simulator.drive([0.1, 0.5, -0.05, 0.1, 0.3, 0.3])
    np.testing.assert_allclose(driven, [0.1, 0.2, -0.05, 0, 0, 0])
    before = simulator.base_poses
    for _ in range(500):
        simulator.step(holding(simulator))
    turned = before[0, 2] + 0.05
    np.testing.assert_allclose(simulator.base_poses[0, 2], turned, atol=1e-3)
    travelled = np.linalg.norm((simulator.base_poses - before)[0, :2])
    assert travelled == pytest.approx(0.5 * np.hypot(0.2, 0.05), abs=2e-3)
    np.testing.assert_allclose(simulator.base_poses[1], before[1], atol=1e-4)
    assert simulator.tilts.max() < 1e-3


def test_ropes_hold_the_platform_while_a_base_drives(world):
    """Lengths of where the base will be keep the platform still."""
    with cl.open_simulator(world, "length", bodies=True) as simulator:
        start, off = simulator.state().pose, 0.0
        simulator.drive([0, 0.1, 0, 0, 0, 0])
        for k in range(1, 401):
            moved = world.robot.with_bases({"active": (-3.2 + 0.1 * k * 1e-3, 0.0, 0.0)})
            simulator.wind(cl.cable_lengths(moved, start))
            off = max(off, float(np.linalg.norm(simulator.position - start.position)))
    assert off <= 2e-3 and (simulator.tensions >= 0).all()


def test_bases_on_stabilizers_do_not_drive(simulator):
    simulator.bases.lower_stabilizers()
    before = simulator.base_poses
    assert simulator.bases.is_stabilized and not simulator.drive([0.1, 0.2, 0, 0, 0, 0]).any()
    for _ in range(200):
        simulator.step(holding(simulator))
    np.testing.assert_allclose(simulator.base_poses, before, atol=1e-4)
    simulator.bases.raise_stabilizers()
    assert simulator.drive([0.1, 0.2, 0, 0, 0, 0]).any()
    simulator.bases.lower_stabilizers()
    simulator.reset()
    assert not simulator.bases.is_stabilized


def test_coupled_bases_drive_together(simulator):
    simulator.bases.couple()
    assert simulator.bases.is_coupled
    before = simulator.base_poses
    simulator.drive([0, 0.2, 0, 0, 0, 0])
    for _ in range(500):
        simulator.step(holding(simulator))
    moved = simulator.base_poses - before
    np.testing.assert_allclose(moved[:, 0], 0.1, atol=5e-3)
    simulator.bases.uncouple()
    simulator.drive(np.zeros(6))
    rest = simulator.base_poses
    for _ in range(200):
        simulator.step(holding(simulator))
    np.testing.assert_allclose(simulator.base_poses, rest, atol=5e-3)


def test_a_gripped_box_comes_along_and_a_released_one_stays(world):
    with cl.open_simulator(world, "length", bodies=True) as simulator:
        start = simulator.state().pose
        simulator.boxes.add("box", start.position + [0, 0, -0.3], [0.4, 0.3, 0.15], 0.5)
        simulator.boxes.grip("box")
        for k in range(1, 401):
            simulator.wind(cl.cable_lengths(world.robot, cl.Pose(start.position + [0, 0, 0.1 * k / 400])))
        lifted = simulator.boxes.pose("box").position
        np.testing.assert_allclose(lifted - start.position, [0, 0, -0.2], atol=0.03)
        simulator.boxes.release("box")
        for _ in range(600):
            simulator.wind(simulator.rope_lengths)
        assert simulator.boxes.pose("box").position[2] == pytest.approx(0.075, abs=0.01)  # on the floor


def test_tensions_are_judged_where_bases_stand_that_give_way(world):
    assert cl.run(world, bodies=True, duration=0.05).feasible.all()


def test_substeps_change_neither_wheel_loads_nor_driving(world):
    """One call of two substeps, or two calls: the same loads, and a base that drives without pitching."""
    seen = []
    for substeps in (1, 2):
        with cl.open_simulator(world, dt=2e-3, bodies=True) as simulator:
            for k in range(200 // substeps):
                simulator.drive([0, min(0.05, 0.2 * substeps * k * 2e-3), 0, 0, 0, 0])  # 0.2 m/s², then steady
                simulator.step(holding(simulator), substeps)
            seen.append((simulator.wheel_loads()["active"], simulator.base_poses[0]))
    np.testing.assert_allclose(seen[0][0], seen[1][0], rtol=0.03)
    np.testing.assert_allclose(seen[0][1], seen[1][1], atol=2e-4)  # one engine step of the speeds' ramp
    assert min(load.min() for load, _ in seen) > 20


def test_a_gripped_box_is_drawn_in(world):
    with cl.open_simulator(world, bodies=True) as simulator:
        start = simulator.state().pose
        simulator.boxes.add("box", start.position + [0, 0.3, 0], [0.1, 0.1, 0.1], 0.01)
        simulator.boxes.grip("box")
        for k in range(1, 501):
            simulator.boxes.draw("box", [0, -0.2 * k / 500, 0])
            simulator.step(holding(simulator))
        off = (simulator.boxes.pose("box").position - simulator.position) @ simulator.rotation
        np.testing.assert_allclose(off, [0, 0.1, 0], atol=2e-3)
        assert simulator.boxes.is_gripped("box")
        with pytest.raises(InvalidInput, match="not gripped"):
            simulator.boxes.draw("crate", [0, 0, 0])


def test_two_flights_are_identical(world):
    def fly():
        with cl.open_simulator(world, bodies=True) as simulator:
            simulator.drive([0.1, 0.1, 0, 0, 0, 0])
            for _ in range(100):
                simulator.step(np.full(8, 20.0))
            return np.concatenate([simulator.position, simulator.base_poses.ravel(), simulator.tensions])

    np.testing.assert_array_equal(fly(), fly())


def test_wrong_requests_are_named(world, simulator):
    with pytest.raises(InvalidInput, match="a world with bases"):
        cl.open_simulator(cl.load_world("caroca"), bodies=True)
    with pytest.raises(InvalidInput, match="cables that are bodies"):
        cl.open_simulator(world, "force", bodies=True)
    with pytest.raises(InvalidInput, match="no box 'crate'"):
        simulator.boxes.grip("crate")
    with pytest.raises(InvalidInput, match="base speeds"):
        simulator.drive([0, 0, 0])
