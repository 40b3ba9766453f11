"""A design beside its brief: the robot with the box of positions it must serve, and its margins over that box."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ...arrays import Array
from ...errors import InvalidInput
from ...robot.pose import Pose
from ...view.drawing import RobotDrawing
from ...view.outlines import box_corners, box_edges
from ...view.style import INK, WARNING, house_style
from ...world import World
from ..brief import Brief

_ACROSS, _LIMIT = 5, 300.0
"""Places along the longest edge of the box; margin of the strongest color [N]."""


def plot_design(brief: Brief, world: World, title: str = "") -> Figure:
    """The robot with the brief's box, and the smallest margin at places of the box, bottom, middle and top.

    brief : Brief
    world : the design
    Returns Figure: numbers are margins [N], the smallest over all pushes and headings; boxed and bold where negative.
    Raises InvalidInput for a design whose margins the brief cannot judge, with its reasons.
    """
    import matplotlib.pyplot as plt

    verdict = brief.judge(world)
    if not any(point.name == "holds the load everywhere" for point in verdict.points):
        raise InvalidInput("this design cannot be drawn with its margins:\n" + "\n".join(verdict.reasons))
    with house_style():
        figure = plt.figure(figsize=(9.6, 4.2), layout="constrained")
        grid = figure.add_gridspec(3, 2, width_ratios=(1.5, 1))
        draw_design(figure.add_subplot(grid[:, 0]), brief, world)
        heights = np.linspace(brief.upper[2], brief.lower[2], 3)
        for row, height in enumerate(heights):
            axes = figure.add_subplot(grid[row, 1])
            _map(axes, brief, world, float(height))
            axes.set(ylabel="y [m]", xlabel="x [m]" if row == 2 else "", title=f"margin [N] at z = {height:g} m")
        held = verdict.margin >= 0
        figure.suptitle(f"{title or world.title or world.name}: {world.robot.n_cables} cables, smallest margin "
                        f"{verdict.margin:.0f} N{'' if held else ' (limits broken)'}")
    return figure


def draw_design(axes: Axes, brief: Brief, world: World, azimuth: float = 25.0) -> RobotDrawing:
    """The robot at its start, the box of positions dashed."""
    drawing = RobotDrawing(axes, world.robot, world.scene, world.pose, azimuth)
    middle = Pose((brief.lower + brief.upper) / 2)
    box = box_corners(brief.upper - brief.lower, np.zeros(3), middle)
    axes.add_collection(LineCollection(list(drawing.view.flat(box[box_edges(3)])), colors=INK, linewidths=1.2,
                                       linestyles=[(0, (4, 3))], zorder=7), autolim=False)
    for artist in axes.get_children():
        artist.set_animated(False)  # a still picture
    return drawing


def _map(axes: Axes, brief: Brief, world: World, height: float) -> None:
    x, y, margins = _margins(brief, world, height)
    shown: Any = np.clip(np.nan_to_num(margins, neginf=-_LIMIT), -_LIMIT, _LIMIT)
    axes.pcolormesh(x, y, shown.T, cmap="PuOr", vmin=-_LIMIT, vmax=_LIMIT, shading="nearest", edgecolors="white")
    for i, j in np.ndindex(margins.shape):
        number = "none" if not np.isfinite(margins[i, j]) else f"{margins[i, j]:.0f}".replace("-", "−")
        axes.text(float(x[i]), float(y[j]), number, ha="center", va="center", fontsize=9, color=INK,
                  fontweight="bold" if margins[i, j] < 0 else "normal",
                  bbox={"facecolor": WARNING, "edgecolor": INK, "pad": 1.5} if margins[i, j] < 0 else
                  {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.0})
    axes.set(xticks=x[::2], yticks=y)
    axes.grid(visible=False)


def _margins(brief: Brief, world: World, height: float) -> tuple[Array, Array, Array]:
    """Places along x and y, and (nx, ny) the smallest margin there over pushes and three headings."""
    x, y = np.linspace(brief.lower[0], brief.upper[0], _ACROSS), np.linspace(brief.lower[1], brief.upper[1], 3)
    headings = brief.yaw * np.array([-1.0, 0.0, 1.0])
    places = np.array([[a, b, height, turn] for a, b, turn in product(x, y, headings)])
    poses = Pose(places[:, :3], rpy=np.pad(places[:, 3:], ((0, 0), (2, 0))))
    return x, y, brief.margins(world.robot, poses).min(axis=0).reshape(len(x), len(y), -1).min(axis=-1)
