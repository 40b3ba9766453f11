"""What several pictures draw alike: labels beside a point, arrows, exit points."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.text import Text
from numpy.typing import ArrayLike

from ...arrays import Array
from ...view.plots import Figure
from ...view.style import INK, LineStyle, house_style

HALO = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5}
"""Behind text that lies on lines."""


PLAN: Any = {"aspect": "equal", "xlabel": "x [m]", "ylabel": "y [m]"}
"""Of a panel that shows places."""


@contextmanager
def drawn(width: float, height: float) -> Iterator[Figure]:
    """A figure of so many inches, filled in the house's style."""
    with house_style():
        yield Figure(figsize=(width, height), layout="constrained")


def label(panel: Axes, text: str, place: Any, side: Any, gap: float = 7.0, **look: Any) -> None:
    """Text beside a point, in the direction of a vector, ``gap`` points away."""
    x, y = side / np.linalg.norm(side)
    panel.annotate(text, place[:2], (gap * x, gap * y), textcoords="offset points", bbox=HALO,
                   ha="left" if x > 0.3 else "right" if x < -0.3 else "center",
                   va="bottom" if y > 0.3 else "top" if y < -0.3 else "center", **look)


def arrow(panel: Axes, start: Any, end: Any, **look: Any) -> None:
    """From point to point."""
    panel.annotate("", end[:2], start[:2], annotation_clip=True, arrowprops={
        "arrowstyle": "-|>", "linewidth": 2.2, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 14, **look})


def bar_panel(panel: Axes, m: int, end: float, low: float = 0.0) -> Axes:
    """For the tensions of m cables from 0, or a round number below ``low``, to ``end`` [N]."""
    panel.set(xlim=(-round_up(-1.15 * low) if low < 0 else 0.0, end), ylim=(m + 0.5, 0.5), xlabel="tension [N]",
              ylabel="cable", yticks=range(1, m + 1))
    panel.grid(axis="y", visible=False)
    return panel


def draw_bars(panel: Axes, sizes: Array, looks: Sequence[LineStyle], words: Sequence[str],
              ends: Array | None = None, hollow: Any = False) -> list[Text]:
    """A bar for each of m cables, and a word at the end of each.

    sizes : (m,); looks : of each bar
    ends : (m,) where words stand; default where bars end
    hollow : which are hatched instead of filled
    """
    m = len(sizes)
    empty = np.broadcast_to(hollow, m)
    corners = np.stack([np.outer(sizes, [0, 0, 1, 1]), np.arange(1, m + 1)[:, None] + [-0.3, 0.3, 0.3, -0.3]], axis=-1)
    for which, hatch in ((~empty, None), (empty, "//")):
        chosen = np.flatnonzero(which).tolist()
        colors = [looks[k].color for k in chosen]
        panel.add_collection(PolyCollection(
            list(corners[chosen]), edgecolors=colors if hatch else INK, facecolors="white" if hatch else colors,
            hatch=hatch, linewidths=1.4, zorder=2, linestyles=[looks[k].linestyle for k in chosen]), autolim=False)
    return [panel.annotate(word, (end, k), (5, 0), textcoords="offset points", annotation_clip=False, va="center",
                           fontsize=9, color=INK, zorder=6)
            for k, (end, word) in enumerate(zip(sizes if ends is None else ends, words), start=1)]


def draw_exit_points(panel: Axes, points: ArrayLike, names: Sequence[str] = (), **look: Any) -> None:
    """Squares with their numbers (or names) on the outer side."""
    places = np.asarray(points)
    panel.plot(*places.T, "s", markersize=7, color=INK, zorder=4)
    sides = 11 * np.sign(np.round(places - places.mean(axis=0), 9))
    for place, side, name in zip(places, sides, names or map(str, count(1))):
        panel.annotate(name, place, side, textcoords="offset points", ha="center", va="center", color=INK, **look)


def round_up(size: float) -> float:
    """The next of a few round numbers: limits of axes that stay need not be drawn again."""
    unit = 10.0 ** np.floor(np.log10(size))
    return float(unit * min(digit for digit in (1, 1.5, 2, 3, 5, 7, 10)
                            if digit * unit >= size))


def show_square(panel: Axes, middle: Array, reach: float) -> None:
    """Limits that hold so much on all sides of a middle, in coarse steps, a third for the middle."""
    reach = round_up(1.15 * reach)
    middle = np.round(3 * middle / reach) * reach / 3
    (left, bottom), (right, top) = middle - reach, middle + reach
    panel.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
