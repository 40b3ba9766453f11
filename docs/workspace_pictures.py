"""A workspace in space, which stands on one page only."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cdprlab.errors import InvalidInput
from cdprlab.robot.pose import Pose
from cdprlab.view.depth import Blocks
from cdprlab.view.drawing import RobotDrawing
from cdprlab.view.film import save_png
from cdprlab.view.outlines import box_corners, surroundings
from cdprlab.view.picture import Picture
from cdprlab.view.plots import Figure
from cdprlab.view.screen import robot_axes, sized_figure
from cdprlab.view.style import INK
from cdprlab.view.workspace import describe
from cdprlab.workspace import Judgement, PoseGrid
from cdprlab.world import World


def workspace_still(world: World, grid: PoseGrid, judgement: Judgement, path: str | Path,
                    width: int = 960) -> Path:
    """A PNG of a workspace in space, layer upon layer, around the robot at its start, with a description inside.

    A layer ends half-way between poses inside and outside.

    grid : over x, y and z; judgement : of its poses
    path : ends in .png; width : [pixels]
    Raises InvalidInput for a grid that is no volume.
    """
    if len(grid.axes) != 3:
        raise InvalidInput(f"layers need a grid over x, y and z, this one is over {', '.join(grid.axes)}")
    figure = sized_figure(width, 3 * width // 4)
    drawing = RobotDrawing(robot_axes(figure, 3), world.robot, world.scene, world.pose,
                           solid=True)
    x, y, heights = grid.axes.values()
    slate = Figure().add_subplot()
    corners, codes = [], []
    for height, inside in zip(heights, grid.field(judgement.inside).T):
        outline = slate.contourf(x, y, inside, [0.5, 1.5]).get_paths()[0]
        corners.append(drawing.view.flat(np.insert(outline.vertices, 2, height, axis=1)))
        codes.append(outline.codes)
    drawing.faces(5.4, facecolors="#5696C8", edgecolors=INK,
                  linewidths=0.4).set_verts_and_codes(corners, codes)
    # What stands around it is painted once more, as far as it is not behind the workspace.
    places = grid.poses.position[judgement.inside]
    if len(places):
        low, high = places.min(axis=0), places.max(axis=0)
        space = Blocks(box_corners(high - low, Pose((low + high) / 2))[None], drawing.view.eye)
        drawing.paint(drawing.faces(5.5),
                      [solid for solid in surroundings(world.robot, world.scene)
                                          if not space.hides(solid.corners).any()])
    return save_png(Picture(figure).pixels(), path,
                    f"Layers of a workspace of {world.title or world.name}. {describe(grid, judgement)}")
