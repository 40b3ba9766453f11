"""Available twist and wrench sets as pictures: shadows and cuts in two or three dimensions, charts per axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import InvalidInput
from ..sets import Polytope
from .plots import Figure
from .style import BLUE, GREEN, INK, ORANGE, VERMILION, house_style

COLORS = (BLUE, VERMILION, GREEN, ORANGE)
"""Of the first, second, … set; outlines and hatches differ too, for those who see no colors."""

DASHES: tuple[Any, ...] = ("solid", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
HATCHES = ("", "///", "...", "xx")

Quantity = Literal["twist", "wrench"]

_AXES = {
    ("1T", "twist"): ("v_x",), ("1T", "wrench"): ("f_x",),
    ("2T", "twist"): ("v_x", "v_y"), ("2T", "wrench"): ("f_x", "f_y"),
    ("1R2T", "twist"): ("v_x", "v_y", "ω"), ("1R2T", "wrench"): ("f_x", "f_y", "m"),
    ("3T", "twist"): ("v_x", "v_y", "v_z"), ("3T", "wrench"): ("f_x", "f_y", "f_z"),
    ("2R3T", "twist"): ("v_x", "v_y", "v_z", "ω_y′", "ω_z′"), ("2R3T", "wrench"): ("f_x", "f_y", "f_z", "m_y′", "m_z′"),
    ("3R3T", "twist"): ("v_x", "v_y", "v_z", "ω_x", "ω_y", "ω_z"),
    ("3R3T", "wrench"): ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z"),
}
_UNITS = {"v": "m/s", "ω": "rad/s", "f": "N", "m": "N m"}


def axis_names(motion_pattern: str, quantity: Quantity) -> tuple[str, ...]:
    """What the components of a twist or wrench are called, in the pattern's order.

    >>> axis_names("1R2T", "twist")
    ('v_x', 'v_y', 'ω')
    """
    if (motion_pattern, quantity) not in _AXES:
        raise InvalidInput(f"no axes for {motion_pattern!r} and {quantity!r}: patterns are 1T, 2T, 1R2T, 3T, 2R3T, "
                           "3R3T, quantities twist and wrench")
    return _AXES[motion_pattern, quantity]


def axis_label(name: str) -> str:
    """The name with its unit, as matplotlib sets it.

    >>> axis_label("f_x")
    '$f_x$ [N]'
    """
    return f"{_math(name)} [{_UNITS[name[0]]}]"


def draw_polygon(axes: Axes, vertices: ArrayLike, style: int = 0, label: str = "") -> Polygon:
    """A plane set on axes of one's own, ready to be moved by ``set_xy``.

    vertices : (v, 2) in order
    style : which of the colors and outlines, from 0
    """
    patch = Polygon(np.asarray(vertices), closed=True, label=label, linewidth=1.8, linestyle=DASHES[style % 4],
                    edgecolor=COLORS[style % 4], facecolor=(*_rgb(COLORS[style % 4]), 0.16))
    axes.add_patch(patch)
    return patch


def draw_polyhedron(axes: Any, polytope: Polytope, style: int = 0, label: str = "") -> Any:
    """A set in three dimensions on 3-D axes: every facet one face, no triangles drawn."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    collection = Poly3DCollection(facet_corners(polytope), linewidths=0.9, label=label,
                                  linestyles=[DASHES[style % 4]], edgecolors=COLORS[style % 4],
                                  facecolors=(*_rgb(COLORS[style % 4]), 0.13))
    axes.add_collection3d(collection)
    return collection


def facet_corners(polytope: Polytope) -> list[Array]:
    """One (k, 3) array a facet of a set in three dimensions: its corners in order around it."""
    vertices, faces = polytope.vertices, []
    size = np.ptp(vertices, axis=0).max(initial=1e-300)
    for normal, offset in zip(polytope.normals, polytope.offsets):
        corners = vertices[np.abs(vertices @ normal - offset) < 1e-7 * size]
        if len(corners) < 3:
            continue
        spokes = corners - corners.mean(axis=0)
        first = spokes[0] / np.linalg.norm(spokes[0])
        faces.append(corners[np.argsort(np.arctan2(spokes @ np.cross(normal, first), spokes @ first))])
    return faces


