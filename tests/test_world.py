"""World files: what is shipped is sound, what is saved comes back, and every mistake is named where it stands."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cdprlab import Pose, World, distribute_tensions, gravity_wrench, load_world, wrench_matrix
from cdprlab.errors import InvalidInput, WorldError
from cdprlab.world import world_names, world_schema
from cdprlab.world.blocks import WorldFile

described = WorldFile.of

FILE = """\
# a comment at the top
name: small
title: A small robot
source: every number is chosen
engine: spatial
motion_pattern: 3R3T
platform:
  mass: 10.0          # kg, a comment on mass
  inertia: [1, 1, 1]
  size: [0.2, 0.2, 0.2]
  pose: {position: [0, 0, 1]}
cable_limits: {tension: [1, 100], speed: 2.0}
cables:
  - {exit_point: [-1, -1, 2], anchor_point: [-0.1, -0.1, 0.1]}
  - {exit_point: [1, -1, 2], anchor_point: [0.1, -0.1, 0.1]}
  - {exit_point: [0.5, 0, 0.5], anchor_point: [0.0, 0.1, 0.1], base: cart}
bases:
  - name: cart
    pose: {position: [0, 1]}
    mass: 20    # kg, a comment on the cart
    footprint: [[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]]
tasks:
  default: {kind: quintic, to: {position: [0.1, 0, 1]}, duration: 2.0}   # a comment on the task
"""
THIRD_CABLE = "{exit_point: [0.5, 0, 0.5], anchor_point: [0.0, 0.1, 0.1], base: cart}"


@pytest.fixture
def small(tmp_path: Path) -> World:
    return load_world(written(tmp_path))


def written(folder: Path, old: str = "", new: str = "") -> Path:
    """The small world's file with one text in it exchanged."""
    assert old in FILE
    path = folder / "small.yaml"
    path.write_text(FILE.replace(old, new, 1) if old else FILE, encoding="utf-8")
    return path


def saved(world: World, folder: Path) -> tuple[World, str]:
    path = world.save(folder / "saved.yaml")
    return load_world(path), path.read_text(encoding="utf-8")


def changed(world: World, robot: Any = None, **others: Any) -> World:
    return dataclasses.replace(world, robot=robot or world.robot, **others)


# --- what is shipped ----------------------------------------------------------------------------------
@pytest.mark.parametrize("name", world_names())
def test_shipped_world_is_complete(name: str) -> None:
    world = load_world(name)
    assert world.name == name and world.title and world.source
    assert world.document["engine"] == world.engine
    assert world.scene.frame is not None or all(cable.base for cable in world.robot.cables)
    # The engines let the platform collide: it must start clear of the floor.
    lowest = world.pose.position + world.robot.platform.center - world.robot.platform.size / 2
    assert lowest[-1] > world.scene.floor_height


@pytest.mark.parametrize("name", world_names())
def test_shipped_task_is_statically_feasible_all_the_way(name: str) -> None:
    world = load_world(name)
    robot, task = world.robot, world.task()
    assert 2.0 <= task.duration <= 10.0  # long enough to see, short enough to wait for
    for t in np.linspace(0, task.duration, 31):
        pose = task.trajectory()(t).pose
        result = distribute_tensions(wrench_matrix(robot, pose), gravity_wrench(robot, pose),
                                     robot.tension_min, robot.tension_max)
        assert result.feasible, (t, result.reason)


def test_thesis_trajectory_starts_infeasible() -> None:
    # The file says so; the errata puts the first feasible instant at 28.40 s.
    world = load_world("caroca_light")
    feasible = []
    for t in (0.0, 28.3, 28.5, 60.0, 100.0):
        pose = world.task("thesis").trajectory()(t).pose
        feasible.append(bool(distribute_tensions(wrench_matrix(world.robot, pose), gravity_wrench(world.robot, pose),
                                                 world.robot.tension_min, world.robot.tension_max).feasible))
    assert feasible == [False, False, True, True, True]


