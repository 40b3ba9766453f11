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
from ..mechanics.intervals import Intervals, exact, stack
from .configuration import HalfWidth

Spot = Annotated[Array, "(2,) [m]"]
Side = Callable[[Intervals, Intervals, Intervals], Intervals]
"""Boxes (…, 2) of A_i, A_j and M in plan → the range of the side."""


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
    a, b, m = (exact(center) + Intervals(-radius, radius) for center, radius in (
        (start, exit_uncertainty), (end, exit_uncertainty), (position, position_uncertainty)))
    found = FORMS[form](a, b, m)
    return float(found.lower), float(found.upper)


def _natural(a: Intervals, b: Intervals, m: Intervals) -> Intervals:
    return _cross(b - a, m - a)


def _translated(a: Intervals, b: Intervals, m: Intervals) -> Intervals:
    return _cross(a - m, b - m)


def _cross(x: Intervals, y: Intervals) -> Intervals:
    products = x * y[..., ::-1]
    return products[..., 0] - products[..., 1]


def _corner_range(a: Intervals, b: Intervals, m: Intervals) -> Intervals:
    """Multilinear: smallest and largest at the 64 corners, each evaluated with outward rounding."""
    ends = [end for box in (a, b, m) for end in zip(box.lower, box.upper)]
    corners = exact(np.array(list(product(*ends))))
    found = _natural(corners[:, :2], corners[:, 2:4], corners[:, 4:])
    return Intervals(found.lower.min(), found.upper.max())


def _contractor(a: Intervals, b: Intervals, m: Intervals) -> Intervals:
    """The natural form, then its ends pulled in while a contractor proves the strip beyond empty."""
    whole = _natural(a, b, m)
    return Intervals(_pull_in(a, b, m, whole.lower, whole.upper),
                     -_pull_in(b, a, m, -whole.upper, -whole.lower))


def _pull_in(a: Intervals, b: Intervals, m: Intervals, low: float, high: float) -> float:
    """The largest t, to a millionth of the range, for which no point of the boxes has a side in [low, t]."""
    for _ in range(4):
        ends = np.linspace(low, high, 33)
        proven = _out_of_reach(a, b, m, Intervals(np.full(32, low - 1.0), ends[1:]))
        first = int(proven.argmin())        # the last one, which is the whole range, is not out of reach
        low, high = ends[first], ends[first + 1]
    return float(low)


def _out_of_reach(a: Intervals, b: Intervals, m: Intervals, strips: Intervals) -> Flags:
    """(k,) for each strip: narrow the boxes to what it allows until one of them is empty.

    The side is of second degree: side(c + h) = side(c) + g · h with its gradient g at c + h /
    2.
    """
    box = Intervals(np.concatenate([a.lower, b.lower, m.lower]),
                    np.concatenate([a.upper, b.upper, m.upper]))
    box, before = box * np.ones((len(strips.lower), 1)), np.full(6, np.inf)
    empty = np.zeros(len(strips.lower), dtype=bool)
    with np.errstate(all="ignore"):
        while not (empty | ~(box.width < 0.999 * before).any(axis=-1)).all():
            before, c = box.width, (box.lower + box.upper) / 2
            h, z = box - c, (box + c) * 0.5
            g = stack([z[:, j] - z[:, k]
                       for j, k in ((3, 5), (4, 2), (5, 1), (0, 4), (1, 3), (2, 0))])
            wanted = strips - _natural(exact(c[:, :2]), exact(c[:, 2:4]), exact(c[:, 4:]))
            others = ((g * h)[:, None, :] * (1 - np.eye(6))).total()
            box = box & (wanted[:, None] - others) / g + c
            empty |= (box.width < 0).any(axis=-1)
    return empty


FORMS: dict[str, Side] = {"corners": _corner_range, "translated": _translated,
                          "natural": _natural,
                          "contractor": _contractor}
"""Exact · (A_i − M) × (A_j − M) · as written · as written, then contracted."""
