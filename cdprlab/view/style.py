"""One visual language: colors a color-blind reader can tell apart, one look for all figures.

Cables take four colors, solid for 1 to 4, dashed for 5 to 8, dotted for 9 to 12, and carry their number at the
line's end, so that no reader depends on color alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

# Okabe and Ito 2008, Color Universal Design; without yellow, which vanishes on white.
BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"
INK, GREY, WARNING = "#2D323A", "#6B7280", "#F3D9CF"

CABLE_COLORS = (BLUE, VERMILION, GREEN, PURPLE)
CABLE_DASHES = ("solid", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
AXIS_COLORS = (VERMILION, GREEN, BLUE)
# y dashed: where x and y move alike, both stay visible.
AXIS_DASHES = ("solid", (0, (4, 3)), "solid")


class LineStyle(NamedTuple):
    """Color and dash pattern, as matplotlib takes them."""

    color: str
    linestyle: Any


def cable_style(index: int) -> LineStyle:
    """How cable ``index`` (from 0) is drawn.

    >>> cable_style(0)
    LineStyle(color='#0072B2', linestyle='solid')
    """
    colors, dashes = len(CABLE_COLORS), len(CABLE_DASHES)
    return LineStyle(CABLE_COLORS[index % colors], CABLE_DASHES[index // colors % dashes])


@contextmanager
def house_style() -> Iterator[None]:
    """Figures made inside look like all the others; settings outside stay as they are."""
    import matplotlib.style

    with matplotlib.style.context(Path(__file__).with_name("cdprlab.mplstyle")):
        yield
