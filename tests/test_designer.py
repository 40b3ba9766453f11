"""The designer: what was done can be undone, no edit changes more than it says, bad ones change nothing."""

import html
import json

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab import course
from cdprlab.course.designer.assessment import CLEARANCE, PLANES, assess, workspace_slice
from cdprlab.course.designer.edits import contents, edited, opened, value_at, with_entry, without_entry
from cdprlab.course.designer.fields import GROUPS, Place, rows, shown, typed
from cdprlab.course.designer.history import MOST, History, Step
from cdprlab.course.designer.pictures import SlicePicture
from cdprlab.course.designer.session import DesignSession
from cdprlab.errors import CdprError, InvalidInput, WorldError
from cdprlab.workspace.interference import cable_distances

every_world = pytest.mark.parametrize("name", cl.world_names())


def session(name="caroca"):
    return DesignSession(cl.load_world(name))


def refused(work, *entries):
    """What is said of an edit that is refused."""
    with pytest.raises(CdprError) as caught:
        work(*entries)
    return str(caught.value)


def every_field(world):
    """All fields of all groups, cable by cable, base by base."""
    places = [Place(cable, 0) for cable in range(world.robot.n_cables)]
    places += [Place(0, base) for base in range(1, len(world.robot.bases))]
    fields = {field.path: field for group in GROUPS for place in places for row in rows(world, group, place)
              for field in row.fields}
    return list(fields.values())


# --- history ------------------------------------------------------------------------------------------------
def begun_at(state):
    return History((Step("", state),))


def random_history(seed):
    rng, history = np.random.default_rng(seed), begun_at(0)
    for k in range(30):
        able = [0] + [-1] * bool(history.labels[0]) + [1] * bool(history.labels[1])
        by = int(rng.choice(able))
        history = history.moved(by) if by else history.done(f"edit {k}", k + 1)
    return history


@pytest.mark.parametrize("seed", range(5))
def test_undoing_an_edit_and_redoing_it_changes_nothing(seed):
    history = random_history(seed)
    assert history.done("more", -1).moved(-1).present == history.present
    for by, label in zip((-1, 1), history.labels):
        if label:
            assert history.moved(by).moved(-by) == history


def test_all_edits_can_be_undone_to_the_beginning_and_a_new_one_forgets_the_undone():
    history = begun_at(0)
    for k in range(1, 6):
        history = history.done(f"to {k}", k)
    seen = []
    while history.labels[0]:
        seen.append(history.labels[0])
        history = history.moved(-1)
        assert history.labels[1] == seen[-1]
    assert (history.present, seen) == (0, ["to 5", "to 4", "to 3", "to 2", "to 1"])
    with pytest.raises(InvalidInput):
        history.done("other", 9).moved(1)


def test_the_oldest_edits_are_forgotten_first():
    history = begun_at(0)
    for k in range(1, MOST + 3):
        history = history.done(f"to {k}", k)
    assert [step.state for step in history.steps] == [*range(2, MOST + 3)]
    assert history.moved(-MOST).present == 2


@pytest.mark.parametrize("by", [-1, 1])
def test_nothing_to_undo_is_said(by):
    with pytest.raises(InvalidInput, match="nothing to"):
        begun_at(0).moved(by)


# --- world files --------------------------------------------------------------------------------------------
@every_world
def test_opening_and_saving_a_shipped_world_keeps_its_meaning_and_comments(name, tmp_path):
    world = cl.load_world(name)
    begun = DesignSession(world)
    begun.save(str(tmp_path / "saved.yaml"))
    again = cl.load_world(tmp_path / "saved.yaml")
    assert contents(begun.world) == contents(world) == contents(again)
    assert world.to_dict() == again.to_dict()
    assert world.to_yaml() == again.to_yaml()


@every_world
def test_every_field_written_back_as_it_is_changes_no_meaning(name):
    world = opened(cl.load_world(name))
    before = contents(world)
    fields = every_field(world)
    assert all(typed(world, field, shown(field, world)) is world for field in fields)
    for field in fields[::3]:
        value = value_at(world, field.path)
        if shown(field, world) != "":
            assert contents(edited(world, field.path, value)) == before, field.path


