"""The designer's two pictures, made once and then drawn anew: the robot at its start, and a slice of its workspace."""

from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from ...mechanics.cables import cable_vectors
from ...robot.pose import Pose
from ...view.drawing import RobotDrawing
from ...view.notebook import picture_tag
from ...view.picture import Picture
from ...view.style import INK, ORANGE, house_style
from ...world import World
from ..explorers.explorer import movable
from .assessment import Slice
from .report import in_words

_SIZE = (6.6, 3.7)
"""[inch at 100 pixels]: beside the fields, on a page 848 pixels wide, it is shown a little smaller."""


class DesignPicture:
    """Designs drawn one after the other.

    dimension : of them all
    """

    def __init__(self, dimension: int) -> None:
        figure = Figure(figsize=_SIZE, dpi=100)
        with house_style():
            self._axes = figure.add_axes((0.0, 0.0, 1.0, 1.0) if dimension == 3 else (0.11, 0.12, 0.87, 0.86))
            # Few ticks: matplotlib spends much of its time on these.
            self._axes.locator_params(nbins=4)
        self._picture = Picture(figure)
        self._shown: World | None = None
        self.drawing: Any = None

    def _draw(self) -> None:
        world: Any = self._shown
        ends = [world.pose, world.tasks["default"].end]   # both must fit into the picture
        poses = Pose([end.position for end in ends], matrix=[end.rotation for end in ends])
        self.drawing = RobotDrawing(self._axes, world.robot, world.scene, poses)
        self._mark = movable(self._axes, color=ORANGE, linewidth=8, alpha=0.45, zorder=4.5, solid_capstyle="butt")

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
            ends = exit_point, exit_point - cable_vectors(drawing.robot, drawing.pose)[cable]
            self._mark.set_data(*drawing.view.flat(np.stack(ends)).T)
            return self._picture.png()


_SLICE_SIZE = (2.5, 1.85)
_KINDS = {"not held": "#FFFFFF", "held, but cables interfere (dotted)": "#F3C98B",
          "held within the limits": "#8FC1E3"}
_LEGEND = "".join(f'<div><span style="background: {color}; border: 1px solid {INK}; padding: 0 0.6em"></span> '
                  f"{word}</div>" for word, color in reversed(_KINDS.items()))


class SlicePicture:
    """Cells of a plane: white, dotted orange, blue; a cross at the start; axes in metres."""

    def __init__(self) -> None:
        with house_style():
            figure = Figure(_SLICE_SIZE, dpi=100)
            self._axes = figure.add_axes((0.2, 0.24, 0.77, 0.73))
            # Few ticks, no grid; title and legend are the page's: matplotlib spends much of its
            # time on these.
            self._axes.locator_params(nbins=4)
            self._axes.grid(visible=False)
            self._cells = self._axes.imshow(np.zeros((1, 1)), ListedColormap(list(_KINDS.values())), vmin=0, vmax=2,
                                            origin="lower", animated=True)
            self._tangled = movable(self._axes, ".", color=INK, markersize=2)
            self._start = movable(self._axes, "+", color=INK, markersize=12, markeredgewidth=3)
        self._picture = Picture(figure)
        self._window: object = None

    def html(self, world: World, found: Slice) -> str:
        """A world's slice with title and legend."""
        (across, x), (up, y) = found.grid.axes.items()
        half = found.grid.step / 2
        self._cells.set_data(found.grid.field(found.held.astype(int) + found.clear).T)
        window = (x[0] - half[0], x[-1] + half[0], y[0] - half[1], y[-1] + half[1])
        if (across, up, window) != self._window:   # moved axes are drawn anew, all else is not
            self._window = across, up, window
            self._cells.set_extent(window)
            self._axes.set(xlabel=f"{across} [m]", ylabel=f"{up} [m]")
        tangled = np.argwhere(found.grid.field(found.held ^ found.clear))
        self._tangled.set_data(x[tangled[:, 0]], y[tangled[:, 1]])
        place = dict(zip("xyz", world.pose.position))
        self._start.set_data([place.pop(across)], [place.pop(up)])
        with house_style():
            picture = picture_tag(self._picture.png(), in_words(found))
        level = "".join(f" at {name} = {value:.2f} m" for name, value in place.items())
        return f"<b>Held at rest: {across}–{up}{level}</b>{picture}{_LEGEND}"