@pytest.mark.parametrize("name", world_names())
def test_shipped_file_is_saved_unchanged(name: str, tmp_path: Path) -> None:
    world = load_world(name)
    again, text = saved(world, tmp_path)
    assert described(again) == described(world)
    assert text == (Path(__file__).parent.parent / "worlds" / f"{name}.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", world_names())
def test_to_dict_is_the_same_world(name: str) -> None:
    world = load_world(name)
    assert described(World.from_dict(world.to_dict())) == described(world)


@pytest.mark.parametrize("name", world_names())
def test_schema_knows_every_key_of_shipped_files(name: str) -> None:
    schema = world_schema()
    document = load_world(name).to_dict()
    assert set(schema["required"]) <= set(document) <= set(schema["properties"])
    blocks = schema["$defs"]
    assert set(document["platform"]) <= set(blocks["PlatformBlock"]["properties"])
    assert all(set(cable) <= set(blocks["CableBlock"]["properties"]) for cable in document["cables"])
    assert schema["additionalProperties"] is False


def test_documented_example_is_a_world(tmp_path: Path) -> None:
    page = (Path(__file__).parent.parent / "docs" / "world_file.md").read_text(encoding="utf-8")
    path = tmp_path / "example.yaml"
    path.write_text(page.split("```yaml\n")[1].split("```")[0], encoding="utf-8")
    world = load_world(path)
    assert list(world.tasks) == ["default", "wait"]
    again, text = saved(world, tmp_path)
    assert described(again) == described(world) and text == path.read_text(encoding="utf-8")


def test_every_key_of_the_schema_is_documented() -> None:
    page = (Path(__file__).parent.parent / "docs" / "world_file.md").read_text(encoding="utf-8")
    blocks = [world_schema(), *world_schema()["$defs"].values()]
    assert [key for block in blocks for key in block["properties"] if key not in page] == []


# --- what is saved ------------------------------------------------------------------------------------
def test_payload_is_saved(small: World, tmp_path: Path) -> None:
    loaded = changed(small, small.robot.with_payload(5.0, [0.1, 0.0, -0.2]))
    again, text = saved(loaded, tmp_path)
    for name in ("mass", "inertia", "center_of_mass"):
        assert np.array_equal(getattr(again.robot.platform, name), getattr(loaded.robot.platform, name))
    for comment in ("# a comment at the top", "# changed; before: kg, a comment on mass", "# a comment on the task"):
        assert comment in text
    assert THIRD_CABLE in text


def test_left_out_inertia_is_saved_once_the_mass_changes(tmp_path: Path) -> None:
    world = load_world("point_mass")
    platform = dataclasses.replace(world.robot.platform, mass=99.0)
    again, _ = saved(changed(world, dataclasses.replace(world.robot, platform=platform)), tmp_path)
    assert np.array_equal(again.robot.platform.inertia, platform.inertia)


def test_moved_base_is_saved(small: World, tmp_path: Path) -> None:
    again, text = saved(changed(small, small.robot.with_bases({"cart": (0.5, 1.5, 0.3)})), tmp_path)
    assert again.robot.bases[0].position.tolist() == [0.5, 1.5]
    assert again.robot.bases[0].heading == 0.3
    assert "# kg, a comment on the cart" in text


def test_pose_and_gravity_are_saved(small: World, tmp_path: Path) -> None:
    pose = Pose([0.1, 0.2, 0.9], rpy=[0.1, -0.2, 0.3])
    again, _ = saved(changed(small, dataclasses.replace(small.robot, gravity=1.62), pose=pose), tmp_path)
    assert again.robot.gravity == 1.62
    assert np.array_equal(again.pose.position, pose.position)
    assert np.allclose(again.pose.rotation, pose.rotation, atol=1e-15)


@pytest.mark.parametrize("limits", [{"tension_min": 3.0, "tension_max": 30.0}, {"speed_max": 0.5},
                                    {"speed_max": float("inf")}])
