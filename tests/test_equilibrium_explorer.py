"""The equilibrium explorer: its forces obey the laws, and every control answers at both ends of its range."""

import itertools

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab import course
from cdprlab.course.pictures.equilibrium import draw_equilibrium
from cdprlab.course.props.point_load import EXIT_POINTS, MASS, equilibrium, null_vector, point_load
from cdprlab.errors import InvalidInput

# Sums of a few products of doubles of size 1e3: some 1e-13 of rounding each, far above nothing, far below a newton.
ROUNDING = 1e-9


def random_loads(count, seed):
    rng = np.random.default_rng(seed)
    return [(int(rng.integers(2, 5)), rng.uniform([-1.8, 0.2], [1.8, 2.8]), rng.uniform(-150, 150, 2),
             float(rng.uniform(-200, 200))) for _ in range(count)]


@pytest.mark.parametrize(("m", "position", "push", "internal"), random_loads(20, 1))
def test_forces_balance_whatever_the_internal_tension(m, position, push, internal):
    state = equilibrium(point_load(m), position, push, internal)
    u = np.array(EXIT_POINTS[m]) - position
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    total = state.tensions @ u + push + [0, -MASS * 9.81]
    assert np.abs(total).max() < ROUNDING
    assert state.closed


@pytest.mark.parametrize(("m", "position", "push", "internal"), random_loads(10, 2))
def test_least_tensions_are_perpendicular_to_the_null_space(m, position, push, internal):
    least = equilibrium(point_load(m), position, push)
    for direction in np.linalg.svd(least.W)[2][2:]:
        assert abs(least.tensions @ direction) < ROUNDING


@pytest.mark.parametrize("seed", range(30))
def test_null_vector_is_positive_exactly_where_an_lp_finds_a_positive_one(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))
    W = rng.normal(size=(n, n + int(rng.integers(1, 4))))
    h = null_vector(W)
    assert np.abs(W @ h).max() < ROUNDING and abs(np.abs(h).max() - 1) < ROUNDING
    # h ≥ 1 can be scaled from any h > 0.
    found = linprog(np.zeros(W.shape[1]), A_eq=W, b_eq=np.zeros(n), bounds=(1, None)).status == 0
    assert (h.min() > ROUNDING) == found


def test_no_null_space_no_null_vector():
    assert not null_vector(np.eye(2)).any()


def test_inside_the_triangle_internal_tension_lifts_every_cable():
    robot = point_load(3)
    inside, outside = equilibrium(robot, [0, 1.5]), equilibrium(robot, [1.5, 0.5])
    assert (inside.null_vector > 0).all()
    assert outside.null_vector.min() < 0 < outside.null_vector.max()


def test_a_load_above_its_cables_would_have_to_be_pushed():
    state = equilibrium(point_load(2), [0, 3.4])
    assert state.slack.all()
    assert "cable 1 would have to push" in state.words() and "slack" in state.words()


def test_cables_in_one_line_leave_the_weight_over():
    state = equilibrium(point_load(2), [0, 3])
    assert not state.closed
    assert "98.1 N are left over" in state.words()


def test_a_cable_that_pulls_with_nothing_is_not_slack():
    # Straight below exit point 2, cable 1 has nothing to do.
    state = equilibrium(point_load(2), [2.0, 1.0])
    assert not state.slack.any()
    np.testing.assert_allclose(state.tensions, [0, MASS * 9.81], atol=ROUNDING)


def test_numbers_of_cables_that_do_not_fit_are_named():
    with pytest.raises(InvalidInput, match="2, 3 or 4 cables, got 5"):
        point_load(5)
    with pytest.raises(InvalidInput, match="2, 3 or 4 cables, got 1"):
        course.equilibrium_explorer(1)


def test_a_figure_tells_its_numbers_and_takes_a_students_own():
    figure = draw_equilibrium(point_load(2), [0, 1])
    assert "69.4, 69.4" in figure.alt_text
    wrong = draw_equilibrium(point_load(2), [0, 1], tensions=[50, 69.4])
    assert "left over" in wrong.alt_text
    titles = [drawn.axes[1].get_title(loc="left") for drawn in (wrong, figure)]
    assert titles == ["Force polygon: OPEN", "Force polygon: closed"]


def test_every_control_answers_at_both_ends_of_its_range():
    explorer = course.equilibrium_explorer(2)
    ends = {name: (control.low, control.high) for name, control in explorer.controls.items() if name != "cables"}
    corners = itertools.product(EXIT_POINTS, *(ends[name] for name in ("x", "y", "internal", "time")))
    for m, x, y, internal, seconds in corners:
        explorer.set(cables=m, x=x, y=y, internal=internal, push_x=ends["push_x"][0], push_y=ends["push_y"][1],
                     extra=ends["extra"][seconds > 0], time=seconds)
        assert explorer.picture.startswith(b"\x89PNG")
        assert "W τ + w_e" in explorer.text and "τ = (" in explorer.alt_text
    explorer.close()


def test_a_closed_polygon_stays_when_let_go_and_an_open_one_moves_along_what_is_left_over():
    explorer = course.equilibrium_explorer(3)
    explorer.set(y=1.5, internal=100, time=0.5)
    assert "moved 0.0 mm" in explorer.text
    explorer.set(extra=40, time=0.1)
    state, motion = explorer.state(explorer.values), explorer.motion(explorer.values)
    moved = motion.positions[-1] - motion.positions[0]
    # A tenth of a second is short: the cables have turned by a degree.
    assert moved @ state.left_over > 0.99 * np.linalg.norm(moved) * np.linalg.norm(state.left_over)
    np.testing.assert_allclose(motion.acceleration * MASS, state.left_over, atol=ROUNDING * 1e3)  # speed / 1 ms
    assert "OPEN" in explorer.axes[1].get_title(loc="left")
    explorer.close()


def test_a_cable_told_to_push_carries_nothing():
    state = equilibrium(point_load(3), [0.0, 1.5], internal=-100)
    np.testing.assert_allclose(state.left_over, [0, -MASS * 9.81])  # all three are slack: it falls
    explorer = course.equilibrium_explorer(3)
    explorer.set(y=1.5, internal=-100, time=0.2)
    assert "pymunk     a = (0.000, -9.810)" in explorer.text
    assert explorer.axes[1].get_title(loc="left") == "Force polygon: slack!"
    explorer.close()


def test_a_load_that_is_held_tells_nothing_yet():
    explorer = course.equilibrium_explorer(2)
    assert explorer.motion(explorer.values) is None and "which way" in explorer.text
    explorer.close()


def test_slack_cables_are_told_in_text():
    explorer = course.equilibrium_explorer(3)
    explorer.set(x=0.0, y=1.5, internal=100)
    assert "slack" not in explorer.text
    explorer.set(internal=-100)
    assert explorer.text.count("slack!") >= 3
    explorer.close()


def test_without_internal_tension_there_is_no_such_slider():
    explorer = course.equilibrium_explorer(2, internal=False)
    assert "internal" not in explorer.controls
    explorer.close()


def test_explorer_shows_what_statics_says():
    explorer = course.equilibrium_explorer(4)
    explorer.set(x=0.4, y=1.2, push_x=30)
    state = explorer.state(explorer.values)
    pose = cl.Pose([0.4, 1.2], angle=0.0)
    np.testing.assert_array_equal(state.W, cl.wrench_matrix(point_load(4), pose))
    np.testing.assert_allclose(state.w_e, [30, -MASS * 9.81])
    explorer.close()
