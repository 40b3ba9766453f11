"""The picture of lesson 9: a robot on light masts, what its cables can exert, and what of it keeps the masts upright.

python docs/lesson_pictures/09_available_wrench_set.py
"""

from __future__ import annotations

import dataclasses
from io import BytesIO

import matplotlib
from attachment import attach
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import cdprlab as cl
from cdprlab.course.pictures.set_charts import draw_polygon
from cdprlab.view.style import GREEN, GREY, INK, VERMILION, cable_style, house_style

MASS = 30.0
"""Of each mast [kg]."""


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    world = cl.load_world("planar_mcdpr")
    light = tuple(dataclasses.replace(base, mass=MASS) for base in world.robot.bases)
    robot = dataclasses.replace(world.robot, bases=light)
    with house_style():
        figure = Figure(figsize=(8.6, 4.3), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.1))
        _robot(left, robot, world.pose)
        _sets(right, robot, world.pose)
        file = BytesIO()
        figure.savefig(file, dpi=88)
    return file.getvalue()


def _robot(axes: Axes, robot: cl.Robot, pose: cl.Pose) -> None:
    """Masts on wheels, cables and load; wheels over which a mast can tip are crossed."""
    axes.axhline(0, color=GREY, linewidth=1.6, zorder=0)
    for base, inner in zip(robot.bases, (0, 1)):
        x = float(base.position[0])
        axes.plot([x, x], [0.12, 2.0], linewidth=4, color=GREY, solid_capstyle="round")
        axes.plot(x + base.footprint[:, 0], [0.12, 0.12], linewidth=6, color=GREY, solid_capstyle="round")
        for k, foot in enumerate(base.footprint[:, 0]):
            axes.plot(x + foot, 0.045, "X" if k == inner else "o", markersize=13 if k == inner else 9,
                      color=VERMILION if k == inner else GREY, zorder=6)
    for i, exit_point in enumerate(robot.exit_points):
        color, _ = cable_style(i)
        axes.plot(*zip(exit_point, pose.position), color=color, linewidth=2.2)
        axes.plot(*exit_point, "o", color=INK, markersize=7)
        axes.text(*(0.62 * exit_point + 0.38 * pose.position), str(i + 1), ha="center", va="center", fontweight="bold",
                  bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5})
    axes.plot(*pose.position, "s", color="#7896B4", markeredgecolor=INK, markersize=15, zorder=5)
    axes.set(xlim=(-0.6, 2.6), ylim=(-0.25, 2.3), xlabel="x [m]", ylabel="y [m]", aspect="equal",
             title=f"two masts of {MASS:g} kg on wheels")
    axes.grid(visible=False)


def _sets(axes: Axes, robot: cl.Robot, pose: cl.Pose) -> None:
    """The forces that limits allow, and those that also keep the masts upright."""
    draw_polygon(axes, cl.available_wrench_set(robot, pose).vertices, 0, "within the tension limits")
    draw_polygon(axes, cl.available_wrench_set(robot, pose, tipping=True).vertices, 1, "and no mast tips")
    axes.plot(*-cl.gravity_wrench(robot, pose), "*", color=GREEN, markersize=15, markeredgecolor="white", zorder=5,
              linestyle="none", label="holds the load")
    axes.set(xlim=(-180, 180), ylim=(-220, 110), xlabel="$f_x$ [N]", ylabel="$f_y$ [N]", aspect="equal",
             title="forces the cables can exert")
    axes.legend(loc="lower center", ncols=2, fontsize=8.5)


if __name__ == "__main__":
    attach("09_available_wrench_set", "wrench_set.png", picture())
