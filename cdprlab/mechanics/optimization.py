"""The programs that have no room of their own: whoever has rows, limits and one wish asks here."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array


def largest_last(A: Any, b: Array, A_eq: Any = None, b_eq: Array | None = None,
                 bounds: Any = (None, None)) -> tuple[float, Array]:
    """max s with A [x; s] ≤ b, A_eq [x; s] = b_eq and bounds on each or on all of them: one linear program.

    A, A_eq : (k, v + 1), (e, v + 1), plain or sparse
    bounds : (least, most) for all, or one pair a variable; None where there is none
    Returns s, −inf where nothing keeps the rows, inf where they do not limit it, NaN where the solver gives up; and
    x (v,), NaN without an answer.
    Source: Huangfu and Hall 2018 (HiGHS).

    >>> largest_last(np.array([[1.0, 1.0], [-1.0, 1.0]]), np.array([3.0, 1.0]))
    (2.0, array([1.]))
    """
    from scipy.optimize import linprog

    cost = np.zeros(A.shape[1])
    cost[-1] = -1.0
    found = linprog(cost, A, b, A_eq, b_eq, bounds, method="highs")
    if found.status == 0:
        return float(found.x[-1]), np.asarray(found.x[:-1])
    return {2: -np.inf, 3: np.inf}.get(found.status, np.nan), np.full(cost.size - 1, np.nan)
