"""Least sum of tensions inside the limits: min Σ τ subject to W τ + w_e = 0, τ_min ≤ τ ≤ τ_max."""

from functools import partial

import numpy as np

from ..arrays import Array
from ..compiled import LOWEST, TOLERANCE
from .feasible_polygon import polygon_points
from .law import tension_scale
from .method import INFEASIBLE, UNREACHABLE, Answers, Solution, one_by_one, sharpened, vectorized
from .quadratic_program import independent_rows


def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
    """A corner of the feasible set: with up to two redundant cables the best of the polygon's, else by HiGHS.

    Among equally good corners of a polygon that with the smaller tension in cable 1, then 2, …
    Source: Okoli 2016, eq. (6.24); Huangfu and Hall 2018 (HiGHS).
    """
    tensions, reasons, spare = polygon_points(W, w_e, low, high, LOWEST)
    one_by_one((spare > 2) & (reasons == ""), lambda *limits: partial(_highs, *limits),
               W, w_e, low, high, tensions, reasons)
    return tensions, reasons


def _highs(low: Array, high: Array, W: Array, w_e: Array) -> Solution:
    from scipy.optimize import linprog

    unit = tension_scale(w_e, low).max()   # HiGHS's tolerances are absolute
    found = linprog(np.ones(low.size), A_eq=W, b_eq=-w_e / unit, bounds=np.stack([low, high], axis=1) / unit,
                    method="highs-ds")
    if found.status == 0:   # it leaves 1e-7 of equilibrium, ten times the tolerance
        return sharpened(W, w_e, low, high, found.x * unit), ""
    reason = INFEASIBLE if found.status == 2 else f"HiGHS gave up: {found.message}"
    if independent_rows(W, -w_e)[2] > TOLERANCE * (1 + np.abs(w_e).max()):
        reason = UNREACHABLE
    return np.full(low.size, np.nan), reason


METHOD = vectorized(solve, complete=True,
                    summary="min Σ τ inside the limits: least total tension, jumps between corners")