@pytest.mark.parametrize("which", [(1,), (0, 1, 2)])
def test_limits_are_saved(small: World, tmp_path: Path, limits: dict[str, float], which: tuple[int, ...]) -> None:
    cables = [dataclasses.replace(cable, **limits) if i in which else cable
              for i, cable in enumerate(small.robot.cables)]
    wanted = changed(small, dataclasses.replace(small.robot, cables=tuple(cables)))
    again, _ = saved(wanted, tmp_path)
    assert described(again) == described(wanted)
    assert described(World.from_dict(wanted.to_dict())) == described(wanted)


def test_limits_all_cables_share_stay_in_one_place(small: World, tmp_path: Path) -> None:
    cables = tuple(dataclasses.replace(cable, tension_max=50.0) for cable in small.robot.cables)
    _, text = saved(changed(small, dataclasses.replace(small.robot, cables=cables)), tmp_path)
    assert "cable_limits: {tension: [1, 50.0], speed: 2.0}" in text
    assert text.count("tension:") == 1


@pytest.mark.parametrize("count", [2, 4])
def test_cables_taken_away_or_added_are_saved(small: World, tmp_path: Path, count: int) -> None:
    cables = (*small.robot.cables, small.robot.cables[0])[:count]
    wanted = changed(small, dataclasses.replace(small.robot, cables=cables))
    again, _ = saved(wanted, tmp_path)
    assert described(again) == described(wanted)


def test_bases_taken_away_are_saved(small: World, tmp_path: Path) -> None:
    cables = tuple(dataclasses.replace(cable, base=None) for cable in small.robot.cables)
    again, _ = saved(changed(small, dataclasses.replace(small.robot, cables=cables, bases=())), tmp_path)
    assert again.robot.bases == ()


def test_a_value_two_cables_share_by_anchor_changes_for_one_only(tmp_path: Path) -> None:
    path = written(tmp_path, "[-0.1, -0.1, 0.1]", "&corner [-0.1, -0.1, 0.1]")
    path.write_text(path.read_text().replace("[0.1, -0.1, 0.1]}", "*corner}", 1))
    world = load_world(path)
    first, *others = world.robot.cables
    moved = dataclasses.replace(first, anchor_point=np.array([0.0, 0.0, 0.1]))
    again, _ = saved(changed(world, dataclasses.replace(world.robot, cables=(moved, *others))), tmp_path)
    assert again.robot.anchor_points[:2].tolist() == [[0.0, 0.0, 0.1], [-0.1, -0.1, 0.1]]


def test_saving_leaves_the_world_as_it_was(small: World, tmp_path: Path) -> None:
    before = small.to_dict()
    saved(changed(small, small.robot.with_payload(5.0, [0, 0, 0.1])), tmp_path)
    assert small.to_dict() == before


def test_world_from_numpy_and_tuples_is_saved_readably(small: World, tmp_path: Path) -> None:
    document = small.to_dict()
    document["platform"]["mass"] = np.float32(2.5)
    document["platform"]["size"] = np.full(3, 0.25)
    for cable in document["cables"]:
        cable["exit_point"] = tuple(np.array(cable["exit_point"]))
    world = World.from_dict(document)
    document["platform"]["mass"] = 77.0      # the world keeps its own copy
    again, text = saved(world, tmp_path)
    assert again.robot.mass == 2.5 and again.robot.platform.size.tolist() == [0.25] * 3
    assert "  - {exit_point: [-1, -1, 2]" in text or "  - {exit_point: [-1.0, -1.0, 2.0]" in text


def test_save_needs_a_folder(small: World, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="there is no folder"):
        small.save(tmp_path / "nowhere" / "a.yaml")


