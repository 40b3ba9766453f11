"""Figures say what they show, pictures show the cables, films open anywhere."""

import subprocess
import sys
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from PIL import Image

import cdprlab as cl
from cdprlab import view
from cdprlab.errors import InvalidInput
from cdprlab.view.camera import SHADOW, SLACK_COLOR, TENSION_COLORS, Camera, extents, tension_colors

SIZE = 320, 240


@dataclass
class Log:
    """What a view needs of a Run, made without an engine."""

    world: cl.World
    time: Any
    poses: cl.Pose
    reference: cl.Reference
    commanded_tensions: Any
    measured_tensions: Any
    errors: Any
    feasible: Any
    task: str = "default"
    method: str = "quadratic_program"
    cables: str = "tension"


def log(name="caroca", steps=201, dt=0.02):
    """A platform that follows its reference 0.1 mm beside it; steps 50 to 59 are infeasible."""
    world = cl.load_world(name)
    job = world.task()
    time = np.arange(steps) * dt
    reference = job.trajectory()(time)
    d, n, m = world.robot.dimension, world.robot.n_dof, world.robot.n_cables
    poses = cl.Pose.of(reference.pose.position - 1e-4, reference.pose.rotation)
    commanded = 200 + 20 * np.arange(m) + 50 * np.sin(time)[:, None]
    errors = np.concatenate([np.full((steps, min(d, n)), 1e-4), np.full((steps, max(n - d, 0)), 2e-4)], axis=1)
    feasible = (np.arange(steps) < 50) | (np.arange(steps) >= 60)
    return Log(world, time, poses, reference, commanded, commanded + 0.01, errors, feasible)


def planar_world():
    return cl.World.from_dict({
        "name": "plane", "title": "planar robot", "source": "a test", "motion_pattern": "1R2T",
        "platform": {"mass": 10, "inertia": 0.3, "size": [0.4, 0.2], "pose": {"position": [0, 1], "angle": 0}},
        "cable_limits": {"tension": [10, 1000]},
        "cables": [{"exit_point": e, "anchor_point": a} for e, a in
                   (([-2, 0], [-0.2, -0.1]), ([2, 0], [0.2, -0.1]), ([2, 2], [0.2, 0.1]), ([-2, 2], [-0.2, 0.1]))]})


@pytest.fixture(scope="module")
def flown():
    return log()


@pytest.fixture(scope="module")
def camera():
    return Camera(cl.load_world("caroca"))


def near(picture, color, tolerance=25):
    """How many pixels have about that color."""
    return int((np.abs(picture.astype(int) - color).max(axis=-1) <= tolerance).sum())


# --- figures ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("make", [view.plot, view.plot_tracking, view.plot_tensions])
def test_every_axis_names_quantity_and_unit(flown, make):
    for panel in make(flown).axes:
        assert panel.get_ylabel().endswith(("[m]", "[mm]", "[mrad]", "[N]"))
        assert panel.get_title(loc="left")
    assert make(flown).axes[-1].get_xlabel() == "time [s]"


def test_one_commanded_and_one_measured_line_per_cable(flown):
    above, below = view.plot_tensions(flown).axes
    for panel in (above, below):
        lines = [line for line in panel.lines if line.get_label().startswith("cable")]
        assert len(lines) == 8
        assert len({(line.get_color(), line.get_linestyle(), line._dash_pattern[1] is None) for line in lines}) == 8
    measured = [line for line in above.lines if line.get_label().startswith("_measured")]
    assert len(measured) == 8
    np.testing.assert_array_equal(measured[3].get_ydata(), flown.measured_tensions[:, 3])


def test_cables_carry_their_numbers(flown):
    """In the upper panel, whose lines are apart; the lower one says that it is drawn alike."""
    above, below = view.plot_tensions(flown).axes
    assert {text.get_text() for text in above.texts} >= {str(cable) for cable in range(1, 9)}
    assert below.get_title(loc="right") == "cables drawn as above"


def test_end_labels_do_not_overlap(flown):
    figure = view.plot_tensions(flown)
    figure.canvas.draw()
    for panel in figure.axes:
        labels = [text for text in panel.texts if text.get_text().isdigit()]
        bottoms = sorted((text.get_window_extent().y0, text.get_window_extent().y1) for text in labels)
        assert all(after[0] >= before[1] - 2 for before, after in pairwise(bottoms))


def test_a_long_title_stays_inside_the_figure(flown):
    long = replace(flown, world=replace(flown.world, title="a robot with a rather long description " * 3))
    figure = view.plot_tensions(long)
    figure.canvas.draw()
    assert figure._suptitle.get_window_extent().x1 <= figure.bbox.x1


def test_limits_are_drawn_in_range_and_told_off_scale(flown):
    above = view.plot_tensions(flown).axes[0]
    words = " ".join(text.get_text() for text in above.texts)
    assert "50 N" in words
    assert "off scale" in words and "10000 N" in words
    assert above.get_ylim()[1] < 1000