@every_world
def test_an_edited_number_changes_that_number_and_nothing_else(name):
    world = opened(cl.load_world(name))
    moved = [field for field in every_field(world)
             if field.kind == "number" and not {"cable_limits", "inertia"} & set(field.path)]
    for field in moved[::7]:
        old = value_at(world, field.path)
        new = edited(world, field.path, old + 0.001)
        expected = json.loads(json.dumps(contents(world)))
        node = expected
        for part in field.path[:-1]:
            node = node[part]
        node[field.path[-1]] = old + 0.001
        found = contents(new)
        assert found.pop("title") == expected.pop("title") + " (changed)"
        if field.path[0] == "platform" and field.path[1] in ("mass", "size"):
            expected["platform"]["inertia"] = found["platform"]["inertia"]  # of a uniform box, if left out
        if field.path[:2] == ("cables", 0):
            expected["cable_limits"] = found["cable_limits"]  # shown there are the first cable's
        if field.path[-1] == "yaw" or "rpy" in field.path or "pose" in field.path:
            np.testing.assert_allclose(value_at(new, field.path), old + 0.001, atol=1e-12)
            continue
        assert found == expected, field.path


def test_comments_of_the_file_survive_edits():
    begun = session()
    begun.edit(("platform", "mass"), 160.0)
    begun.edit(("cables", 3, "exit_point", 2), 3.25)
    comments = [line.split("#", 1)[1] for line in cl.load_world("caroca").to_yaml().splitlines() if "#" in line]
    # A number that is not the source's any more does not claim to be.
    comments[comments.index(" kg, source")] = " changed; before: kg, source"
    assert [line.split("#", 1)[1] for line in begun.world.to_yaml().splitlines() if "#" in line] == comments


def test_an_edit_leaves_the_world_it_came_from_alone():
    world = opened(cl.load_world("fastkit_suspended"))
    before = world.to_yaml()
    edited(world, ("cables", 0, "tension", 1), 77.0)
    with_entry(world, "cables", contents(world)["cables"][0])
    without_entry(world, "cables", 2)
    assert world.to_yaml() == before


def test_a_limit_for_all_cables_holds_for_those_that_had_their_own():
    world = edited(opened(cl.load_world("caroca")), ("cables", 1, "tension", 1), 500.0)
    assert world.robot.tension_max[1] == 500.0
    assert set(edited(world, ("cable_limits", "tension", 1), 900.0).robot.tension_max) == {900.0}


def test_the_first_cables_limit_typed_again_for_all_holds_for_all():
    world = edited(opened(cl.load_world("caroca")), ("cables", 1, "tension", 1), 500.0)
    first = value_at(world, ("cable_limits", "tension", 1))
    assert set(edited(world, ("cable_limits", "tension", 1), first).robot.tension_max) == {first}


@pytest.mark.parametrize("name", ["planar_mcdpr", "mobile_four_bases", "fastkit_suspended"])
def test_a_cable_given_to_a_base_keeps_its_exit_point_in_the_world(name):
    begun = session(name)
    exits = begun.world.robot.exit_points
    (field,) = [field for field in every_field(begun.world) if field.path == ("cables", 0, "base")]
    for base in (begun.world.robot.bases[-1].name, None, begun.world.robot.bases[0].name):
        begun.type(field, base)
        assert begun.world.robot.cables[0].base == base
        np.testing.assert_allclose(begun.world.robot.exit_points, exits, atol=1e-12)


