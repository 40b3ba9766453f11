"""A design beside its brief: the robot with the box of positions it must serve, and its margins over that box."""

from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ...arrays import checked
from ...errors import InvalidInput
from ...robot.pose import Pose
from ...view.drawing import RobotDrawing
from ...view.outlines import box_corners, box_edges
from ...view.style import INK, WARNING, house_style
from ...world import World
from ..brief import Brief
from .panels import HALO

_ACROSS, _LIMIT = 5, 300.0
"""Places along the longest edge of the box; margin of the strongest color [N]."""


@checked
def plot_design(brief: Brief, world: World, title: str = "") -> Figure:
    """The robot with the brief's box, and the smallest margin at places of the box, bottom, middle and top.

    brief : Brief
    world : the design
    Returns Figure: numbers are margins [N], the smallest over all pushes and headings; boxed
    and bold where negative.
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
        for row, height in enumerate(np.linspace(brief.upper[2], brief.lower[2], 3)):
            axes = figure.add_subplot(grid[row, 1])
            _draw_margins(axes, brief, world, height)
            axes.set(ylabel="y [m]", xlabel="x [m]" if row == 2 else "", title=f"margin [N] at z = {height:g} m")
        figure.suptitle(f"{title or world.title or world.name}: {world.robot.n_cables} cables, smallest margin "
                        f"{verdict.margin:.0f} N{'' if verdict.margin >= 0 else ' (limits broken)'}")
    return figure


def draw_design(axes: Axes, brief: Brief, world: World) -> None:
    """The robot at its start, the box of positions dashed."""
    drawing = RobotDrawing(axes, world.robot, world.scene, world.pose)
    box = box_corners(brief.upper - brief.lower, Pose((brief.lower + brief.upper) / 2))
    axes.add_collection(LineCollection(list(drawing.view.flat(box[box_edges(3)])), colors=INK, linewidths=1.2,
                                       linestyles=[(0, (4, 3))], zorder=7), autolim=False)
    for artist in axes.get_children():
        artist.set_animated(False)  # a still picture


def _draw_margins(axes: Axes, brief: Brief, world: World, height: float) -> None:
    """A field a place: the smallest margin there over pushes and three headings."""
    (left, front, _), (right, back, _) = brief.lower, brief.upper
    x, y = np.linspace(left, right, _ACROSS), np.linspace(front, back, 3)
    places = np.array([*product(x, y, [height], brief.yaw * np.array([-1.0, 0.0, 1.0]))])
    poses = Pose(places[:, :3], rpy=places[:, 3:] * [0.0, 0.0, 1.0])
    margins = brief.margins(world.robot, poses).min(axis=0).reshape(_ACROSS, 3, 3).min(axis=-1)
    axes.pcolormesh(x, y, margins.clip(-_LIMIT, _LIMIT).T, cmap="PuOr", vmin=-_LIMIT, vmax=_LIMIT, shading="nearest",
                    edgecolors="white")
    for (i, j), margin in np.ndenumerate(margins):
        number = f"{margin:.0f}".replace("-", "−") if np.isfinite(margin) else "none"
        look = {"weight": "bold", "bbox": {"facecolor": WARNING, "edgecolor": INK, "pad": 1.5}} if margin < 0 \
            else {"bbox": HALO}
        axes.text(float(x[i]), float(y[j]), number, ha="center", va="center", fontsize=9, color=INK, **look)
    axes.set(xticks=x[::2], yticks=y)
    axes.grid(visible=False)
