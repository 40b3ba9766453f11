"""Figures say what they show, pictures show the cables, films open anywhere."""

import subprocess
import sys
from dataclasses import dataclass, replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

import cdprlab as cl
from cdprlab import view
from cdprlab.errors import InvalidInput
from cdprlab.view.depth import Blocks
from cdprlab.view.drawing import RobotDrawing
from cdprlab.view.outlines import box_corners
from cdprlab.view.picture import Picture
from cdprlab.view.screen import robot_axes, sized_figure
from cdprlab.view.style import (
    BOX,
    LOAD,
    SHADOW,
    SLACK_COLOR,
    TENSION_COLORS,
    house_style,
    tension_colors,
    tension_limits,
)

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
    commanded_lengths: Any = None
    base_poses: Any = None

    @property
    def estimates(self) -> cl.Pose:
        return self.poses   # no sensors: what was is what was seen

    @property
    def twists(self) -> Any:
        return self.reference.twist

    def robot_at(self, index: int) -> cl.Robot:
        return self.world.robot

    def boxes_at(self, index: int) -> tuple[()]:
        return ()


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
    for panel in view.plot_tensions(flown).axes:
        (shade,) = panel.collections
        left, right = shade.get_paths()[0].vertices[:, 0].min(), shade.get_paths()[0].vertices[:, 0].max()
        assert len(shade.get_paths()) == 1 and (left, right) == pytest.approx((1.0, 1.2))
        assert shade.get_linewidth()[0] > 0   # a single step is seen, too
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
def solid_drawing(world, size=SIZE):
    """A robot as stills and films show it, and its picture."""
    figure = sized_figure(*size)
    with house_style():
        axes = robot_axes(figure, world.robot.dimension)
        drawing = RobotDrawing(axes, world.robot, world.scene, world.pose, solid=True)
    drawing.limits = (0.0, 100.0)
    return drawing, Picture(figure)


def picture_of(world, tensions, size=SIZE, pose=None, **shown):
    drawing, picture = solid_drawing(world, size)
    if "robot" in shown:
        drawing.drive(shown.pop("robot"))
    drawing.move(world.pose if pose is None else pose, tensions, **shown)
    with house_style():
        return picture.pixels()


def pixels_of(drawing, points):
    """(k, 2) x to the right and y down [pixels]."""
    places = drawing.axes.transData.transform(drawing.view.flat(np.asarray(points, dtype=float)))
    return np.abs(places - [0, drawing.axes.figure.bbox.height])


def state_of(world, tensions, pose=None, **more):
    """What `draw` needs of an engine's state."""
    more = {"scene": world.scene, "rope_lengths": None, "boxes": ()} | more
    return SimpleNamespace(robot=world.robot, pose=world.pose if pose is None else pose, tensions=np.asarray(tensions),
                           **more)


@pytest.mark.parametrize("angle", [0, 90, 37])
@pytest.mark.parametrize("words", ["Force f_x [N]", "$\\tau_\\mathrm{max}$", "two\nlines, ggg"])
def test_words_kept_are_where_matplotlib_draws_them(words, angle):
    figures = [Figure((3.0, 3.0), dpi=110) for _ in range(2)]
    for figure in figures:
        figure.text(0.503, 0.487, words, rotation=angle, color="#D55E00", alpha=0.8, ha="center")
    canvas = FigureCanvasAgg(figures[0])
    canvas.draw()
    plain = 255.0 - np.asarray(canvas.buffer_rgba())[..., :3]
    picture = Picture(figures[1])
    kept = 255.0 - picture.pixels()
    assert kept.sum() == pytest.approx(plain.sum(), rel=0.03)   # edges fall between pixels otherwise
    centers = [np.array([(ink.sum(axis=(1 - axis, 2)) * np.arange(330)).sum() / ink.sum() for axis in (0, 1)])
               for ink in (plain, kept)]
    assert np.abs(centers[0] - centers[1]).max() < 0.75         # half a pixel either way, and rounding
    figures[1].stale = True
    np.testing.assert_array_equal(255.0 - picture.pixels(), kept)


def test_a_panel_whose_numbers_grew_stays_as_it_was_drawn():
    """At the next move too: wide numbers reach out of their panel, and all is drawn anew."""
    figure = Figure((4.0, 2.0), dpi=80)
    _, right = figure.subplots(1, 2)
    dot, = right.plot([], [], "o", animated=True)
    picture = Picture(figure)
    picture.pixels()
    for top in (1.0, 1e15, 3.0):
        picture.redraw(lambda top=top: right.set(ylim=(0, top)))
        picture.pixels()
        picture.redraw(lambda top=top: dot.set_data([0.5], [top / 2]))
        seen = picture.pixels()
        figure.stale = True
        np.testing.assert_array_equal(picture.pixels(), seen)