def test_planar_world_is_saved(tmp_path: Path) -> None:
    world = World.from_dict({
        "name": "flat", "motion_pattern": "1R2T", "cable_limits": {"tension": (1, 50)},
        "platform": {"mass": 1, "inertia": 0.1, "size": (0.2, 0.1), "pose": {"position": (0, 1), "angle": 0.1}},
        "cables": [{"exit_point": (x, 2), "anchor_point": (x / 10, 0)} for x in (-1, 1)]})
    loaded = changed(world, world.robot.with_payload(1.0, [0.1, 0.0]), pose=Pose([0.5, 1.0], angle=0.4))
    again, _ = saved(loaded, tmp_path)
    assert again.robot.mass == 2.0 and again.pose.angle == pytest.approx(0.4, abs=1e-15)
    assert float(again.robot.platform.inertia) == pytest.approx(0.1 + 0.5 * 0.1**2)


# --- mistakes -----------------------------------------------------------------------------------------
MISTAKES: dict[str, tuple[str, str, int, list[str]]] = {
    # what: text in the file, what stands there instead, its line, words the message must have
    "unknown key": ("mass: 10.0", "masss: 10.0", 8, ["platform.masss", "unknown key", "did you mean 'mass'"]),
    "unknown key of a cable": (THIRD_CABLE, THIRD_CABLE.replace("anchor_point", "anchor_pont"), 16,
                               ["cable 3: anchor_pont", "did you mean 'anchor_point'"]),
    "unknown key of a task": ("duration", "duratoin", 23, ["tasks.default.duratoin", "did you mean 'duration'"]),
    "duplicate key": ("engine: spatial", "engine: spatial\nname: other", 6, ["name", "twice"]),
    "duplicate key of a cable": ("base: cart}", "base: cart, base: cart}", 16, ["cable 3: base", "twice"]),
    "missing cables": (FILE[FILE.index("cables:"):FILE.index("bases:")], "", 2, ["cables: missing"]),
    "a number for cables": (FILE[FILE.index("cables:"):FILE.index("bases:")], "cables: 5\n", 13,
                            ["cables: must be a list, got 5"]),
    "missing exit_point": ("exit_point: [0.5, 0, 0.5], ", "", 16, ["cable 3: exit_point: missing"]),
    "wrong shape": ("[0.5, 0, 0.5]", "[0.5, 0]", 16, ["cable 3: exit_point", "must be 3 numbers in space, got 2"]),
    "too many numbers": ("[0.5, 0, 0.5]", "[0, 0, 0, 0]", 16, ["cable 3: exit_point", "at most 3", "got 4"]),
    "NaN": ("[0.5, 0, 0.5]", "[0.5, .nan, 0.5]", 16, ["cable 3: exit_point", "finite", "nan"]),
    "crossed limits of a cable": ("base: cart}", "base: cart, tension: [9, 3]}", 16,
                                  ["cable 3: tension", "smallest 9 N > largest 3 N"]),
    "crossed limits of all": ("[1, 100]", "[100, 1]", 12, ["cable_limits.tension", "smallest 100 N > largest 1 N"]),
    "no limits": ("cable_limits: {tension: [1, 100], speed: 2.0}", "", 14, ["cable 1: tension", "no tension limits"]),
    "negative tension": ("[1, 100]", "[-1, 100]", 12, ["cable_limits.tension", "at least 0", "-1"]),
    "negative mass": ("mass: 10.0", "mass: -10.0", 8, ["platform.mass", "greater than 0", "-10"]),
    "no mass": ("mass: 10.0", "mass: 0", 8, ["platform.mass", "greater than 0"]),
    "unknown base": ("base: cart}", "base: card}", 16, ["cable 3: base", "unknown base 'card'", "there are cart"]),
    "wrong engine": ("engine: spatial", "engine: planar", 5, ["engine", "3R3T", "spatial"]),
    "unknown engine": ("engine: spatial", "engine: gazebo", 5, ["engine", "'planar' or 'spatial'", "gazebo"]),
    "anchor off P": ("3R3T", "3T", 14, ["cable 1: anchor_point", "all cables meet at P"]),
    "broken YAML": ("[1, 1, 1]", "[[1, 1, 1]", 10, ["not valid YAML"]),
    "text for a number": ("mass: 10.0", "mass: heavy", 8, ["platform.mass", "must be a number", "'heavy'"]),
    "unit in a number": ("mass: 10.0", "mass: 10 kg", 8, ["platform.mass", "must be a number", "'10 kg'"]),
    "text in a union": ("[1, 1, 1]", "[a, 1, 1]", 9, ["platform.inertia[1]", "must be a number", "'a'"]),
    "true for a number": ("mass: 10.0", "mass: true", 8, ["platform.mass", "must be a number", "True"]),
    "nothing for a number": ("mass: 10.0", "mass:", 8, ["platform.mass", "must be a number", "nothing"]),
    "unknown task": ("kind: quintic", "kind: cubic", 23, ["tasks.default", "'quintic', 'hold'", "cubic"]),
    "flat box": ("tasks:", "scene: {boxes: [{position: [0, 0, 0], size: [1, 0, 1]}]}\ntasks:", 22,
                 ["scene.boxes[1].size", "greater than 0"]),
    "shelf without levels": ("tasks:", "scene: {shelves: [{position: [0, 0], size: [1, 1, 1]}]}\ntasks:", 22,
                             ["scene.shelves[1].levels: missing"]),
    "name of two words": ("name: small", "name: very small", 2, ["name", "one word", "very small"]),
}


