"""One visual language: colors a color-blind reader can tell apart, one look for all figures.

Cables take four colors, solid for 1 to 4, dashed for 5 to 8, dotted for 9 to 12, and carry
their number at the line's end, so that no reader depends on color alone.
"""

from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import checked
from ..robot import Robot

# Okabe and Ito 2008, Color Universal Design; without yellow, which vanishes on white.
BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"
INK, GREY, WARNING = "#2D323A", "#6B7280", "#F3D9CF"

CABLE_COLORS = (BLUE, VERMILION, GREEN, PURPLE)
CABLE_DASHES = ("solid", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
AXIS_COLORS = (VERMILION, GREEN, BLUE)

STEEL, DECK, TRAIL = "#C4CBD3", "#BAC3CC", "#008060"
PLATFORM, LOAD, BOX, OBSTACLE = "#7896B4", "#C4965A", "#CDBEA5", "#CD6E5F"
FLOOR, SHADOW = ("#EEF0F2", "#E4E7EA"), "#BEC2C7"

TENSION_COLORS = ((24, 20, 120), (92, 10, 165), (156, 23, 158), (203, 71, 120), (232, 114, 66),
                  (240, 150, 20))
"""Low to high tension: plasma without its yellow end, which vanishes on white; readable with color-blind eyes."""

SLACK_COLOR = (120, 120, 120)


class LineStyle(NamedTuple):
    """Color and dash pattern, as matplotlib takes them."""

    color: str
    linestyle: Any


# y dashed: where x and y move alike, both stay visible.
AXIS_STYLES = tuple(map(LineStyle, AXIS_COLORS, ("solid", (0, (4, 3)), "solid")))


@checked
def cable_style(index: int) -> LineStyle:
    """How cable ``index`` (from 0) is drawn.

    >>> cable_style(0)
    LineStyle(color='#0072B2', linestyle='solid')
    """
    lap, color = divmod(index, len(CABLE_COLORS))
    return LineStyle(CABLE_COLORS[color], CABLE_DASHES[lap % len(CABLE_DASHES)])


def tension_colors(tensions: ArrayLike, limits: tuple[float, float]) -> NDArray[np.uint8]:
    """Colors of tensions on the scale of ``TENSION_COLORS``; grey where a cable is slack (no positive tension).

    tensions : (…) [N]; NaN for a cable that is cut
    limits : tensions of the first and the last color [N]
    Returns (…, 3).

    >>> tension_colors([0.0, 100.0], (0.0, 100.0)).tolist()
    [[120, 120, 120], [240, 150, 20]]
    """
    tau = np.asarray(tensions, dtype=float)
    places = np.linspace(*limits, len(TENSION_COLORS))
    colors = [np.interp(tau, places, channel).round()
              for channel in np.transpose(TENSION_COLORS)]
    return np.where(tau[..., None] > 0, np.stack(colors, axis=-1), SLACK_COLOR).astype(np.uint8)


def tension_limits(robot: Robot) -> tuple[float, float]:
    """A color scale for any task: 0 to the smaller of the platform's weight and the largest tension limit [N]."""
    highest = robot.tension_max.max()
    return 0.0, min(robot.mass * robot.gravity or highest, highest)


def house_style() -> AbstractContextManager[None]:
    """Figures made inside look like all the others; settings outside stay as they are."""
    import matplotlib.style

    return matplotlib.style.context(Path(__file__).with_name("cdprlab.mplstyle"))
