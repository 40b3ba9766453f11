"""The set of tensions drawn: polygon or interval with the methods' points in it, and tensions as bars with limits."""

from collections.abc import Mapping, Sequence
from itertools import cycle
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import ArrayLike

from ...arrays import Array, checked
from ...tensions import distribute_tensions
from ...view.plots import Figure
from ...view.style import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, SKY, VERMILION, cable_style
from .panels import HALO, arrow, draw_bars, drawn, label, round_up, show_square
from .tension_polygon import MET, TensionSet, set_in_words, tension_set


class Mark(NamedTuple):
    """How a method's point is drawn; sizes differ so that points on each other can all be seen."""

    marker: str
    color: str
    size: float


MARKS = {
    "linear_program": Mark("s", VERMILION, 12),
    "quadratic_program": Mark("o", BLUE, 13),
    "pseudo_inverse": Mark("x", INK, 8),
    "closed_form": Mark("^", ORANGE, 12),
    "improved_closed_form": Mark("v", ORANGE, 9),
    "kernel": Mark("D", PURPLE, 9),
    "puncture": Mark("P", PURPLE, 10),
    "barycenter": Mark("*", GREEN, 15),
    "relaxed": Mark("h", SKY, 9),
}
"""Method → its mark; filled inside the limits, hollow outside."""

OWN = (Mark("D", INK, 13), Mark("o", INK, 20))
"""Points of no method, a student's own or the one that walks along the border: hollow, so that nothing hides."""

@checked
def plot_tension_set(W: ArrayLike, w_e: ArrayLike, tension_min: ArrayLike,
                     tension_max: ArrayLike,
                     methods: Sequence[str] = (), own: Mapping[str, ArrayLike] | None = None,
                     title: str = "") -> Figure:
    """The interval or polygon of feasible tensions, with methods' and other points in it.

    W, w_e, tension_min, tension_max : as in `distribute_tensions`, for one pose, r = 1 or 2
    methods : names whose answers are marked
    own : label → tensions (m,) or (k, m), marked too [N]
    title : above the picture
    """
    found = {name: distribute_tensions(W, w_e, tension_min, tension_max, name)
             for name in methods}
    points = {name: answer.tensions for name, answer in found.items()}
    feasible = {name: bool(answer.feasible) for name, answer in found.items()}
    points |= {name: np.asarray(values, float) for name, values in (own or {}).items()}
    free = tension_set(W, w_e, tension_min, tension_max)
    with drawn(7.6, 4.8) as figure:
        panel = figure.subplots()
        draw_set(panel, free, points, feasible)
        if title:
            panel.set_title(title)
        if points:
            panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), labelspacing=0.9)
        figure.alt_text = set_in_words(free) + " " + "; ".join(
            f"{name.replace('_', ' ')} at λ = {free.coordinates(tau).round(1).tolist()} N"
            for name, tau in points.items() if np.isfinite(tau).all())
    return figure


def draw_set(panel: Axes, free: TensionSet, points: Mapping[str, Array],
             feasible: Mapping[str, bool],
             chosen: str = "") -> None:
    """Fill a panel, under house style.

    points : label → tensions (m,) or (k, m); methods' names take their marks
    feasible : label → whether its mark is filled; default all
    chosen : the label that gets a ring
    """
    if free.redundancy not in (1, 2):
        panel.set(xlim=(-1, 1), ylim=(-1, 1), xlabel="", ylabel="")
        panel.text(0, 0, set_in_words(free), ha="center", va="center", color=INK)
        panel.set_title("Tensions to choose from")
        return
    shown = {name: np.atleast_2d(free.coordinates(tau)) for name, tau in points.items()
             if np.isfinite(tau).all()}
    frame = _frame(free, shown)
    (_draw_interval if free.redundancy == 1 else _draw_polygon)(panel, free, frame)
    own = iter(OWN * len(shown))
    for name, places in shown.items():
        mark = MARKS.get(name) or next(own)
        inside = feasible.get(name, True) and mark not in OWN
        xy = places if free.redundancy == 2 else np.column_stack([places,
                                                                  np.zeros(len(places))])
        panel.plot(*xy.T, linestyle="none", marker=mark.marker, markersize=mark.size,
                   markeredgecolor=mark.color,
                   markerfacecolor=mark.color if inside else "none", markeredgewidth=1.6,
                   alpha=0.9, zorder=5,
                   label=name.replace("_", " ") + ("" if inside
                                                   or mark in OWN else ", outside"))
        if name == chosen and ((xy < frame[0]) | (xy > frame[1])).any():
            panel.text(0.02, 0.02, f"{name.replace('_', ' ')}: beyond this picture",
                       transform=panel.transAxes,
                       fontsize=9, color=INK, zorder=6, bbox=HALO)
        elif name == chosen:
            panel.plot(*xy.T, linestyle="none", marker="o", markersize=22, markeredgecolor=INK,
                       markerfacecolor="none", markeredgewidth=1.6, zorder=6)
    _count_coinciding(panel, [spots[0] for spots in shown.values() if len(spots) == 1], frame)


