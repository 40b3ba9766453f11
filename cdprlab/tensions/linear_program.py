"""Least sum of tensions inside the limits: min Σ τ subject to W τ + w_e = 0, τ_min ≤ τ ≤ τ_max."""

import numpy as np

from ..arrays import Array
from ..compiled import LOWEST
from .feasible_polygon import polygon_points, unanswered
from .law import reachable, tension_scale
from .method import INFEASIBLE, UNREACHABLE, Answers, Solution, sharpened, vectorized


def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
    """A corner of the feasible set: with up to two redundant cables the best of the polygon's, else by HiGHS.

    Among equally good corners of a polygon that with the smaller tension in cable 1, then 2, …
    Source: Okoli 2016, eq. (6.24); Huangfu and Hall 2018 (HiGHS).
    """
    tensions, reasons, spare = polygon_points(W, w_e, low, high, LOWEST)
    lows, highs = (np.broadcast_to(limit, tensions.shape) for limit in (low, high))
    for k in unanswered(spare, reasons):
        tensions[k], reasons[k] = _highs(W[k], w_e[k], lows[k], highs[k])
    return tensions, reasons


def _highs(W: Array, w_e: Array, low: Array, high: Array) -> Solution:
    from scipy.optimize import linprog

    unit = tension_scale(w_e, low).max()   # HiGHS's tolerances are absolute
    found = linprog(np.ones(low.size), A_eq=W, b_eq=-w_e / unit, bounds=np.stack([low, high], axis=1) / unit,
                    method="highs-ds")
    if found.status == 0:   # it leaves 1e-7 of equilibrium, ten times the tolerance
        return sharpened(W, w_e, low, high, found.x * unit), ""
    if not reachable(W, w_e):
        return np.full(low.size, np.nan), UNREACHABLE
    return np.full(low.size, np.nan), INFEASIBLE if found.status == 2 else f"HiGHS gave up: {found.message}"


METHOD = vectorized(solve, complete=True,
                    summary="min Σ τ inside the limits: least total tension, jumps between corners")
