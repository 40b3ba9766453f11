"""The slice of a workspace as SVG text: a few dozen rectangles, ready in a millisecond or two."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...view.style import INK
from ...world import World
from .assessment import Slice

WIDTH, HEIGHT = 340, 330
_LEFT, _TOP, _RIGHT, _BELOW = 48, 30, 10, 108
FREE, HELD = "#8FC1E3", "#F3C98B"
_DOTS = ('<pattern id="dots" width="7" height="7" patternUnits="userSpaceOnUse">'
         f'<rect width="7" height="7" fill="{HELD}"/><circle cx="3.5" cy="3.5" r="1.3" fill="{INK}"/></pattern>')
_FILL = ("#FFFFFF", "url(#dots)", FREE)
LEGEND = ("not held", "held, but cables interfere", "held within the limits")


Spot = Callable[[Sequence[float]], tuple[float, float]]
"""A point of the plane [m] → where it is drawn [pixels]."""


def slice_svg(world: World, shown: Slice) -> str:
    """The plane's cells: white, dotted orange, blue; a cross at the start; axes in metres.

    >>> import cdprlab as cl
    >>> from cdprlab.course.designer.assessment import workspace_slice
    >>> world = cl.load_world("planar_rigid")
    >>> slice_svg(world, workspace_slice(world))[:4]
    '<svg'
    """
    across, up = shown.plane.split("–")
    place = dict(zip("xyz", world.pose.position))
    x, y = shown.grid.axes[across], shown.grid.axes[up]
    kinds = (shown.held.astype(int) + (shown.held & shown.clear)).reshape(len(x), len(y))
    half = 0.5 * shown.grid.step
    low, high = np.array([x[0], y[0]]) - half, np.array([x[-1], y[-1]]) + half
    scale = min((WIDTH - _LEFT - _RIGHT) / (high[0] - low[0]), (HEIGHT - _TOP - _BELOW) / (high[1] - low[1]))

    def at(point: Sequence[float]) -> tuple[float, float]:
        return _LEFT + scale * float(point[0] - low[0]), _TOP + scale * float(high[1] - point[1])

    level = "".join(f" at {name} = {place[name]:.2f} m" for name in place if name not in (across, up))
    right, bottom = at((high[0], low[1]))
    parts = [f'<text x="{_LEFT}" y="18" font-weight="bold">Held at rest: {shown.plane}{level}</text>',
             f'<rect x="{_LEFT}" y="{_TOP}" width="{right - _LEFT:.1f}" height="{bottom - _TOP:.1f}" fill="#FFFFFF" '
             f'stroke="{INK}"/>', *_cells(kinds, x, y, half, at), *_ticks(low, high, at, bottom),
             _cross(*at((place[across], place[up]))),
             f'<text x="{(_LEFT + right) / 2:.1f}" y="{bottom + 32:.1f}" text-anchor="middle">{across} [m]</text>',
             f'<text transform="translate(13,{(_TOP + bottom) / 2:.1f}) rotate(-90)" text-anchor="middle">{up} [m]'
             "</text>",
             *_legend(bottom + 44)]
    return (f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{html.escape(in_words(shown))}" '
            f'width="{WIDTH}" height="{bottom + 104:.0f}" font-family="DejaVu Sans, Arial, sans-serif" '
            f'font-size="11.5" fill="{INK}" style="max-width: 100%; background: #FFFFFF">'
            f'<defs>{_DOTS}</defs>{"".join(parts)}</svg>')


def in_words(shown: Slice) -> str:
    """How much of the plane is held, in a sentence.

    >>> import cdprlab as cl
    >>> from cdprlab.course.designer.assessment import workspace_slice
    >>> in_words(workspace_slice(cl.load_world("planar_rigid")))
    'Of the plane x–y 75 % are held within the limits.'
    """
    held, clear = (100 * float(flags.mean()) for flags in (shown.held, shown.held & shown.clear))
    tangled = f", {clear:.0f} % without interference" if clear < held else ""
    return f"Of the plane {shown.plane} {held:.0f} % are held within the limits{tangled}."


def _cells(kinds: NDArray[np.int_], x: Array, y: Array, half: Array, at: Spot) -> Iterator[str]:
    """One rectangle a run of equal cells in a row."""
    for j, row in enumerate(kinds.T):
        borders = [0, *(np.flatnonzero(np.diff(row)) + 1), len(row)]
        for first, end in zip(borders, borders[1:]):
            if row[first]:
                left, top = at((x[first] - half[0], y[j] + half[1]))
                right, bottom = at((x[end - 1] + half[0], y[j] - half[1]))
                yield (f'<rect x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" '
                       f'height="{bottom - top:.1f}" fill="{_FILL[row[first]]}" '
                       'shape-rendering="crispEdges"/>')


def _ticks(low: Array, high: Array, at: Spot, bottom: float) -> Iterator[str]:
    for value in round_numbers(float(low[0]), float(high[0])):
        x, _ = at((value, low[1]))
        yield (f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{bottom:.1f}" y2="{bottom + 4:.1f}" stroke="{INK}"/>'
               f'<text x="{x:.1f}" y="{bottom + 16:.1f}" text-anchor="middle">{_said(value)}</text>')
    for value in round_numbers(float(low[1]), float(high[1])):
        _, y = at((low[0], value))
        yield (f'<line x1="{_LEFT - 4}" x2="{_LEFT}" y1="{y:.1f}" y2="{y:.1f}" stroke="{INK}"/>'
               f'<text x="{_LEFT - 7}" y="{y + 4:.1f}" text-anchor="end">{_said(value)}</text>')


def round_numbers(low: float, high: float) -> list[float]:
    """Three to six multiples of 1, 2 or 5 times a power of ten between two numbers.

    >>> round_numbers(-3.5, 3.5)
    [-2.0, 0.0, 2.0]
    """
    rough = (high - low) / 4
    power = 10.0 ** np.floor(np.log10(rough))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= rough * 0.999)
    count = np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1)
    return [float(number) for number in np.round(count * step, 9) + 0.0]


def _said(value: float) -> str:
    return f"{value:g}".replace("-", "−")


def _cross(x: float, y: float) -> str:
    arms = f"M{x - 6:.1f} {y:.1f}h12M{x:.1f} {y - 6:.1f}v12"
    return f'<path d="{arms}" stroke="#FFFFFF" stroke-width="6"/><path d="{arms}" stroke="{INK}" stroke-width="3"/>'


def _legend(top: float) -> Iterator[str]:
    for k, (fill, words) in enumerate(zip(_FILL[::-1], LEGEND[::-1])):
        y = top + 16 * k
        yield (f'<rect x="{_LEFT}" y="{y:.1f}" width="20" height="11" fill="{fill}" stroke="{INK}"/>'
               f'<text x="{_LEFT + 27}" y="{y + 10:.1f}">{words}</text>')
