"""The same side of an edge, (A_j − A_i) × (M − A_i), in interval forms that differ in how much they over-estimate.

Interval arithmetic takes every occurrence of a variable as a new, independent one. A form in
which a variable occurs twice therefore answers with a range that is too wide: it may call
uncertain what is certain, never the reverse.
"""

from collections.abc import Callable
from itertools import product
from typing import Annotated

import numpy as np

from ..arrays import Array, Flags, checked
from ..errors import InvalidInput, quoted
from ..mechanics.intervals import Intervals, exact
from .configuration import HalfWidth

Spot = Annotated[Array, "(2,) [m]"]


@checked
def side_range(start: Spot, end: Spot, position: Spot, exit_uncertainty: HalfWidth,
               position_uncertainty: HalfWidth, form: str) -> tuple[float, float]:
    """Lower and upper end of (A_j − A_i) × (M − A_i) over boxes, in one of ``FORMS`` [m²].

    start, end : (2,) A_i and A_j in plan [m]; position : (2,) M in plan [m]
    exit_uncertainty, position_uncertainty : half widths of the boxes [m]
    Raises InvalidInput for an unknown form.

    >>> A, B, M = np.array([0, 0.0]), np.array([4, 0.0]), np.array([2, 0.3])
    >>> [f"{side_range(A, B, M, 0.02, 0.05, form)[0]:.3f}" for form in ("corners", "translated", "natural")]
    ['0.911', '0.888', '0.828']
    """
    if form not in FORMS:
        raise InvalidInput(f"interval form must be one of {', '.join(FORMS)}, got {quoted(form)}")
    radii = np.repeat([exit_uncertainty, exit_uncertainty, position_uncertainty], 2)
    found = FORMS[form](exact(np.concatenate([start, end, position])) + Intervals(-radii, radii))
    return float(found.lower), float(found.upper)


def _natural(box: Intervals) -> Intervals:
    a, b, m = box[..., :2], box[..., 2:4], box[..., 4:]
    return _cross(b - a, m - a)


def _translated(box: Intervals) -> Intervals:
    m = box[..., 4:]
    return _cross(box[..., :2] - m, box[..., 2:4] - m)


def _cross(x: Intervals, y: Intervals) -> Intervals:
    products = x * y[..., ::-1]
    return products[..., 0] - products[..., 1]


def _corner_range(box: Intervals) -> Intervals:
    """Multilinear: smallest and largest at the 64 corners, each evaluated with outward rounding."""
    found = _natural(exact(list(product(*zip(box.lower, box.upper)))))
    return Intervals(found.lower.min(), found.upper.max())


def _contractor(box: Intervals) -> Intervals:
    """The natural form, then its ends pulled in while a contractor proves the strip beyond empty."""
    whole, turned = _natural(box), box[[2, 3, 0, 1, 4, 5]]
    return Intervals(_pull_in(box, whole.lower, whole.upper), -_pull_in(turned, -whole.upper, -whole.lower))


def _pull_in(box: Intervals, low: float, high: float) -> float:
    """The largest t, to a millionth of the range, for which no point of the box has a side in [low, t]."""
    for _ in range(4):
        ends = np.linspace(low, high, 33)
        proven = _out_of_reach(box, Intervals(np.full(32, low - 1.0), ends[1:]))
        first = proven.argmin()        # the last one, which is the whole range, is not out of reach
        low, high = ends[first], ends[first + 1]
    return low


def _out_of_reach(box: Intervals, strips: Intervals) -> Flags:
    """(k,) for each strip: narrow the box to what it allows until it is empty.

    The side is of second degree: side(c + h) = side(c) + g · h with its gradient g at c + h /
    2.
    """
    box, before = box * np.ones((len(strips.lower), 1)), np.full(6, np.inf)
    empty = np.zeros(len(strips.lower), dtype=bool)
    with np.errstate(all="ignore"):
        while not (empty | ~(box.width < 0.999 * before).any(axis=-1)).all():
            before, c = box.width, (box.lower + box.upper) / 2
            h, z = box - c, (box + c) * 0.5
            g = z[:, [3, 4, 5, 0, 1, 2]] - z[:, [5, 2, 1, 4, 3, 0]]
            others = ((g * h)[:, None, :] * (1 - np.eye(6))).total()
            box = box & ((strips - _natural(exact(c)))[:, None] - others) / g + c
            empty |= (box.width < 0).any(axis=-1)
    return empty


FORMS: dict[str, Callable[[Intervals], Intervals]] = {
    "corners": _corner_range, "translated": _translated, "natural": _natural, "contractor": _contractor}
"""Box (…, 6) of A_i, A_j and M in plan → the range of the side.

Exact · (A_i − M) × (A_j − M) · as written · as written, then contracted."""
