"""How far a line runs inside a `Polytope`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from .simplex import maximize
from .subspace import solve

if TYPE_CHECKING:
    from .polytope import Polytope


def line_ends(polytope: Polytope, start: Array, way: Array) -> tuple[float, float]:
    """Smallest and largest s with start + s way inside, nan where no s is.

    A program over s and what the map forgets: M q = start + s way is solved by q = q₀ + s q₁ + K y.

    start, way : (n,)

    >>> from cdprlab.sets import Polytope
    >>> line_ends(Polytope.from_box(np.eye(2), [-1, -1], [1, 3]), np.zeros(2), np.array([0.0, 2.0]))
    (-0.5, 1.5)
    """
    q, reached = solve(polytope.map, np.stack([start - polytope.shift, way]))
    if not reached[1]:      # the set does not extend that way at all
        return (0.0, 0.0) if polytope.contains(start) else (np.nan, np.nan)
    rows = polytope.rows @ np.concatenate([polytope._null, q[1][:, None]], axis=1)
    goals = np.zeros((2, rows.shape[1]))
    goals[:, -1] = -1.0, 1.0
    low, high = maximize(rows, polytope.limits - polytope.rows @ q[0], goals).values
    if not reached[0] or np.isneginf(low):
        return np.nan, np.nan
    if not way.any():
        return -np.inf, np.inf
    return -float(low), float(high)
