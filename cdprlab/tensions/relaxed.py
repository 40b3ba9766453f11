"""When no tensions balance the wrench: the least wrench error inside the limits, then the least tensions."""

from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, as_array
from ..compiled import TOLERANCE
from ..errors import InvalidInput
from ..mechanics.optimization import least_quadratic
from . import quadratic_program
from .law import NOT_FINITE, limits_kept, tension_scale
from .method import (
    INFEASIBLE,
    Answers,
    Method,
    Solution,
    Solver,
    around_fixed,
    one_by_one,
)
from .quadratic_program import LeastNorm

# The first program's weight on ‖τ‖², relative to W's: small enough to find the right active
# limits, large enough for a Cholesky factor in double precision. The second stage removes its
# bias.
_RIDGE = 1e-9


def build(n: int, tension_min: Array, tension_max: Array, *, weights: ArrayLike | None = None) -> Solver:
    """First min ‖D (W τ + w_e)‖ inside the limits, then min ‖τ‖ among the tensions that reach it.

    weights : (n,) diagonal of D, default ones: how much a newton counts against a newton meter
    Source: the lexicographic limit of Okoli 2016's slack program (6.3.3).
    """
    scale = np.ones(n) if weights is None else as_array(weights, "weights", (n,))
    if (scale <= 0).any():
        raise InvalidInput(f"weights must be positive, got {scale.tolist()}")
    return around_fixed(partial(_relaxed, scale), tension_min, tension_max)


def solve(W: Array, w_e: Array, low: Array, high: Array, *, weights: ArrayLike | None = None) -> Answers:
    """The quadratic program where it has an answer; the others one by one."""
    tensions, reasons = quadratic_program.solve(W, w_e, low, high)
    one_by_one(reasons != "", partial(build, W.shape[1], weights=weights), W, w_e, low, high, tensions, reasons)
    return tensions, reasons


def _relaxed(scale: Array, low: Array, high: Array) -> Solver:
    exact = LeastNorm(scale.size, low, high)

    def solve(W: Array, w_e: Array) -> Solution:
        tau, kept = exact.no_limit_active(W, w_e, low, high)
        if not kept:
            tau = least_quadratic(*exact.program(W, w_e))
        if tau is not None:
            return tau, ""
        if not np.isfinite(w_e).all():
            return np.full(low.size, np.nan), NOT_FINITE
        tau, movable = _least_error(W * scale[:, None], -w_e * scale, low, high, w_e)
        if movable.any():   # of all tensions that give this wrench the least
            columns = W[:, movable]
            least, lost = LeastNorm(scale.size, low[movable], high[movable])(columns, -(columns @ tau[movable]))
            if not lost:   # to rounding
                tau[movable] = least
        left = float(np.abs(W @ tau + w_e).max())
        balanced = left <= TOLERANCE * (1 + float(np.abs(w_e).max()))
        return tau, "" if balanced else f"{INFEASIBLE}; {left:.3g} N or N m is left"

    return solve


def _least_error(rows: Array, goal: Array, low: Array, high: Array,
                 w_e: Array) -> tuple[Array, NDArray[np.bool_]]:
    """min ‖rows τ − goal‖ inside the limits, and which cables the error leaves a choice; none if it is the only point.

    The program finds the cables at a limit, the free ones are then solved anew without its
    ridge.
    """
    reach, away = float((np.abs(rows) @ high).max()), float(np.abs(goal).max())
    if away > reach:   # no tolerance grows beyond what cables can do; far away only the direction counts
        w_e = w_e * (reach / away)
        goal = goal * min(1.0, 1e5 * reach / away)
    identity = np.eye(low.size)
    gram = rows.T @ rows
    gram += _RIDGE * (np.trace(gram) or 1.0) * identity
    limits = np.concatenate([identity, -identity], axis=1)
    found = least_quadratic(gram, rows.T @ goal, limits, np.concatenate([low, -high]))
    assert found is not None, "limits are in order"
    at_limit = 1e-6 * tension_scale(w_e, low)   # a thousand times the ridge
    at_low, at_high = found <= low + at_limit, found >= high - at_limit
    free = ~(at_low | at_high)
    tau = np.where(at_low, low, np.where(at_high, high, found))
    tau[free], _, rank, _ = np.linalg.lstsq(rows[:, free], goal - rows[:, ~free] @ tau[~free],
                                            rcond=None)
    sharp = limits_kept(tau, w_e, low, high)
    tau = np.clip(tau if sharp else found, low, high)
    # A cable that the error pulls against its limit stays there, whatever the others do.
    pull = np.abs(rows.T @ (rows @ tau - goal))
    movable = free | (pull <= 1e-9 * np.abs(rows).max() * np.abs(goal).max())
    return tau, movable & (not sharp or rank < movable.sum())


METHOD = Method(solve, build, complete=True, summary="least wrench error inside the limits, then least norm")
