"""Pictures of workspaces, and the border in space."""

import numpy as np
import pytest
from PIL import Image

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.view import save_figure
from cdprlab.view.workspace import plot_workspaces, workspace_still
from cdprlab.workspace import Judgement, position_grid
from cdprlab.workspace.surface import border_triangles
from robots import robot_1r2t, robot_3r3t

PLANE = position_grid([-2, -2], [2, 2], 0.2)
ROOM = position_grid([-1, -1, 0], [1, 1, 2], 0.1)


def ball(radius=0.7):
    """Poses within a radius of the middle of the room; the margin is the distance to the border."""
    margin = radius - np.linalg.norm(ROOM.poses.position - [0, 0, 1], axis=1)
    return Judgement(margin >= 0, margin)


def enclosed(triangles):
    """Volume, by the divergence theorem: negative if the surface looks inwards."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return (triangles.mean(axis=1) * normals).sum() / 6


@pytest.mark.parametrize("known, close", [(True, 0.02), (False, 0.08)], ids=["margins", "verdicts"])
def test_the_border_encloses_the_volume(known, close):
    found = ball()
    triangles = border_triangles(ROOM, found if known else Judgement(found.inside, np.full(len(ROOM), np.nan)))
    assert enclosed(triangles) == pytest.approx(4 / 3 * np.pi * 0.7**3, rel=close)
    # Closed: every edge belongs to two triangles that run along it in opposite directions.
    ends = np.round(np.concatenate([triangles[:, [a, (a + 1) % 3]] for a in range(3)]), 9)
    there, back = ({tuple(edge.ravel()) for edge in way} for way in (ends, ends[:, ::-1]))
    assert there == back
    if known:   # linear interpolation of a distance
        assert np.abs(np.linalg.norm(triangles - [0, 0, 1], axis=2) - 0.7).max() < 0.01


def test_a_workspace_that_fills_its_grid_is_closed_at_the_ends():
    assert enclosed(border_triangles(ROOM, ball(9.0))) == pytest.approx(8.0, rel=1e-4)
    assert border_triangles(ROOM, ball(-1.0)).shape == (0, 3, 3)


def test_maps_say_what_they_show(tmp_path):
    robot = robot_1r2t()
    found = cl.workspace(robot, PLANE, cl.WrenchFeasible())
    figure = plot_workspaces(robot, PLANE, {"": found}, title="A platform", unit="N")
    axes = figure.axes[0]
    assert axes.get_xlabel() == "x [m]" and axes.get_ylabel() == "y [m]" and "[N]" in figure.axes[1].get_xlabel() + \
        figure.axes[1].get_ylabel()
    assert f"{100 * found.inside.mean():.1f} % of 441 poses" in figure.alt_text and "N." in figure.alt_text
    save_figure(figure, tmp_path / "map.png")
    with Image.open(tmp_path / "map.png") as picture:
        assert picture.text["Description"] == figure.alt_text


def test_all_inside_none_inside_and_no_margins_are_drawn_too(tmp_path):
    robot, n = robot_1r2t(), len(PLANE)
    judgements = {"all": Judgement(np.ones(n, bool), np.ones(n)), "none": Judgement(np.zeros(n, bool), -np.ones(n)),
                  "verdicts": Judgement(np.arange(n) % 3 > 0, np.full(n, np.nan)),
                  "unbalanced": Judgement(np.arange(n) > 99, np.where(np.arange(n) > 99, 1.0, -np.inf))}
    figure = plot_workspaces(robot, PLANE, judgements, title="Corner cases")
    save_figure(figure, tmp_path / "maps.png")
    assert all(name in figure.alt_text for name in judgements)


def test_space_is_drawn_as_a_still(tmp_path):
    world = cl.load_world("caroca")
    grid = position_grid([-3, -1.5, 0.5], [3, 1.5, 3], 0.75)
    found = cl.workspace(world.robot, grid, cl.WrenchFeasible())
    path = workspace_still(world, grid, found, tmp_path / "still.png", width=320)
    with Image.open(path) as picture:
        assert picture.size == (320, 240) and "poses inside" in picture.text["Description"]
        assert len(np.unique(np.asarray(picture).reshape(-1, 3), axis=0)) > 50


def test_what_cannot_be_drawn_is_said(tmp_path):
    robot, found = robot_3r3t(), ball()
    with pytest.raises(InvalidInput, match="over two axes"):
        plot_workspaces(robot, ROOM, {"": found})
    with pytest.raises(InvalidInput, match="over x, y and z"):
        border_triangles(PLANE, found)
    with pytest.raises(InvalidInput, match=r"\.png"):
        workspace_still(cl.load_world("caroca"), ROOM, found, tmp_path / "still.gif")
