"""The forward kinematics explorer: its iteration is right, its numbers add up, every slider goes to both its ends."""

import numpy as np
import pytest

import cdprlab as cl
from cdprlab import course
from cdprlab.course.explorers.explorer import Slider
from cdprlab.course.pictures import pose_estimates
from cdprlab.course.props.changed_cables import without_cable
from cdprlab.course.props.pose_search import gauss_newton_path, six_cables
from cdprlab.errors import InvalidInput

# Lengths of a few meters are rounded to 1e-15 m; J⁺ multiplies that by less than 10 for these poses.
ROUNDING = 1e-13


@pytest.fixture(scope="module")
def explorer():
    made = course.forward_kinematics_explorer()
    yield made
    made.close()


def reset(explorer, **values):
    start = {name: control.start if isinstance(control, Slider) else control.start or control.options[0]
             for name, control in explorer.controls.items()}
    explorer.set(**{**start, **values})


def random_planar_poses(count, seed):
    rng = np.random.default_rng(seed)
    return cl.Pose(rng.uniform([-0.8, 0.8], [0.8, 2.2], (count, 2)), angle=rng.uniform(-0.5, 0.5, count))


@pytest.mark.parametrize("count", [3, 4, 5, 6])
def test_exact_lengths_lead_back_to_the_pose(count):
    robot, rng = six_cables(count), np.random.default_rng(count)
    for pose in random_planar_poses(20, count):
        guess = cl.Pose(pose.position + rng.uniform(-0.2, 0.2, 2), angle=pose.angle + rng.uniform(-0.2, 0.2))
        path = gauss_newton_path(robot, cl.cable_lengths(robot, pose), guess)
        assert path.converged
        np.testing.assert_allclose(path.poses[-1].position, pose.position, atol=ROUNDING)
        np.testing.assert_allclose(path.poses[-1].angle, pose.angle, atol=ROUNDING)


def test_where_it_settles_the_residuals_are_perpendicular_to_the_jacobian():
    robot, rng = six_cables(), np.random.default_rng(1)
    for pose in random_planar_poses(20, 1):
        path = gauss_newton_path(robot, cl.cable_lengths(robot, pose) + rng.normal(0, 0.05, 6), pose)
        # Steps stop below 1e-10 m, J is of size 2.
        np.testing.assert_allclose(cl.jacobian(robot, path.poses[-1]).T @ path.residuals, 0, atol=1e-9)
        found = cl.forward_kinematics(robot, cl.cable_lengths(robot, path.poses[-1]) + path.residuals, pose,
                                      tolerance=np.inf)
        # The library stops where the sum of squares no longer changes, at the root of rounding.
        np.testing.assert_allclose(found.position, path.poses[-1].position, atol=1e-7)


def test_three_cables_have_two_exact_answers_and_six_one(explorer):
    reset(explorer, cables=3, guess_angle=-140.0)
    assert "exactly these lengths" in explorer.text and "575" in explorer.text
    reset(explorer, cables=6, guess_angle=-140.0)
    assert "off the truth by  0.0 mm, 0.0°" in explorer.text


def test_a_fourth_cable_gives_the_wrong_mode_away(explorer):
    reset(explorer, cables=4, guess_angle=170.0)
    assert "no pose has these lengths" in explorer.text


def test_three_cables_hide_an_error_four_show_it_five_name_it(explorer):
    error = {"error": 100.0, "cable": 2, "guess_x": 0.4, "guess_y": 1.4, "guess_angle": 0.0}
    reset(explorer, cables=3, **error)
    assert "largest residual  0.0 mm" in explorer.text
    reset(explorer, cables=4, **error)
    assert "no pose has these lengths" in explorer.text and "without it" not in explorer.text
    reset(explorer, cables=5, **error)
    left = [float(word) for word in explorer.text.split("without it")[1].splitlines()[0].split()]
    assert int(np.argmin(left)) == 1 and left[1] == 0.0 and sorted(left)[1] > 1.0


