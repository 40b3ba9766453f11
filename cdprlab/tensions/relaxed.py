"""When no tensions balance the wrench: the least wrench error inside the limits, then the least tensions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput
from ..mechanics.optimization import least_quadratic
from . import quadratic_program
from .method import (
    INFEASIBLE,
    NOT_FINITE,
    RESIDUAL_TOLERANCE,
    Answers,
    BatchSolver,
    Method,
    Solution,
    Solver,
    around_fixed,
    one_by_one,
)
from .quadratic_program import LeastNorm, independent_rows

# The first program's weight on ‖τ‖², relative to W's: small enough to find the right active limits,
# large enough for a Cholesky factor in double precision. The second stage removes its bias.
_RIDGE = 1e-9


def build(n: int, tension_min: Array, tension_max: Array, *, weights: ArrayLike | None = None) -> Solver:
    """First min ‖D (W τ + w_e)‖ inside the limits, then min ‖τ‖ among the tensions that reach it.

    weights : (n,) diagonal of D, default ones: how much a newton counts against a newton meter
    Source: the lexicographic limit of Okoli 2016's slack program (6.3.3).
    """
    scale = np.ones(n) if weights is None else as_array(weights, "weights", (n,))
    if (scale <= 0).any():
        raise InvalidInput(f"weights must be positive, got {scale.tolist()}")

    return around_fixed(lambda low, high: _relaxed(scale, low, high), tension_min, tension_max)


def batch(*, weights: ArrayLike | None = None) -> BatchSolver:
    """The quadratic program where it has an answer; the others one by one."""
    exact = quadratic_program.batch()

    def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
        tensions, reasons = exact(W, w_e, low, high)
        left = reasons != ""
        own = left if len(low) > 1 else slice(None)
        tensions[left], reasons[left] = one_by_one(lambda low, high: build(W.shape[1], low, high, weights=weights),
                                                   W[left], w_e[left], low[own], high[own])
        return tensions, reasons

    return solve


def _relaxed(scale: Array, low: Array, high: Array) -> Solver:
    exact = quadratic_program.build(scale.shape[0], low, high)

    def solve(W: Array, w_e: Array) -> Solution:
        least_norm, reason = exact(W, w_e)
        if not reason or reason == NOT_FINITE:
            return least_norm, reason
        rows, goal = W * scale[:, None], -w_e * scale
        tau = _least_tension(rows, goal, _least_error(rows, goal, low, high), low, high)
        left = float(np.abs(W @ tau + w_e).max())
        balanced = left <= RESIDUAL_TOLERANCE * (1 + float(np.abs(w_e).max()))
        return tau, "" if balanced else f"{INFEASIBLE}; {left:.3g} N or N m is left"

    return solve


def _least_error(rows: Array, goal: Array, low: Array, high: Array) -> Array:
    """min ‖rows τ − goal‖² + ridge ‖τ‖² inside the limits."""
    m = low.shape[0]
    gram = rows.T @ rows
    gram[np.diag_indices(m)] += _RIDGE * max(np.trace(gram), np.finfo(float).tiny)
    identity = np.eye(m)
    limits = np.concatenate([identity, -identity], axis=1)
    found = least_quadratic(gram, rows.T @ goal, limits, np.concatenate([low, -high]))
    assert found is not None, "limits are in order"
    return np.clip(found, low, high)


def _least_tension(rows: Array, goal: Array, first: Array, low: Array, high: Array) -> Array:
    """The exact lexicographic answer: cables held at a limit stay there, the free ones solve anew."""
    at_limit = 1e-7 * (1 + high - low)
    free = (first > low + at_limit) & (first < high - at_limit)
    held = np.where(first <= low + at_limit, low, high)
    tau = np.where(free, first, held)
    if free.any():
        tau[free] = np.linalg.lstsq(rows[:, free], goal - rows[:, ~free] @ tau[~free], rcond=None)[0]
    if ((tau < low) | (tau > high)).any():
        tau = first
    # All tensions that give this wrench: the least of them, where rounding leaves that set non-empty.
    equal, values, _ = independent_rows(rows, rows @ tau)
    least = LeastNorm(len(equal), low, high).program(equal, -values)
    return tau if least is None else least


METHOD = Method(build, complete=True, summary="least wrench error inside the limits, then least norm", batch=batch)
