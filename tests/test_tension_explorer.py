"""The tension explorer: its set obeys the laws, every method's point is where it belongs, every control answers."""

import itertools

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab import course
from cdprlab.course.explorers.tension import BORDER
from cdprlab.course.pictures.flights import plot_tension_runs
from cdprlab.course.pictures.tension_panels import plot_tension_set
from cdprlab.course.pictures.tension_polygon import set_in_words, tension_set
from cdprlab.errors import InvalidInput
from robots import robot_1r2t, robot_2t, robot_3r3t

# Products of numbers of size 1e3 and bases from an SVD leave some 1e-12 of 1e3; the list of corners is exact to 1e-9.
ROUNDING = 1e-6

CAROCA = cl.load_world("caroca")


def random_problems(count, seed):
    """W, w_e and limits with a feasible set; r = 1 and r = 2 in turn."""
    rng = np.random.default_rng(seed)
    problems = []
    for k in range(count):
        n, r = int(rng.integers(1, 7)), 1 + k % 2
        W = rng.normal(size=(n, n + r))
        low, high = rng.uniform(0, 50, n + r), rng.uniform(100, 900, n + r)
        problems.append((W, -W @ rng.uniform(low, high), low, high))
    return problems


@pytest.mark.parametrize(("W", "w_e", "low", "high"), random_problems(16, 1))
def test_corners_balance_keep_all_limits_and_are_all_there_are(W, w_e, low, high):
    free = tension_set(W, w_e, low, high)
    r = W.shape[1] - W.shape[0]
    assert free.redundancy == r and len(free.corners) >= 2
    tau = free.tensions(free.corners)
    np.testing.assert_allclose(tau @ W.T, np.tile(-w_e, (len(tau), 1)), atol=ROUNDING)
    assert (tau >= low - ROUNDING).all() and (tau <= high + ROUNDING).all()
    assert all(len(free.met_limits(corner)) == r for corner in tau)
    # A linear function is largest at a corner, and an independent program says how large.
    for cost in np.random.default_rng(2).normal(size=(6, W.shape[1])):
        best = -linprog(-cost, A_eq=W, b_eq=-w_e, bounds=list(zip(low, high))).fun
        assert abs((tau @ cost).max() - best) < 1e-5 * high.max()


@pytest.mark.parametrize(("W", "w_e", "low", "high"), random_problems(8, 3))
def test_coordinates_keep_distances_and_the_first_is_the_way_of_more_tension(W, w_e, low, high):
    free = tension_set(W, w_e, low, high)
    N = free.directions
    np.testing.assert_allclose(N.T @ N, np.eye(free.redundancy), atol=1e-12)
    np.testing.assert_allclose(W @ N, 0, atol=1e-12)
    slopes = N.sum(axis=0)
    assert slopes[0] > 0 and np.abs(slopes[1:]).max(initial=0) < 1e-12
    tau = free.tensions(free.corners)
    np.testing.assert_allclose(free.coordinates(tau), free.corners, atol=ROUNDING)
    np.testing.assert_allclose(free.coordinates(free.least), 0, atol=ROUNDING)


@pytest.mark.parametrize(("W", "w_e", "low", "high"), random_problems(8, 4))
def test_methods_pick_the_points_the_lesson_says(W, w_e, low, high):
    free = tension_set(W, w_e, low, high)
    at = {name: free.coordinates(cl.distribute_tensions(W, w_e, low, high, name).tensions)
          for name in ("linear_program", "quadratic_program", "pseudo_inverse")}
    assert abs(at["linear_program"][0] - free.corners[:, 0].min()) < ROUNDING
    np.testing.assert_allclose(at["pseudo_inverse"], 0, atol=ROUNDING)
    # Nearest to 0: no corner lies ahead of it.
    assert ((free.corners - at["quadratic_program"]) @ at["quadratic_program"] > -ROUNDING * high.max()).all()


@pytest.mark.parametrize(("W", "w_e", "low", "high"), random_problems(8, 5))
def test_the_walk_stays_on_the_border_and_passes_every_corner(W, w_e, low, high):
    free = tension_set(W, w_e, low, high)
    places = np.array([free.walk(share) for share in np.linspace(0, 1, 201)])
    assert all(len(free.met_limits(free.tensions(place))) >= 1 for place in places[[0, -1]])
    if free.redundancy == 2:
        assert all(free.met_limits(free.tensions(place)) for place in places)
        np.testing.assert_allclose(places[0], places[-1], atol=ROUNDING)
    step = np.linalg.norm(np.diff(places, axis=0), axis=1).max()
    for corner in free.corners:
        assert np.linalg.norm(places - corner, axis=1).min() <= step


def test_axes_follow_the_pose_smoothly():
    x = np.linspace(-1, 1, 41)
    frames = []
    for place in x:
        pose = cl.Pose([place, 0.4, 1.2], rpy=[0.1, -0.05, 0.15])
        frames.append(tension_set(cl.wrench_matrix(CAROCA.robot, pose), cl.gravity_wrench(CAROCA.robot, pose),
                                  50, 10000).directions)
    # A flipped axis of length 1 would move by 2.
    assert np.linalg.norm(np.diff(frames, axis=0), axis=1).max() < 0.3