def test_leaving_one_of_four_out_explains_any_error():
    robot, pose = six_cables(4), cl.Pose([0.4, 1.3], angle=0.15)
    lengths = cl.cable_lengths(robot, pose) + [0, 0.03, 0, 0]
    for i in range(4):
        cl.forward_kinematics(without_cable(robot, i), np.delete(lengths, i), pose, tolerance=1e-9)  # or NoConvergence


@pytest.mark.parametrize("cables", [3, 4, 5, 6])
def test_both_ends_of_every_slider(explorer, cables):
    for name, control in explorer.controls.items():
        for value in (control.low, control.high) if isinstance(control, Slider) else control.options:
            reset(explorer, **{"cables": cables, "error": 100.0, name: value})
            assert explorer.text and explorer.picture.startswith(b"\x89PNG") and "nan" not in explorer.alt_text


def test_an_error_of_a_cable_that_is_not_measured_is_said_to_do_nothing(explorer):
    reset(explorer, cables=3, cable=5, error=50.0)
    assert "cable 5 is not measured" in explorer.text and "0.0 mm, 0.0°" in explorer.text


@pytest.mark.parametrize(("cables", "slack"), [(3, "none"), (4, "cable 4 by 113 mm"), (6, "cable 2 by 100 mm")])
def test_hung_on_ropes_one_too_long_another_gives(explorer, cables, slack):
    reset(explorer, cables=cables, cable=2, error=100.0, hang="yes")
    assert f"slack: {slack}" in explorer.text and slack in explorer.alt_text


def test_exact_lengths_of_a_pose_that_would_need_a_push_hang_elsewhere(explorer):
    reset(explorer, cables=3, x=-0.8, y=2.0, guess_angle=0.0, hang="yes")
    assert "exactly these lengths" in explorer.text and "slack: cable 3" in explorer.text


def test_a_rope_too_short_hangs_nothing_and_says_so(explorer):
    reset(explorer, cables=4, error=-50.0, hang="yes")
    assert "Something would tear" in explorer.text and not explorer.hung


def test_it_is_hung_only_when_asked(explorer):
    reset(explorer, cables=4)
    assert "pymunk" not in explorer.text and not explorer.hung


def test_a_wrong_count_is_named():
    with pytest.raises(InvalidInput, match="3, 4, 5 or 6 cables, got 7"):
        six_cables(7)


def test_figures_say_in_words_what_they_show():
    robot, truth = six_cables(), cl.Pose([0.4, 1.3], angle=0.2)
    path = gauss_newton_path(robot, cl.cable_lengths(robot, truth), cl.Pose([0, 1.8], angle=-0.3))
    covariance = 1e-6 * np.linalg.inv(cl.jacobian(robot, truth).T @ cl.jacobian(robot, truth))
    rng = np.random.default_rng(0)
    errors = rng.multivariate_normal(np.zeros(3), covariance, 400)
    figures = [pose_estimates.convergence(robot, path.poses, truth),
               pose_estimates.assembly_modes(robot, [truth, path.poses[0]], ["true", "guess"]),
               pose_estimates.cloud(errors, covariance),
               pose_estimates.residual_bars([0.001, -0.02, 0.003], [0.02, 0.001, 0.015]),
               pose_estimates.flight(np.arange(5), np.zeros((5, 6)), np.ones((5, 6)), np.zeros((5, 8)), 1e-3)]
    for figure in figures:
        assert len(figure.alt_text) > 20
        figure.draw_without_rendering()
    assert "Largest residual in the fit to all: cable 2; least remains without cable 2" in figures[-2].alt_text


def test_the_ellipse_holds_ninety_five_percent():
    errors = np.random.default_rng(2).multivariate_normal(np.zeros(3), np.diag([4e-6, 1e-6, 1e-6]), 2000)
    share = int(pose_estimates.cloud(errors, np.diag([4e-6, 1e-6, 1e-6])).alt_text.split(" %")[0].split()[-1])
    # Binomial: sqrt(0.95 · 0.05 / 2000) is half a percent; four of them, and half a percent of rounding.
    assert abs(share - 95) <= 2.5
