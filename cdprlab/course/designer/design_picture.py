"""The picture of a design: the robot at its start, the edited cable marked."""

from __future__ import annotations

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ...mechanics.cables import anchor_offsets
from ...robot.pose import Pose
from ...view.drawing import RobotDrawing
from ...view.picture import Picture
from ...view.style import ORANGE, house_style
from ...world import World

SIZE = (5.2, 4.3)
"""[inch at 100 pixels]: with the slice and the fields beside it, it fits a page 1280 pixels wide."""


class DesignPicture:
    """One design drawn; another one is another picture.

    world : what is drawn
    cable : from 0, marked
    azimuth : of the eye [deg], spatial robots only
    """

    def __init__(self, world: World, cable: int, azimuth: float) -> None:
        figure = Figure(figsize=SIZE, dpi=100)
        with house_style():
            axes = figure.add_axes((0.0, 0.0, 1.0, 1.0) if world.robot.dimension == 3 else (0.11, 0.12, 0.87, 0.86))
            # Few ticks, and a title that stays in place: matplotlib spends much of its time on these.
            axes.set_title("", y=1.0)
            axes.locator_params(nbins=4)
            self.drawing = RobotDrawing(axes, world.robot, world.scene, _poses(world), azimuth)
            self._mark = LineCollection([], colors=ORANGE, linewidths=8, alpha=0.45, zorder=4.5, animated=True)
            axes.add_collection(self._mark, autolim=False)
        self._picture, self._cable = Picture(figure), cable

    def png(self, azimuth: float | None = None, cable: int | None = None) -> bytes:
        """The picture, seen from another side or with another cable marked if told so."""
        drawing = self.drawing
        self._cable = self._cable if cable is None else cable
        with house_style():
            if azimuth is not None and drawing.robot.dimension == 3:
                drawing.turn(azimuth)
                drawing.move(drawing.pose)
            anchors = drawing.pose.position + anchor_offsets(drawing.robot, drawing.pose)
            ends = np.stack([drawing.robot.exit_points[self._cable], anchors[self._cable]])
            self._mark.set_segments([drawing.view.flat(ends)])
            return self._picture.png()


def _poses(world: World) -> Pose:
    """The start, which is drawn, and the end of the task: both must fit into the picture."""
    end = getattr(world.tasks["default"], "end", world.pose)
    poses = [world.pose, end]
    return Pose.of(np.stack([pose.position for pose in poses]), np.stack([pose.rotation for pose in poses]))
