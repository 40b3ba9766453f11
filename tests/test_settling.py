"""A load let go moves in pymunk as statics says; hung on ropes it rests where geometry says, as low as they allow."""

import numpy as np
import pytest
from scipy.optimize import minimize

import cdprlab as cl
from cdprlab.course.props.experiments import hang, let_go
from cdprlab.course.props.point_load import circle_crossings, point_load
from cdprlab.course.props.pose_search import six_cables
from cdprlab.errors import InvalidInput

AT_REST = 1e-6     # m: `equilibrium` finds cables taut to this

EXITS = np.array([[-2.0, 3.0], [2.0, 3.0]])


# --- let go -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("seed", range(12))
def test_a_load_let_go_accelerates_as_the_forces_left_over_say(seed):
    rng = np.random.default_rng(seed)
    robot = six_cables(int(rng.integers(3, 7))) if seed % 2 else point_load(int(rng.integers(2, 5)))
    pose = cl.Pose(rng.uniform([-0.8, 0.8], [0.8, 2.2]), angle=rng.uniform(-0.4, 0.4) if seed % 2 else 0.0)
    tensions, push = rng.uniform(-60, 100, robot.n_cables), rng.uniform(-50, 50, robot.n_dof)
    left_over = cl.wrench_matrix(robot, pose) @ tensions.clip(0) + cl.gravity_wrench(robot, pose) + push
    inertia = np.array([robot.mass, robot.mass, float(robot.platform.inertia)])[:robot.n_dof]
    # One step's change of speed, divided by 1 ms: rounding of the speed, a thousandfold.
    np.testing.assert_allclose(let_go(robot, pose, tensions, push, 0.01).acceleration, left_over / inertia, atol=1e-9)


@pytest.mark.parametrize("m", [2, 3, 4])
def test_balanced_tensions_leave_the_load_where_it_is(m):
    robot, pose = point_load(m), cl.Pose([0.3, 1.4], angle=0.0)
    W, w_e = cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose)
    held = cl.distribute_tensions(W, w_e, robot.tension_min, robot.tension_max).require().tensions
    places = let_go(robot, pose, held).positions
    # Rounding of the tensions, 1e-12 N on 10 kg for half a second.
    assert np.linalg.norm(places - pose.position, axis=1).max() < 1e-12


def test_a_rope_cannot_push():
    robot, pose = point_load(3), cl.Pose([0.3, 1.4], angle=0.0)
    pushed, slack = let_go(robot, pose, [40, -500, 20]), let_go(robot, pose, [40, 0, 20])
    np.testing.assert_array_equal(pushed.positions, slack.positions)


def test_in_free_fall_the_way_is_half_g_t_squared_and_half_a_step():
    motion = let_go(point_load(2), cl.Pose([0.0, 1.0], angle=0.0), [-1, -1], duration=0.4)
    # Speeds first, then places with the new speed: k(k + 1)/2 steps of g dt².
    np.testing.assert_allclose(motion.positions[:, 1], 1 - 9.81 / 2 * motion.time * (motion.time + 1e-3), atol=1e-12)


# --- hung on ropes ----------------------------------------------------------------------------------------
def two_lengths(count, seed):
    """Ropes that reach each other, with centimeters to spare."""
    lengths = np.random.default_rng(seed).uniform(1, 7, (3 * count, 2))
    return lengths[lengths.sum(axis=1) > 4.1][:count]


@pytest.mark.parametrize("lengths", two_lengths(25, 1))
def test_a_load_hangs_at_the_lower_crossing_or_below_one_exit(lengths):
    settled = hang(point_load(2), lengths, cl.Pose([0.0, 1.0], angle=0.0))
    lower = circle_crossings(EXITS, lengths)[0]
    if -2 < lower[0] < 2:     # between the exits both ropes pull
        assert not settled.slack.any()
    else:
        short = int(lengths.argmin())
        assert settled.slack.tolist() == [short == 1, short == 0]
        lower = EXITS[short] - [0, lengths[short]]
        assert settled.spare[1 - short] == pytest.approx(
            lengths[1 - short] - np.linalg.norm(EXITS[1 - short] - lower), abs=AT_REST)
    np.testing.assert_allclose(settled.pose.position, lower, atol=AT_REST)


