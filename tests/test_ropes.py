"""Laws of ropes wound to a length: complementarity, statics at rest, slack carries nothing, winches have limits."""

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.mechanics.dynamics import inverse_dynamics, mass_and_bias
from cdprlab.view.outlines import hanging

pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
G = 9.81


@pytest.fixture(scope="module")
def marionet():
    return cl.load_world("marionet")


def wind_to(simulator, lengths, seconds):
    """Reel evenly to these lengths; returns the positions and tensions on the way."""
    steps, start, seen = round(seconds / simulator.dt), simulator.rope_lengths, []
    for k in range(1, steps + 1):
        assert simulator.wind(start + k / steps * (np.asarray(lengths) - start))
        seen.append((simulator.position, simulator.tensions))
    return tuple(map(np.array, zip(*seen)))


def along(simulator, path, seconds, slack):
    """Wind as inverse kinematics of a path says, plus slack; returns the largest distance from it [m] and tensions."""
    times = np.arange(1, round(seconds / simulator.dt) + 1) * simulator.dt
    poses = path(times).pose
    lengths = cl.cable_lengths(simulator.robot, poses) + slack
    off, tensions = 0.0, []
    for k, length in enumerate(lengths):
        simulator.wind(length)
        off = max(off, float(np.linalg.norm(simulator.position - poses.position[k])))
        tensions.append(simulator.tensions)
    return off, np.array(tensions)


@pytest.mark.parametrize("name, seed", [("marionet", 1), ("caroca", 2)])
def test_tensions_and_gaps_are_complementary(name, seed):
    """T ≥ 0, no rope longer than wound, and no pull from one that is shorter: for random speeds and lengths."""
    world, rng = cl.load_world(name), np.random.default_rng(seed)
    with cl.open_simulator(world, "length") as simulator:
        law, W, whole = simulator.ropes, simulator.wrench_matrix, simulator.whole_wrenches
        mass, _ = mass_and_bias(world.robot, simulator.rotation, np.zeros(6))
        S = world.robot.pattern.basis(simulator.rotation)
        mobility = S.T @ np.linalg.inv(mass) @ S
        for _ in range(50):
            twist, extra = rng.normal(size=6) * 0.1, rng.uniform(-2e-5, 2e-5, world.robot.n_cables)
            wound = simulator.lengths + extra
            T = law(whole, simulator.rotation, twist, simulator.lengths, simulator.lengths, wound, np.zeros(6))
            rest = inverse_dynamics(world.robot, simulator.rotation, twist, np.zeros(6))
            moving = twist[:W.shape[0]] + 1e-3 * mobility @ (W @ T - rest)
            gap = wound - (simulator.lengths - 1e-3 * W.T @ moving)
            yielding = 1e-6 * np.trace(W.T @ mobility @ W) * T * 1e-6   # the law's own, dt² = 1e-6
            assert (T >= 0).all()
            assert (gap + yielding >= -1e-12).all()
            assert np.abs(T * (gap + yielding)).max() <= 1e-10 * (1 + T.max())


def test_three_taut_cables_carry_what_statics_says(marionet):
    with cl.open_simulator(marionet, "length") as simulator:
        start = simulator.position
        _, tensions = wind_to(simulator, simulator.rope_lengths + [0, 0, 0.2, 0], 0.6)
        held = np.linalg.solve(simulator.wrench_matrix[:, [0, 1, 3]], [0, 0, marionet.robot.mass * G])
        assert np.linalg.norm(simulator.position - start) <= 1e-6
        np.testing.assert_allclose(tensions[-1, [0, 1, 3]], held, rtol=0, atol=0.01)  # tips of 1e-4 kg weigh 1e-3 N
        assert tensions[-1, 2] <= 0.01 and (tensions >= 0).all()


