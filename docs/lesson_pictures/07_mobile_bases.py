"""The picture of lesson 7: a base drives, its winches reel in, the load stays.

python docs/lesson_pictures/07_mobile_bases.py
"""

from __future__ import annotations

from io import BytesIO
from typing import Any

import matplotlib
from attachment import attach
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import cdprlab as cl
from cdprlab.view.style import GREY, INK, cable_style, house_style

DRIVEN = 0.5
"""How far the left base drives to the right [m]."""


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    world = cl.load_world("planar_mcdpr")
    after = world.robot.with_bases({"left": (DRIVEN, 0.0, 0.0)})
    with house_style():
        figure = Figure(figsize=(8, 4.8), layout="constrained")
        axes = figure.subplots()
        _robot(axes, world.robot, world.pose, faint=True)
        _robot(axes, after, world.pose)
        axes.axhline(0, color=GREY, linewidth=1.6, zorder=0)
        arrow = {"arrowstyle": "-|>", "color": INK, "linewidth": 2, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (DRIVEN, -0.16), (0, -0.16), arrowprops=arrow)
        axes.text(DRIVEN / 2, -0.33, "the base drives: ρ̇₁ > 0", ha="center")
        axes.text(2.0, -0.33, "this base stands", ha="center")
        axes.text(1.18, 1.93, "the platform\nholds still", ha="center", va="bottom")
        axes.text(-0.12, 1.3, "cables 1 and 2\nare reeled in", ha="right", va="center")
        axes.text(2.12, 1.3, "cables 3 and 4\nkeep their length", ha="left", va="center")
        axes.set(xlim=(-0.95, 3.0), ylim=(-0.42, 2.3), xlabel="x [m]", ylabel="y [m]", aspect="equal")
        axes.grid(visible=False)
        file = BytesIO()
        figure.savefig(file, dpi=88)
    return file.getvalue()


def _robot(axes: Axes, robot: cl.Robot, pose: cl.Pose, faint: bool = False) -> None:
    """Masts on wheels, cables and load; faint where the robot was before."""
    alpha = 0.25 if faint else 1.0
    look: dict[str, Any] = {"alpha": alpha, "color": GREY, "solid_capstyle": "round"}
    for base in robot.bases:
        x = float(base.position[0])
        axes.plot([x, x], [0.12, 2.0], linewidth=4, **look)
        axes.plot(x + base.footprint[:, 0], [0.12, 0.12], linewidth=6, **look)
        axes.plot(x + 0.75 * base.footprint[:, 0], [0.045, 0.045], "o", markersize=9, color=GREY, alpha=alpha)
    for i, exit_point in enumerate(robot.exit_points):
        color, _ = cable_style(i)
        axes.plot(*zip(exit_point, pose.position), color=color, alpha=alpha, linewidth=2.2,
                  linestyle="--" if faint else "-")
        axes.plot(*exit_point, "o", color=INK, alpha=alpha, markersize=7)
        if not faint:
            middle = 0.62 * exit_point + 0.38 * pose.position
            axes.text(*middle, str(i + 1), ha="center", va="center", fontweight="bold",
                      bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5})
    if not faint:
        axes.plot(*pose.position, "s", color="#7896B4", markeredgecolor=INK, markersize=15, zorder=5)


if __name__ == "__main__":
    attach("07_mobile_bases", "mobile_bases.png", picture())
