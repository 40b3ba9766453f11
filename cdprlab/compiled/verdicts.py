"""The compiled verdict: whether the polygon of feasible tensions has a corner at all, for many poses."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from .jit import compiled
from .polygon import _BORDER, _ROUNDING, _polygon, _reduce, _spread

OUTSIDE, INSIDE, TOO_REDUNDANT = 0, 1, 2


@compiled
def verdicts(W: Array, w_e: Array, low: Array, high: Array) -> Any:
    """INSIDE, OUTSIDE or TOO_REDUNDANT (k,), where more than a polygon is feasible and W loses rank.

    W (k, n, m); w_e (k, n); low, high (1, m)
    """
    count, n, m = W.shape
    found = np.zeros(count, np.int64)
    rows, line, owner = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m, np.int64)
    c, D, corners = np.empty(m), np.zeros((m, max(m, 2))), np.zeros((4 * m + 16, 3))
    largest = high.max()
    for k in range(count):
        for j in range(m):
            owner[j] = -1
            D[j, 0] = D[j, 1] = 0.0
        rank, reachable = _reduce(W, w_e, k, c, rows, line, owner)
        if not reachable:
            continue
        if m - rank > 2:
            found[k] = TOO_REDUNDANT
            continue
        _spread(rows, owner, c, c, D)
        _, sides = _polygon(c, D, owner, low, high, 0, 0.0, _ROUNDING * largest, corners)
        if sides == 0:   # one last point on the very border is lost to rounding
            _, sides = _polygon(c, D, owner, low, high, 0, _BORDER * largest, 0.0, corners)
        if sides > 0:
            found[k] = INSIDE
    return found