def test_a_switch_takes_up_before_it_pays_out(marionet):
    """Cable 3 slack, then cable 4: in this order the load stays; both at once, it hangs on two cables and swings."""
    place, slack = np.array([1.40, 0.78, 1.80]), 0.2
    loose3, loose4 = np.array([0, 0, slack, 0]), np.array([0, 0, 0, slack])
    with cl.open_simulator(marionet, "length") as simulator:
        simulator.reset(cl.Pose(place))
        length = simulator.rope_lengths
        wind_to(simulator, length + loose3, 0.5)
        stayed = np.concatenate([wind_to(simulator, length, 0.5)[0], wind_to(simulator, length + loose4, 0.5)[0]])
        simulator.reset(cl.Pose(place))
        wind_to(simulator, length + loose3, 0.5)
        swung, _ = wind_to(simulator, length + loose4, 0.5)
    assert np.linalg.norm(stayed - place, axis=1).max() <= 1e-6
    assert np.linalg.norm(swung - place, axis=1).max() > 0.02


@pytest.mark.parametrize("name, end", [("marionet", cl.Pose([1.2, 0.95, 0.7])),
                                       ("caroca", cl.Pose([0.5, 0.6, 0.8], rpy=[0.1, -0.1, 0.2]))])
def test_the_load_follows_the_lengths(name, end):
    world = cl.load_world(name)
    with cl.open_simulator(world, "length") as simulator:
        off, tensions = along(simulator, cl.quintic(world.pose, end, 2.0), 2.2, 0.0)
        assert off <= 2e-6          # curvature of the path within a step: v² dt²/2l, and rounding of float32 pivots
        assert (tensions >= 0).all()
        W, weight = simulator.wrench_matrix, cl.gravity_wrench(world.robot, world.pose)
        np.testing.assert_allclose(W @ tensions[-1], -weight[:len(W)], rtol=0, atol=0.01)


def test_a_push_is_carried(marionet):
    with cl.open_simulator(marionet, "length") as simulator:
        start = simulator.position
        simulator.push([30.0, -20.0, 0.0])
        wind_to(simulator, simulator.rope_lengths, 0.2)
        np.testing.assert_allclose(simulator.wrench_matrix @ simulator.tensions,
                                   [-30, 20, marionet.robot.mass * G], rtol=0, atol=0.01)
        assert np.linalg.norm(simulator.position - start) <= 1e-6


def test_a_cut_rope_carries_nothing_and_the_load_swings_to_the_others(marionet):
    with cl.open_simulator(marionet, "length") as simulator:
        start = simulator.position
        simulator.cut([0])
        wind_to(simulator, simulator.rope_lengths, 0.3)
        assert simulator.tensions[0] == 0
        assert np.linalg.norm(simulator.position - start) > 0.05
        others = cl.cable_lengths(marionet.robot, simulator.state().pose)[1:] - simulator.rope_lengths[1:]
        assert others.max() <= 1e-5


def test_winches_keep_their_speed_limits(marionet):
    with cl.open_simulator(marionet, "length") as simulator:
        before = simulator.rope_lengths
        assert simulator.wind(before + [0.4e-3, 0, 0, 0])
        assert not simulator.wind(simulator.rope_lengths + [5e-3, 0, 0, -5e-3])
        np.testing.assert_allclose(simulator.rope_lengths - before, [0.9e-3, 0, 0, -0.5e-3], rtol=0, atol=1e-8)
        assert simulator.wind(simulator.rope_lengths + [4e-3, 0, 0, 0], substeps=10)


def test_elastic_ropes_start_at_rest_and_stretch_by_tension_over_stiffness(marionet):
    with cl.open_simulator(marionet, "elastic") as simulator:
        start = simulator.position
        wind_to(simulator, simulator.rope_lengths, 0.3)
        assert np.linalg.norm(simulator.position - start) <= 1e-5
        wind_to(simulator, simulator.rope_lengths - [0.01, 0, 0, 0], 0.3)
        wind_to(simulator, simulator.rope_lengths, 2.0)
        stretch = simulator.lengths - simulator.rope_lengths
        expected = simulator.tensions * simulator.rope_lengths / marionet.robot.elasticity.axial_stiffness
        taut = simulator.tensions > 1
        np.testing.assert_allclose(stretch[taut], expected[taut], rtol=0, atol=1e-6)
        np.testing.assert_allclose(simulator.wrench_matrix @ simulator.tensions, [0, 0, marionet.robot.mass * G],
                                   rtol=0, atol=0.05)


