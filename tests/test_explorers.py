"""Explorers answer at every end of every range, tell the library's numbers, and hide no mistake."""

import io
import itertools
import subprocess
import sys

import ipywidgets
import numpy as np
import pytest
from PIL import Image

import cdprlab as cl
from cdprlab import course
from cdprlab.course import Choice, Explorer, Slider, play, pose_explorer, run_player
from cdprlab.course.explorers.posing import ROW_NAMES
from cdprlab.course.explorers.since_start import with_changes
from cdprlab.errors import InvalidInput
from cdprlab.run.log import text_table
from cdprlab.view.drawing import RobotDrawing
from cdprlab.view.projection import Projection
from robots import ROBOTS

SUBJECTS = {**ROBOTS, **{name: (lambda name=name: cl.load_world(name)) for name in cl.world_names()}}
every_subject = pytest.mark.parametrize(
    "name", [name if k % 2 == 0 else pytest.param(name, marks=pytest.mark.long) for k, name in enumerate(SUBJECTS)])


class Spring(Explorer):
    """The example of a lesson: force over extension; the student's function may fail."""

    def __init__(self, force=lambda x: 100 * x):
        self.force = force
        super().__init__([Slider("x", "extension", "m", -1.0, 1.0, 0.5), Choice("kind", "kind", ["steel", "rubber"])],
                         title="A spring")

    def build(self, figure):
        axes = figure.subplots()
        axes.set(xlim=(-1, 1), ylim=(-100, 100), xlabel="extension [m]", ylabel="force [N]")
        self.dot, = axes.plot([0], [0], "o", animated=True)
        self.axes = axes

    def numbers(self, values):
        return {"force [N]": f"{self.force(values['x']):.1f}", "kind": values["kind"]}

    def draw(self, values):
        self.dot.set_data([values["x"]], [self.force(values["x"])])


class LateMistake(Spring):
    """Fails while drawing, below zero."""

    def draw(self, values):
        if values["x"] < 0:
            raise ZeroDivisionError("no negative extension")
        super().draw(values)


def pixels(explorer):
    with Image.open(io.BytesIO(explorer.picture)) as picture:
        return np.asarray(picture.convert("RGB")).astype(int)


def numbers_in(line):
    """The numbers of a table's line, its label left out."""
    return [float(word) for word in line.split("]")[-1].split() if word.replace(".", "").replace("-", "").isdigit()]


