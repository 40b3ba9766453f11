"""Pictures of workspaces: maps, and layers in space."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from PIL import Image
from scipy.spatial import ConvexHull
from workspace_pictures import workspace_still

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.view import save_figure
from cdprlab.view.projection import Projection
from cdprlab.view.workspace import plot_workspaces
from cdprlab.workspace import Judgement, position_grid
from robots import robot_1r2t, robot_3r3t

PLANE = position_grid([-2, -2], [2, 2], 0.2)
ROOM = position_grid([-1, -1, 0], [1, 1, 2], 0.1)


def ball(radius=0.7):
    """Poses within a radius of the middle of the room; the margin is the distance to the border."""
    margin = radius - np.linalg.norm(ROOM.poses.position - [0, 0, 1], axis=1)
    return Judgement(margin >= 0, margin)


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


def test_layers_cover_what_is_inside_and_nothing_else(tmp_path, monkeypatch):
    """Of a ball: each layer a disk, in which one of the poses inside it is seen; none where nothing is inside."""
    layers = []
    keep = PolyCollection.set_verts_and_codes
    monkeypatch.setattr(PolyCollection, "set_verts_and_codes", lambda self, verts, codes: (
        layers.append((verts, codes)), keep(self, verts, codes)))
    monkeypatch.setattr(Projection, "flat", lambda self, points: 1.0 * points[..., :2])   # from straight above
    world = cl.load_world("caroca")
    for radius in (0.7, -1.0):
        workspace_still(world, ROOM, ball(radius), tmp_path / "still.png", width=64)
    (verts, codes), (nothing, _) = layers
    inside = ROOM.field(ball().inside)
    areas = [ConvexHull(corners).volume if len(corners) else 0.0 for corners in verts]
    assert len(verts) == len(codes) == inside.shape[2]
    np.testing.assert_allclose(areas, 0.01 * inside.sum(axis=(0, 1)), atol=0.05)
    assert sum(areas) * 0.1 == pytest.approx(4 / 3 * np.pi * 0.7**3, rel=0.08)
    assert not any(len(corners) for corners in nothing)


def test_what_cannot_be_drawn_is_said(tmp_path):
    robot, found = robot_3r3t(), ball()
    with pytest.raises(InvalidInput, match="over two axes"):
        plot_workspaces(robot, ROOM, {"": found})
    with pytest.raises(InvalidInput, match="over x, y and z"):
        workspace_still(cl.load_world("caroca"), PLANE, found, tmp_path / "still.png")
    with pytest.raises(InvalidInput, match=r"\.png"):
        workspace_still(cl.load_world("caroca"), ROOM, found, tmp_path / "still.gif")