def test_where_nothing_can_be_drawn_words_say_why():
    assert set_in_words(tension_set(np.eye(2), [1.0, 1.0], 0, 10)) == "r = 0: nothing to choose."
    assert "too many dimensions" in set_in_words(tension_set(np.ones((1, 4)), [-10.0], 0, 10))
    assert "no tensions" in set_in_words(tension_set([[1.0, 1.0, 1.0]], [5.0], 0, 10))
    # Outside the range of W no tensions balance the wrench, and there is no set to draw.
    flat = np.array([[1.0, -1.0, 0.5], [0.0, 0.0, 0.0]])
    assert len(tension_set(flat, [0.0, 5.0], 0, 10).corners) == 0


def test_figures_tell_their_numbers():
    figure = plot_tension_set([[1.0, -1.0]], [30.0], 10, 100, ["linear_program"], own={"yours": [[10, 40], [70, 100]]})
    assert "interval of" in figure.alt_text and "linear program" in figure.alt_text
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert labels == ["linear program", "yours"]
    pose = cl.Pose([0.3, 0.2, 1.2], rpy=[0.1, -0.05, 0.2])
    W, w_e = cl.wrench_matrix(CAROCA.robot, pose), cl.gravity_wrench(CAROCA.robot, pose)
    assert "4 corners" in plot_tension_set(W, w_e, 50, 10000, ["closed_form"]).alt_text
    assert "no tensions" in plot_tension_set(W, w_e, 500, 501, ["closed_form"]).alt_text


@pytest.mark.parametrize("subject", [CAROCA, cl.load_world("planar_suspended")], ids=["r = 2", "r = 1"])
def test_every_control_answers_at_both_ends_of_its_range(subject):
    explorer = course.tension_explorer(subject)
    start = explorer.values
    for name, control in explorer.controls.items():
        ends = control.options if name == "method" else (control.low, control.high)
        for end in ends:
            explorer.set(**{**start, name: end})
            assert explorer.picture.startswith(b"\x89PNG") and "feasible set" in explorer.text
    assert "role=\"alert\"" not in explorer.mistake.value
    explorer.close()


def test_limits_of_the_sliders_never_cross():
    for name in ("caroca", "caroca_light", "planar_suspended", "ipanema3"):
        explorer = course.tension_explorer(cl.load_world(name))
        assert explorer.controls["tension_min"].high <= explorer.controls["tension_max"].low
        explorer.close()


@pytest.mark.parametrize("robot", [robot_2t(), robot_1r2t(), robot_3r3t()], ids=["2T", "1R2T", "3R3T"])
def test_robots_without_a_world_are_explored_too(robot):
    explorer = course.tension_explorer(robot)
    for name, walk in itertools.product((BORDER, "relaxed"), (0.0, 50.0)):
        explorer.set(method=name, walk=walk)
    state = explorer.state(explorer.values)
    assert state.shown.shape == (robot.n_cables,)
    explorer.close()


def test_explorer_shows_what_the_library_finds():
    pose = cl.Pose([-1.5, -0.6, 1.6], rpy=[0.02, 0.15, -0.15])
    explorer = course.tension_explorer(CAROCA, pose)
    explorer.set(method="puncture", tension_min=250, tension_max=1500)
    W, w_e = cl.wrench_matrix(CAROCA.robot, pose), cl.gravity_wrench(CAROCA.robot, pose)
    found = cl.distribute_tensions(W, w_e, 250, 1500, "puncture")
    np.testing.assert_allclose(explorer.state(explorer.values).shown, found.tensions, rtol=1e-9)
    assert f"{found.tensions[0]:.1f}" in explorer.text and "6 corners" in explorer.alt_text
    explorer.set(method="pseudo_inverse")
    assert "Cable 8 would need" in explorer.text and "LP says a distribution" in explorer.text.replace("\n", " ")
    explorer.set(method="linear_program", tension_min=400)
    assert "No tensions within the limits" in explorer.text and "no tensions within the limits" in explorer.alt_text
    explorer.close()


def test_other_redundancies_are_named():
    with pytest.raises(InvalidInput, match="6 cables hold 6 freedoms, r = 0"):
        course.tension_explorer(cl.load_world("robocrane"))
    with pytest.raises(InvalidInput, match="World or a Robot, got str"):
        course.tension_explorer("caroca")


def test_runs_side_by_side_tell_their_numbers():
    pytest.importorskip("pymunk")
    world = cl.load_world("planar_rigid")
    runs = [cl.run(world, method=name, duration=0.05) for name in ("linear_program", "quadratic_program")]
    figure = plot_tension_runs(runs)
    assert "linear program" in figure.alt_text and figure.axes
    with pytest.raises(InvalidInput, match="one duration"):
        plot_tension_runs([runs[0], cl.run(world, duration=0.1)])
    with pytest.raises(InvalidInput, match="got none"):
        plot_tension_runs([])