def test_stiff_elastic_ropes_are_ropes_of_given_length(marionet):
    """The compliance goes to zero as the stiffness grows: the same tensions in the limit."""
    from cdprlab.robot import Elasticity
    from cdprlab.simulate.ropes import RopeLaw

    with cl.open_simulator(marionet, "length") as simulator:
        stiff = RopeLaw(marionet.robot, 1e-3, Elasticity(1e12, 0.0))
        arguments = (simulator.whole_wrenches, simulator.rotation, simulator.twist, simulator.lengths,
                     simulator.lengths, simulator.lengths + [0, 0, 0.1, 0], np.zeros(6))
        # Ropes of given length yield too, 1e-6 of A's trace, of which A's smallest eigenvalue is a few thousandths.
        np.testing.assert_allclose(stiff(*arguments), simulator.ropes(*arguments), rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("cables", ["length", "elastic"])
def test_a_run_on_ropes_is_feasible_only_while_they_hold_the_platform(marionet, cables):
    """Ropes from above hold against no push upwards: the winches reach their lengths, the platform rises."""
    up = np.array([0.0, 0.0, 2 * marionet.robot.mass * G])
    calm = cl.run(marionet, cables=cables, duration=0.4)
    begun = 0.02 if cables == "elastic" else 0.0   # wound to hang at rest, they first pay out what they are stretched
    assert calm.feasible[calm.time >= begun].all()
    run = cl.run(marionet, cables=cables, duration=0.4, external_wrench=lambda t: up if t >= 0.2 else 0 * up)
    assert run.feasible[(run.time >= begun) & (run.time < 0.2)].all() and not run.feasible[run.time > 0.3].any()
    assert (np.abs(run.lengths[-1] - run.commanded_lengths[-1]) > 1e-3).any()


def test_two_windings_are_identical(marionet):
    def fly():
        with cl.open_simulator(marionet, "length") as simulator:
            return along(simulator, cl.quintic(marionet.pose, cl.Pose([0.8, 0.9, 0.9]), 1.0), 0.3, [0, 0, 0.01, 0])[1]

    np.testing.assert_array_equal(fly(), fly())


def test_wrong_requests_are_named(marionet):
    with cl.open_simulator(marionet, "length") as simulator:
        with pytest.raises(InvalidInput, match=r"use wind\(lengths\)"):
            simulator.step(np.ones(4))
        with pytest.raises(InvalidInput, match="must be 4 numbers"):
            simulator.wind([1, 2, 3])
        with pytest.raises(InvalidInput, match="finite"):
            simulator.wind([1, 2, 3, np.nan])
    with cl.open_simulator(marionet) as simulator, pytest.raises(InvalidInput, match=r"cables=\"length\""):
        simulator.wind(np.ones(4))
    with pytest.raises(InvalidInput, match=r"axial_stiffness"):
        cl.open_simulator(cl.load_world("point_mass"), "elastic")


@pytest.mark.parametrize("length", [0.5, 2.0, 2.3, 5.0])
def test_a_hanging_rope_has_its_length(length):
    start, end = np.array([0.0, 0.0, 1.0]), np.array([1.0, 1.0, 2.4])
    points = hanging(start, end, length)
    drawn = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert drawn == pytest.approx(max(length, np.linalg.norm(end - start)), abs=1e-6)
    assert np.allclose(points[[0, -1]], [start, end])


def test_the_complementarity_problem_is_solved_whatever_was_tried_first():
    """Redundant ropes or not, from any set of taut ropes: one answer, that of the quadratic program."""
    from quadprog import solve_qp

    from cdprlab.compiled.complementarity import complementary

    rng = np.random.default_rng(4)
    for m in (1, 3, 4, 8):
        for _ in range(50):
            J = rng.normal(size=(m, 6 if m > 4 else 3))
            A, b = J @ J.T + 1e-6 * np.eye(m), rng.normal(size=m)
            T = complementary(A, b, np.ones(m))
            program, near = solve_qp(A, b, np.eye(m), np.zeros(m))[0], 1e-8 * (1 + T.max())
            np.testing.assert_allclose(T, program, rtol=1e-6, atol=near)
            assert (T >= 0).all() and (A @ T - b >= -1e-9 * (1 + T.max())).all()
            again = complementary(A, b, rng.integers(0, 2, m).astype(float))
            np.testing.assert_allclose(again, T, rtol=1e-6, atol=near)
