"""Available twist and wrench sets as pictures: plane shadows and cuts, charts per axis."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike

from ...arrays import Array, as_array, checked
from ...errors import InvalidInput, quoted
from ...robot.pattern import motion_pattern as patterns
from ...view.style import BLUE, CABLE_DASHES, GREEN, INK, ORANGE, VERMILION

COLORS = (BLUE, VERMILION, GREEN, ORANGE)
"""Of the first, second, … set; outlines and hatches differ too, for those who see no colors."""

HATCHES = ("", "///", "...", "xx")

Quantity = Literal["twist", "wrench"]

_LETTERS = {"twist": ("v", "ω"), "wrench": ("f", "m")}
_UNITS = {"v": "m/s", "ω": "rad/s", "f": "N", "m": "N m"}


@checked
def axis_names(motion_pattern: str, quantity: Quantity) -> tuple[str, ...]:
    """What the components of a twist or wrench are called, in the pattern's order.

    >>> axis_names("1R2T", "twist")
    ('v_x', 'v_y', 'ω')
    """
    pattern, (along, about) = patterns(motion_pattern), _LETTERS[quantity]
    if pattern.dimension == 2:  # all turns are about the same axis
        return tuple(about if row == "rz" else f"{along}_{row}" for row in pattern.rows)
    return tuple(f"{about}_{row[1:]}" if row[0] == "r" else f"{along}_{row}"
                 for row in pattern.rows)


def axis_label(name: str) -> str:
    """The name with its unit, as matplotlib sets it.

    >>> axis_label("f_x")
    '$f_x$ [N]'
    """
    return f"{_math(name)} [{_UNITS[name[0]]}]"


@checked
def draw_polygon(axes: Axes, vertices: Annotated[Array, "(v, 2)"], style: int = 0, label: str = "") -> Polygon:
    """A plane set on axes of one's own, ready to be moved by ``set_xy``.

    vertices : (v, 2) in order
    style : which of the colors and outlines, from 0
    """
    color = COLORS[style % 4]
    patch = Polygon(vertices, label=label, linewidth=1.8, linestyle=CABLE_DASHES[style % 4], edgecolor=color,
                    facecolor=to_rgba(color, 0.16))
    axes.add_patch(patch)
    return patch


@checked
def draw_capability(axes: Axes, bars: Mapping[str, ArrayLike], names: Sequence[str], group: Sequence[int]) -> None:
    """Bars on axes of one's own, every bar with its number.

    bars : label → (n,) one value an axis, for instance
        ``np.abs(polytope.component_range()).max(axis=1)``
    names : of the axes, as `axis_names` gives them; group : indices of those that are drawn, of
        one unit
    """
    if not bars or not len(group) or not 0 <= min(group) <= max(group) < len(names):
        raise InvalidInput(f"group must be indices of names, 0 to {len(names) - 1}, and bars one at least; "
                           f"got {quoted(group)} and {quoted(bars)}")
    chosen, width = list(group), 0.8 / len(bars)
    for k, (label, values) in enumerate(bars.items()):
        told = np.ravel(np.asarray(values, object))
        none = np.not_equal(told, told)   # nan
        known = as_array(np.where(none, 0.0, told), label, (len(names),), limit=np.inf)
        heights = np.nan_to_num(known)[chosen]
        places = np.arange(len(chosen)) + (k - (len(bars) - 1) / 2) * width
        drawn = axes.bar(places, heights, 0.92 * width, label=label,
                         color=to_rgba(COLORS[k % 4], 0.75), edgecolor=INK, linewidth=0.6,
                         hatch=HATCHES[k % 4])
        axes.bar_label(drawn, ["none" if lost else f"{h:.3g}" for lost, h in zip(none[chosen], heights)],
                       padding=2, fontsize=8)
    axes.set_xticks(range(len(chosen)), [_math(names[i]) for i in chosen])
    axes.set_ylabel(f"[{_UNITS[names[chosen[0]][0]]}]")
    axes.grid(axis="x", visible=False)
    axes.margins(y=0.12)


def _math(name: str) -> str:
    letter, _, axis = name.partition("_")
    symbol = r"\omega" if letter == "ω" else letter
    index = f"_{{{axis}}}".replace("′", "'") if len(axis) > 1 else f"_{axis}" if axis else ""
    return f"${symbol}{index}$"
