"""The set of tensions drawn: polygon or interval with the methods' points in it, and tensions as bars with limits."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.text import Annotation
from numpy.typing import ArrayLike

from ...arrays import Array, checked
from ...tensions import distribute_tensions
from ...view.plots import Figure
from ...view.style import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, SKY, VERMILION, cable_style
from .panels import HALO, arrow, bar_panel, draw_bars, drawn, label, round_up, show_square
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

_GAPS = np.array([[32, 14], [32, -14], [-32, 14], [-32, -14], [0, 20], [0, -20]])
"""From marks on each other to the middle of the word that counts them [points]."""

_WIDTH = 190.0
"""Of a panel, about [points]."""

OWN = (Mark("D", INK, 13), Mark("o", INK, 20))
"""Points of no method, a student's own or the one that walks along the border: hollow, so that nothing hides."""


@checked
def plot_tension_set(W: ArrayLike, w_e: ArrayLike, tension_min: ArrayLike,
                     tension_max: ArrayLike,
                     methods: Sequence[str] = (), own: Mapping[str, ArrayLike] | None = None) -> Figure:
    """The interval or polygon of feasible tensions, with methods' and other points in it.

    W, w_e, tension_min, tension_max : as in `distribute_tensions`, for one pose, r = 1 or 2
    methods : names whose answers are marked
    own : label → tensions (m,) or (k, m), marked too [N]
    """
    found = {name: distribute_tensions(W, w_e, tension_min, tension_max, name) for name in methods}
    points = {name: answer.tensions for name, answer in found.items()}
    points |= {name: np.asarray(values, float) for name, values in (own or {}).items()}
    free = tension_set(W, w_e, tension_min, tension_max)
    with drawn(7.6, 4.8) as figure:
        panel = figure.subplots()
        draw_set(panel, free, points, {name: bool(answer.feasible) for name, answer in found.items()})
        if points:
            panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), labelspacing=0.9)
        figure.alt_text = f"{set_in_words(free)} " + "; ".join(
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
    r = free.redundancy
    if r not in (1, 2):
        panel.set(xlim=(-1, 1), ylim=(-1, 1), xlabel="", ylabel="", title="Tensions to choose from")
        panel.text(0, 0, set_in_words(free), ha="center", va="center", color=INK)
        return
    shown = {name: np.atleast_2d(free.coordinates(tau)) for name, tau in points.items() if np.isfinite(tau).all()}
    frame = _frame(free, np.concatenate([np.zeros((0, r)), *shown.values()]))
    (_draw_interval if r == 1 else _draw_polygon)(panel, free, frame)
    own = iter(OWN * len(shown))
    for name, places in shown.items():
        mark, words = MARKS.get(name) or next(own), name.replace("_", " ")
        inside = feasible.get(name, True)
        xy = np.pad(places, ((0, 0), (0, 2 - r))).T
        panel.add_artist(Line2D(*xy, linestyle="none", marker=mark.marker, markersize=mark.size,
                                markeredgecolor=mark.color, markeredgewidth=1.6, alpha=0.9, zorder=5,
                                markerfacecolor=mark.color if inside and mark not in OWN else "none",
                                label=words if inside else f"{words}, outside"))
        if name == chosen and (places != places.clip(*frame)).any():
            panel.text(0.02, 0.02, f"{words}: beyond this picture", transform=panel.transAxes,
                       fontsize=9, color=INK, zorder=6, bbox=HALO)
        elif name == chosen:
            panel.plot(*xy, "o", markersize=22, markeredgecolor=INK, markerfacecolor="none", markeredgewidth=1.6,
                       zorder=6)
    _count_coinciding(panel, [spots[0] for spots in shown.values() if len(spots) == 1], frame)


def _count_coinciding(panel: Axes, places: list[Array], frame: Array) -> None:
    """Where marks lie on each other, a word says how many, where most room is."""
    left = np.array(sorted(map(tuple, places)))
    point = np.ptp(panel.get_xlim()) / _WIDTH
    taken = [*(np.append(place, 0.0)[:2] / point for place in places),
             *(np.divide(text.xy, point) + text.xyann for text in panel.texts
               if isinstance(text, Annotation) and text.get_text())]
    while len(left):
        place = left[0]
        here = (np.abs(left - place) < 0.03 * np.ptp(frame, axis=0).max()).all(axis=1)
        if here.sum() > 1 and (frame[0] < place).all() and (place < frame[1]).all():
            words = np.append(place, 0.0)[:2] / point + _GAPS
            # They are three times as wide as high.
            room = [np.linalg.norm((word - taken) / [3, 1], axis=1).min() for word in words]
            best = int(np.argmax(room))
            taken.append(words[best])
            panel.annotate(f"{here.sum()} marks", (*place, 0.0)[:2], _GAPS[best], textcoords="offset points",
                           fontsize=9, ha="center", va="center", color=INK, zorder=7, bbox=HALO)
        left = left[~here]


def _frame(free: TensionSet, spots: Array) -> Array:
    """(2, r) lower and upper end of what is drawn: the corners with room around, or as far as limits are broken."""
    r, ends = free.redundancy, free.corners
    if not len(ends):
        steps = np.maximum(free.low - free.least, free.least - free.high)
        far = (steps / np.maximum(np.linalg.norm(free.directions, axis=1), 0.1)).max(initial=0.0)
        ends = np.outer([-far, far], np.ones(r))
    size = max(np.ptp(ends, axis=0).max(), 1e-3 * free.high.max(), 1e-9)
    if len(free.corners):
        # Points outside come into view unless they are too far: the polygon must not shrink to a
        # dot.
        middle = (ends.min(axis=0) + ends.max(axis=0)) / 2
        ends = np.concatenate([ends, spots[(np.abs(spots - middle) <= 1.3 * size).all(axis=1)]])
    pad = (0.16 if r == 2 else 0.5) * max(np.ptp(ends, axis=0).max(), size)
    return np.stack([ends.min(axis=0) - pad, ends.max(axis=0) + pad])


def _draw_polygon(panel: Axes, free: TensionSet, frame: Array) -> None:
    middle, reach = frame.mean(axis=0), 0.5 * np.ptp(frame, axis=0).max()
    lines, looks = [], []
    for i, row in enumerate(free.directions):
        look, size = cable_style(i), np.linalg.norm(row)
        for limit in (free.low[i], free.high[i]) if size > 1e-9 else ():
            foot = middle + row * (limit - free.least[i] - row @ middle) / size**2
            lines.append(foot + np.outer([-9, 9], [-row[1], row[0]]) * reach / size)
            looks.append(look)
            if np.linalg.norm(foot - middle) > 3 * reach:   # out of sight
                continue
            if len(free.corners) == 0 and limit == free.low[i] > free.least[i]:
                # To where the limit is kept.
                way = 0.16 * reach * row / size
                arrow(panel, foot, foot + way, color=look.color, linewidth=1.6)
                x, y = foot + 1.25 * way
                panel.text(x, y, f"{i + 1} min", fontsize=9, color=INK, ha="center", va="center",
                           clip_on=True, bbox=HALO)
    # As one collection they are drawn in a tenth of the time.
    colors, dashes = zip(*looks)
    panel.add_collection(LineCollection(lines, colors=colors, linestyles=dashes, linewidths=0.9, alpha=0.6),
                         autolim=False)
    if len(free.corners):
        panel.fill(*free.corners.T, facecolor=GREY, alpha=0.22, edgecolor=INK, linewidth=2.0, zorder=3)
        for start, end in zip(free.corners, np.roll(free.corners, -1, axis=0)):
            if np.linalg.norm(end - start) > 0.12 * reach:   # shorter edges have no room for the limit's name
                place = (start + end) / 2
                label(panel, ", ".join(free.met_limits(free.tensions(place))), place,
                      place - free.corners.mean(axis=0), 13, fontsize=9, color=INK, zorder=4)
        panel.set_title(f"Feasible tensions: {len(free.corners)} corners")
    else:
        panel.set_title("Empty: no tensions keep all limits")
    # Limits that hold amply stay, and new ones hold more: to draw ticks takes longer than all else.
    kept, first = np.transpose([panel.get_xlim(), panel.get_ylim()]), panel.get_autoscale_on()
    if first or (frame != frame.clip(*kept)).any() or np.ptp(kept, axis=0).max() > 6 * reach:
        show_square(panel, middle, reach / 1.15 if first else 1.2 * reach)
    panel.set(xlabel="λ₁ [N], to the right Σ τ grows", ylabel="λ₂ [N], Σ τ stays")
    panel.locator_params(axis="x", nbins=4)
    panel.yaxis.set_label_coords(-0.21, 0.5)   # where five characters fit between it and the axis


def _draw_interval(panel: Axes, free: TensionSet, frame: Array) -> None:
    """Each cable's own interval of λ as a bar; what all of them share is shaded."""
    h, m = free.directions[:, 0], free.least.size
    low, high = frame[:, 0]
    room = 0.05 * (high - low)
    for i in range(m):
        limits = (free.low[i], "min"), (free.high[i], "max")
        if abs(h[i]) > 1e-9:
            ends = sorted(((limit - free.least[i]) / h[i], name) for limit, name in limits)
        else:   # the cable does not mind λ: it agrees with all or none
            kept = free.low[i] <= free.least[i] <= free.high[i]
            ends = [(-np.inf, ""), (np.inf if kept else -np.inf, "")]
        left, right = np.clip([end for end, _ in ends], low - room, high + room)
        color = cable_style(i).color
        panel.barh(i + 1, right - left, left=left, height=0.5, color=color, alpha=0.55, edgecolor=color)
        for (end, name), side, gap in zip(ends, ("left", "right"), (4, -4)):
            if low < end < high:
                panel.annotate(name, (end, i + 1), (gap, 0), textcoords="offset points", ha=side, va="center",
                               fontsize=9, color=INK)
    title = "Empty: no λ suits all cables"
    if len(free.corners):
        first, last = free.corners[[0, -1], 0]
        panel.axvspan(first, last, facecolor=GREY, alpha=0.22, edgecolor=INK, zorder=0)
        title = f"Feasible λ: {first + 0.0:.4g} to {last + 0.0:.4g} N".replace("-", "−")
    panel.set(xlim=(low, high), ylim=(m + 0.6, -0.7), yticks=range(m + 1),
              yticklabels=["answers", *(f"cable {i + 1}" for i in range(m))],
              xlabel="λ [N], to the right Σ τ grows", ylabel="", title=title)
    panel.grid(axis="y", visible=False)


def draw_tensions(panel: Axes, tensions: Array, low: Array, high: Array, title: str) -> None:
    """Tensions as bars with their numbers between their limits, under house style; broken limits are named.

    tensions : (m,) [N], NaN where there are none
    """
    m, close, there = tensions.size, MET * high.max(), np.nan_to_num(tensions)
    top = max(np.abs(there).max(), 1.0, 1.5 * low.max())
    near = high <= 1.6 * top
    broken = np.select([tensions < low - close, tensions > high + close], [" below min", " above max"], "")
    words = [f"{tension:.4g} N{how}".replace("-", "−") if np.isfinite(tension) else ""
             for tension, how in zip(tensions, broken)]
    # Words stand beyond a limit's mark, which would strike them through.
    ends = np.maximum(there, np.where(near & (high - there < 0.4 * top), high, low))
    draw_bars(panel, there, [*map(cable_style, range(m))], words, ends, broken != "")
    marks = [[(limits[k], k + 0.6), (limits[k], k + 1.4)]
             for limits, cables in ((low, range(m)), (high, np.flatnonzero(near))) for k in cables]
    panel.add_collection(LineCollection(marks, colors=INK, linewidths=2.2, zorder=5), autolim=False)
    bottom, right = min(there.min(), 0.0), high[near].max(initial=top)
    room = 1.0 if (tensions > high).any() else 0.5
    bar_panel(panel, m, round_up(right + room * (right - bottom)), bottom)
    panel.set(xlabel="tension [N]; black: limits", title=title)
