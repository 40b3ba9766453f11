"""The picture of lesson 13: a cable over a wheel, one that hangs by its weight, and a platform on springs.

python docs/lesson_pictures/13_real_cables.py
"""

from __future__ import annotations

from io import BytesIO

import matplotlib
import numpy as np
from attachment import attach
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

import cdprlab as cl
from cdprlab.compiled.columns import over_pulley
from cdprlab.mechanics.cables import straight_lengths
from cdprlab.view.style import BLUE, GREY, INK, ORANGE, house_style

RADIUS = 0.5
LOAD = np.array([3.2, -0.8])


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    with house_style():
        figure = Figure(figsize=(9.6, 3.0), layout="constrained")
        wheel, weight, springs = figure.subplots(1, 3)
        _wheel(wheel)
        _weight(weight)
        _springs(springs)
        for panel in (wheel, weight, springs):
            panel.set(aspect="equal", xticks=[], yticks=[])
            panel.grid(visible=False)
        file = BytesIO()
        figure.savefig(file, dpi=76)
    return file.getvalue()


def _wheel(panel):
    pulley = np.array([RADIUS, 0.0, 1.0])
    length = over_pulley(*-LOAD, 0.0, pulley)[0]
    wrap = (length - straight_lengths(LOAD, pulley[None])[0]) / RADIUS
    turn, arc = np.linspace(0, 2 * np.pi, 90), np.linspace(0, wrap, 40)
    panel.plot(RADIUS - RADIUS * np.cos(turn), RADIUS * np.sin(turn), color=GREY, lw=3)
    panel.plot([0, 0], [-1.6, 0], color=BLUE, lw=2)
    panel.plot([*(RADIUS - RADIUS * np.cos(arc)), LOAD[0]], [*(RADIUS * np.sin(arc)), LOAD[1]], color=BLUE, lw=2)
    panel.plot([0, LOAD[0]], [0, LOAD[1]], "--", color=INK, lw=1)
    for name, place, shift in (("A", (0, 0), (-13, -3)), ("B", LOAD, (6, -3)),
                               ("T", (RADIUS - RADIUS * np.cos(wrap), RADIUS * np.sin(wrap)), (2, 7))):
        panel.plot(*place, "o", color=INK)
        panel.annotate(name, place, shift, textcoords="offset points")
    panel.set(title="over a wheel", xlim=(-0.5, 3.8), ylim=(-1.7, 1.0))


def _weight(panel):
    points = cl.sagging_cable([3.2, -0.8], 3.55, 1.0, 1e5).points(80)
    panel.plot([0, 3.2], [0, -0.8], "--", color=INK, lw=1)
    panel.plot(*points.T, color=BLUE, lw=2)
    panel.plot([0, 3.2], [0, -0.8], "o", color=INK)
    panel.set(title="with its weight", xlim=(-0.5, 3.8), ylim=(-1.7, 1.0))


def _springs(panel):
    corners = np.array([[-1.6, 1.0], [1.6, 1.0], [-1.6, -1.2], [1.6, -1.2]])
    anchors = 0.35 * np.sign(corners)
    panel.add_patch(Rectangle((-0.35, -0.35), 0.7, 0.7, facecolor=GREY, alpha=0.4, edgecolor=INK))
    for corner, anchor in zip(corners, anchors):
        along = np.linspace(0, 1, 15)[:, None]
        across = np.array([-(corner - anchor)[1], (corner - anchor)[0]]) / np.linalg.norm(corner - anchor)
        zigzag = 0.08 * np.where(np.arange(15) % 2, 1, -1)[:, None] * ((along > 0.2) & (along < 0.8))
        panel.plot(*(anchor + along * (corner - anchor) + zigzag * across).T, color=ORANGE)
        panel.plot(*corner, "o", color=INK)
    panel.set(title="stretching", xlim=(-1.9, 1.9), ylim=(-1.5, 1.3))


if __name__ == "__main__":
    attach("13_real_cables", "real_cables.png", picture())
