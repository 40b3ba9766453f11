"""What several pictures draw alike: labels beside a point, arrows, exit points."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ...view.style import INK

HALO = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5}
"""Behind text that lies on lines."""


def label(panel: Axes, text: str, place: Any, side: Any, gap: float = 7.0, **look: Any) -> None:
    """Text beside a point, on the side of a unit vector, ``gap`` points away."""
    x, y = float(side[0]), float(side[1])
    panel.annotate(text, (place[0], place[1]), (gap * x, gap * y), textcoords="offset points",
                   bbox=HALO,
                   ha="left" if x > 0.3 else "right" if x < -0.3 else "center",
                   va="bottom" if y > 0.3 else "top" if y < -0.3 else "center", **look)


def arrow(panel: Axes, start: Any, end: Any, **look: Any) -> None:
    """From point to point."""
    panel.annotate("", (end[0], end[1]), (start[0], start[1]), annotation_clip=True,
                   arrowprops={
        "arrowstyle": "-|>", "linewidth": 2.2, "shrinkA": 0, "shrinkB": 0,
        "mutation_scale": 14, **look})


def draw_exit_points(panel: Axes, points: ArrayLike, names: Sequence[str] = (), **look: Any) -> None:
    """Squares with their numbers (or names) on the outer side."""
    places = np.asarray(points, dtype=float)
    middle = places.mean(axis=0)
    for i, place in enumerate(places):
        panel.plot(*place, marker="s", markersize=7, color=INK, zorder=4)
        side = np.sign(np.round(place - middle, 9))
        panel.annotate(names[i] if names else str(i + 1), place, (11 * side[0], 11 * side[1]),
                       textcoords="offset points", ha="center", va="center", color=INK, **look)
