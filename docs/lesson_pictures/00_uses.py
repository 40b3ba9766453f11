"""What cable robots are for, in four sketches: the second picture of lesson 00. Writes it into the lesson's source.

Run: python docs/lesson_pictures/00_uses.py
"""

from __future__ import annotations

from io import BytesIO

import matplotlib
import numpy as np
from attachment import attach
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cdprlab.view.style import BLUE, GREY, INK, house_style

PALE = "#E8EBEF"


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    with house_style():
        figure = Figure(figsize=(8, 2.3))
        for column, (draw, title) in enumerate(((stadium, "a camera above a field"), (dish, "FAST, a 500 m telescope"),
                                                (facade, "work on a façade"), (hall, "moving loads in a hall"))):
            axes = figure.add_axes((0.25 * column, 0, 0.25, 1))
            axes.set(xlim=(-1.15, 1.15), ylim=(-0.32, 1.2), aspect="equal")
            axes.axis("off")
            draw(axes)
            axes.text(0, -0.24, title, ha="center", va="center", fontsize=10)
        file = BytesIO()
        figure.savefig(file, dpi=100)
    return file.getvalue()


def cables(axes: Axes, *pairs: tuple[tuple[float, float], tuple[float, float]]) -> None:
    """Lines from exit points to anchor points."""
    for exit_point, anchor in pairs:
        axes.plot(*np.transpose([exit_point, anchor]), color=BLUE, lw=1.2)
        axes.plot(*exit_point, "o", color=INK, ms=4)


def stadium(axes: Axes) -> None:
    """Four masts at the corners, the camera between them."""
    axes.fill([-0.8, 0.8, 1.0, -1.0], [0.22, 0.22, 0.0, 0.0], color=PALE, ec=GREY)
    masts = [(-1.0, 0.95), (1.0, 0.95), (-0.75, 1.1), (0.75, 1.1)]
    for x, y in masts:
        axes.plot([x, x], [0.0 if y < 1 else 0.22, y], color=GREY, lw=3, zorder=0)
    cables(axes, *[(mast, (0.15, 0.58)) for mast in masts])
    axes.fill(*np.transpose([(0.07, 0.5), (0.23, 0.5), (0.23, 0.62), (0.07, 0.62)]), color=INK)


def dish(axes: Axes) -> None:
    """The reflector below, six towers, the receiver's cabin in the focus."""
    angle = np.linspace(1.15 * np.pi, 1.85 * np.pi, 60)
    axes.fill(1.0 * np.cos(angle), 0.78 + 0.82 * np.sin(angle), color=PALE, ec=GREY)
    towers = [(x, 1.08 - 0.1 * abs(x)) for x in (-1.08, -0.75, -0.35, 0.35, 0.75, 1.08)]
    for x, y in towers:
        axes.plot([x, x], [0.2 if abs(x) > 0.9 else 0.45, y], color=GREY, lw=1.5, zorder=0)
    cables(axes, *[(tower, (-0.1, 0.6)) for tower in towers])
    axes.fill(*np.transpose([(-0.2, 0.5), (0.0, 0.5), (0.0, 0.62), (-0.2, 0.62)]), color=INK)


def facade(axes: Axes) -> None:
    """A wall with windows, and a platform on four cables in front of it."""
    axes.fill([-0.8, 0.8, 0.8, -0.8], [0, 0, 1.1, 1.1], color=PALE, ec=GREY)
    for x in (-0.6, -0.2, 0.2, 0.6):
        for y in (0.15, 0.5, 0.85):
            axes.fill(x + np.array([-0.1, 0.1, 0.1, -0.1]), y + np.array([-0.08, -0.08, 0.1, 0.1]),
                      color="white", ec=GREY)
    corners = [(-0.1, 0.42), (0.3, 0.42), (0.3, 0.56), (-0.1, 0.56)]
    cables(axes, ((-0.8, 0), corners[0]), ((0.8, 0), corners[1]), ((0.8, 1.1), corners[2]), ((-0.8, 1.1), corners[3]))
    axes.fill(*np.transpose(corners), color=INK)


def hall(axes: Axes) -> None:
    """A frame, a platform with a box on eight cables, a shelf."""
    axes.plot([-1.0, -1.0, 1.0, 1.0], [0, 1.05, 1.05, 0], color=GREY, lw=3, zorder=0)
    for y in (0.12, 0.36, 0.6):
        axes.plot([0.55, 0.95], [y, y], color=GREY, lw=2)
        axes.fill(0.66 + np.array([0, 0.16, 0.16, 0]), y + np.array([0.02, 0.02, 0.14, 0.14]), color=PALE, ec=GREY)
    corners = [(-0.35, 0.4), (0.1, 0.4), (0.1, 0.5), (-0.35, 0.5)]
    for x, outer in ((-1.0, 3), (1.0, 2)):
        cables(axes, ((x, 1.05), corners[outer]), ((x, 0.98), corners[3 - outer]))
    axes.fill(*np.transpose(corners), color=INK)
    axes.fill(-0.2 + np.array([0, 0.16, 0.16, 0]), 0.26 + np.array([0, 0, 0.14, 0.14]), color="white", ec=INK)


if __name__ == "__main__":
    attach("00_first_flight", "uses.png", picture(), cell=2)