def test_infeasible_steps_are_shaded(flown):
    from cdprlab.view.run_words import infeasible_spans

    assert infeasible_spans(flown) == [pytest.approx((1.0, 1.2))]
    labels = [text.get_text() for text in view.plot_tensions(flown).axes[0].get_legend().get_texts()]
    assert labels == ["commanded", "measured", "infeasible"]


def test_errors_are_in_millimetres_and_milliradians(flown):
    _, position, rotation = view.plot_tracking(flown).axes
    np.testing.assert_allclose(position.lines[0].get_ydata(), 0.1)
    np.testing.assert_allclose(rotation.lines[0].get_ydata(), 0.2)


def test_rounding_is_not_blown_up():
    quiet = log()
    quiet.errors = quiet.errors * 1e-9
    low, high = view.plot_tracking(quiet).axes[1].get_ylim()
    assert low <= -1e-3 and high >= 1e-3


def test_planar_runs_plot_too():
    world, time = planar_world(), np.linspace(0, 1, 30)
    reference = world.task().trajectory()(time)
    tau = np.full((30, 4), 100.0)
    run = Log(world, time, reference.pose, reference, tau, tau, np.zeros((30, 3)), np.ones(30, bool))
    assert [panel.get_ylabel() for panel in view.plot_tracking(run).axes] == [
        "position [m]", "position error [mm]", "rotation error [mrad]"]
    assert len(view.plot(run).axes) == 5


def test_a_description_travels_with_the_file(flown, tmp_path):
    figures = [make(flown) for make in (view.plot, view.plot_tracking, view.plot_tensions)]
    assert all("CAROCA" in figure.alt_text and len(figure.alt_text) > 100 for figure in figures)
    with Image.open(view.save_figure(figures[1], tmp_path / "figure.png")) as picture:
        assert picture.info["Description"] == figures[1].alt_text


def test_figures_show_themselves_in_notebooks(flown):
    assert view.plot_tensions(flown)._repr_png_().startswith(b"\x89PNG")


def test_plot_draws_what_can_draw_itself_and_refuses_the_rest():
    class Table:
        def plot(self):
            return "drawn"

    assert view.plot(Table()) == "drawn"
    with pytest.raises(InvalidInput, match="plot takes a Run"):
        view.plot(42)


def test_drawing_libraries_load_when_first_used():
    code = "import sys, cdprlab.view; print({'matplotlib', 'PIL', 'pybullet'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


# --- pictures -----------------------------------------------------------------------------------------------
def test_a_cables_color_is_its_tension(camera):
    world = camera.world
    blue = camera.picture(world.pose, [1.0] * 8, *SIZE, limits=(0, 100))
    orange = camera.picture(world.pose, [100.0] * 8, *SIZE, limits=(0, 100))
    low, high = TENSION_COLORS[0], TENSION_COLORS[-1]
    assert near(blue, low) > 200 and near(orange, high) > 200
    assert near(blue, high) == 0 and near(orange, low) < 10
    assert blue.shape == (240, 320, 3) and blue.dtype == np.uint8


def test_slack_and_cut_cables_are_grey_and_dashed(camera):
    taut = camera.picture(camera.world.pose, [100.0] * 8, *SIZE, limits=(0, 100))
    slack = camera.picture(camera.world.pose, [0.0, np.nan] * 4, *SIZE, limits=(0, 100))
    assert near(slack, TENSION_COLORS[-1]) == 0
    assert 0 < near(slack, SLACK_COLOR, 12) < 0.8 * near(taut, TENSION_COLORS[-1])


def test_colors_follow_the_scale_and_stay_on_it():
    colors = tension_colors([-5.0, 1e-6, 50.0, 100.0, 1e9, np.nan], (0.0, 100.0))
    assert tuple(colors[0]) == tuple(colors[5]) == SLACK_COLOR
    assert tuple(colors[1]) == TENSION_COLORS[0]
    assert tuple(colors[3]) == tuple(colors[4]) == TENSION_COLORS[-1]


def test_tension_colors_stand_out_from_paper():
    def luminance(color):
        linear = (np.array(color) / 255) ** 2.2
        return float(linear @ [0.2126, 0.7152, 0.0722])

    values = [luminance(color) for color in TENSION_COLORS]
    assert values == sorted(values)
    assert 1.05 / (values[-1] + 0.05) > 2


def test_a_wall_hides_the_cables_behind_it():
    document = cl.load_world("caroca").to_dict()
    wall = {"position": [0, -1.95, 1.75], "size": [7, 0.02, 3.5]}
    seen, hidden = (Camera(cl.World.from_dict({**document, "scene": {**document["scene"], "obstacles": walls}}))
                    for walls in ([], [wall]))
    pictures = [camera.picture(camera.world.pose, [100.0] * 8, *SIZE, limits=(0, 100)) for camera in (seen, hidden)]
    counts = [near(picture, TENSION_COLORS[-1]) for picture in pictures]
    assert counts[1] < 0.5 * counts[0]


