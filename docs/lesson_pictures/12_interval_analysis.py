"""The picture of lesson 12: boxes for what is not known exactly, and the range of a side in four interval forms.

python docs/lesson_pictures/12_interval_analysis.py
"""

from __future__ import annotations

from io import BytesIO

import matplotlib
import numpy as np
from attachment import attach
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

import cdprlab as cl
from cdprlab.configurations.region import region
from cdprlab.configurations.sides import side_range
from cdprlab.course.pictures.configuration_plan import draw_room
from cdprlab.view.style import BLUE, INK, ORANGE, VERMILION, house_style

PLACE = np.array([1.38, 0.98, 0.62])
POSITION, EXITS = 0.05, 0.02    # m


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    robot = cl.load_world("marionet").robot
    with house_style():
        figure = Figure(figsize=(9.6, 4.2), layout="constrained")
        left, right = figure.subplots(1, 2)
        _boxes(left, robot, [0, 1, 2])
        _ranges(right, robot.exit_points[[2, 0], :2])
        file = BytesIO()
        figure.savefig(file, dpi=76)
    return file.getvalue()


def _boxes(panel, robot, chosen):
    corners = robot.exit_points[chosen]
    draw_room(panel, robot)
    panel.fill(*corners[:, :2].T, facecolor=BLUE, alpha=0.2)
    panel.fill(*region(corners, EXITS, POSITION).polygon(corners[:, :2], PLACE[2]).T, facecolor=BLUE, alpha=0.4)
    for place, width in [(corner, EXITS) for corner in robot.exit_points] + [(PLACE, POSITION)]:
        panel.add_patch(Rectangle(place[:2] - width, 2 * width, 2 * width, facecolor=ORANGE, edgecolor=INK, zorder=6))
    panel.annotate("M ± 5 cm", PLACE[:2], (14, -16), textcoords="offset points")
    panel.annotate("A ± 2 cm", robot.exit_points[1, :2], (-30, -4), textcoords="offset points", ha="right", va="top")
    panel.set_title("A123, and where it is certain (dark)")


def _ranges(panel, edge):
    for k, form in enumerate(("natural", "translated", "contractor", "corners")):
        low, high = side_range(*edge, PLACE[:2], EXITS, POSITION, form)
        panel.barh(k, high - low, left=low, height=0.6, color=VERMILION if low < 0 else BLUE, edgecolor="white",
                   hatch="//" if low < 0 else "")
        panel.text(high, k, "  uncertain" if low < 0 else "  certain", va="center")
    panel.axvline(0, color=INK)
    panel.set(yticks=range(4), yticklabels=["natural", "translated", "contractor", "64 corners,\nexact"],
              xlabel="side of M from the edge A3 → A1 [m²]", xlim=(-0.12, 1.1))
    panel.invert_yaxis()
    panel.set_title("The same number, four interval forms")


if __name__ == "__main__":
    attach("12_interval_analysis", "interval_analysis.png", picture())
