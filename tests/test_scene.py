"""The k3d scene: the robot's geometry, tensions as color and as number, objects changed in place."""

import numpy as np
import pytest
from test_explorers import planar_world

import cdprlab as cl
from cdprlab.course.explorers.scene import RobotScene, legend_html
from cdprlab.errors import InvalidInput
from cdprlab.view.style import OBSTACLE, SLACK_COLOR, tension_colors

SPATIAL = [name for name in cl.world_names() if cl.load_world(name).robot.dimension == 3]
TENSIONS = np.linspace(20.0, 400.0, 8)


def rgb(number):
    return [number >> 16 & 255, number >> 8 & 255, number & 255]


@pytest.mark.parametrize("name", SPATIAL)
def test_cables_run_from_exits_to_anchors(name):
    world = cl.load_world(name)
    opened = RobotScene(world)
    pose = cl.Pose(world.pose.position + 0.1, rpy=[0.1, -0.2, 0.3])
    opened.move(pose, np.full(world.robot.n_cables, 100.0))
    vectors = np.array([line.vertices[0] - line.vertices[1] for line in opened.cables])
    np.testing.assert_allclose(vectors, cl.cable_vectors(world.robot, pose), atol=1e-5)  # k3d holds float32
    np.testing.assert_allclose(opened.platform.model_matrix[:3, :3], pose.rotation, atol=1e-6)
    corners = opened.platform.vertices
    np.testing.assert_allclose(np.ptp(corners, axis=0), world.robot.platform.size, rtol=1e-6)
    opened.close()


def test_a_move_changes_the_same_objects():
    opened = RobotScene(cl.load_world("caroca"), tensions=TENSIONS)
    before = [(thing.id, id(thing)) for thing in opened.plot.objects]
    vertices, legend = opened.cables[0].vertices.copy(), opened.legend.text
    opened.move(cl.Pose([0.3, 0, 1]), TENSIONS[::-1])
    assert [(thing.id, id(thing)) for thing in opened.plot.objects] == before
    assert (opened.cables[0].vertices != vertices).any() and opened.legend.text != legend


def test_colors_and_numbers_are_the_tensions():
    tau = np.array([*TENSIONS[:6], 0.0, np.nan])
    opened = RobotScene(cl.load_world("caroca"), tensions=tau, limits=(0.0, 400.0))
    colors = [rgb(line.color) for line in opened.cables]
    np.testing.assert_array_equal(colors, tension_colors(tau, (0.0, 400.0)))
    assert tuple(colors[6]) == tuple(colors[7]) == SLACK_COLOR
    words = opened.legend.text.split("<br>")
    assert "[N]: 0 " in words[0] and " 400, slack" in words[0]
    assert [word.split(": ")[-1] for word in words[1:]] == [*(f"{t:.1f}" for t in TENSIONS[:6]), "slack", "slack"]


def test_without_tensions_cables_are_grey_and_nothing_is_claimed():
    opened = RobotScene(cl.load_world("caroca"))
    assert {tuple(rgb(line.color)) for line in opened.cables} == {SLACK_COLOR}
    assert "<br>" not in legend_html(np.full(8, np.nan), (0.0, 1.0))


def test_boxes_of_the_scene_are_solid():
    document = cl.load_world("caroca").to_dict()
    wall = {"position": [0, -1.95, 1.75], "size": [7, 0.02, 3.5]}
    world = cl.World.from_dict({**document, "scene": {**document["scene"], "obstacles": [wall]}})
    solid, = (thing for thing in RobotScene(world).plot.objects
              if thing.type == "Mesh" and thing.color == int(OBSTACLE.removeprefix("#"), 16))
    np.testing.assert_allclose(np.ptp(solid.vertices, axis=0), [7, 0.02, 3.5], rtol=1e-5)


def test_faces_look_outwards():
    opened = RobotScene(cl.load_world("caroca"))
    corners, faces = opened.platform.vertices, opened.platform.indices.reshape(-1, 3)
    volume = np.einsum("ij,ij->i", corners[faces[:, 0]], np.cross(corners[faces[:, 1]], corners[faces[:, 2]])).sum() / 6
    assert abs(volume) == pytest.approx(np.prod(opened.robot.platform.size), rel=1e-5)  # all the same way round


def test_planar_worlds_and_wrong_poses_are_refused():
    with pytest.raises(InvalidInput, match="planar"):
        RobotScene(planar_world())
    opened = RobotScene(cl.load_world("caroca"))
    with pytest.raises(InvalidInput, match="single spatial Pose"):
        opened.move(cl.Pose([0, 0]), TENSIONS)


def test_closing_twice_is_safe():
    opened = RobotScene(cl.load_world("caroca"))
    opened.close()
    opened.close()
