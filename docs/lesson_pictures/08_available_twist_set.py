"""The picture of lesson 8: a wanted twist, and the two sets that do not and do hold it.

python docs/lesson_pictures/08_available_twist_set.py
"""

from __future__ import annotations

from io import BytesIO

import matplotlib
from attachment import attach
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import cdprlab as cl
from cdprlab.course.pictures.set_charts import draw_polygon
from cdprlab.view.style import GREY, INK, cable_style, house_style

REQUIRED = (1.15, 1.675)
"""The twist of Rasheed et al. 2018, section 4.1 [m/s]."""


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    world = cl.load_world("planar_mcdpr")
    with house_style():
        figure = Figure(figsize=(9.6, 4.5), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
        _robot(left, world)
        for style, (moving, label) in enumerate((("none", "bases fixed"), ("all", "bases drive"))):
            draw_polygon(right, cl.available_twist_set(world.robot, world.pose, moving).vertices, style, label)
        right.plot(*REQUIRED, "*", color=INK, markersize=15, label="wanted twist")
        right.set(xlim=(-3.4, 3.4), ylim=(-3.4, 3.4), xlabel="$v_x$ [m/s]", ylabel="$v_y$ [m/s]", aspect="equal")
        figure.legend(loc="outside lower center", ncols=3)
        file = BytesIO()
        figure.savefig(file, dpi=80)
    return file.getvalue()


def _robot(axes: Axes, world: cl.World) -> None:
    """Masts on wheels, cables, load and its wanted velocity."""
    robot, place = world.robot, world.pose.position
    for base in robot.bases:
        x = float(base.position[0])
        axes.plot([x, x], [0.12, 2.0], linewidth=4, color=GREY)
        axes.plot(x + base.footprint[:, 0], [0.12, 0.12], linewidth=6, color=GREY)
        axes.plot(x + 0.75 * base.footprint[:, 0], [0.045, 0.045], "o", markersize=9, color=GREY)
        axes.annotate("", (x + 0.28, -0.2), (x - 0.28, -0.2), arrowprops={"arrowstyle": "<|-|>", "color": INK})
        axes.text(x, -0.25, "0.8 m/s", ha="center", va="top")
    for i, exit_point in enumerate(robot.exit_points):
        axes.plot(*zip(exit_point, place), color=cable_style(i).color, linewidth=2.2)
        axes.plot(*exit_point, "o", color=INK, markersize=7)
        axes.text(*(0.62 * exit_point + 0.38 * place), str(i + 1), ha="center", va="center", fontweight="bold",
                  bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5})
    axes.axhline(0, color=GREY, linewidth=1.6, zorder=0)
    tip = place + [0.3 * speed for speed in REQUIRED]
    axes.annotate("", tuple(tip), tuple(place), zorder=6,
                  arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 2.6, "shrinkA": 0, "shrinkB": 0})
    axes.text(tip[0] + 0.05, tip[1], "wanted: (1.15, 1.675) m/s", va="center")
    axes.plot(*place, "s", color="#7896B4", markeredgecolor=INK, markersize=14, zorder=5)
    axes.set(xlim=(-0.6, 2.75), ylim=(-0.5, 2.4), xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.grid(visible=False)


if __name__ == "__main__":
    attach("08_available_twist_set", "twist_set.png", picture())
