"""The same side of an edge, (A_j − A_i) × (M − A_i), in interval forms that differ in how much they over-estimate.

Interval arithmetic takes every occurrence of a variable as a new, independent one. A form in which a variable occurs
twice therefore answers with a range that is too wide: it may call uncertain what is certain, never the reverse.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..arrays import Array
from ..errors import InvalidInput
from ..mechanics.intervals import outward

Side = Callable[[Any, Any, Any], tuple[float, float]]
"""Boxes of A_i, A_j and M in plan → the range of the side."""


def side_range(start: Array, end: Array, position: Array, exit_uncertainty: float, position_uncertainty: float,
               form: str) -> tuple[float, float]:
    """Lower and upper end of (A_j − A_i) × (M − A_i) over boxes, in one of ``FORMS`` [m²].

    start, end : (2,) A_i and A_j in plan [m]; position : (2,) M in plan [m]
    exit_uncertainty, position_uncertainty : half widths of the boxes [m]
    Raises InvalidInput for an unknown form.

    >>> import numpy as np
    >>> A, B, M = np.array([0, 0.0]), np.array([4, 0.0]), np.array([2, 0.3])
    >>> [f"{side_range(A, B, M, 0.02, 0.05, form)[0]:.3f}" for form in ("corners", "translated", "natural")]
    ['0.911', '0.888', '0.828']
    """
    if form not in FORMS:
        raise InvalidInput(f"interval form must be one of {', '.join(FORMS)}, got {form!r}")
    with outward():
        boxes = [_box(start, exit_uncertainty), _box(end, exit_uncertainty), _box(position, position_uncertainty)]
        return FORMS[form](*boxes)


def _box(center: Array, radius: float) -> Any:
    from codac import Interval

    return [Interval(float(x) - radius, float(x) + radius) for x in center]


def _natural(a: Any, b: Any, m: Any) -> tuple[float, float]:
    value = (b[0] - a[0]) * (m[1] - a[1]) - (b[1] - a[1]) * (m[0] - a[0])
    return value.lb(), value.ub()


def _translated(a: Any, b: Any, m: Any) -> tuple[float, float]:
    value = (a[0] - m[0]) * (b[1] - m[1]) - (a[1] - m[1]) * (b[0] - m[0])
    return value.lb(), value.ub()


def _corner_range(a: Any, b: Any, m: Any) -> tuple[float, float]:
    """Multilinear: smallest and largest at the 64 corners, each evaluated with outward rounding."""
    from itertools import product

    from codac import Interval

    ends = [[Interval(x.lb()), Interval(x.ub())] for x in (*a, *b, *m)]
    values = [_natural((x, y), (u, v), (p, q)) for x, y, u, v, p, q in product(*ends)]
    return min(low for low, _ in values), max(high for _, high in values)


def _contractor(a: Any, b: Any, m: Any) -> tuple[float, float]:
    """The natural form, then its ends pulled in while a forward-backward contractor proves the strip beyond empty."""
    low, high = _natural(a, b, m)
    return _pull_in(a, b, m, low, high), -_pull_in(b, a, m, -high, -low)


def _pull_in(a: Any, b: Any, m: Any, low: float, high: float) -> float:
    """The largest t found by halving for which no point of the boxes has a side in [low, t]."""
    from codac import AnalyticFunction, CtcFixpoint, CtcInverse, Interval, IntervalVector, VectorVar

    x = VectorVar(6)
    side = AnalyticFunction([x], (x[2] - x[0]) * (x[5] - x[1]) - (x[3] - x[1]) * (x[4] - x[0]))
    proven, open_end = low, high
    for _ in range(20):
        middle = (proven + open_end) / 2
        box = IntervalVector([*a, *b, *m])
        CtcFixpoint(CtcInverse(side, Interval(low - 1.0, middle)), 1e-3).contract(box)
        proven, open_end = (middle, open_end) if box.is_empty() else (proven, middle)
    return proven


FORMS: dict[str, Side] = {"corners": _corner_range, "translated": _translated, "natural": _natural,
                          "contractor": _contractor}
"""Exact · (A_i − M) × (A_j − M) · as written · as written, then contracted."""