@pytest.mark.parametrize("lengths", two_lengths(6, 2))
def test_it_does_not_matter_where_the_load_was_before(lengths):
    first, second = (hang(point_load(2), lengths, cl.Pose(start, angle=0.0)).pose.position
                     for start in ([0.0, 1.0], [-1.0, 2.5]))
    np.testing.assert_allclose(first, second, atol=2 * AT_REST)


def test_ropes_that_do_not_reach_each_other_are_said_not_to_fit():
    assert hang(point_load(2), np.array([1.0, 2.0]), cl.Pose([0.0, 1.0], angle=0.0)) is None
    truth = cl.Pose([0.4, 1.3], angle=0.15)
    for count in (4, 5, 6):     # held from all around: nothing gives when one rope gets shorter
        assert hang(six_cables(count), cl.cable_lengths(six_cables(count), truth) - [0, 0.01, *[0] * (count - 2)],
                    truth) is None


@pytest.mark.parametrize("seed", range(12))
def test_a_platform_hangs_at_rest_as_low_as_its_ropes_allow(seed):
    rng = np.random.default_rng(seed)
    robot, truth = six_cables(int(rng.integers(3, 7))), cl.Pose(rng.uniform([-0.6, 0.9], [0.6, 2.1]),
                                                                 angle=rng.uniform(-0.3, 0.3))
    lengths = cl.cable_lengths(robot, truth) + 0.2 * rng.random(robot.n_cables) * (rng.random(robot.n_cables) < 0.5)
    settled = hang(robot, lengths, truth)
    assert settled.spare.min() > -AT_REST

    def spare(x):
        return lengths - cl.cable_lengths(robot, cl.Pose(x[:2], angle=x[2]))

    start = np.append(settled.pose.position, settled.pose.angle)
    lowest = minimize(lambda x: x[1], start, constraints={"type": "ineq", "fun": spare}, method="SLSQP",
                      options={"ftol": 1e-12})
    # An independent search from there finds nothing lower; it may break its constraints by 1e-6 m and a little more.
    assert lowest.fun > settled.pose.position[1] - 2 * AT_REST


def test_an_error_of_one_length_is_slack_somewhere():
    """Three cables follow it, of four another goes slack, of six the long one itself."""
    truth = cl.Pose([0.4, 1.3], angle=np.deg2rad(9))
    slack = {}
    for count in (3, 4, 6):
        robot = six_cables(count)
        lengths = cl.cable_lengths(robot, truth) + [0, 0.1, *[0] * (count - 2)]
        slack[count] = hang(robot, lengths, truth)
    assert [np.flatnonzero(slack[count].slack).tolist() for count in (3, 4, 6)] == [[], [3], [1]]
    np.testing.assert_allclose(slack[6].pose.position, truth.position, atol=AT_REST)
    found = cl.forward_kinematics(six_cables(3), cl.cable_lengths(six_cables(3), truth) + [0, 0.1, 0], truth)
    for count in (3, 4):
        np.testing.assert_allclose(slack[count].pose.position, found.position, atol=AT_REST)


def test_only_planar_robots_are_let_go_here():
    caroca = cl.load_world("caroca")
    with pytest.raises(InvalidInput, match="planar robots, got Robot"):
        let_go(caroca.robot, caroca.pose, np.full(8, 100.0))
    with pytest.raises(InvalidInput, match="tensions must be"):
        let_go(point_load(2), cl.Pose([0, 1], angle=0), [1, 2, 3])


# --- the crossings themselves -----------------------------------------------------------------------------
def test_crossings_lie_on_both_circles_lower_first():
    rng = np.random.default_rng(3)
    for _ in range(30):
        centers, point = rng.normal(size=(2, 2)), rng.normal(size=2) * 2
        lengths = np.linalg.norm(centers - point, axis=1)
        crossings = circle_crossings(centers, lengths)
        # A root of rounding's size where the circles only just touch.
        np.testing.assert_allclose(np.linalg.norm(crossings[:, None] - centers, axis=2), [lengths] * 2, atol=1e-7)
        assert np.linalg.norm(crossings - point, axis=1).min() < 1e-6
        assert crossings[0, 1] <= crossings[1, 1]


def test_circles_that_miss_each_other_have_no_crossing_in_a_batch_too():
    crossings = circle_crossings(EXITS, [[2.5, 2.5], [1, 1], [1, 7]])
    assert np.isnan(crossings).all(axis=(1, 2)).tolist() == [False, True, True]
    with pytest.raises(InvalidInput, match="one place"):
        circle_crossings([[0, 0], [0, 0]], [1, 1])
