"""The picture of lesson 06: the same frame, two robots, nested workspaces and their margins.

python docs/lesson_pictures/06_workspaces.py
"""

from __future__ import annotations

from io import BytesIO
from itertools import product
from typing import Any

import matplotlib
import numpy as np
from attachment import attach
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

import cdprlab as cl
from cdprlab.view.drawing import RobotDrawing
from cdprlab.view.style import INK, PURPLE, VERMILION, house_style
from cdprlab.workspace import position_grid

PUSH = 40.0
"""[N]"""


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    with house_style():
        figure = Figure(figsize=(9.6, 4.6), layout="constrained")
        panels = figure.subplots(1, 2, sharey=True)
        _maps(panels[0], "planar_rigid", "four cables, two from below")
        _maps(panels[1], "planar_suspended", "four cables from above")
        panels[1].set_ylabel("")
        handles = [panels[0].plot([], [], color=color, linestyle=dashes, linewidth=width, label=label)[0]
                   for _, label, color, dashes, width in _questions(3)]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
        file = BytesIO()
        figure.savefig(file, dpi=80)
    small = BytesIO()
    Image.open(file).convert("RGB").quantize(96, dither=Image.Dither.NONE).save(small, "png", optimize=True)
    return small.getvalue()


def _questions(n_dof: int) -> list[tuple[Any, str, str, Any, float]]:
    pushes = [[x, y, *[0.0] * (n_dof - 2)] for x, y in product((PUSH, -PUSH), repeat=2)]
    return [(cl.WrenchClosure(), "wrench closure", PURPLE, (0, (1.5, 1.5)), 3.0),
            (cl.WrenchFeasible(), "weight held within limits", INK, "solid", 2.0),
            (cl.WrenchFeasible(pushes), f"weight and pushes of {PUSH:g} N held", VERMILION, (0, (5, 2)), 2.0)]


def _maps(axes: Axes, name: str, title: str) -> None:
    world = cl.load_world(name)
    drawing = RobotDrawing(axes, world.robot, world.scene, world.pose)
    drawing.move(world.pose)
    grid = position_grid([-1.99, 0.02], [1.99, 3.2], 0.03)
    x, y = grid.axes["x"], grid.axes["y"]
    for criterion, _, color, dashes, width in _questions(world.robot.n_dof):
        inside, margin = cl.workspace(world.robot, grid, criterion)
        if color == INK:
            share = np.ma.masked_where(~inside, margin / np.percentile(margin[inside], 97))
            axes.contourf(x, y, grid.field(share).T, levels=np.linspace(0, 1, 6), cmap="Blues", vmin=-0.3, vmax=1.6,
                          extend="max", zorder=0.5)
        # A margin of 0 fills all of the outside of closure: the border is where the verdict changes.
        axes.contour(x, y, grid.field(inside).T.astype(float), levels=[0.5], colors=color, linestyles=[dashes],
                     linewidths=width, zorder=0.8)
    axes.grid(visible=False)
    axes.set(title=title, ylim=(-0.15, 3.35), xlim=(-2.25, 2.25))
    for artist in axes.get_children():
        artist.set_animated(False)


if __name__ == "__main__":
    attach("06_workspaces", "workspaces.png", picture())