# --- bad edits ----------------------------------------------------------------------------------------------
BAD = [
    ("caroca", ("cables", 2, "exit_point", 0), "left", "cable 3: exit_point"),
    ("caroca", ("cables", 2, "exit_point", 0), float("nan"), "cable 3: exit_point"),
    ("caroca", ("cables", 2, "tension", 0), 20000.0, "cable 3: tension"),
    ("caroca", ("cables", 0, "speed"), 0.0, "cable 1: speed"),
    ("caroca", ("cables", 4, "base"), "nowhere", "cable 5: base"),
    ("caroca", ("cable_limits", "tension", 1), -1.0, "cable_limits.tension"),
    ("caroca", ("platform", "mass"), -1.0, "platform.mass"),
    ("caroca", ("platform", "inertia"), [1.0, 1.0, 9.0], "platform.inertia"),
    ("caroca", ("platform", "size", 1), 0.0, "platform.size"),
    ("caroca", ("motion_pattern",), "3T", "cable 1: anchor_point"),
    ("caroca", ("gravity",), float("inf"), "gravity"),
    ("caroca", ("cable", "axial_stiffness"), -5.0, "cable.axial_stiffness"),
    ("planar_mcdpr", ("bases", 1, "footprint"), [[0.0, 0.0], [0.0, 0.0]], "bases[2].footprint"),
    ("planar_mcdpr", ("bases", 0, "mass"), 0.0, "bases[1].mass"),
    ("caroca", ("tasks", "default", "duration"), 0.0, "tasks.default.duration"),
]


@pytest.mark.parametrize(("name", "path", "value", "named"), BAD, ids=lambda part: str(part)[:40])
def test_a_bad_edit_names_the_field_and_keeps_the_last_good_robot(name, path, value, named):
    begun = session(name)
    begun.edit(("platform", "mass"), 42.0)
    good, judged, history = begun.world, begun.assessment, begun.history
    assert refused(begun.edit, path, value).startswith(named)
    assert begun.world is good and begun.assessment is judged and begun.history is history
    begun.edit(("platform", "mass"), 43.0)
    assert begun.world.robot.mass == 43.0


def test_words_where_a_number_belongs_are_named():
    begun = session()
    fields = {field.path: field for field in every_field(begun.world)}
    for path, entry in ((("platform", "inertia"), "6.5, twenty, 22.5"), (("cables", 0, "speed"), "fast")):
        said = refused(begun.type, fields[path], entry)
        assert repr(entry) in said and path[-1] in said


def test_left_out_means_left_out():
    begun = session()
    fields = {field.path: field for field in every_field(begun.world)}
    begun.type(fields["platform", "inertia"], "")
    assert shown(fields["platform", "inertia"], begun.world) == ""
    begun.type(fields["cable", "axial_stiffness"], "2e5")
    assert begun.world.robot.elasticity.axial_stiffness == 2e5
    begun.type(fields["cable", "axial_stiffness"], "")
    assert begun.world.robot.elasticity is None
    begun.type(fields["cable_limits", "speed"], "")
    assert np.isinf(begun.world.robot.speed_max).all()


def test_cables_and_bases_come_and_go():
    begun = session("planar_mcdpr")
    begun.add("cables")
    assert begun.world.robot.n_cables == 5 and begun.place.cable == 4
    begun.remove("cables")
    assert begun.world.robot.n_cables == 4 and begun.place.cable == 3
    begun.add("bases")
    assert len(begun.world.robot.bases) == 3 and begun.place.base == 2
    begun.remove("bases")
    assert len(begun.world.robot.bases) == 2
    begun.turn_to(Place(0, 0))
    assert "'left' still carries cables 1, 2" in refused(begun.remove, "bases")
    for _ in range(4):
        begun.undo()
    assert contents(begun.world) == contents(cl.load_world("planar_mcdpr"))


def test_the_last_cable_stays():
    begun = session("planar_point_3")
    begun.remove("cables")
    begun.remove("cables")
    assert "cables" in refused(begun.remove, "cables") and begun.world.robot.n_cables == 1


def test_a_file_that_is_no_world_is_told_by_line_and_the_robot_stays(tmp_path):
    begun = session()
    text = begun.world.to_yaml().replace("mass: 150.0", "mass: heavy")
    line = next(k for k, row in enumerate(text.splitlines(), 1) if "heavy" in row)
    assert refused(begun.read, text, "mine.yaml").startswith(f"mine.yaml:{line}: platform.mass")
    assert "no_such_world" in refused(begun.load, "no_such_world")
    assert "folder" in refused(begun.save, str(tmp_path / "no" / "folder.yaml"))
    assert ".yaml" in refused(begun.save, "robot.txt")
    assert begun.world.name == "caroca"
    begun.load("planar_rigid")
    begun.undo()
    assert begun.world.name == "caroca"


# --- what a design is worth ---------------------------------------------------------------------------------
def warned(begun):
    return " ".join(begun.assessment.warnings)


