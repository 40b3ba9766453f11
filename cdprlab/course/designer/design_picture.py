"""The picture of a design: the robot at its start, the edited cable marked."""

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ...mechanics.cables import cable_vectors
from ...robot.pose import Pose
from ...view.drawing import RobotDrawing
from ...view.picture import Picture
from ...view.style import ORANGE, house_style
from ...world import World

SIZE = (6.6, 3.7)
"""[inch at 100 pixels]: beside the fields, on a page 848 pixels wide, it is shown a little smaller."""


class DesignPicture:
    """Designs drawn one after the other.

    dimension : of them all
    """

    def __init__(self, dimension: int) -> None:
        figure = Figure(figsize=SIZE, dpi=100)
        with house_style():
            self._axes = figure.add_axes((0.0, 0.0, 1.0, 1.0) if dimension == 3 else (0.11, 0.12, 0.87, 0.86))
            # Few ticks: matplotlib spends much of its time on these.
            self._axes.locator_params(nbins=4)
        self._picture = Picture(figure)
        self._shown: World | None = None
        self.drawing: Any = None

    def _draw(self) -> None:
        world: Any = self._shown
        self.drawing = RobotDrawing(self._axes, world.robot, world.scene, _poses(world))
        self._mark = LineCollection([], colors=ORANGE, linewidths=8, alpha=0.45, zorder=4.5)
        self._axes.add_collection(self._mark, autolim=False)

    def png(self, world: World, azimuth: float, cable: int) -> bytes:
        """The picture with a cable marked, from 0; of robots in space as seen from an azimuth [deg]."""
        with house_style():
            if world is not self._shown:
                self._shown = world
                self._picture.redraw(self._draw)
            drawing = self.drawing
            if drawing.robot.dimension == 3:
                drawing.turn(azimuth)
                drawing.move(drawing.pose)
            exit_point = drawing.robot.exit_points[cable]
            ends = np.stack([exit_point,
                             exit_point - cable_vectors(drawing.robot, drawing.pose)[cable]])
            self._mark.set_segments([drawing.view.flat(ends)])
            return self._picture.png()


def _poses(world: World) -> Pose:
    """The start, which is drawn, and the end of the task: both must fit into the picture."""
    poses = [world.pose, world.tasks["default"].end]
    return Pose.of(np.stack([pose.position for pose in poses]),
                   np.stack([pose.rotation for pose in poses]))
