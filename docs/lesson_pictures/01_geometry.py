"""The picture of lesson 1: the loop O, P, B, A of one cable, drawn into the lesson's first cell.

python docs/lesson_pictures/01_geometry.py
"""

from __future__ import annotations

from io import BytesIO

import matplotlib
import numpy as np
from attachment import attach
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cdprlab.view.style import BLUE, GREEN, GREY, INK, PURPLE, VERMILION, house_style

ORIGIN = np.array([-2.75, -0.3])  # drawn off the frame's middle, so that the loop is wide open
EXITS = np.array([[-2.0, 0.0], [2.0, 0.0], [2.0, 2.0], [-2.0, 2.0]])
ANCHORS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [0.8, 0.34]
P = np.array([0.35, 0.66])
ROTATION = np.array([[0.94, -0.342], [0.342, 0.94]])


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    with house_style():
        figure = Figure(figsize=(7.6, 3.9))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(-3.15, 2.6), ylim=(-0.6, 2.35), aspect="equal")
        axes.axis("off")
        draw(axes)
        file = BytesIO()
        figure.savefig(file, dpi=100)
    return file.getvalue()


def draw(axes: Axes) -> None:
    """Frame, platform, four cables, and the loop of cable 3."""
    corners = P + ANCHORS @ ROTATION.T
    axes.plot(*EXITS[[0, 1, 2, 3, 0]].T, color="#C9CED6", lw=5, zorder=0)
    for i in (0, 1, 3):
        axes.plot(*np.array([corners[i], EXITS[i]]).T, color=GREY, lw=1.2, ls=(0, (5, 3)))
    axes.fill(*corners.T, facecolor="#E8EBEF", edgecolor=INK, lw=1.5)
    axes.plot(*EXITS.T, "o", color=INK, ms=8)
    axes.plot(*corners.T, "o", mfc="white", mec=INK, ms=7)
    frame(axes, ORIGIN, np.eye(2), 0.5, ("x", "y"))
    frame(axes, P, ROTATION, 0.25, ("x′", "y′"))
    arrow(axes, ORIGIN, EXITS[2], BLUE, r"$\mathbf{a}_3$", (0.3, 0.18))
    arrow(axes, ORIGIN, P, GREEN, r"$\mathbf{p}$", (0.5, 0.15))
    arrow(axes, P, corners[2], PURPLE, r"$R\,\mathbf{b}_3$", (0.72, -0.21))
    arrow(axes, corners[2], EXITS[2], VERMILION, r"$\mathbf{l}_3$", (0.5, -0.16))
    for place, words, side in ((ORIGIN, "O", (-0.14, -0.12)), (P, "P", (0.0, -0.15)),
                               (corners[2], "anchor point $B_3$", (0.57, -0.12)),
                               (EXITS[2], "exit point $A_3$", (-0.2, 0.2)), (P, "platform", (0.0, -0.33))):
        axes.text(*(place + side), words, ha="center", va="center")



def frame(axes: Axes, origin: np.ndarray, turn: np.ndarray, size: float, names: tuple[str, str]) -> None:
    """Two thin axes with their names."""
    for axis, name in zip(turn.T, names):
        tip = origin + size * axis
        axes.annotate("", tip, origin, arrowprops={"arrowstyle": "->", "color": INK, "lw": 1.2, "shrinkA": 0,
                                                   "shrinkB": 0})
        axes.text(*(origin + (size + 0.1) * axis), name, ha="center", va="center", fontsize=10)


def arrow(axes: Axes, tail: np.ndarray, tip: np.ndarray, color: str, name: str, label: tuple[float, float]) -> None:
    """A thick arrow; ``label`` = how far along its name stands, and how far beside [m]."""
    axes.annotate("", tip, tail, arrowprops={"arrowstyle": "-|>", "color": color, "lw": 2.4, "mutation_scale": 16,
                                             "shrinkA": 0, "shrinkB": 3})
    along = (tip - tail) / np.linalg.norm(tip - tail)
    place = tail + label[0] * (tip - tail) + label[1] * np.array([-along[1], along[0]])
    axes.text(*place, name, color=color, fontsize=14, ha="center", va="center")


if __name__ == "__main__":
    attach("01_geometry", "loop.png", picture())