@pytest.mark.parametrize("world", [cl.load_world("caroca"), planar_world()], ids=["spatial", "planar"])
def test_a_cables_color_is_its_tension(world):
    m = world.robot.n_cables
    blue, orange = (picture_of(world, [pull] * m) for pull in (1.0, 100.0))
    low, high = TENSION_COLORS[0], TENSION_COLORS[-1]
    assert near(blue, low) > 200 and near(orange, high) > 200
    assert near(blue, high) == 0 and near(orange, low) < 10
    assert blue.shape == (240, 320, 3) and blue.dtype == np.uint8


@pytest.mark.parametrize("world", [cl.load_world("caroca"), planar_world()], ids=["spatial", "planar"])
def test_slack_and_cut_cables_are_grey_and_dashed(world):
    m = world.robot.n_cables
    taut, slack = picture_of(world, [100.0] * m), picture_of(world, [0.0, np.nan] * (m // 2))
    assert near(slack, TENSION_COLORS[-1]) == 0
    grey = near(slack, SLACK_COLOR, 12) - near(taut, SLACK_COLOR, 12)
    assert 0 < grey < 0.8 * near(taut, TENSION_COLORS[-1])


def test_a_slack_rope_hangs_through():
    world = planar_world()
    lengths = cl.cable_lengths(world.robot, world.pose)
    straight, loose = (picture_of(world, [0.0, 9, 9, 9], rope_lengths=more * lengths)
                       for more in (1.0, 1.2))
    assert near(loose, SLACK_COLOR) > near(straight, SLACK_COLOR)


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
    seen, hidden = (cl.World.from_dict({**document, "scene": {**document["scene"], "obstacles": walls}})
                    for walls in ([], [wall]))
    counts = [near(picture_of(world, [100.0] * 8), TENSION_COLORS[-1]) for world in (seen, hidden)]
    assert counts[1] < 0.5 * counts[0]


def boxes_at_random(seed, count=12):
    """Corners of turned boxes that do not run through each other: one in each cell of a grid."""
    rng = np.random.default_rng(seed)
    cells = rng.choice(27, count, replace=False)
    places = np.stack(np.unravel_index(cells, (3, 3, 3)), axis=1) * 1.0
    return np.stack([box_corners(rng.uniform(0.1, 0.55, 3), cl.Pose(place, rpy=rng.uniform(-3, 3, 3)))
                     for place in places])


@pytest.mark.parametrize("seed", range(5))
def test_what_is_hidden_is_what_a_ray_meets(seed):
    """Rays sampled finely against every box; points within the tolerance of a surface are left out."""
    rng = np.random.default_rng(100 + seed)
    corners, eye = boxes_at_random(seed), rng.uniform(4, 8, 3) * rng.choice([-1, 1], 3)
    points = rng.uniform(-0.5, 2.5, (60, 3))
    blocks = Blocks(corners, eye)
    rays = eye + np.linspace(0.3, 1.0, 6001)[:, None, None] * (points - eye)
    depth = (np.einsum("ifx,skx->skif", blocks.normals, rays) - blocks.offsets).max(axis=-1)   # < 0 inside box i
    clear = np.abs(depth.min(axis=(0, 2))) > 0.02
    np.testing.assert_array_equal(blocks.hides(points).any(axis=0)[clear], (depth.min(axis=(0, 2)) < 0)[clear])


@pytest.mark.parametrize("seed", range(5))
def test_boxes_are_painted_from_the_back_to_the_front(seed):
    """Along each line of sight the box painted last is the one met first."""
    corners, eye = boxes_at_random(seed), np.array([7.0, -9.0, 5.0])
    blocks = Blocks(corners, eye)
    painted = np.empty(len(corners), dtype=int)
    painted[blocks.order()] = np.arange(len(corners))
    for point in np.random.default_rng(seed).uniform(-0.5, 2.5, (200, 3)):
        ray = eye + np.linspace(0.3, 1.6, 4001)[:, None] * (point - eye)
        inside = (np.einsum("ifx,sx->sif", blocks.normals, ray) <= blocks.offsets - 1e-9).all(axis=-1)
        met = np.flatnonzero(inside.any(axis=0))
        if len(met):
            assert met[np.argmin(inside[:, met].argmax(axis=0))] == met[np.argmax(painted[met])]


def test_the_shadow_lies_straight_below_the_platform():
    world, pose = cl.load_world("caroca"), cl.Pose([0, 0, 1.6], rpy=[0, 0, 0.5])
    drawing, picture = solid_drawing(world)
    drawing.move(pose, [np.nan] * 8)
    corners = pose.position + np.array([[x, y, 0] for x in (-0.6, 0.6) for y in (-0.3, 0.3)]) @ pose.rotation.T
    shadow = pixels_of(drawing, corners * [1, 1, 0])
    x, y = (shadow[[0, 1, 3, 2]]).T
    area = abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2
    (left, top), (right, bottom) = np.floor(shadow.min(axis=0)).astype(int), np.ceil(shadow.max(axis=0)).astype(int)
    grey = [int(SHADOW[i:i + 2], 16) for i in (1, 3, 5)]
    assert near(picture.pixels()[top:bottom, left:right], grey, 8) == pytest.approx(area, rel=0.15)


@pytest.mark.parametrize("name", cl.world_names())
@pytest.mark.parametrize("size", [(320, 240), (200, 300)])
def test_the_whole_robot_is_in_the_picture(name, size):
    world = cl.load_world(name)
    drawing, picture = solid_drawing(world, size)
    places = pixels_of(drawing, np.concatenate([world.robot.exit_points, world.pose.position[None]]))
    letters = drawing.axes.transData.transform([text.get_position() for text in drawing.axes.texts] or [[0, 0]])
    for shown in (places, pixels_of(drawing, drawing.points), letters):     # bases and the world's axes too
        assert (shown >= 0).all() and (shown <= size).all()
    room = np.array([drawing.axes.bbox.width, drawing.axes.bbox.height])
    assert (np.ptp(pixels_of(drawing, drawing.points), axis=0) / room).max() > 0.8      # and it fills the picture
    drawing.move(world.pose, [100.0] * world.robot.n_cables)
    pixels = picture.pixels()
    assert pixels.shape == (size[1], size[0], 3) and near(pixels, TENSION_COLORS[-1]) > 50


@pytest.mark.parametrize("world", [cl.load_world("caroca"), planar_world()], ids=["spatial", "planar"])
def test_pictures_are_deterministic_and_independent(world):
    tensions = np.linspace(50, 500, world.robot.n_cables)
    first = view.draw(state_of(world, tensions), *SIZE)
    others = [solid_drawing(world) for _ in range(3)]
    others[0][0].move(cl.Pose(world.pose.position + 1.0), tensions, trail=[world.pose.position] * 2)
    again = []
    for drawing, picture in others:
        drawing.limits = tension_limits(world.robot)
        drawing.move(world.pose, tensions)
        with house_style():
            again += [picture.pixels(), picture.pixels()]
    for pixels in [*again, view.draw(state_of(world, tensions), *SIZE)]:
        np.testing.assert_array_equal(pixels, first)


def test_the_picture_follows_platform_and_bases():
    world = cl.load_world("caroca")
    pictures = [picture_of(world, [100.0] * 8, pose=cl.Pose([x, 0, 1])) for x in (-1, 1)]
    assert (pictures[0] != pictures[1]).any(axis=-1).sum() > 1000
    world = cl.load_world("planar_mcdpr")
    moved = world.robot.with_bases({"left": (0.3, 0, 0)})
    pictures = [picture_of(world, [10.0] * 4, robot=robot) for robot in (world.robot, moved)]
    assert (pictures[0] != pictures[1]).any(axis=-1).sum() > 500


def test_a_box_in_the_platform_is_seen():
    world = cl.load_world("fastkit_suspended")
    load = [int(LOAD[i:i + 2], 16) for i in (1, 3, 5)]
    boxes = [(world.pose, np.array([0.2, 0.2, 0.1]))]
    with_box, without = (view.draw(state_of(world, [50.0] * 8, boxes=loads)) for loads in (boxes, ()))
    assert near(with_box, load, 40) > near(without, load, 40) + 20


@pytest.mark.parametrize("place", [[0, 0, 1e4], [30, -60, 30], [0, 0, -50]])
def test_a_robot_gone_astray_does_no_harm(place):
    world = cl.load_world("caroca")
    assert view.draw(state_of(world, [100.0] * 8, cl.Pose(place)), *SIZE).shape == (240, 320, 3)
    assert picture_of(world, [100.0] * 8, pose=cl.Pose(place)).shape == (240, 320, 3)


def test_pictures_that_are_too_small_are_refused():
    for world in (cl.load_world("caroca"), planar_world()):
        with pytest.raises(InvalidInput, match="from 16 to"):
            view.draw(state_of(world, [1.0] * world.robot.n_cables), 4, 4)


def test_an_engines_state_can_be_drawn():
    with cl.open_simulator(cl.load_world("planar_mcdpr")) as engine:
        engine.cut([0])
        engine.step(np.full(4, 20.0))
        picture = view.draw(engine.state(), 320, 240)
    assert picture.shape == (240, 320, 3) and near(picture, SLACK_COLOR) > 20
    with cl.open_simulator(cl.load_world("marionet"), "length") as engine:
        picture = view.draw(engine.state())
    assert near(picture, [int(0.9 * int(BOX[i:i + 2], 16)) for i in (1, 3, 5)]) > 100    # its scene is drawn too


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
    with pytest.raises(InvalidInput, match="seconds must be positive"):
        view.save_film(flown, tmp_path / "film.gif", seconds=0)
    with pytest.raises(InvalidInput, match="no folder"):
        view.save_figure(view.plot_tracking(flown), tmp_path / "nowhere" / "figure.png")