def _count_coinciding(panel: Axes, places: list[Array], frame: Array) -> None:
    """Where marks lie on each other, a word says how many."""
    near = 0.03 * float((frame[1] - frame[0]).max())
    left = sorted(places, key=lambda place: float(place[0]))
    gaps = cycle(((13, 10), (13, -16)))   # words side by side would run into each other
    while left:
        here = [place for place in left if np.abs(place - left[0]).max() < near]
        at = (*left[0], 0.0)[:2]
        left = [place for place in left if np.abs(place - left[0]).max() >= near]
        if len(here) > 1 and (here[0] > frame[0]).all() and (here[0] < frame[1]).all():
            panel.annotate(f"{len(here)} marks", at, next(gaps), textcoords="offset points", fontsize=9,
                           color=INK, zorder=7, bbox=HALO)


def _frame(free: TensionSet, shown: Mapping[str, Array]) -> Array:
    """(2, r) lower and upper end of what is drawn: the corners with room around, or as far as limits are broken."""
    r = free.redundancy
    if len(free.corners):
        low, high = free.corners.min(axis=0), free.corners.max(axis=0)
    else:
        steps = np.maximum(free.low - free.least, free.least - free.high)
        far = (steps / np.maximum(np.linalg.norm(free.directions, axis=1), 0.1)).max(initial=0.0)
        low, high = np.full(r, -far), np.full(r, far)
    size = max((high - low).max(), 1e-3 * free.high.max(), 1e-9)
    # Points outside come into view unless they are too far: the polygon must not shrink to a
    # dot.
    for spots in shown.values():
        near = spots[(np.abs(spots - (low + high) / 2) <= 1.3 * size).all(axis=1)]
        if len(near) and len(free.corners):
            low, high = np.minimum(low, near.min(axis=0)), np.maximum(high, near.max(axis=0))
    pad = (0.16 if r == 2 else 0.5) * max((high - low).max(), size)
    return np.stack([low - pad, high + pad])


def _draw_polygon(panel: Axes, free: TensionSet, frame: Array) -> None:
    middle, reach = frame.mean(axis=0), 0.5 * (frame[1] - frame[0]).max()
    lines, looks = [], []
    for i, row in enumerate(free.directions):
        look, size = cable_style(i), np.linalg.norm(row)
        for limit in (free.low[i], free.high[i]) if size > 1e-9 else ():
            foot = middle + row * (limit - free.least[i] - row @ middle) / size**2
            if np.linalg.norm(foot - middle) > 3 * reach:
                continue
            along = 9 * reach / size * np.array([-row[1], row[0]])
            lines.append([foot - along, foot + along])
            looks.append(look)
            if len(free.corners) == 0 and limit == free.low[i] > free.least[i]:
                # To where the limit is kept.
                way = 0.16 * reach * row / size
                x, y = foot + 1.25 * way
                arrow(panel, foot, foot + way, color=look.color, linewidth=1.6)
                panel.text(x, y, f"{i + 1} min", fontsize=9, color=INK, ha="center",
                           va="center",
                           clip_on=True, bbox=HALO)
    panel.add_collection(LineCollection(lines, colors=[look.color for look in looks], linewidths=0.9, alpha=0.6,
                                        linestyles=[look.linestyle for look in looks]), autolim=False)
    if len(free.corners):
        panel.fill(*free.corners.T, facecolor=GREY, alpha=0.22, edgecolor=INK,
                   linewidth=2.0, zorder=3)
        center = free.corners.mean(axis=0)
        for start, end in zip(free.corners, np.roll(free.corners, -1, axis=0)):
            if np.linalg.norm(end - start) > 0.12 * reach:   # shorter edges have no room for the limit's name
                place = (start + end) / 2
                side = (place - center) / np.linalg.norm(place - center)
                label(panel, ", ".join(free.met_limits(free.tensions(place))), place, side, 13,
                      fontsize=9, color=INK,
                      zorder=4)
        panel.set_title(f"Feasible tensions: {len(free.corners)} corners")
    else:
        panel.set_title("Empty: no tensions keep all limits")
    show_square(panel, middle, reach / 1.15)
    panel.set(xlabel="λ₁ [N], to the right Σ τ grows", ylabel="λ₂ [N], Σ τ stays")
    panel.locator_params(axis="x", nbins=6)