def test_the_shadow_lies_straight_below_the_platform(camera):
    pose = cl.Pose([0, 0, 1.6], rpy=[0, 0, 0.5])
    picture = camera.picture(pose, [np.nan] * 8, *SIZE)
    corners = pose.position + np.array([[x, y, 0] for x in (-0.6, 0.6) for y in (-0.3, 0.3)]) @ pose.rotation.T
    shadow = camera.project(corners * [1, 1, 0], *SIZE)
    x, y = (shadow[[0, 1, 3, 2]]).T
    area = abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2
    (left, top), (right, bottom) = np.floor(shadow.min(axis=0)).astype(int), np.ceil(shadow.max(axis=0)).astype(int)
    assert near(picture[top:bottom, left:right], SHADOW, 8) == pytest.approx(area, rel=0.12)


@pytest.mark.parametrize("name", cl.world_names())
@pytest.mark.parametrize("size", [(320, 240), (200, 300)])
def test_the_whole_robot_is_in_the_picture(name, size):
    world = cl.load_world(name)
    if world.robot.dimension != 3:
        pytest.skip("planar")
    camera, corners = Camera(world), extents(world)
    box = np.stack(np.meshgrid(*corners.T), axis=-1).reshape(-1, 3)
    places = np.concatenate([world.robot.exit_points, world.pose.position[None]])
    pixels = camera.project(places, *size)
    assert (pixels >= 0).all() and (pixels <= size).all()
    spread = np.ptp(camera.project(box, *size), axis=0) / size
    assert spread.max() > 0.8  # and it fills the picture


def test_cameras_are_deterministic_and_independent(camera):
    tensions = np.linspace(50, 500, 8)
    first = camera.picture(camera.world.pose, tensions, *SIZE)
    others = [Camera(cl.load_world("caroca")) for _ in range(3)]
    others[0].picture(cl.Pose([0, 0, 2]), tensions, 100, 80)
    for other in others:
        np.testing.assert_array_equal(other.picture(camera.world.pose, tensions, *SIZE), first)
        other.close()
        other.close()
    np.testing.assert_array_equal(camera.picture(camera.world.pose, tensions, *SIZE), first)


def test_the_picture_follows_the_platform(camera):
    pictures = [camera.picture(cl.Pose([x, 0, 1]), [100.0] * 8, *SIZE) for x in (-1, 1)]
    assert (pictures[0] != pictures[1]).any(axis=-1).sum() > 1000


@pytest.mark.parametrize("place", [[0, 0, 1e4], [30, -60, 30], [0, 0, -50]])
def test_a_robot_gone_astray_does_no_harm(camera, place):
    assert camera.picture(cl.Pose(place), [100.0] * 8, *SIZE).shape == (240, 320, 3)


def test_the_camera_refuses_what_it_cannot_draw(camera):
    with pytest.raises(InvalidInput, match="planar"):
        Camera(planar_world())
    with pytest.raises(InvalidInput, match="16 x 16"):
        camera.picture(camera.world.pose, [1.0] * 8, 4, 4)


# --- films --------------------------------------------------------------------------------------------------
def test_a_film_is_an_animated_gif_below_3_mb(flown, tmp_path):
    path = view.save_film(flown, tmp_path / "film.gif", seconds=1.5, fps=8, width=240)
    with Image.open(path) as film:
        assert film.format == "GIF" and film.n_frames > 10 and film.info["loop"] == 0
        first = np.asarray(film.convert("RGB"))
        film.seek(film.n_frames - 1)
        assert (first != np.asarray(film.convert("RGB"))).any()
    assert 1000 < path.stat().st_size < 3_000_000


def test_a_film_that_would_be_too_large_is_made_smaller(flown, tmp_path, monkeypatch):
    import cdprlab.view.film as film

    full = view.save_film(flown, tmp_path / "full.gif", seconds=2, fps=6, width=200).stat().st_size
    monkeypatch.setattr(film, "LARGEST_FILE", full // 2)
    assert view.save_film(flown, tmp_path / "small.gif", seconds=2, fps=6, width=200).stat().st_size < full // 2


def test_a_still_has_a_description(flown, tmp_path):
    with Image.open(view.still(flown, tmp_path / "still.png", t=1.0)) as picture:
        assert picture.width == 960 and "t = 1.00 s" in picture.info["Description"]


def test_bad_paths_and_lengths_are_named(flown, tmp_path):
    with pytest.raises(InvalidInput, match=r"end in \.gif"):
        view.save_film(flown, tmp_path / "film.mp4")
    with pytest.raises(InvalidInput, match="no folder"):
        view.save_film(flown, tmp_path / "nowhere" / "film.gif")
    with pytest.raises(InvalidInput, match="positive length"):
        view.save_film(flown, tmp_path / "film.gif", seconds=0)
    with pytest.raises(InvalidInput, match="no folder"):
        view.save_figure(view.plot_tracking(flown), tmp_path / "nowhere" / "figure.png")