def test_an_infeasible_start_says_whether_limits_or_geometry_are_at_fault():
    begun = session()
    assert begun.assessment.warnings == ()
    begun.edit(("cable_limits", "tension", 1), 300.0)
    assert "Infeasible start" in warned(begun) and "With other limits" in warned(begun)
    begun.undo()
    assert begun.assessment.warnings == ()
    begun.edit(("platform", "pose", "position", 2), 5.0)
    assert "Infeasible start" in warned(begun) and "can only pull" in warned(begun)
    assert begun.assessment.stiffness is None


def test_the_pull_named_for_other_limits_is_enough():
    begun = session()
    begun.edit(("cable_limits", "tension", 1), 300.0)
    most = float(warned(begun).split("pull up to ")[1].split()[0])
    begun.edit(("cable_limits", "tension", 1), 1.01 * most)
    begun.edit(("cable_limits", "tension", 0), 0.0)
    assert begun.assessment.tensions.feasible


def test_too_few_cables_lose_rank():
    begun = session("planar_rigid")
    begun.remove("cables")
    assert "rank" not in warned(begun)
    begun.remove("cables")
    assert "rank 2 of 3" in warned(begun) and "Add cables" in warned(begun)


def test_cables_that_cross_are_named():
    begun = session()
    # Cable 2 from the opposite corner's exit: it must pass cable 8, which runs the other way.
    robot, pose = begun.world.robot, begun.world.pose
    middle = (robot.exit_points[4] + pose.position + pose.rotation @ robot.anchor_points[4]) / 2
    anchor = pose.position + pose.rotation @ robot.anchor_points[0]
    through = anchor + 2 * (middle - anchor)
    for k in range(3):
        begun.edit(("cables", 0, "exit_point", k), float(through[k]))
    assert cable_distances(begun.world.robot, pose).min() < CLEARANCE
    assert "cables 1 and 5 are touching" in warned(begun)


def test_a_cable_without_length_a_low_platform_and_a_tipping_base_are_named():
    begun = session("planar_point")
    x, y = begun.world.robot.exit_points[1]
    begun.edit(("platform", "pose", "position", 0), float(x))
    begun.edit(("platform", "pose", "position", 1), float(y))
    assert "Cable 2 has no length" in warned(begun) and begun.assessment.tensions is None
    low = session()
    low.edit(("platform", "pose", "position", 2), 0.1)
    assert "starts 0.1 m below the floor" in warned(low)
    light = session("planar_mcdpr")
    assert "tips" not in warned(light)
    light.edit(("bases", 0, "mass"), 0.01)
    assert "Base 'left' tips" in warned(light)


@pytest.mark.parametrize("name", ["caroca", "planar_rigid", "planar_mcdpr", "mobile_four_bases"])
def test_the_slice_is_what_a_linear_program_says(name):
    world, rng = cl.load_world(name), np.random.default_rng(7)
    for plane in PLANES if world.robot.dimension == 3 else PLANES[:1]:
        found = workspace_slice(world, plane)
        poses, robot = found.grid.poses, world.robot
        for k in rng.integers(len(found.grid), size=12):
            W, w_e = cl.wrench_matrix(robot, poses[k]), cl.gravity_wrench(robot, poses[k])
            answer = linprog(np.zeros(robot.n_cables), A_eq=W, b_eq=-w_e,
                             bounds=list(zip(robot.tension_min, robot.tension_max)))
            assert found.held[k] == (answer.status == 0)
        assert not (found.clear & ~found.held).any()
        assert SlicePicture().html(world, found).count("<img") == 1


def test_cells_of_a_slice_tile_the_box_of_exit_points_and_floor():
    robot = cl.load_world("caroca").robot
    grid = workspace_slice(cl.load_world("caroca"), "x–z").grid
    width, height = np.ptp(robot.exit_points[:, 0]), robot.exit_points[:, 2].max()
    assert len(grid) * grid.cell == pytest.approx(width * height)


def test_many_redundant_cables_have_a_coarse_slice():
    begun = session("point_mass")
    for _ in range(2):
        begun.add("cables")
    assert len(begun.assessment.slice.grid) <= 64


