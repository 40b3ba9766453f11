"""What several pictures draw alike: labels beside a point, arrows, exit points."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.text import Text
from matplotlib.transforms import offset_copy
from numpy.typing import ArrayLike

from ...arrays import Array
from ...view.plots import Figure
from ...view.style import INK, LineStyle, house_style

HALO = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5}
"""Behind text that lies on lines."""


@contextmanager
def drawn(width: float, height: float) -> Iterator[Figure]:
    """A figure of so many inches, filled in the house's style."""
    with house_style():
        yield Figure(figsize=(width, height), layout="constrained")


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


def bar_panel(panel: Axes, m: int, end: float) -> Axes:
    """For the tensions of m cables from 0 to ``end`` [N]."""
    panel.set(xlim=(0.0, end), ylim=(m + 0.5, 0.5), xlabel="tension [N]", ylabel="cable",
              yticks=range(1, m + 1))
    return panel


def draw_bars(panel: Axes, sizes: Array, looks: Sequence[LineStyle], words: Sequence[str],
              ends: Array | None = None, hollow: Any = (), upright: bool = False,
              **look: Any) -> list[Text]:
    """A bar for each of m cables, and a word at the end of each.

    sizes : (m,); looks : of each bar
    ends : (m,) where words stand; default where bars end
    hollow : which are hatched instead of filled, with words on the side of 0 where they are upright
    """
    m = len(sizes)
    empty = np.array(hollow if len(hollow) else [False] * m, dtype=bool)
    along = np.outer(sizes, [0, 0, 1, 1])
    corners = np.stack([along, np.arange(1, m + 1)[:, None] + [-0.3, 0.3, 0.3, -0.3]], axis=-1)
    for which, hatch in ((~empty, None), (empty, "//")):
        chosen = np.flatnonzero(which).tolist()
        colors = [looks[k].color for k in chosen]
        panel.add_collection(PolyCollection(
            list(corners[chosen, :, ::-1] if upright else corners[chosen]), edgecolors=colors if hatch else INK,
            facecolors="white" if hatch else colors, hatch=hatch, linewidths=1.4, zorder=2,
            linestyles=[looks[k].linestyle for k in chosen]), autolim=False)
    figure: Any = panel.figure
    aside = offset_copy(panel.transData, figure, *((0, 3) if upright else (5, 0)), "points")
    below = offset_copy(panel.transData, figure, 0, -3, "points")
    told = []
    for k, (end, word) in enumerate(zip(sizes if ends is None else ends, words)):
        under = upright and empty[k]
        x, y = (k + 1, end) if upright else (end, k + 1)
        told.append(panel.text(x, y, word,
                               transform=below if under else aside,
                               **{"ha": "center" if upright else "left", "fontsize": 9, "color": INK, "zorder": 6,
                                  "va": "top" if under else "bottom" if upright else "center"} | look))
    return told


def draw_exit_points(panel: Axes, points: ArrayLike, names: Sequence[str] = (), **look: Any) -> None:
    """Squares with their numbers (or names) on the outer side."""
    places = np.asarray(points, dtype=float)
    middle = places.mean(axis=0)
    for i, place in enumerate(places):
        panel.plot(*place, marker="s", markersize=7, color=INK, zorder=4)
        side = np.sign(np.round(place - middle, 9))
        panel.annotate(names[i] if names else str(i + 1), place, (11 * side[0], 11 * side[1]),
                       textcoords="offset points", ha="center", va="center", color=INK, **look)


def round_up(size: float) -> float:
    """The next of a few round numbers: limits of axes that stay need not be drawn again."""
    unit = 10.0 ** np.floor(np.log10(size))
    return float(unit * min(digit for digit in (1, 1.5, 2, 3, 5, 7, 10)
                            if digit * unit >= size))


def show_square(panel: Axes, middle: Array, reach: float) -> None:
    """Limits that hold so much on all sides of a middle, in coarse steps, a third for the middle."""
    reach = round_up(1.15 * reach)
    middle = np.round(3 * middle / reach) * reach / 3
    panel.set(xlim=middle[0] + reach * np.array([-1, 1]),
              ylim=middle[1] + reach * np.array([-1, 1]), aspect="equal")