@pytest.mark.parametrize("what", MISTAKES)
def test_mistake_is_named_where_it_stands(what: str, tmp_path: Path) -> None:
    old, new, line, words = MISTAKES[what]
    path = written(tmp_path, old, new)
    with pytest.raises(WorldError) as caught:
        load_world(path)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(f"{path}:{line}: "), message
    assert [word for word in words if word not in message] == [], message


def test_every_mistake_is_kept(tmp_path: Path) -> None:
    path = written(tmp_path, "mass: 10.0", "mass: heavy\n  colour: red")
    with pytest.raises(WorldError, match=r"\(and 1 more mistake\)") as caught:
        load_world(path)
    assert [problem.split(": ")[1] for problem in caught.value.problems] == ["platform.colour", "platform.mass"]


def test_mistakes_of_several_parts_are_told_at_once(tmp_path: Path) -> None:
    path = written(tmp_path, "inertia: [1, 1, 1]", "inertia: [1, 1, 9]")
    path.write_text(path.read_text().replace("base: cart}", "base: cart, tension: [9, 3]}"))
    with pytest.raises(WorldError) as caught:
        load_world(path)
    assert [problem.split(": ")[1] for problem in caught.value.problems] == ["platform.inertia", "cable 3"]


@pytest.mark.parametrize(("text", "got"), [("- 1\n", "a list"), ("", "an empty file"), ("hello", "'hello'")])
def test_not_a_mapping(text: str, got: str, tmp_path: Path) -> None:
    path = tmp_path / "odd.yaml"
    path.write_text(text)
    with pytest.raises(WorldError, match=f"odd.yaml: a world is a mapping of keys .* got {got}"):
        load_world(path)


@pytest.mark.parametrize(("name", "words"), [
    ("carroca", "did you mean 'caroca'"), ("nothing_like_it", "there are caroca"),
    ("nowhere.yaml", "there is no world file nowhere.yaml"),
])
def test_unknown_world(name: str, words: str) -> None:
    with pytest.raises(WorldError, match=words):
        load_world(name)


def test_mistake_in_a_dict_has_no_line_but_its_cable(small: World) -> None:
    document = small.to_dict()
    document["cables"][2]["base"] = "card"
    with pytest.raises(WorldError, match=r"^world: cable 3: base: unknown base 'card'"):
        World.from_dict(document)


def test_exponents_are_numbers(tmp_path: Path) -> None:
    world = load_world(written(tmp_path, "mass: 10.0", "mass: 1e-4"))
    assert world.robot.mass == 1e-4


def test_unknown_task_of_a_world(small: World) -> None:
    with pytest.raises(InvalidInput, match="no task 'dance'; there are default"):
        small.task("dance")