# --- the page -----------------------------------------------------------------------------------------------
@pytest.fixture(params=["caroca", "planar_mcdpr", "marionet"])
def designer(request):
    designer = course.robot_designer(request.param)
    yield designer
    designer.close()


def test_every_group_shows_its_fields_and_every_choice_answers(designer):
    for group in designer.groups.options:
        designer.groups.value = group
    designer.groups.value = "cables"
    for cable in range(designer.world.robot.n_cables):
        designer.cables.value = cable
        first = float(designer.form.entries["exit point A", "x"].value)
        assert first == pytest.approx(designer.world.robot.cables[cable].exit_point[0])
    for plane in designer.planes.options:
        designer.planes.value = plane
    for end in (-180, 180):
        designer.eye.value = end
        assert designer.picture.startswith(b"\x89PNG")
    assert designer.session.history.labels == ("", "")


def test_typing_edits_and_a_mistake_is_shown_beside_the_fields(designer):
    picture = designer.picture
    entry = designer.form.entries["exit point A", "x"]
    entry.value = str(float(entry.value) + 0.25)
    assert designer.picture != picture and designer.undo_button.description == "Undo: cable 1: exit point A x"
    x, good = designer.form.entries["tension limits", "min"], designer.world
    x.value = "1e9"
    assert 'role="alert"' in designer.message.value and "cable 1: tension limits min: " in designer.message.value
    assert designer.world is good and "cdprlab-refused" in x._dom_classes
    designer.take_back.click()
    assert x.value == f"{good.robot.tension_min[0]:g}" and "cdprlab-refused" not in x._dom_classes
    assert 'role="alert"' not in designer.message.value and designer.take_back.layout.display == "none"
    designer.undo_button.click()
    assert designer.picture == picture and 'role="alert"' not in designer.message.value
    assert float(designer.form.entries["tension limits", "min"].value) == good.robot.tension_min[0]
    designer.redo_button.click()
    assert contents(designer.world) == contents(good)


@pytest.mark.parametrize("entry, said", [("", "nothing stands there"), ("1e400", "endless"), ("nan", "endless"),
                                         ("0,5", "type one, as 0.5"), ("wide", "is no number")])
def test_what_is_no_ordinary_number_is_said_beside_its_name(entry, said):
    designer = course.robot_designer("planar_rigid")
    designer.form.entries["exit point A", "y"].value = entry
    name, why = html.unescape(designer.message.value).split("cable 1: ")[1].split(": ", 1)
    assert name == "exit point A y" and said in why.splitlines()[0] and not designer.session.unsaved
    designer.close()


