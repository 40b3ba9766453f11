"""The picture of lesson 14: a robot as drawn and as built, and what its cables then pull at rest, wound or commanded.

python docs/lesson_pictures/14_model_errors.py
"""

from __future__ import annotations

from io import BytesIO

import matplotlib
import numpy as np
from attachment import attach
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import cdprlab as cl
from cdprlab.view.style import BLUE, GREY, INK, VERMILION, house_style

DRAWN_LARGER = 60
"""Errors of 5 mm would not be seen."""


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    world = cl.load_world("fastkit_suspended")
    real = cl.perturbed(world, exit_points=0.005, seed=1)
    with house_style():
        figure = Figure(figsize=(8.6, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
        _robots(left, world, real)
        _tensions(right, world, real)
        file = BytesIO()
        figure.savefig(file, dpi=88)
    return file.getvalue()


def _robots(axes: Axes, world: cl.World, real: cl.World) -> None:
    """From the side, thin as drawn, thick as built."""
    robot, pose = world.robot, world.task().end
    anchors = pose.position + robot.anchor_points @ pose.rotation.T
    shifted = robot.exit_points + DRAWN_LARGER * real.errors["exit_points"]
    for believed, built, anchor in zip(robot.exit_points, shifted, anchors):
        axes.plot(*zip(believed[[0, 2]], anchor[[0, 2]]), color=GREY, linewidth=1.0, linestyle=(0, (4, 2)))
        axes.plot(*zip(built[[0, 2]], anchor[[0, 2]]), color=BLUE, linewidth=1.6)
        axes.annotate("", built[[0, 2]], believed[[0, 2]], arrowprops={"arrowstyle": "-|>", "color": VERMILION})
        axes.plot(*believed[[0, 2]], "o", color=GREY, markersize=5)
    corners = anchors[:, [0, 2]]
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes.fill(*np.array([low, [high[0], low[1]], high, [low[0], high[1]]]).T, facecolor="#7896B4", edgecolor=INK)
    axes.set(xlim=(-3.3, 3.3), ylim=(0.4, 2.9), xlabel="x [m]", ylabel="z [m]", aspect="equal",
             title=f"as drawn and as built ({DRAWN_LARGER} ×)")


def _tensions(axes: Axes, world: cl.World, real: cl.World) -> None:
    """At rest: wanted, and what ropes wound to the model's lengths pull."""
    robot, pose = world.robot, world.task().end
    stiffness = robot.elasticity.axial_stiffness
    wanted = cl.distribute_tensions(cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), robot.tension_min,
                                    robot.tension_max).tensions
    wound = cl.equilibrium(real.robot, cl.cable_lengths(robot, pose) / (1 + wanted / stiffness), pose,
                           axial_stiffness=stiffness).tensions
    place = np.arange(1, 9)
    axes.bar(place - 0.2, wound, 0.38, color=VERMILION, label="wound to length")
    axes.bar(place + 0.2, wanted, 0.38, color=BLUE, hatch="//", edgecolor="white", label="tension control")
    axes.set(xlabel="cable", ylabel="tension at rest [N]", xticks=place, ylim=(0, 30), title="exit points off by 5 mm")
    axes.legend(loc="upper left", ncols=2)


if __name__ == "__main__":
    attach("14_model_errors", "model_errors.png", picture())