def kinematic_run(world, steps=41, dt=0.05):
    """A run made without an engine: poses on the reference, tensions that differ cable by cable."""
    robot, time = world.robot, np.arange(steps) * dt
    reference = world.task().trajectory()(time)
    m, n = robot.n_cables, robot.n_dof
    tau = 200 + 20 * np.arange(m) + 50 * np.sin(time)[:, None]
    errors = np.full((steps, n), 1e-4)
    full = 3 if robot.dimension == 2 else 6
    return cl.Run(world, "default", "quadratic_program", "tension", time, reference.pose, np.zeros((steps, full)),
                  reference, tau, tau + 1.0, cl.cable_lengths(robot, reference.pose), errors,
                  np.arange(steps) < steps // 2, 1.0, dt, dt, {})


def planar_world():
    return cl.World.from_dict({
        "name": "plane", "title": "planar robot", "source": "a test", "motion_pattern": "1R2T",
        "platform": {"mass": 10, "inertia": 0.3, "size": [0.4, 0.2], "pose": {"position": [0, 1], "angle": 0}},
        "cable_limits": {"tension": [10, 1000]},
        "cables": [{"exit_point": e, "anchor_point": a} for e, a in
                   (([-2, 0], [-0.2, -0.1]), ([2, 0], [0.2, -0.1]), ([2, 2], [0.2, 0.1]), ([-2, 2], [-0.2, 0.1]))],
        "tasks": {"default": {"kind": "quintic", "to": {"position": [0.5, 1.2], "angle": 0.3}, "duration": 2.0}}})


RUNS = {"planar": planar_world, "caroca": lambda: cl.load_world("caroca")}


def extremes(explorer, count, seed):
    """Both ends of every slider, the corners all low and all high, and random values."""
    sliders = {name: control for name, control in explorer.controls.items() if isinstance(control, Slider)}
    for name, slider in sliders.items():
        yield from ({name: slider.low}, {name: slider.high})
    yield {name: slider.low for name, slider in sliders.items()}
    yield {name: slider.high for name, slider in sliders.items()}
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield {name: float(rng.uniform(slider.low, slider.high)) for name, slider in sliders.items()}


# --- the base ---------------------------------------------------------------------------------------------------
def test_every_widget_is_what_its_name_says():
    """And no file of the folder hides the function it is imported for."""
    for name in 2 * course.__all__:  # the first time imports the file
        assert callable(getattr(course, name, None)) or not name.endswith(("explorer", "player", "designer")), name
    with pytest.raises(AttributeError, match="pose_explorer"):
        _ = course.pose_explorr


def test_widgets_load_when_first_used():
    code = "import sys; from cdprlab import course; print({'ipywidgets', 'matplotlib', 'k3d'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_a_move_changes_picture_text_and_description():
    spring = Spring()
    before = pixels(spring)
    spring.set(x=-0.25)
    assert (pixels(spring) != before).any()
    assert spring.text == "force [N]  -25.0\nkind       steel"
    assert "extension [m] -0.25" in spring.alt_text and f'alt="{spring.alt_text}"' in spring.image.value
    spring.set(x=0.5)
    np.testing.assert_array_equal(pixels(spring), before)  # nothing of the way there is left behind


def test_the_dot_is_where_the_numbers_say():
    spring = Spring()
    for x in (-0.9, 0.0, 0.7):
        spring.set(x=x)
        blue = np.argwhere(np.abs(pixels(spring) - [31, 119, 180]).max(axis=-1) < 40).mean(axis=0)[::-1]
        place = spring.axes.transData.transform((x, 100 * x))
        np.testing.assert_allclose(blue, [place[0], pixels(spring).shape[0] - place[1]], atol=1.0)  # one pixel


class Adding(Spring):
    """Its marks are made anew at every move, and beyond 0.8 its axes are longer."""

    def draw(self, values):
        super().draw(values)
        self.axes.plot([values["x"]], [-50], "s", color="red")
        if values["x"] < -0.8:
            raise ZeroDivisionError("no such extension")
        self.axes.set_xlim(-1, 2 if values["x"] > 0.8 else 1)


def test_what_a_move_adds_is_gone_before_the_next():
    adding = Adding()
    before, children = pixels(adding), len(adding.axes.get_children())
    adding.set(x=-0.25)
    assert (pixels(adding) != before).any()
    with pytest.raises(ZeroDivisionError):
        adding.set(x=-0.9)
    adding.set(x=0.9)      # other limits: what stands still is drawn anew
    adding.set(x=0.5)
    np.testing.assert_array_equal(pixels(adding), before)
    assert len(adding.axes.get_children()) == children


def test_what_a_move_adds_leaves_the_rest_as_it_was_drawn(monkeypatch):
    adding, drawn = Adding(), []
    monkeypatch.setattr(type(adding.axes), "draw", lambda self, renderer: drawn.append(self))
    adding.set(x=0.25)
    assert not drawn
    adding.set(x=0.9)
    assert drawn == [adding.axes]


def test_what_is_not_animated_is_drawn_too():
    spring = Spring()
    before = pixels(spring)
    spring.axes.set_xlim(-2, 2)
    spring.set(x=0.5)
    assert (pixels(spring) != before).any()


def test_moves_from_the_browser_answer_too():
    spring = Spring()
    spring.sliders["x"].set_state({"value": 0.75})
    assert spring.values["x"] == 0.75 and "75.0" in spring.text
    spring.sliders["kind"].value = "rubber"
    assert "rubber" in spring.text


def test_several_sliders_at_once_are_one_answer():
    spring, calls = Spring(), []
    end = spring.on_move(calls.append)
    spring.set(x=0.1, kind="rubber")
    assert calls == [{"x": 0.1, "kind": "rubber"}]
    end()
    end()
    spring.set(x=0.2)
    assert len(calls) == 1


@pytest.mark.parametrize("move", [lambda e: e.set(x=-0.5), lambda e: e.sliders["x"].set_state({"value": -0.5})],
                         ids=["from code", "from the browser"])
def test_a_mistake_is_raised_and_shown_and_forgotten(move):
    spring = LateMistake()
    picture = spring.picture
    with pytest.raises(ZeroDivisionError, match="no negative extension"):
        move(spring)
    assert spring.text == "ZeroDivisionError: no negative extension"
    assert "ZeroDivisionError: no negative extension" in spring.mistake.value and spring.picture == picture
    spring.set(x=0.3)
    assert spring.mistake.value == "" and "30.0" in spring.text and spring.picture != picture


def test_mistakes_in_numbers_and_callbacks_come_through():
    def student(x):
        if x > 0.8:
            raise NotImplementedError("write the force law")
        return x

    spring = Spring(student)
    with pytest.raises(NotImplementedError, match="write the force law"):
        spring.set(x=0.9)
    spring.on_move(lambda values: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        spring.set(x=0.1)
    assert "ZeroDivisionError" in spring.text
    with pytest.raises(NotImplementedError, match="my part"):
        Spring(lambda x: (_ for _ in ()).throw(NotImplementedError("my part")))


def test_a_mistakes_text_is_no_html():
    def student(x):
        raise ValueError("<b>bold</b>")

    spring = Spring()
    spring.force = student
    with pytest.raises(ValueError, match="bold"):
        spring.set(x=0.1)
    assert "&lt;b&gt;" in spring.mistake.value


@pytest.mark.parametrize(("values", "words"), [
    ({"y": 1}, "no control 'y'; there are x, kind"), ({"x": 1.5}, "between -1 and 1 m, got 1.5"),
    ({"x": float("nan")}, "x must be finite"), ({"x": "far"}, "x must be a number"),
    ({"kind": "wood"}, "one of steel, rubber")])
def test_values_that_cannot_be_are_named(values, words):
    spring = Spring()
    with pytest.raises(InvalidInput, match=words):
        spring.set(**values)
    assert spring.values == {"x": 0.5, "kind": "steel"}


@pytest.mark.parametrize("numbers", [(1.0, 0.0, 0.5), (0.0, 1.0, 2.0), (0.0, float("nan"), 0.0), (0.0, 0.0, 0.0)])
def test_sliders_need_a_range_that_holds_their_start(numbers):
    with pytest.raises(InvalidInput, match=r"slider 'x'|must be a number"):
        Slider("x", "x", "m", *numbers)
    with pytest.raises(InvalidInput, match="same name"):
        Explorer([Slider("x", "x", "m", 0, 1, 0)] * 2)


def test_an_unfinished_explorer_says_what_is_missing():
    with pytest.raises(NotImplementedError, match=r"build\(figure\)"):
        Explorer([])


def test_sliders_answer_while_moving_and_show_unit_and_number():
    spring = Spring()
    slider, entry = spring.sliders["x"], spring.entries["x"]
    assert slider.continuous_update and slider.description == entry.tooltip == "extension [m]"
    assert slider.step == entry.step == pytest.approx(0.02) and entry.value == 0.5
    slider.set_state({"value": 0.1 + 0.2})
    assert entry.value == spring.values["x"] == 0.3   # no 0.30000000000000004


def test_what_is_typed_is_taken_as_typed():
    spring = Spring()
    spring.entries["x"].set_state({"value": 0.0512})
    assert spring.values["x"] == 0.0512 and "5.1" in spring.text
    assert spring.sliders["x"].value == pytest.approx(0.06)   # the mark beside it
    spring.set(x=1 / 3)
    assert spring.values["x"] == 1 / 3


def test_a_typed_value_out_of_range_is_put_back_with_the_reason():
    spring = Spring()
    picture = spring.picture
    spring.entries["x"].set_state({"value": 7.0})
    assert spring.values["x"] == spring.entries["x"].value == 0.5 and spring.picture == picture
    assert "between -1 and 1 m, got 7" in spring.mistake.value
    spring.entries["x"].set_state({"value": 0.7})
    assert spring.mistake.value == "" and spring.values["x"] == 0.7


def test_reset_goes_back_to_what_was_first_shown():
    spring = Spring()
    spring.set(x=0.25)
    spring._repr_mimebundle_()   # shown
    picture = spring.picture
    spring.set(x=-0.75, kind="rubber")
    assert "(-100.0)" in spring._numbers.value
    spring.reset()
    assert spring.values == {"x": 0.25, "kind": "steel"} and spring.picture == picture
    assert "<i>" not in spring._numbers.value


def test_changes_stand_beside_or_below_their_numbers():
    start = "length [m]  1.00  2.00  3.00\nmass  4\n1: A12 → A34: score 4\nnorm  2.0e-14\nAt 5 N it holds 3 %."
    now = "length [m]  1.25  2.00  2.50\nmass  4\n1: A12 → A34: score 6\nnorm  1.0e-14\nAt 7 N it holds 3 %."
    assert with_changes(now, start).splitlines() == [
        "length [m]  1.25  2.00  2.50", "<i>           +0.25       -0.50</i>", "mass  4",
        "1: A12 → A34: score 6", "<i>                   +2</i>", "norm  1.0e-14<i>  (-1.0e-14)</i>",
        "At 7 N it holds 3 %."]
    assert with_changes(start, start) == start
    assert "<i>" not in with_changes("slack  none", "slack  cable 2")


def test_closing_leaves_nothing_behind():
    living = ipywidgets.widgets.widget._instances
    before = set(living)
    makers = (Spring, lambda: pose_explorer(ROBOTS["1R2T"]()),
              lambda: run_player(kinematic_run(cl.load_world("caroca"))))
    for make in makers:
        explorer = make()
        explorer.close()
        explorer.close()
        assert set(living) == before
        assert set(explorer._repr_mimebundle_()) == {"text/plain"}


def test_notebooks_get_the_widget_and_its_numbers():
    spring = Spring()
    bundle = spring._repr_mimebundle_()
    assert bundle["application/vnd.jupyter.widget-view+json"]["model_id"] == spring.widget.model_id
    assert "force [N]  50.0" in bundle["text/plain"]


def test_tables_align():
    lines = text_table(["cable", "1", "20"], [["l", "1.5", "-22.25"]]).splitlines()
    assert [len(line) for line in lines] == [len(lines[1])] * 2
    assert lines[1].startswith("l ") and lines[1].endswith("-22.25")


# --- projection and drawing ---------------------------------------------------------------------------------------
@pytest.mark.parametrize("azimuth", [-180.0, -70.0, 0.0, 25.0, 90.0])
def test_points_on_a_line_of_sight_coincide_in_the_picture(azimuth):
    rng = np.random.default_rng(3)
    view = Projection(rng.uniform(-1, 1, (9, 3)), azimuth)
    points = rng.uniform(-1, 1, (5, 3))
    nearer = points + 0.3 * (view.eye - points)
    np.testing.assert_allclose(view.flat(nearer), view.flat(points), atol=1e-12)


def test_up_is_up_and_x_goes_right_from_the_front():
    view = Projection(np.array([[-1.0, -1, -1], [1, 1, 1]]), azimuth=0.0)
    right, up = view.flat(np.array([[0.5, 0, 0], [0, 0, 0.5]]))
    assert right[0] > 0.4 and abs(right[1]) < 1e-12 and up[1] > 0.4 and abs(up[0]) < 1e-12


def test_the_whole_robot_stays_in_the_picture():
    for name, make in SUBJECTS.items():
        explorer = pose_explorer(make())
        drawing = explorer.drawing
        (left, right), (bottom, top) = drawing.axes.get_xlim(), drawing.axes.get_ylim()
        for azimuth in ([-180.0, -60.0, 100.0] if "azimuth" in explorer.controls else [0.0]):
            drawing.turn(azimuth)
            x, y = drawing.view.flat(drawing.points).T
            assert left < x.min() and x.max() < right and bottom < y.min() and y.max() < top, (name, azimuth)


def test_cables_are_drawn_from_exit_to_anchor():
    for make in ROBOTS.values():
        robot = make()
        explorer = pose_explorer(robot)
        drawing = explorer.drawing
        ends = np.array(drawing.cables.get_segments())[:, [0, -1]]
        np.testing.assert_allclose(ends[:, 0], drawing.view.flat(robot.exit_points))
        anchors = explorer.pose.position + robot.anchor_points @ explorer.pose.rotation.T
        np.testing.assert_allclose(ends[:, 1], drawing.view.flat(anchors))
        assert [text.get_text() for text in drawing.numbers] == [str(k + 1) for k in range(robot.n_cables)]


def test_numbers_of_cables_do_not_overlap_at_the_start():
    for name in cl.world_names():
        drawing: RobotDrawing = pose_explorer(cl.load_world(name)).drawing
        places = drawing.axes.transData.transform([text.get_position() for text in drawing.numbers])
        for one, other in itertools.combinations(places, 2):
            assert np.abs(one - other).max() > 9, name  # pixels: a digit of 10 pt is about 8 wide and 10 high


# --- the pose explorer --------------------------------------------------------------------------------------------
@every_subject
def test_lengths_and_wrench_matrix_are_the_librarys_at_every_end(name):
    explorer = pose_explorer(SUBJECTS[name]())
    robot, pictures = explorer.robot, set()
    for values in extremes(explorer, 3, seed=1):
        explorer.set(**values)
        pose = explorer.pose
        lines = explorer.text.splitlines()
        np.testing.assert_allclose(numbers_in(lines[1]), cl.cable_lengths(robot, pose), atol=5.1e-4)  # 3 decimals
        for line, name, row in zip(lines[4:], robot.pattern.rows, cl.wrench_matrix(robot, pose)):
            label = ROW_NAMES[name]
            assert line.startswith(label)
            np.testing.assert_allclose(numbers_in(line.removeprefix(label)), row, atol=5.1e-3)  # 2 decimals
        pictures.add(explorer.picture)
    assert len(pictures) > 4
    explorer.close()


@every_subject
def test_each_slider_moves_its_motion_and_the_picture(name):
    explorer = pose_explorer(SUBJECTS[name]())
    start, first = explorer.pose, explorer.values
    motions = {"x": 0, "y": 1, "z": 2}
    for name, slider in explorer.controls.items():
        before = explorer.picture
        explorer.set(**{name: slider.high if first[name] < slider.high else slider.low})
        assert explorer.picture != before
        moved = explorer.pose.position - start.position
        if name in motions:
            assert np.flatnonzero(np.abs(moved) > 1e-9).tolist() == [motions[name]]
            np.testing.assert_array_equal(explorer.pose.rotation, explorer.posing.pose(first).rotation)
        else:
            np.testing.assert_array_equal(moved, 0)
        explorer.set(**first)
    explorer.close()


def test_turns_are_in_degrees_and_fixed_axes():
    explorer = pose_explorer(ROBOTS["3R3T"]())
    explorer.set(roll=10.0, pitch=-20.0, yaw=30.0)
    np.testing.assert_allclose(np.rad2deg(explorer.pose.rpy), [10, -20, 30])
    planar = pose_explorer(ROBOTS["1R2T"]())
    planar.set(angle=-45.0)
    np.testing.assert_allclose(np.rad2deg(planar.pose.angle), -45)


def test_motions_without_a_slider_stay():
    start = cl.Pose([0.1, 0.2, 1.0], rpy=[0.3, 0.1, -0.2])
    explorer = pose_explorer(ROBOTS["2R3T"](), start)
    assert list(explorer.controls) == ["x", "y", "z", "pitch", "yaw", "azimuth"]
    np.testing.assert_allclose(explorer.pose.rotation, start.rotation, atol=1e-12)
    explorer.set(yaw=40.0)
    np.testing.assert_allclose(explorer.pose.rpy[0], 0.3)
    assert list(pose_explorer(ROBOTS["1T"]()).controls) == ["x"]


def test_a_start_beyond_the_range_widens_it():
    explorer = pose_explorer(ROBOTS["3R3T"](), cl.Pose([0, 0, 5.0], rpy=[1.3, 0, 0]))
    np.testing.assert_allclose(explorer.pose.position, [0, 0, 5.0])
    assert explorer.controls["z"].high >= 5.0 and explorer.controls["roll"].high >= np.rad2deg(1.3)


def test_a_cable_without_length_is_told():
    robot = ROBOTS["3T"]()
    explorer = pose_explorer(robot, cl.Pose(robot.exit_points[2]))
    assert "Cable 3 has no length" in explorer.text
    explorer.set(z=1.0)
    assert "f_x" in explorer.text


@pytest.mark.parametrize(("subject", "start"), [
    ("caroca", None), (ROBOTS["2T"], None), (ROBOTS["2T"](), cl.Pose([0, 0, 1])), (ROBOTS["2T"](), "here"),
    (ROBOTS["2T"](), cl.Pose(np.zeros((3, 2))))])
def test_pose_explorer_refuses_what_it_cannot_show(subject, start):
    with pytest.raises(InvalidInput, match=r"takes a World or a Robot|single planar Pose"):
        pose_explorer(subject, start)


# --- the player -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", RUNS)
def test_the_player_tells_the_run_in_text(name):
    run = kinematic_run(RUNS[name]())
    player = run_player(run)
    assert player.run is run and all(value in player.text for value in run.table().values())
    assert f"{run.world.robot.n_cables} cables" in player.alt_text and "2.00 s" in player.alt_text
    player.close()


def test_states_of_an_engine_play_too():
    world = planar_world()
    with cl.open_simulator(world) as engine:
        states = []
        for _ in range(5):
            engine.step(np.full(4, 200.0))
            states.append(engine.state())
    player = play({"before": states[:2], "now": states[2:]}, title="By hand")
    assert "By hand" in player.alt_text and player.alt_text.endswith(" before. now.")
    assert '"notes": ["before", "before", "now", "now", "now"]' in player.scene.plot.additional_js_code
    assert (np.diff(player.scene.times) > 0).all() and player.scene.states[2].position is states[2].position
    player.close()


@pytest.mark.parametrize("what", [42, "caroca", [1, 2]])
def test_the_player_refuses_what_it_cannot_play(what):
    with pytest.raises(InvalidInput, match="takes a Run or a list of engine states"):
        run_player(what)
