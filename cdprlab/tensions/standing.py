"""Tensions that keep mobile bases standing: the limits, and a row for every edge a base could tip about."""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..mechanics.optimization import least_quadratic
from .law import NOT_FINITE
from .method import INFEASIBLE, Solution
from .quadratic_program import kept_rows


def standing_tensions(W: Array, w_e: Array, low: Array, high: Array, rows: Array, offset: Array,
                      *,
                      toward: ArrayLike = 0.0) -> Solution:
    """min ‖τ − τ₀‖² subject to W τ + w_e = 0, the limits, and G τ + g ≤ 0.

    W, w_e : (n, m), (n,) [N, N m]; low, high : (m,) [N]
    rows, offset : G (k, m) [m] and g (k,) [N m], as `tipping_rows` gives them for all bases; k
        may be 0
    toward : τ₀, a number or (m,): 0 is the least norm, more stiffens the robot [N]
    Returns tensions (m,) and '' or the reason why there are none.
    Source: Pedemonte et al. 2020, eq. (21)–(24), as constraints of Okoli 2016, eq. (6.25).

    >>> W, none = np.array([[1.0, -1.0]]), np.zeros((0, 2))
    >>> standing_tensions(W, np.zeros(1), np.ones(2), np.full(2, 9.0), none, np.zeros(0))[0]
    array([1., 1.])
    """
    C, b = kept_rows(W, w_e, low, high)
    found = least_quadratic(np.eye(low.size), np.full(low.size, toward, dtype=float),
                            np.concatenate([C, -rows.T], axis=1), np.concatenate([b, offset]), len(w_e), factored=True)
    if found is not None:
        return found.clip(low, high), ""
    reason = f"{INFEASIBLE} and keep every base standing" if rows.size else INFEASIBLE
    if not np.isfinite([*w_e, *offset]).all():
        reason = NOT_FINITE
    return np.full(low.size, np.nan), reason