def _draw_interval(panel: Axes, free: TensionSet, frame: Array) -> None:
    """Each cable's own interval of λ as a bar; what all of them share is shaded."""
    h, m = free.directions[:, 0], free.least.size
    low, high = frame[:, 0]
    for i in range(m):
        look = cable_style(i)
        if abs(h[i]) > 1e-9:
            ends = sorted((limit - free.least[i]) / h[i]
                          for limit in (free.low[i], free.high[i]))
        else:   # the cable does not mind λ: it agrees with all or none
            kept = free.low[i] <= free.least[i] <= free.high[i]
            ends = [low - 1, high + 1] if kept else [np.nan, np.nan]
        left, right = np.clip(ends, low - 0.05 * (high - low), high + 0.05 * (high - low))
        panel.barh(i + 1, right - left, left=left, height=0.5, color=look.color, alpha=0.55,
                   edgecolor=look.color)
        for end, name, side, gap in zip(ends, ("min", "max") if h[i] > 0 else ("max", "min"),
                                        ("left", "right"),
                                        (4, -4)):
            if low < end < high:
                panel.annotate(name, (end, i + 1), (gap, 0), textcoords="offset points",
                               ha=side, va="center",
                               fontsize=9, color=INK)
    if len(free.corners):
        panel.axvspan(free.corners[0, 0], free.corners[-1, 0], facecolor=GREY, alpha=0.22,
                      edgecolor=INK, zorder=0)
        words = " to ".join(f"{end + 0.0:.4g}" for end in free.corners[[0, -1], 0])
        panel.set_title(f"Feasible λ: {words} N".replace("-", "−"))
    else:
        panel.set_title("Empty: no λ suits all cables")
    panel.set(xlim=(low, high), ylim=(m + 0.6, -0.7), yticks=range(m + 1),
              yticklabels=["answers", *(f"cable {i + 1}" for i in range(m))],
              xlabel="λ [N], to the right Σ τ grows",
              ylabel="")
    panel.grid(axis="y", visible=False)


def draw_tensions(panel: Axes, tensions: Array, low: Array, high: Array, title: str) -> None:
    """Tensions as bars with their numbers between their limits, under house style; broken limits are named.

    tensions : (m,) [N], NaN where there are none
    """
    m, close = tensions.size, MET * high.max()
    there = np.nan_to_num(tensions)
    top = max(np.nanmax(np.abs(tensions), initial=1.0), 1.5 * low.max())
    near = high <= 1.6 * top
    broken = np.select([tensions < low - close, tensions > high + close], [" below min", " above max"], "")
    words = [f"{tension:.4g} N{how}".replace("-", "−") if np.isfinite(tension) else ""
             for tension, how in zip(tensions, broken)]
    # Words stand beyond a limit's mark, which would strike them through.
    close_to = near & (high - there < 0.4 * top)
    draw_bars(panel, there, list(map(cable_style, range(m))), words,
              np.maximum(there, np.where(close_to, high, low)), broken != "")
    for limits, cables in ((low, np.arange(m)), (high, np.flatnonzero(near))):
        panel.vlines(limits[cables], cables + 0.6, cables + 1.4, color=INK,
                     linewidth=2.2, zorder=5)
    bottom = np.nanmin(tensions, initial=0.0)
    right = high[near].max(initial=top)
    room = 1.0 if (tensions > high).any() else 0.5
    left = -round_up(-1.15 * bottom) if bottom < 0 else 0.0
    panel.set(xlim=(left, round_up(right + room * (right - bottom))), ylim=(m + 0.6, 0.4),
              yticks=range(1, m + 1),
              ylabel="cable", xlabel="tension [N]; black: limits")
    panel.grid(axis="y", visible=False)
    panel.set_title(title)
