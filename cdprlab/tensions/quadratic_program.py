"""Least-norm tensions inside the limits: min ‖τ‖² subject to W τ + w_e = 0, τ_min ≤ τ ≤ τ_max."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from ..arrays import Array, frozen
from ..errors import InvalidInput
from .method import (
    INFEASIBLE,
    LIMIT_TOLERANCE,
    NOT_FINITE,
    RESIDUAL_TOLERANCE,
    Method,
    Solution,
    Solver,
    around_fixed,
    sharpened,
)


def build(n: int, tension_min: Array, tension_max: Array, *, solver: str = "quadprog") -> Solver:
    """min ‖τ‖² subject to W τ + w_e = 0 and the limits.

    solver : "quadprog", called directly, or any other that qpsolvers has installed
    Source: Okoli 2016, eq. (6.25); Goldfarb and Idnani 1983 (quadprog's dual active-set method).
    """
    if solver == "quadprog":
        return around_fixed(lambda low, high: _quadprog(n, low, high), tension_min, tension_max)
    return around_fixed(lambda low, high: _other_solver(low, high, solver), tension_min, tension_max)


def _quadprog(n: int, tension_min: Array, tension_max: Array) -> Solver:
    import quadprog

    m = tension_min.shape[0]
    quadprog_solve = quadprog.solve_qp
    least_norm = _least_norm(tension_min, tension_max)
    program: list[Array] = []

    def solve(W: Array, w_e: Array) -> Solution:
        tau = least_norm(W, w_e)
        if tau is not None:
            return tau, ""
        if not np.isfinite(w_e).all():   # quadprog answers NaN with numbers
            return np.full(m, np.nan), NOT_FINITE
        if not program:   # all but W and w_e is written once
            program.extend(part.copy() for part in _template(n, m))   # quadprog takes no read-only arrays
            program.append(np.concatenate([np.zeros(n), tension_min, -tension_max]))
        identity, zero, constraints, bounds = program
        constraints[:, :n] = W.T
        np.negative(w_e, out=bounds[:n])
        try:
            return quadprog_solve(identity, zero, constraints, bounds, n, True)[0], ""
        except ValueError:
            return _without_dependent_rows(W, w_e, tension_min, tension_max)

    return solve


@cache
def _template(n: int, m: int) -> tuple[Array, Array, Array]:
    """‖τ‖², no linear cost, and the rows [0, I, −I] of Cᵀ x ≥ b as quadprog wants them, equalities first."""
    one = np.eye(m)
    return frozen(one), frozen(np.zeros(m)), frozen(np.concatenate([np.zeros((m, n)), one, -one], axis=1))


def _least_norm(low: Array, high: Array) -> Callable[[Array, Array], Array | None]:
    """τ = −Wᵀ (W Wᵀ)⁻¹ w_e where it keeps the limits: the program's solution with no limit active, at half its cost."""
    from scipy.linalg.lapack import dposv

    lows, highs = low.tolist(), high.tolist()

    def solve(W: Array, w_e: Array) -> Array | None:
        factor, y, failed = dposv(W.dot(W.T), w_e)
        # W Wᵀ has W's condition squared, of which the factor's diagonal is an estimate: 1e-3 leaves residuals of
        # about 1e6 ε = 1e-10, and what is worse conditioned goes to the program.
        diagonal = factor.diagonal().tolist()
        if failed or min(diagonal) < 1e-3 * max(diagonal):
            return None
        tau = -y.dot(W)
        for smallest, tension, largest in zip(lows, tau.tolist(), highs):
            if not smallest <= tension <= largest:
                return None
        return tau

    return solve


def min_norm(rows: Array, values: Array, low: Array, high: Array) -> Array | None:
    """min ‖τ‖² with rows τ = values and low ≤ τ ≤ high, rows independent; None if there is none."""
    import quadprog

    m = low.shape[0]
    identity = np.eye(m)
    constraints = np.concatenate([rows.T, identity, -identity], axis=1)
    bounds = np.concatenate([values, low, -high])
    try:
        return quadprog.solve_qp(identity, np.zeros(m), constraints, bounds, rows.shape[0], True)[0]
    except ValueError:
        return None


def independent_rows(W: Array, values: Array) -> tuple[Array, Array, float]:
    """Orthonormal rows with the same row space as W, their values, and how far ``values`` is off W's range.

    W τ = values  ⇔  rows τ = reduced, if the last number is zero.
    """
    u, s, vt = np.linalg.svd(W, full_matrices=False)
    rank = int((s > s[0] * max(W.shape) * np.finfo(float).eps).sum()) if s.size and s[0] > 0 else 0
    inside = u[:, :rank].T @ values
    outside = float(np.abs(values - u[:, :rank] @ inside).max(initial=0.0))
    return vt[:rank], inside / s[:rank], outside


def _without_dependent_rows(W: Array, w_e: Array, low: Array, high: Array) -> Solution:
    """What is left when the direct call fails: dependent rows of W, a single point, or truly no solution."""
    nothing = np.full(W.shape[1], np.nan)
    rows, values, outside = independent_rows(W, -w_e)
    if outside > RESIDUAL_TOLERANCE * (1 + np.abs(w_e).max()):
        return nothing, (f"the cables cannot exert this wrench at any tension: W has rank {rows.shape[0]} of "
                         f"{W.shape[0]}, and {outside:.3g} N or N m lies outside its range")
    found = min_norm(rows, values, low, high)
    if found is None:   # one last tension on the very border is lost to rounding: half of what the check forgives
        slack = LIMIT_TOLERANCE / 2 * high.max()
        found = min_norm(rows, values, low - slack, high + slack)
        found = None if found is None else sharpened(W, w_e, low, high, found)
    return (nothing, INFEASIBLE) if found is None else (found, "")


def _other_solver(low: Array, high: Array, solver: str) -> Solver:
    import qpsolvers

    if solver not in qpsolvers.available_solvers:
        raise InvalidInput(f"QP solver {solver!r} is not installed; there are "
                           f"{', '.join(qpsolvers.available_solvers)}")
    m = low.shape[0]

    def solve(W: Array, w_e: Array) -> Solution:
        rows, values, outside = independent_rows(W, -w_e)
        reachable = outside <= RESIDUAL_TOLERANCE * (1 + np.abs(w_e).max())
        found = qpsolvers.solve_qp(np.eye(m), np.zeros(m), A=rows, b=values, lb=np.array(low), ub=np.array(high),
                                   solver=solver) if reachable else None
        return (np.full(m, np.nan), INFEASIBLE) if found is None else (found, "")

    return solve


METHOD = Method(build, complete=True, summary="min ‖τ‖² inside the limits: smooth, low tensions")