def plot_sets(sets: Mapping[str, Polytope], names: Sequence[str], points: Mapping[str, ArrayLike] | None = None,
              title: str = "", aspect: Literal["equal", "auto"] = "auto") -> Figure:
    """Sets of the same two or three components in one picture.

    sets : label → Polytope with 2 or 3 components (`Polytope.project` and `Polytope.slice` make them)
    names : of the components, as `axis_names` gives them
    points : label → point that is marked, and said to be inside or not of every set

    >>> square = Polytope.from_box(np.eye(2), [-1, -1], [1, 1])
    >>> len(plot_sets({"square": square}, ("v_x", "v_y")).axes)
    1
    """
    n = len(names)
    if n not in (2, 3) or any(polytope.n != n for polytope in sets.values()):
        raise InvalidInput(f"sets of 2 or 3 components can be drawn, got {n} names for sets of "
                           f"{sorted({polytope.n for polytope in sets.values()})}; use project or slice")
    with house_style():
        figure = Figure(figsize=(6.4, 5.4), layout="constrained")
        axes: Any = figure.add_subplot(projection="3d" if n == 3 else None)
        for style, (label, polytope) in enumerate(sets.items()):
            if n == 2:
                draw_polygon(axes, polytope.vertices, style, label)
            else:
                draw_polyhedron(axes, polytope, style, label)
        _mark(axes, points or {})
        _frame(axes, sets, names, aspect)
        axes.set_title(title)
        axes.legend(loc="upper right")
        figure.alt_text = _alt_text(sets, names, points or {})
    return figure


def draw_capability(axes: Axes, bars: Mapping[str, ArrayLike], names: Sequence[str], group: Sequence[int]) -> None:
    """Bars on axes of one's own, every bar with its number.

    bars : label → (n,) one value an axis, for instance ``np.abs(polytope.component_range()).max(axis=1)``
    names : of the axes, as `axis_names` gives them; group : indices of those that are drawn, of one unit
    """
    width = 0.8 / len(bars)
    for k, (label, values) in enumerate(bars.items()):
        heights = np.asarray(values, dtype=float)[list(group)]
        places = np.arange(len(group)) + (k - (len(bars) - 1) / 2) * width
        drawn = axes.bar(places, np.nan_to_num(heights), 0.92 * width, label=label, 
                         color=(*_rgb(COLORS[k % 4]), 0.75), edgecolor=INK, linewidth=0.6, hatch=HATCHES[k % 4])
        axes.bar_label(drawn, ["none" if np.isnan(h) else f"{h:.3g}" for h in heights], padding=2, fontsize=8)
    axes.set_xticks(range(len(group)), [_math(names[i]) for i in group])
    axes.set_ylabel(f"[{_UNITS[names[group[0]][0]]}]")
    axes.grid(axis="x", visible=False)
    axes.margins(y=0.12)


def _frame(axes: Any, sets: Mapping[str, Polytope], names: Sequence[str], aspect: Literal["equal", "auto"]) -> None:
    corners = np.concatenate([polytope.vertices for polytope in sets.values()])
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = 0.08 * np.where(high > low, high - low, 1.0)
    for letter, name, a, b in zip("xyz", names, low - room, high + room):
        getattr(axes, f"set_{letter}lim")(a, b)
        getattr(axes, f"set_{letter}label")(axis_label(name))
    axes.set_aspect(aspect)


def _mark(axes: Any, points: Mapping[str, ArrayLike]) -> None:
    for label, point in points.items():
        axes.plot(*np.asarray(point, dtype=float)[:, None], marker="o", color=INK, linestyle="none", label=label)


def _alt_text(sets: Mapping[str, Polytope], names: Sequence[str], points: Mapping[str, ArrayLike]) -> str:
    parts = [f"Convex sets over {', '.join(names)}."]
    for label, polytope in sets.items():
        reach = ", ".join(f"{name} from {a:.3g} to {b:.3g}" for name, (a, b) in zip(names, polytope.component_range()))
        where = "".join(f", {mark} {'inside' if polytope.contains(x) else 'outside'}" for mark, x in points.items())
        parts.append(f"{label}: {reach}{where}.")
    return " ".join(parts)


def _math(name: str) -> str:
    letter, _, axis = name.partition("_")
    symbol = r"\omega" if letter == "ω" else letter
    index = f"_{{{axis}}}".replace("′", "'") if len(axis) > 1 else f"_{axis}" if axis else ""
    return f"${symbol}{index}$"


def _rgb(color: str) -> tuple[float, float, float]:
    from matplotlib.colors import to_rgb

    return to_rgb(color)