def test_what_is_loaded_is_named_and_what_is_not_saved_is_marked(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    designer = course.robot_designer("caroca")
    world, begun = designer.world, designer.session
    assert f"<b>{world.title}</b> (caroca)" in designer.head.value and "not saved" not in designer.head.value
    designer.do(designer.session.edit, ("platform", "mass"), 120.0)
    assert f"<b>{world.title} (changed)</b>" in designer.head.value and "not saved" in designer.head.value
    designer.do(designer.session.undo)
    assert "not saved" not in designer.head.value
    designer.do(designer.session.redo)
    assert designer.do(designer.session.save, "mine.yaml") and "not saved" not in designer.head.value
    assert cl.load_world(tmp_path / "mine.yaml").robot.mass == 120.0 and str(tmp_path) not in designer.head.value
    assert designer.do(begun.new, "planar_rigid") and begun.world.name == "my_robot" and begun.unsaved
    assert designer.do(begun.new) and begun.world.robot.n_cables == 1 and "My robot" in designer.head.value
    designer.close()


@every_world
def test_mirrored_edits_keep_a_symmetric_robot_symmetric(name):
    begun = session(name)
    robot = begun.world.robot
    begun.mirrored = "xy" if robot.dimension == 3 else "x"
    middle = (robot.exit_points.min(axis=0) + robot.exit_points.max(axis=0)) / 2
    flipped = np.where(np.arange(robot.dimension) == 0, -1.0, 1.0)

    def images():
        """Pairs of cables whose exit points mirror each other in x."""
        places = begun.world.robot.exit_points - middle
        return {(i, j) for i, one in enumerate(places) for j, other in enumerate(places)
                if np.allclose(other, flipped * one)}

    before, free = images(), not robot.bases
    begun.edit(("cables", 0, "exit_point", 0), float(robot.cables[0].exit_point[0]) + 0.0625)
    begun.edit(("cables", 0, "tension", 0), float(robot.tension_min[0]) + 1.0)
    assert not free or images() == before
    raised = begun.world.robot.tension_min != robot.tension_min
    assert raised[0] and (free or raised.sum() == 1)
    assert all(raised[i] == raised[j] for i, j in before if free)


def test_an_anchor_moves_its_images_and_an_exit_the_whole_corner():
    begun = session("caroca")
    begun.mirrored = "xy"
    exits, anchors = begun.world.robot.exit_points, begun.world.robot.anchor_points
    begun.edit(("cables", 0, "exit_point", 0), -3.0)
    begun.edit(("cables", 0, "anchor_point", 0), 0.5)
    np.testing.assert_allclose(begun.world.robot.exit_points, exits * [6 / 7, 1, 1])
    lower = anchors[:, [2]] < 0
    expected = np.where(lower, anchors * [5 / 6, 1, 1], anchors)
    np.testing.assert_allclose(begun.world.robot.anchor_points, expected)


def test_the_window_of_the_slice_stays_where_it_is():
    begun = session()
    low, high = begun.history.present.window
    begun.edit(("cables", 0, "exit_point", 0), -2.0)
    begun.edit(("cables", 1, "exit_point", 0), -2.0)
    assert np.array_equal(begun.history.present.window, (low, high))
    begun.edit(("cables", 0, "exit_point", 0), -4.0)
    assert begun.history.present.window[0][0] == -4.0
    begun.load("planar_rigid")
    begun.undo()
    assert begun.history.present.window[0][0] == -4.0


def test_a_flight_that_fails_says_so():
    designer = course.robot_designer("planar_point")
    designer.do(designer.session.edit, ("cable_limits", "tension", 1), 6.0)
    designer.simulate()
    assert 'role="alert"' in designer.message.value and "The flight failed: at " in designer.message.value
    designer.close()


def test_the_text_of_the_world_file_can_be_edited(designer):
    designer.groups.value = "world file"
    designer.file_text.value = designer.file_text.value.replace("mass:", "mass: 77.5  #", 1)
    designer.apply.click()
    assert designer.world.robot.mass == 77.5
    assert "mass: 77.5" in designer.file_text.value


def test_pictures_and_slice_have_words(designer):
    assert "cable 1 marked" in designer.image.value and "% are held" in designer.slice.value
    assert designer._repr_mimebundle_()


def test_a_pulley_leans_where_its_axis_is_typed():
    world = cl.load_world("caroca_pulleys")
    (field,) = next(row for row in rows(world, "cables", Place()) if row.label == "pulley axis").fields
    leaning = typed(world, field, "0, 3, 4")
    np.testing.assert_allclose(leaning.robot.cables[0].pulley.axis, [0.0, 0.6, 0.8])
    assert shown(field, leaning) == "0, 0.6, 0.8"


def test_a_design_is_simulated_and_played():
    designer = course.robot_designer("planar_point")
    run = designer.simulate(method="barycenter", kp=50.0, kd=20.0, ki=10.0)
    assert "kp=50.0, kd=20.0, ki=10.0" in str(run.settings)
    assert run.method == "barycenter" and run.world is designer.world
    assert designer.player.run is run and designer.below.children == (designer.player.widget,)
    designer.do(designer.session.edit, ("motion_pattern",), "1R2T")
    assert designer.simulate(method="no_such_method") is None and "no_such_method" in designer.message.value
    designer.close()
    designer.close()


def test_a_designer_takes_worlds():
    with pytest.raises(InvalidInput, match="must be a World"):
        course.robot_designer(42)
    with pytest.raises(WorldError, match="unknown world"):
        course.robot_designer("no_such_world")


@every_world
def test_every_shipped_world_is_judged(name):
    found = assess(cl.load_world(name))
    assert found.tensions.feasible and (found.stiffness is not None)
    assert all("Interference" in warning for warning in found.warnings), found.warnings
